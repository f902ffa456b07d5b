// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/gmsh.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/csv/csv_reader.hpp"
#include "common/log/log.hpp"
#include "common/mesh/gmsh/sandbox.hpp"

namespace couplet::mesh {
namespace {

namespace fs = std::filesystem;

constexpr int no_module = 3;  // exit code of the script
constexpr std::size_t most_complaints = 3;

// Converts a meshio mesh to an input deck: cell blocks by their smallest group, sets of points as node sets.
constexpr const char* script = R"(
import sys
try:
    import numpy
    import meshio
    if sys.argv[1].endswith('.med'):
        import h5py
    else:
        import netCDF4
except ImportError as missing:
    print(missing.name)
    sys.exit(3)
KINDS = {'tetra': ('C3D4', 4), 'hexahedron': ('C3D8', 8), 'wedge': ('C3D6', 6), 'pyramid': ('C3D5', 5), 'triangle': ('CPS3', 3), 'quad': ('CPS4', 4),
         'line': ('T3D2', 2)}
SECOND = {'tetra10': 'C3D10', 'hexahedron20': 'C3D20', 'wedge15': 'C3D15', 'triangle6': 'CPS6', 'quad8': 'CPS8'}
def plain(name):
    return ''.join('_' if c in ',=*".\'\r\n\t' or ord(c) < 32 else c for c in str(name)).strip() or 'unnamed'
mesh = meshio.read(sys.argv[1])
members = [[[] for _ in range(len(block.data))] for block in mesh.cells]
tags, families = mesh.cell_data.get('cell_tags'), getattr(mesh, 'cell_tags', {})
for b, block in enumerate(mesh.cells if tags else []):
    for c, tag in enumerate(tags[b]):
        members[b][c] += families.get(int(tag), [])
for name, blocks in mesh.cell_sets.items():
    for b, cells in enumerate(blocks):
        for c in (cells if cells is not None else []):
            members[b][int(c)].append(name)
size = {}
for b, block in enumerate(mesh.cells):
    for groups in members[b]:
        for name in groups:
            size[name] = size.get(name, 0) + 1
with open(sys.argv[2], 'w', encoding='utf-8') as deck:
    deck.write('*NODE\n')
    for i, x in enumerate(mesh.points):
        deck.write('%d, %s\n' % (i + 1, ', '.join(repr(float(v)) for v in x)))
    element = 0
    for b, block in enumerate(mesh.cells):
        base = block.type.rstrip('0123456789')
        if base not in KINDS:
            continue
        kind, corners = KINDS[base]
        if block.type in SECOND:
            kind, corners = SECOND[block.type], block.data.shape[1]
        by_group = {}
        for c, groups in enumerate(members[b]):
            name = plain(min(groups, key=lambda g: (size[g], str(g)))) if groups else ''
            by_group.setdefault(name, []).append(c)
        for name, cells in by_group.items():
            if not name and base in ('tetra', 'hexahedron', 'wedge', 'pyramid'):
                name = 'block_%d' % (b + 1)
            deck.write('*ELEMENT, TYPE=%s%s\n' % (kind, ', ELSET=' + name if name else ''))
            for c in cells:
                element += 1
                deck.write('%d, %s\n' % (element, ', '.join(str(int(n) + 1) for n in block.data[c][:corners])))
    sets = {name: list(points) for name, points in mesh.point_sets.items()}
    families = getattr(mesh, 'point_tags', {})
    for i, tag in enumerate(mesh.point_data.get('point_tags', [])):
        for name in families.get(int(tag), []):
            sets.setdefault(name, []).append(i)
    for name, points in sets.items():
        deck.write('*NSET, NSET=%s\n' % plain(name))
        for i in points:
            deck.write('%d\n' % (int(i) + 1))
)";

/// Last lines printed by Python, which contain its error.
std::string complaint(const fs::path& log) {
  std::string text;
  std::vector<std::string> lines = csv::read_lines(log, "output of python3", {.text_only = false});
  if (lines.size() > most_complaints) lines.erase(lines.begin(), lines.end() - most_complaints);
  for (const std::string& line : lines) text += "\n  " + line;
  return text;
}

}  // namespace

bool is_read_by_meshio(const std::string& extension) {
  return extension == ".med" || extension == ".exo" || extension == ".e" || extension == ".ex2";
}

RawMesh read_by_meshio(const fs::path& file) {
  const OwnFolder folder;
  const fs::path deck = folder.path() / "mesh.inp", log = folder.path() / "python.log";
  log::info("reading {} with meshio", file.string());
  const ProgramEnd end = run_in_sandbox({"python3", "-c", script, fs::absolute(file).string(), deck.string()},
                                        folder.path(), log, {fs::canonical(file)});
  if (end.code == no_module)
    throw Error(
        "The mesh '{}' is read with the Python module meshio, but python3 on the PATH lacks a module:{} "
        "Install it (Debian: apt install python3-meshio {}), or convert the mesh elsewhere to .msh 4.1 with "
        "its groups as physical names.",
        file.string(), complaint(log), file.extension() == ".med" ? "python3-h5py" : "python3-netcdf4");
  if (end.code != 0 || !fs::is_regular_file(fs::symlink_status(deck)))
    throw Error("meshio could not read '{}' ({}).{}", file.string(),
                end.signal != 0 ? fmt::format("ended by signal {}", end.signal)
                                : fmt::format("exit code {}", end.code),
                complaint(log));
  return read_inp(deck);
}

}  // namespace couplet::mesh
