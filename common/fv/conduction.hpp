// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/fv/gradients.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/linalg/matrix.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::fv {

/// Thermal boundary condition of a patch.
enum class HeatCondition {
  temperature,  ///< given at faces and vertices
  flux,         ///< given heat flux or convection: the temperature of each face is an unknown
  symmetry,     ///< no flux, mirrored cells; no unknown
  bonded,       ///< one side of a face between two materials; both sides share one unknown
};

/// Heat conduction div(k grad T), thesis (2.35), with the face gradient (2.53)-(2.58) of a scalar.
///
/// Unknown nodes of a rank are its owned cells, then its flux faces patch by patch. Known columns are the
/// points, then the faces, of patches with known temperature. With q_f(T) = k_f |S| n . grad T, the heat flow
/// into the owner:
///   cell row       - sum_f q_f over its faces that are not flux faces      + h |S| T_B over those that are
///   flux face row    q_f + h |S| T_B
///   bonded face row  q_f + q_f' of the two sides (unknown of the side with the smaller boundary_id,
///                    listed with the flux faces)
/// The known heat of a flux face, |S| (q + h T_inf), is on the right-hand side of both rows (h = 0 without
/// convection).
class ConductionOperator {
 public:
  /// `conditions` has one entry per patch. Collective.
  ConductionOperator(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                     std::span<const HeatCondition> conditions);

  const mesh::Mesh& mesh() const { return *mesh_; }
  const mesh::Geometry& geometry() const { return *geometry_; }
  const FaceGradient& faces() const { return faces_; }
  const VertexInterpolation& vertices() const { return vertices_; }
  /// Flux faces of owned cells, then first sides of bonded faces. Entry i is unknown n_owned cells + i.
  const std::vector<Index>& flux_faces() const { return flux_faces_; }
  const std::vector<Index>& known_points() const { return known_points_; }
  const std::vector<Index>& known_faces() const { return known_faces_; }  ///< of owned cells
  HeatCondition condition(Index face) const { return condition_of_face_[face - mesh_->n_interior]; }
  std::size_t n_unknowns() const { return mesh_->cells.n_owned() + flux_faces_.size(); }
  std::size_t n_known() const { return known_points_.size() + known_faces_.size(); }

  /// Creates an empty matrix with the sparsity pattern of all rows. Collective.
  linalg::SparseMatrix make_matrix() const;

  /// Coefficients of the stencils in the rows.
  struct RowFactors {
    std::span<const double> conductivity;  ///< k_f per local face (ghosts: only bonded) [W/(m K)]
    std::span<const double> transfer;      ///< h per entry of flux_faces() [W/(m^2 K)], or empty
    std::span<const double> capacity;      ///< on the diagonal of owned cells [W/K], or empty
    double share = 1;                      ///< of the conduction in the cell rows (trapezoidal rule: 1/2)
  };
  void fill(const RowFactors& weights, linalg::SparseMatrix& matrix) const;
  /// Subtracts the known columns times `known`: values of known points, then of known faces.
  void subtract_known(const RowFactors& weights, std::span<const double> known, std::span<double> rhs) const;

  /// Copies the value of a bonded face's first side to the second (`boundary`: up-to-date ghosts).
  void join_twins(std::span<double> boundary) const;

  /// Interpolates the values of all local points and sets the known ones. Collective.
  void point_values(std::span<const double> cells, std::span<const double> boundary,
                    std::span<const double> known, std::span<double> points) const;
  /// Tangential gradient at a face from the values at points.
  Vec3 tangential_gradient(Index face, std::span<const double> points) const;
  /// Complete gradient at a face.
  Vec3 gradient(Index face, std::span<const double> cells, std::span<const double> boundary,
                std::span<const double> points) const;
  /// Value at a face center from the neighboring nodes, exact for linear fields.
  double face_value(Index face, std::span<const double> cells, std::span<const double> boundary,
                    std::span<const double> points) const;
  /// Heat flow through each flux face of the mesh into its owner, k_f |S| n . grad T [W].
  void face_heat(std::span<const double> conductivity, std::span<const double> cells,
                 std::span<const double> boundary, std::span<const double> points,
                 std::span<double> heat) const;

 private:
  enum class Kind : std::uint8_t { conduction, transfer, capacity };
  /// Term of a row. A conduction term is the stencil of a face.
  struct StencilTerm {
    Kind kind;
    bool in_cell_row;  // scaled by Weights::share
    double sign;
    Index index;  // face, entry of flux_faces_ or cell
  };
  void sort_boundary(std::span<const HeatCondition> conditions);
  void build_stencils();
  bool is_second_side(Index entry) const {
    return mesh_->boundary_id[mesh_->twin[entry]] < mesh_->boundary_id[entry];
  }
  Index twin_of(Index face) const { return mesh_->n_interior + mesh_->twin[face - mesh_->n_interior]; }
  bool needs_stencil(Index face) const;
  void build_rows();
  void add_term(const StencilTerm& term, GlobalIndex row);

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  std::vector<HeatCondition> condition_of_face_;  // per entry of mesh.boundary
  VertexInterpolation vertices_;
  FaceGradient faces_;
  std::vector<Index> flux_faces_, known_points_, known_faces_;
  std::vector<Index> known_of_point_, known_of_face_, flux_of_face_;  // or -1; the latter two of boundary
  std::vector<GlobalIndex> number_;                                   // of each local node as unknown, or -1

  // Stencil of each flux face: |S| n . grad T = sum coefficient x value, over nodes and over known columns.
  std::vector<std::int64_t> offset_, known_offset_;
  std::vector<Index> node_, known_column_;
  std::vector<double> coefficient_, known_coefficient_;
  std::vector<StencilTerm> terms_;  // of all rows, in the order of the triplets
  std::vector<GlobalIndex> row_, column_;
};

}  // namespace couplet::fv
