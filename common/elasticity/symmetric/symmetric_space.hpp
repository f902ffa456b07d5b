// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/joined_vertices.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/wrench.hpp"

namespace couplet::elastic {

/// The trial functions of the symmetric face gradient: displacements of nodes (cells, boundary faces) and of
/// points, and forces on them, taken back to the rows of ElasticOperator by the transposed weights,
/// f_j += w_ij F_i f_i. What a strain makes of them (Hooke's law, large strain) stands in the kernels; loads,
/// mass and springs act by the same functions and stand here. A cell's row is 1/dim of its balance, so that it
/// carries 1/dim of what acts on its volume and the vertices carry the rest; a boundary face carries 1/dim of
/// its traction, its vertices the rest.
///
/// Use: fill(), clear_forces(), add forces, collect(), take_rows().
/// Displacements and forces stand by places (see FaceRows), four doubles each; the last ones are zero, in the plane two.
class SymmetricSpace {
 public:
  static constexpr int stride = ElasticNodes::stride;
  using Place = Eigen::Map<Vec3>;

  /// Keeps both by reference.
  SymmetricSpace(const mesh::Mesh& mesh, const ElasticOperator& rows);

  const mesh::Mesh& mesh() const { return mesh_; }
  const ElasticOperator& rows() const { return rows_; }
  /// Displacements at all nodes and points. At symmetry planes the face's node is the mirror image of its cell.
  /// Collective.
  void fill(std::span<const double> unknowns, std::span<const double> known);
  const double* values() const { return nodes_[0]; }
  Vec3 value(Index place) const { return Eigen::Map<const Vec3>(nodes_[place]); }
  double* forces() { return force_.data(); }
  Place force(Index place) { return Place(force_.data() + std::size_t(place) * stride); }
  Index node_of_face(Index f) const { return mesh_.cells.n_local() + f - mesh_.n_interior; }
  Index place_of_point(Index v) const { return n_nodes_ + v; }
  std::size_t n_nodes() const { return std::size_t(n_nodes_); }
  /// dim values a local point; those of points without a value are left as they are.
  void point_values(std::span<double> points) const;
  /// Mean displacement of the trace of a boundary face: its node has the part 1/dim, its points the rest.
  Vec3 face_mean(Index f) const;

  void clear_forces();
  void negate_forces();
  void add_springs(std::span<const double> known);
  void add_mass_forces(double factor);
  void spread_face_forces(std::span<const double> forces);
  void spread_cell_forces(std::span<const double> forces);
  void set_density(std::span<const double> of_cells);
  /// This rank's part of each place, after set_density() [kg].
  const std::vector<double>& mass() const { return mass_; }
  /// sum of force . displacement, this rank's; fill() may have changed the displacement since the forces.
  double work() const;

  /// From points and mirror images to the nodes, over the ranks, and both sides of bonded faces into one.
  /// Collective.
  void collect();
  /// The rows that ElasticOperator defines. `unknowns` empty: of loads, to which supports add no rows of their
  /// own.
  void take_rows(std::span<const double> unknowns, std::span<const double> known, std::span<double> result);
  /// collect() and take_rows() of loads, added.
  void add_collected(std::span<double> rhs);
  /// Sum of those forces of this rank's boundary faces that act; see ElasticKernel::add_face_forces.
  Vec3 acting(std::span<const double> forces) const;
  /// Of the forces there are (inner ones less the loads), what is held at each patch, with the moment of the nodes where they
  /// are, or `moved` by their displacement; this rank's part.
  std::vector<Wrench> held(std::span<const double> known, bool moved);

  // The loops; public for the clones by processor.
  [[gnu::always_inline]] inline void interpolate_free();
  [[gnu::always_inline]] inline void to_nodes_loop();

 private:
  template <int D>
  void fill_nodes(std::span<const double> unknowns, std::span<const double> known);
  template <int D>
  void copy_rows(std::span<double> result);
  void points_to_nodes();
  /// take(place, share) for the node and the points of a boundary face: the parts of its trace, or of a force on it.
  template <class Take>
  void visit_trace(Index f, const Take& take) const;
  void spread_over_base(Index f, const Vec3& force_on_base);
  void spread_around(Index f, const Vec3& force_on_base);
  /// Force k (u - g) of the springs on the mean of the trace of a face.
  Vec3 pull_of_springs(Index f, std::span<const double> known) const;
  void held_at_points(std::span<const Index> patch_of, bool moved, std::vector<Wrench>& result);
  Vec3 position(Index place, bool moved) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  Index n_nodes_;
  ElasticNodes nodes_;  // with the points behind
  ElasticVertices vertices_;
  std::unique_ptr<JoinedVertices> joined_;  // on periodic patches; none without such
  std::vector<double> force_;
  std::vector<std::pair<Index, Vec3>> symmetry_;  // faces and normals
  std::vector<double> volume_;                    // sum of the pyramids of each owned cell
  std::vector<double> mass_;                      // empty: none
};

/// Sum of the pyramids of each owned cell: warped faces fill it only nearly.
std::vector<double> pyramid_volumes(const mesh::Mesh& mesh, const mesh::Geometry& geometry);

}  // namespace couplet::elastic
