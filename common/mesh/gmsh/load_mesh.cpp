// SPDX-License-Identifier: Apache-2.0
#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/gmsh/meshio.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/msh/read_msh.hpp"
#include "common/mesh/on_root.hpp"

namespace couplet::mesh {
namespace {

// Larger ones are read by all ranks together, so that none holds the mesh: some 500 000 cells.
constexpr std::uintmax_t bytes_of_large_msh = std::uintmax_t(64) << 20;

/// Tells whether the mesh is read as an input deck; otherwise it is a .msh, or gmsh makes one of it.
bool is_deck(const std::filesystem::path& file) {
  const std::string kind = file.extension().string();
  return kind == ".inp" || (is_read_by_meshio(kind) && !(kind == ".med" && gmsh_has("Med")));
}

RawMesh read_deck(const std::filesystem::path& file) {
  return file.extension() == ".inp" ? read_inp(file) : read_by_meshio(file);
}

std::filesystem::path finished_msh(const std::filesystem::path& file) {
  return file.extension() == ".msh" ? file : convert_mesh(file);
}

void check_file(const std::filesystem::path& file, const MeshParameters& parameters) {
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

}  // namespace

RawMesh read_finished_mesh(const std::filesystem::path& file) {
  return is_deck(file) ? read_deck(file) : read_msh(finished_msh(file));
}

RawMesh read_mesh(const std::filesystem::path& file, int dim, const MeshParameters& parameters) {
  check_file(file, parameters);
  RawMesh raw =
      file.extension() == ".geo" ? read_msh(mesh_geo(file, dim, parameters)) : read_finished_mesh(file);
  check_dimension(file, raw.dim, GlobalIndex(raw.cell_type.size()), dim);
  return raw;
}

LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                     const MeshParameters& parameters,
                     const std::vector<std::array<std::string, 2>>& periodic,
                     const std::vector<std::vector<std::string>>& materials, bool find_wide_points,
                     double scale) {
  RawMesh deck;
  std::string msh;  // empty: the mesh is a deck
  int holders = 1;
  on_root(comm, [&] {
    check_file(file, parameters);
    if (file.extension() == ".geo")
      msh = mesh_geo(file, dim, parameters);
    else if (is_deck(file))
      deck = read_deck(file);
    else
      msh = finished_msh(file);
    if (!msh.empty() && std::filesystem::file_size(msh) >= bytes_of_large_msh)
      holders = parallel::comm_size(comm);
  });
  parallel::broadcast(comm, msh);
  MPI_Bcast(&holders, 1, MPI_INT, 0, comm);
  MeshBlock block = msh.empty() ? block_of(comm, deck) : read_msh_block(comm, msh, holders);
  deck = {};
  check_dimension(file, block.dim, block.cell_shares.n, dim);
  block.periodic = periodic;
  block.materials = materials;
  block.find_wide_points = find_wide_points;
  return load_block(comm, std::move(block), file, scale);
}

}  // namespace couplet::mesh
