// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/gmsh/sandbox.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/readers/read_msh.hpp"

namespace couplet::mesh {

namespace {

// Larger files (about 500 000 cells) are read by all ranks together, so that none holds the mesh.
constexpr std::uintmax_t bytes_of_large_msh = std::uintmax_t(64) << 20;

/// Reads this rank's block of a mesh. A .geo is meshed in `dim` dimensions. Collective.
MeshBlock read_block(MPI_Comm comm, const std::filesystem::path& file, int dim,
                     const MeshParameters& parameters) {
  RawMesh foreign;
  std::string msh;  // empty if the mesh is of another program
  int holders = 1;
  on_root(comm, [&] {
    if (file.extension() == ".geo")
      msh = mesh_geo(file, dim, parameters);
    else if (is_foreign(file.extension()))
      foreign = read_foreign(file);
    else
      msh = convert_mesh(file);
    if (!msh.empty() && std::filesystem::file_size(msh) >= bytes_of_large_msh)
      holders = parallel::comm_size(comm);
  });
  parallel::broadcast(comm, msh);
  MPI_Bcast(&holders, 1, MPI_INT, 0, comm);
  if (msh.empty()) return block_of(comm, foreign);
  try {
    return read_msh_block(comm, msh, holders);
  } catch (const Error& e) {
    if (msh == file) throw;
    throw Error("Cannot use the mesh of '{}', as gmsh saved it. {}", file.string(), e.what());
  }
}

void check_dimension(const std::filesystem::path& file, int found, GlobalIndex cells, int dim) {
  if (cells == 0)
    throw Error(
        "The mesh '{}' has no cells. Put the {} into a physical group; otherwise gmsh does not "
        "save {}.",
        file.string(), dim == 2 ? "surface" : "volume", dim == 2 ? "its triangles" : "its cells");
  if (found != dim)
    throw Error(
        "The mesh '{}' is {}-dimensional, but the case sets 'dimension: {}'.{}", file.string(), found, dim,
        dim == 3 ? " Put the volume into a physical group; otherwise gmsh does not save its cells." : "");
}

/// Returns the program whose mesh this is, if it is a known one that is not read. Otherwise an empty text.
std::string unread_program(const std::filesystem::path& file) {
  const std::string kind = file.extension().string();
  if (file.filename() == "polyMesh" || file.parent_path().filename() == "polyMesh" || kind == ".foam" ||
      std::filesystem::is_directory(file / "polyMesh") ||
      std::filesystem::is_directory(file / "constant/polyMesh"))
    return "OpenFOAM";
  char first = 0;
  if (kind == ".msh" || kind == ".cas") std::ifstream(file) >> first;
  return first == '(' ? "Fluent" : "";
}

}  // namespace

void check_mesh_file(const std::filesystem::path& file, const MeshParameters& parameters) {
  const std::string program = unread_program(file), kind = file.extension().string();
  if (!std::filesystem::exists(file) || (program.empty() && !std::filesystem::is_regular_file(file)))
    throw Error("The mesh file '{}' does not exist. The path is relative to the folder of the YAML file.",
                file.string());
  if (!program.empty() || (kind != ".msh" && kind != ".geo" && kind != ".cgns" && !is_foreign(kind)))
    throw Error(
        "The mesh file '{}' is {}. Export the mesh from the program that made it, in a format that keeps the "
        "names of its parts: {}.",
        file.string(),
        program.empty() ? "not a .msh, .geo, .inp, .su2, .bdf, .unv, .med, .exo or .cgns file"
                        : fmt::format("a file of {}, which is not supported", program),
        formats_with_names);
  if (kind != ".geo" && !parameters.empty())
    throw Error(
        "The mesh '{}' is already meshed, so 'mesh-parameters' cannot change it. Remove them, or give the "
        ".geo it was made from.",
        file.string());
}

MeshBlock read_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                    const MeshParameters& parameters) {
  on_root(comm, [&] { check_mesh_file(file, parameters); });
  MeshBlock block = read_block(comm, file, dim, parameters);
  check_dimension(file, block.dim, block.cell_shares.n, dim);
  return block;
}

LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                     const MeshParameters& parameters,
                     const std::vector<std::array<std::string, 2>>& periodic,
                     const std::vector<std::vector<std::string>>& materials, bool find_wide_points,
                     double scale, bool tie) {
  MeshBlock block = read_mesh(comm, file, dim, parameters);
  block.periodic = periodic;
  block.materials = materials;
  block.find_wide_points = find_wide_points;
  block.tie = tie;
  return load_block(comm, std::move(block), file, scale);
}

