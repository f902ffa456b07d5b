// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/load.hpp"

namespace couplet::mesh {

/// All faces of a whole mesh. Interior faces first, by (owner, neighbour), the owner being the cell with the
/// smaller number; then the boundary faces, in the order of their boundary elements. Points turn right-handed
/// out of the owner.
struct Faces {
  Index n_interior = 0;
  Csr points;
  std::vector<Index> owner;
  std::vector<Index> neighbour;  ///< interior faces only
  std::vector<int> patch;        ///< boundary faces only
  std::vector<Vec3> shift;       ///< interior faces; empty without periodic patches; see Mesh
  /// Boundary faces from here on are the sides of bonded faces: first_bonded + 2 i and first_bonded + 2 i + 1
  /// are one face, the first side that of the cell with the smaller number. -1: none.
  GlobalIndex first_bonded = -1;
  /// Of a piece of a mesh: the numbers that its boundary faces have in the mesh, ascending. Empty: the mesh is whole.
  std::vector<GlobalIndex> boundary_number;
  GlobalIndex number_of_boundary(Index b) const {
    return boundary_number.empty() ? GlobalIndex(b) : boundary_number[b];
  }
  Index n_boundary() const { return static_cast<Index>(owner.size()) - n_interior; }
};

/// Throws Error naming the place if a boundary face is in no patch or in two, if a boundary element is no
/// boundary face, or if more than two cells share a face.
Faces build_faces(const RawMesh& raw);

// What is wrong with a face, in words. `where`: its middle.
std::string face_without_cell(const std::string& patch, const std::string& where);
std::string face_inside(const std::string& patch, const std::string& where);
std::string face_in_two_patches(const std::string& one, const std::string& other, const std::string& where);
std::string face_of_many_cells(std::size_t cells, const std::string& where);
/// `places`: of the first three.
std::string faces_in_no_patch(GlobalIndex n, const std::vector<std::string>& places, int dim);

std::string no_periodic_patch(const std::string& patch);
std::string periodic_counts_differ(const std::array<std::string, 2>& patches, GlobalIndex first,
                                   GlobalIndex second);
/// `where`, `there`: the middle of a face, and where its partner should be.
std::string no_periodic_match(const std::array<std::string, 2>& patches, const std::string& where,
                              const std::string& there);

/// How far the middle of a face may be from its partner's, as a share of its size.
constexpr double periodic_tolerance = 1e-4;
/// Place along a direction in which meshes have no order.
inline double periodic_key(const Vec3& x) { return 0.5377 * x[0] + 0.3315 * x[1] + 0.7751 * x[2]; }

/// Makes interior faces of the faces of periodic patches (RawMesh::periodic). Throws Error naming the place
/// of a face without a partner.
void join_periodic(const RawMesh& raw, Faces& faces);

/// The material of each cell after RawMesh::materials; empty with fewer than two. Throws Error for a zone
/// without material or a material without zone.
std::vector<int> materials_of_cells(const RawMesh& raw);

/// Makes two boundary faces, in a patch of their own, of each interior face between two materials.
void split_materials(RawMesh& raw, Faces& faces, const std::vector<int>& cell_material);

/// Pairs of cells that hang together by an interior or a bonded face.
struct CellPairs {
  std::vector<Index> first, second;
};
CellPairs connected_cells(const Faces& faces);

/// See Mesh::wide_points; ascending.
std::vector<Index> wide_points(const RawMesh& raw, const Faces& faces, const std::vector<int>& cell_material);

/// Faces of cells that no other cell shares, as boundary elements (for generators, which then name the
/// patches).
Csr outer_faces(const RawMesh& raw);

/// Turns inverted cells (clockwise in 2-D) right side out. Throws Error for a cell without volume and for a mesh
/// without cells. `first`: the number of the first cell, for messages.
void orient_cells(RawMesh& raw, GlobalIndex first = 0);

/// Throws Error for a point out of the plane z = 0 of a 2-D mesh whose points lie in a box of this diagonal.
void check_plane(std::span<const Vec3> points, double diagonal);

/// Points that no cell uses are dropped (a .msh may carry centres of circles); the order of the others stays.
void drop_unused_points(RawMesh& raw);

/// "(1, 2.5)" in 2-D, "(1, 2.5, 3)" in 3-D.
std::string place(const Vec3& x, int dim);

}  // namespace couplet::mesh
