// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {

using parallel::broadcast, parallel::on_all, parallel::on_root;

/// Whole mesh on one rank, from a file or a generator.
struct RawMesh {
  int dim = 3;
  std::vector<Vec3> points;
  std::vector<CellType> cell_type;
  Csr cell_points;
  std::vector<int> cell_zone;
  std::vector<std::string> zones;
  Csr boundary_points;              ///< boundary elements: 2 points (2-D), 3 or 4 points (3-D)
  std::vector<int> boundary_patch;  ///< index into `patches`
  std::vector<std::string> patches;
  /// Pairs of patches, each a translated copy of the other.
  std::vector<std::array<std::string, 2>> periodic;
  /// Names of the zones that each material fills. With two or more materials the faces between them become
  /// bonded faces, see Mesh::twin. If empty, no face is split.
  std::vector<std::vector<std::string>> materials;
  /// Requests Mesh::wide_points, for extrapolation to the surface.
  bool find_wide_points = true;
};

/// Number of the patch `rest` of all boundary faces without a name, which is appended if it is missing.
int rest_of(std::vector<std::string>& patches);

/// Values of the names that a .geo defines by DefineConstant.
using MeshParameters = std::map<std::string, double>;

/// Reads .msh 2.2 or 4.1 (ASCII or binary) with physical names. Elements of second order are reduced to their
/// corners, and the boundary in no group is the patch "rest". Throws Error with file and line.
RawMesh read_msh(const std::filesystem::path& file);

/// Runs gmsh on a .geo unless its mesh is cached, and returns the path of the .msh. It depends on the .geo,
/// the files it includes, `dim` and the parameters. Several programs
/// may request the same file at once. `parameters` replace values in DefineConstant; an unknown name throws
/// Error.
std::filesystem::path mesh_geo(const std::filesystem::path& geo, int dim,
                               const MeshParameters& parameters = {});

/// Distributes a mesh: partitions cells by PT-Scotch with one ring of vertex-neighbor ghosts (two at
/// Mesh::wide_points) and renumbers owned cells by reverse Cuthill-McKee. Only rank 0 reads `raw`. Every
/// boundary face belongs to one patch, "rest" if none is given; errors state the location. Collective.
LoadedMesh distribute(MPI_Comm comm, const RawMesh& raw);

/// Loads and distributes a mesh file (.msh, .geo, or as for convert_mesh() and read_foreign()), with lengths multiplied by
/// `scale`. `periodic`, `materials` and `find_wide_points` are as in RawMesh. `tie` joins parts that touch
/// without sharing points. Collective; an error on rank 0 is thrown on every rank.
LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                     const MeshParameters& parameters = {},
                     const std::vector<std::array<std::string, 2>>& periodic = {},
                     const std::vector<std::vector<std::string>>& materials = {},
                     bool find_wide_points = false, double scale = 1, bool tie = false);

/// Boxes for tests: n cells per side on [lower, upper], patches "xmin" "xmax" "ymin" "ymax" (and "zmin"
/// "zmax" in 3-D).
enum class BoxCells { quadrilaterals, triangles, hexahedra, tetrahedra, prisms, mixed };
RawMesh make_box(BoxCells cells, const std::array<int, 3>& n, const Vec3& lower, const Vec3& upper);
/// Moves interior points by up to `amount` of the local spacing, reproducibly for a given seed. Boundary
/// points stay.
void perturb_interior(RawMesh& raw, double amount, unsigned seed);

}  // namespace couplet::mesh