MeshFacts facts_of(const RawMesh& raw) {
  MeshFacts facts{.dim = raw.dim, .cells = raw.cell_type.size(), .patches = raw.patches};
  if (raw.points.empty() || facts.cells == 0) return facts;
  Vec3 low = raw.points.front(), high = low;
  for (const Vec3& x : raw.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  facts.size = high - low;
  facts.find_mean_cell();
  double shortest = std::numeric_limits<double>::infinity();
  for (Index c = 0; c < Index(facts.cells); ++c) {
    const auto points = raw.cell_points[c];
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = i + 1; j < points.size(); ++j)
        shortest = std::min(shortest, (raw.points[points[i]] - raw.points[points[j]]).squaredNorm());
  }
  facts.shortest_edge = std::sqrt(shortest);
  return facts;
}

MeshFacts facts_of_file(const std::filesystem::path& file, const MeshParameters& parameters, double scale) {
  int dim = 3;
  if (file.extension() == ".geo") {
    const auto volumes = read_geo(file).groups.at(3);
    if (volumes && volumes->empty()) dim = 2;  // not set if some name is computed
  }
  const auto msh = [&] {
    return file.extension() == ".geo" ? mesh_geo(file, dim, parameters) : convert_mesh(file);
  };
  MeshFacts facts = facts_of(is_foreign(file.extension()) ? read_foreign(file) : read_msh(msh()));
  facts.scale(scale);
  return facts;
}

namespace {

void check_names(const std::filesystem::path& geo, const std::vector<std::string>& known,
                 const MeshParameters& parameters) {
  for (const auto& [name, value] : parameters) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    if (known.empty())
      throw Error(
          "The geometry file '{}' defines no parameters, so 'mesh-parameters' cannot set '{}'. Declare "
          "names that are set from outside as 'DefineConstant [ {} = {} ];'.",
          geo.string(), name, name, value);
    throw Error("The geometry file '{}' defines no parameter '{}' with DefineConstant. {}", geo.string(),
                name, base::did_you_mean(name, known, "names"));
  }
}

/// Checks numbers of cells. gmsh ignores a sign and decimals, and makes another kind of mesh for 0.
void check_counts(const std::filesystem::path& geo, const std::map<std::string, bool>& counts,
                  const MeshParameters& parameters) {
  for (const auto& [name, value] : parameters) {
    const auto count = counts.find(name);
    if (count == counts.end()) continue;
    if (!(value > 0) || !(value < 1e7) || (count->second && value != std::floor(value)))
      throw Error(
          "mesh-parameters: '{}' is a number of cells in the geometry file '{}' (Layers, Transfinite "
          "Curve): it must be {} above 0 and below 1e7, not {}.",
          name, geo.string(), count->second ? "a whole number" : "a number", value);
  }
}

/// Rejects an empty mesh, because gmsh reports success even if it makes nothing, or only points or curves.
void refuse_empty(const std::filesystem::path& geo, const std::filesystem::path& mesh, int dim) {
  if (has_cells(mesh, dim)) return;
  std::filesystem::remove(mesh);
  throw Error(
      "gmsh generated no {} from '{}'. Check that it has a {} and that all of it is in a physical group.",
      dim == 3 ? "cells in three dimensions" : "triangles or quadrilaterals", geo.string(),
      dim == 3 ? "volume" : "surface");
}

}  // namespace

std::filesystem::path mesh_geo(const std::filesystem::path& geo, int dim, const MeshParameters& parameters) {
  const GeoScript script = read_geo(geo);
  const bool trusted = std::getenv("COUPLET_ALLOW_COMMANDS") != nullptr;
  if (!trusted && !Barrier::is_possible())
    throw Error(
        "A .geo can run commands and write files with your permissions, and this kernel has no Landlock to prevent "
        "that. If you trust '{}', start with --allow-commands; or mesh it elsewhere and give the .msh.",
        geo.string());
  if (!script.computed.empty() && !trusted)
    throw Error(
        "The {} includes a file whose name is computed, so Couplet cannot detect changes to that file. Write the name as a "
        "string literal, or start with --allow-commands.",
        script.computed);
  if (!script.lost.empty())
    throw Error(
        "The {} does not end with a newline; gmsh would read only one statement of such a last line and "
        "skip the others. Add a newline at the end.",
        script.lost);
  check_names(geo, script.constants, parameters);
  check_counts(geo, script.counts, parameters);
  std::vector<std::string> numbers;
  for (const auto& [name, value] : parameters)
    numbers.insert(numbers.end(), {"-setnumber", name, fmt::format("{}", value)});
  const std::filesystem::path result =
      cache_of(geo, fmt::format("{}\n{}\n{}", dim, base::join(numbers, " "), script.text));
  if (is_sound_cache(result)) return result;

  std::vector<std::string> options{fmt::format("-{}", dim)};
  options.insert(options.end(), numbers.begin(), numbers.end());
  log::info("meshing {} with gmsh", geo.string());
  run_gmsh(options, geo, trusted, result, "mesh");
  refuse_empty(geo, result, dim);
  return result;
}

}  // namespace couplet::mesh
