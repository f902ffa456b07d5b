// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/types.hpp"
#include "common/parallel/collective.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::mesh {

enum class CellType : std::uint8_t { triangle, quadrilateral, tetrahedron, hexahedron, prism, pyramid };

/// Compressed rows: row i is index[offset[i]] .. index[offset[i + 1] - 1].
struct Csr {
  std::vector<Index> offset{0};
  std::vector<Index> index;
  Index size() const { return static_cast<Index>(offset.size()) - 1; }
  std::span<const Index> operator[](Index i) const {
    return {index.data() + offset[i], std::size_t(offset[i + 1] - offset[i])};
  }
  void push_row(std::span<const Index> row) {
    index.insert(index.end(), row.begin(), row.end());
    offset.push_back(static_cast<Index>(index.size()));
  }
};

/// Named part of the boundary: faces [first, first + count) of owned cells and [ghost_first, ghost_first +
/// ghost_count) of ghost cells, for stencils that reach across the partition.
struct Patch {
  std::string name;
  Index first = 0, count = 0;
  Index ghost_first = 0, ghost_count = 0;
  bool bonded = false;  ///< not on the boundary: both sides of faces between two materials, see Mesh::twin
};

/// Positions of the points [m] with the volumes, centers and face vectors computed from them. Several
/// geometries of a mesh can exist at once. `points` is per local point; `volume` [m^3] and `cell_centre` [m]
/// per local cell, ghosts included; `face_area` [m^2], out of the owner, and `face_centre` [m] per local
/// face. A 2-D mesh has unit depth: volume = area x 1 m, face_area = length x 1 m.
struct Geometry {
  std::vector<Vec3> points;
  std::vector<double> volume;
  std::vector<Vec3> cell_centre, face_centre, face_area;
};

/// Limit of n sum w_i^2 for the smallest weights that carry linear fields from n nodes to a point. It is 1 at
/// their center, 28 at the corner of a hexahedron (still accurate enough), 100 for a prism and 364 for a
/// single tetrahedron.
inline constexpr double longest_reach = 40;

/// Topology of the part of a mesh on one rank, constant after setup, with one ring of ghost cells (vertex
/// neighbors; two rings at `wide_points`).
///
/// Faces: [0, n_interior) lie between two local cells, at least one of which is owned. Boundary faces of
/// owned cells follow patch by patch, then those of ghost cells. The face vector points out of `owner`. For
/// interior faces the owner is the cell with the smaller cell_id on every rank. Boundary face f is entry f -
/// n_interior of the index map `boundary`.
///
/// 2-D (dim == 2): cells are triangles and quadrilaterals in the plane z = 0 with unit depth. Faces are edges
/// with two points. Front and back have no unknowns, faces or duplicate points.
struct Mesh {
  MPI_Comm comm = MPI_COMM_SELF;
  int dim = 3;

  parallel::IndexMap cells, points, boundary;  ///< owned first, then ghosts
  /// Numbers per local cell, point and boundary face in the order of the mesh file. They do not depend on the
  /// number of ranks.
  std::vector<GlobalIndex> cell_id, point_id, boundary_id;

  std::vector<CellType> cell_type;  ///< per local cell
  Csr cell_points;                  ///< per local cell, VTK order, local points
  std::vector<int> cell_zone;       ///< per local cell, index into `zones`
  std::vector<std::string> zones;   ///< the same on all ranks
  /// Material index per local cell. Empty with one material.
  std::vector<int> cell_material;

  Index n_interior = 0;          ///< interior faces
  Csr face_points;               ///< per local face, oriented right-handed about the face vector
  std::vector<Index> owner;      ///< per local face
  std::vector<Index> neighbour;  ///< per interior face
  /// Per interior face: shift of the neighbor as seen from the owner [m]. Nonzero only on former periodic
  /// patches, whose points are those of the owner's side. Empty if there are none.
  std::vector<Vec3> neighbour_shift;
  std::vector<Patch> patches;  ///< the same names in the same order on all ranks
  /// Per local boundary face: entry of the other side of a bonded face. It is -1 if the face is not bonded or
  /// the other side is not on this rank. Both sides are present around the points of owned cells. Empty if no
  /// face is bonded.
  std::vector<Index> twin;

  /// Local points on a boundary or between materials whose neighborhood is too thin to extrapolate values.
  /// Around those of owned cells this rank has two rings of cells. Ascending.
  std::vector<Index> wide_points;
  bool is_wide(Index point) const { return std::ranges::binary_search(wide_points, point); }

  Vec3 shift(Index interior_face) const {
    return neighbour_shift.empty() ? Vec3(Vec3::Zero()) : neighbour_shift[interior_face];
  }
  int material_of(Index cell) const { return cell_material.empty() ? 0 : cell_material[cell]; }
  Index n_faces() const { return static_cast<Index>(owner.size()); }
  /// Number of interior faces and boundary faces of owned cells, which carry fluxes on this rank.
  Index n_flux_faces() const { return n_interior + boundary.n_owned(); }
  /// Index of the patch of each local boundary face.
  std::vector<Index> patch_of_boundary() const {
    std::vector<Index> result(boundary.n_local());
    for (Index p = 0; p < static_cast<Index>(patches.size()); ++p) {
      const Patch& patch = patches[p];
      std::fill_n(result.begin() + (patch.first - n_interior), patch.count, p);
      std::fill_n(result.begin() + (patch.ghost_first - n_interior), patch.ghost_count, p);
    }
    return result;
  }
  const Patch* find_patch(std::string_view name) const {
    for (const Patch& p : patches)
      if (p.name == name) return &p;
    return nullptr;
  }
};

/// Mesh and the geometry of its points as read.
struct LoadedMesh {
  Mesh mesh;
  Geometry geometry;
};

/// Computes the geometry of these local points. Quadrilateral faces are split into two triangles by the
/// diagonal through their point with the smallest point_id, so both sides agree. Ghost cells are updated by a
/// halo exchange. Collective.
Geometry compute_geometry(const Mesh& mesh, std::vector<Vec3> points);

/// Volume swept by each local face while its points move linearly from `from` to `to` [m^3], positive along
/// the face vector. Exact by thesis (4.16)-(4.17), with the diagonals of compute_geometry. The signed sum
/// over a cell's faces is its change of volume to round-off.
std::vector<double> swept_volumes(const Mesh& mesh, std::span<const Vec3> from, std::span<const Vec3> to);

/// Bounding box of a mesh [m], over all ranks.
struct Extent {
  Vec3 lower, upper;
  Vec3 size() const { return upper - lower; }
  double diagonal() const { return size().norm(); }
};

inline Extent extent_of(MPI_Comm comm, std::span<const Vec3> points) {
  Extent box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (const Vec3& x : points) box.lower = box.lower.cwiseMin(x), box.upper = box.upper.cwiseMax(x);
  MPI_Allreduce(MPI_IN_PLACE, box.lower.data(), 3, MPI_DOUBLE, MPI_MIN, comm);
  MPI_Allreduce(MPI_IN_PLACE, box.upper.data(), 3, MPI_DOUBLE, MPI_MAX, comm);
  return box;
}
inline Extent extent_of(const Mesh& mesh, const Geometry& geometry) {
  return extent_of(mesh.comm, geometry.points);
}

}  // namespace couplet::mesh
