// SPDX-License-Identifier: Apache-2.0
#include <malloc.h>

#include <optional>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/gmsh/meshio.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/msh/msh_block.hpp"
#include "common/mesh/on_root.hpp"
#include "common/mesh/quality.hpp"

namespace couplet::mesh {
namespace {

/// A cached mesh that cannot be read (a machine that went down, a full disk) is made anew: it is no fault of the
/// user's.
RawMesh read_geo_mesh(const std::filesystem::path& geo, int dim, const MeshParameters& parameters) {
  const std::filesystem::path cached = mesh_geo(geo, dim, parameters);
  try {
    return read_msh(cached);
  } catch (const Error& error) {
    log::warn("The cached mesh is damaged and is regenerated: {}", error.what());
  }
  std::filesystem::remove(cached);
  return read_msh(mesh_geo(geo, dim, parameters));
}

// From here on no rank should hold the file and the mesh: some 500 000 cells.
constexpr std::uintmax_t bytes_of_large_msh = std::uintmax_t(64) << 20;

/// The .msh that all ranks read together, this file or what gmsh makes of it; empty: none.
std::string large_msh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                      const MeshParameters& parameters) {
  const bool is_geo = file.extension() == ".geo";
  if (parallel::comm_size(comm) == 1 || !std::filesystem::is_regular_file(file)) return {};
  if (!is_geo && (file.extension() != ".msh" || !parameters.empty())) return {};
  const std::filesystem::path finished = is_geo ? mesh_geo(file, dim, parameters) : file;
  return std::filesystem::file_size(finished) < bytes_of_large_msh ? std::string() : finished.string();
}

}  // namespace

RawMesh read_finished_mesh(const std::filesystem::path& file) {
  const std::string kind = file.extension().string();
  if (kind == ".msh") return read_msh(file);
  if (kind == ".inp") return read_inp(file);
  if (is_read_by_meshio(kind) && !(kind == ".med" && gmsh_has("Med"))) return read_by_meshio(file);
  return read_msh(convert_mesh(file));
}

RawMesh read_mesh(const std::filesystem::path& file, int dim, const MeshParameters& parameters) {
  if (!std::filesystem::is_regular_file(file))
    throw Error("The mesh file '{}' does not exist. The path is relative to the folder of the YAML file.",
                file.string());
  const std::string kind = file.extension().string();
  const bool foreign = kind == ".unv" || kind == ".cgns" || is_read_by_meshio(kind);
  if (kind == ".vtk")
    throw Error(
        "Cannot read the mesh file '{}': this format does not name its parts. Convert it with meshio to "
        ".msh 4.1 with physical names, or export it as .unv, whose groups become patches and zones.",
        file.string());
  if (kind != ".msh" && kind != ".inp" && kind != ".geo" && !foreign)
    throw Error(
        "The mesh file '{}' is not a .msh, .geo, .inp, .unv, .med, .exo or .cgns file. Convert it with "
        "gmsh or meshio to .msh 4.1 with physical names.",
        file.string());
  if (kind != ".geo" && !parameters.empty())
    throw Error(
        "The mesh '{}' is already meshed, so 'mesh-parameters' cannot change it. Remove them, or give the "
        ".geo it was made from.",
        file.string());
  RawMesh raw = kind == ".geo" ? read_geo_mesh(file, dim, parameters) : read_finished_mesh(file);
  if (raw.cell_type.empty())
    throw Error(
        "The mesh '{}' has no cells. Put the {} into a physical group; otherwise gmsh does not "
        "save {}.",
        file.string(), dim == 2 ? "surface" : "volume", dim == 2 ? "its triangles" : "its cells");
  if (raw.dim != dim)
    throw Error(
        "The mesh '{}' is {}-dimensional, but the case sets 'dimension: {}'.{}", file.string(), raw.dim, dim,
        dim == 3 ? " Put the volume into a physical group; otherwise gmsh does not save its cells." : "");
  return raw;
}

LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                     const MeshParameters& parameters,
                     const std::vector<std::array<std::string, 2>>& periodic,
                     const std::vector<std::vector<std::string>>& materials, bool find_wide_points,
                     double scale) {
  std::string large;
  on_root(comm, [&] { large = large_msh(comm, file, dim, parameters); });
  parallel::broadcast(comm, large);
  if (!large.empty()) {
    std::optional<MeshBlock> block = read_msh_block(comm, large);
    if (block && block->dim == dim && block->cell_shares.n > 0) {
      block->periodic = periodic;
      block->materials = materials;
      block->find_wide_points = find_wide_points;
      return load_block(comm, std::move(*block), file, scale);
    }
  }
  RawMesh raw;
  on_root(comm, [&] {
    raw = read_mesh(file, dim, parameters);
    for (Vec3& x : raw.points) x *= scale;
    raw.periodic = periodic;
    raw.materials = materials;
    raw.find_wide_points = find_wide_points;
  });
  try {
    LoadedMesh loaded = distribute(comm, raw);
    raw = {};
    malloc_trim(0);  // the whole mesh has left holes that nothing else fills
    check_and_report(loaded.mesh, loaded.geometry);
    return loaded;
  } catch (const Error& e) {
    throw Error("Cannot use the mesh '{}'. {}", file.string(), e.what());
  }
}

}  // namespace couplet::mesh
