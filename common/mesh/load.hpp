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

/// A whole mesh on one rank, as a file or a generator gives it.
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
  std::vector<std::array<std::string, 2>>
      periodic;  ///< pairs of patches, each a translated copy of the other
  /// Names of the zones that each material fills. With two or more materials the faces between them become
  /// bonded faces, see Mesh::twin; empty: no face is split.
  std::vector<std::vector<std::string>> materials;
  /// Whether Mesh::wide_points are found: where values are extrapolated to the surface.
  bool find_wide_points = true;
};

/// Numbers for the names that a .geo defines by DefineConstant.
using MeshParameters = std::map<std::string, double>;

/// Reads .msh 2.2 or 4.1 (ASCII or binary) with physical names. Throws Error with file and line.
RawMesh read_msh(const std::filesystem::path& file);

/// Reads the mesh of an input deck of CalculiX or Abaqus (.inp): solid elements of two or three dimensions, those of second
/// order by their corners; *SURFACE and NSET name patches, *SOLID SECTION and ELSET zones; boundary that nothing names is the
/// patch "rest". Throws Error with file and line.
RawMesh read_inp(const std::filesystem::path& file);

/// Runs the gmsh program on a .geo unless a cached result (beside the file, named <stem>.<hash>.cache.msh,
/// where the hash covers the text of the .geo, of the files it includes, `dim` and the parameters) is there;
/// gives the path of the .msh. Several programs may ask for the same file at the same time. `parameters` take
/// the place of the values in the DefineConstant of the .geo; throws Error for a name it does not define.
std::filesystem::path mesh_geo(const std::filesystem::path& geo, int dim,
                               const MeshParameters& parameters = {});

/// Distributes: cells by PT-Scotch, one ring of vertex-neighbour ghosts (two at Mesh::wide_points), owned cells
/// renumbered by reverse Cuthill-McKee. `raw` is read on rank 0 only. Every boundary face must belong to exactly one
/// patch; errors name the place. Collective.
LoadedMesh distribute(MPI_Comm comm, const RawMesh& raw);

/// File (.msh, .inp, .geo, or what convert_mesh() reads) to distributed mesh, `periodic`, `materials` and `find_wide_points` as
/// in RawMesh; all lengths times `scale`.
/// Collective; an error on rank 0 is thrown on every rank.
LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                     const MeshParameters& parameters = {},
                     const std::vector<std::array<std::string, 2>>& periodic = {},
                     const std::vector<std::vector<std::string>>& materials = {},
                     bool find_wide_points = false, double scale = 1);

/// Boxes for tests: n cells a side on [lower, upper], patches "xmin" "xmax" "ymin" "ymax" (and "zmin" "zmax"
/// in 3-D).
enum class BoxCells { quadrilaterals, triangles, hexahedra, tetrahedra, prisms, mixed };
RawMesh make_box(BoxCells cells, const std::array<int, 3>& n, const Vec3& lower, const Vec3& upper);
/// Moves the interior points (boundary points stay) by up to `amount` of the local spacing, the same for the
/// same seed.
void perturb_interior(RawMesh& raw, double amount, unsigned seed);

}  // namespace couplet::mesh
