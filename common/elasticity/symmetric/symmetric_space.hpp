// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/joined_vertices.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {

/// Trial and test functions of the symmetric face gradient: displacements of nodes (cells, boundary faces)
/// and points, and forces on them. The transposed weights distribute forces to the rows of ElasticOperator,
/// f_j += w_ij F_i f_i. The kernels define the material law. Loads, mass and springs use the same functions
/// and are defined here. A cell's row carries 1/dim of the loads on its volume and the vertices the rest.
/// Likewise a boundary face carries 1/dim of its traction.
///
/// Usage: fill(), clear_forces(), add forces, collect(), take_rows(). Displacements and forces are stored by
/// location (see FaceRows) with four doubles each, of which the last one (two in 2-D) is zero.
class SymmetricSpace {
 public:
  static constexpr int stride = ElasticNodes::stride;
  using Place = Eigen::Map<Vec3>;

  /// Keeps references to both.
  SymmetricSpace(const mesh::Mesh& mesh, const ElasticOperator& rows);

  const mesh::Mesh& mesh() const { return mesh_; }
  const ElasticOperator& rows() const { return rows_; }
  /// Sets the displacements at all nodes and points. The node of a symmetry face is the mirror image of its
  /// cell. Collective.
  void fill(std::span<const double> unknowns, std::span<const double> known);
  const double* values() const { return nodes_[0]; }
  Vec3 value(Index place) const { return Eigen::Map<const Vec3>(nodes_[place]); }
  double* forces() { return force_.data(); }
  Place force(Index place) { return Place(force_.data() + std::size_t(place) * stride); }
  Index node_of_face(Index f) const { return mesh_.cells.n_local() + f - mesh_.n_interior; }
  Index place_of_point(Index v) const { return n_nodes_ + v; }
  std::size_t n_nodes() const { return std::size_t(n_nodes_); }
  /// Writes dim values per local point. Points without a value are not changed.
  void point_values(std::span<double> points) const;
  /// Mean displacement of the trace of a boundary face: weight 1/dim for its node, the rest for its points.
  Vec3 face_mean(Index f) const;

  void clear_forces();
  void negate_forces();
  void add_springs(std::span<const double> known);
  void add_mass_forces(double factor);
  /// Forces as in ElasticKernel::add_face_forces().
  void spread_face_forces(std::span<const double> forces);
  void spread_cell_forces(std::span<const double> forces);
  void set_density(std::span<const double> of_cells);
  /// Mass of each location on this rank, after set_density() [kg].
  const std::vector<double>& mass() const { return mass_; }
  /// Sum of force . displacement on this rank. fill() may have changed the displacement since.
  double work() const;

  /// Distributes forces on points and mirror images to the nodes, sums over ranks, and merges both sides of
  /// bonded faces. Collective.
  void collect();
  /// Computes the rows of ElasticOperator. If `unknowns` is empty, these are loads, without the rows of
  /// supports.
  void take_rows(std::span<const double> unknowns, std::span<const double> known, std::span<double> result);
  /// Adds collect() and take_rows() of loads to `rhs`.
  void add_collected(std::span<double> rhs);
  /// Sum of the effective forces of this rank's boundary faces, see ElasticKernel::add_face_forces.
  Vec3 acting(std::span<const double> forces) const;
  /// Reaction forces at each patch from the current forces (inner ones minus loads). Moments use the node
  /// positions, displaced if `moved`. This rank's contribution.
  std::vector<Wrench> held(std::span<const double> known, bool moved);

  // The loops are public so that they can be cloned for several processors.
  [[gnu::always_inline]] inline void interpolate_free();
  [[gnu::always_inline]] inline void to_nodes_loop();

 private:
  template <int D>
  void fill_nodes(std::span<const double> unknowns, std::span<const double> known);
  template <int D>
  void copy_rows(std::span<double> result);
  void points_to_nodes();
  /// Calls take(place, share) for the node and points of a boundary face, with their weights in its trace.
  template <class Take>
  void visit_trace(Index f, const Take& take) const;
  void spread_over_base(Index f, const Vec3& force_on_base);
  void spread_around(Index f, const Vec3& force_on_base);
  void spread_within(Index f, std::span<const double> of_corners);
  /// Force k (u - g) of the springs for the mean trace of a face.
  Vec3 pull_of_springs(Index f, std::span<const double> known) const;
  void held_at_points(std::span<const Index> patch_of, bool moved, std::vector<Wrench>& result);
  Vec3 position(Index place, bool moved) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  Index n_nodes_;
  ElasticNodes nodes_;  // followed by the points
  ElasticVertices vertices_;
  std::unique_ptr<JoinedVertices> joined_;  // nullptr without periodic patches
  std::vector<double> force_;
  std::vector<std::pair<Index, Vec3>> symmetry_;  // faces and normals
  std::vector<double> volume_;                    // sum of the pyramids of each owned cell
  std::vector<double> mass_;                      // empty if there is none
};

/// Sum of the pyramids of each owned cell, which equals its volume except for warped faces.
std::vector<double> pyramid_volumes(const mesh::Mesh& mesh, const mesh::Geometry& geometry);

}  // namespace couplet::elastic
