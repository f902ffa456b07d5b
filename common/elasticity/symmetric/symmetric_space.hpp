// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/elastic_vertices.hpp"
#include "common/elasticity/joined_vertices.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {

/// The trial functions of the symmetric face gradient: displacements of nodes (cells, boundary faces) and of
/// points, and forces on them, taken back to the rows of ElasticOperator by the transposed weights,
/// f_j += w_ij F_i f_i. What a strain makes of them (Hooke's law, large strain) stands in the kernels; loads,
/// mass and springs act by the same functions and stand here. A cell's row is 1/dim of its balance, so that it
/// carries 1/dim of what acts on its volume and the vertices carry the rest; a boundary face carries 1/dim of
/// its traction, its vertices the rest.
///
/// Use: fill(), clear_forces(), add forces, collect(), take_rows().
template <int D>
class SymmetricSpace {
 public:
  static constexpr int stride = lanes::width<D>;

  /// Keeps both by reference.
  SymmetricSpace(const mesh::Mesh& mesh, const ElasticOperator& rows);

  const mesh::Mesh& mesh() const { return mesh_; }
  const ElasticOperator& rows() const { return rows_; }
  /// Displacements at all nodes and points. At symmetry planes the face's node is the mirror image of its cell.
  /// Collective.
  void fill(std::span<const double> unknowns, std::span<const double> known);
  const double* nodes() const { return nodes_[0]; }
  const double* points() const { return points_.data(); }
  /// Data of one place, see FaceRows.
  const double* value(Index place) const {
    const auto n = Index(n_nodes());
    return place < n ? nodes_[place] : points_.data() + std::size_t(place - n) * stride;
  }
  double* force_at(Index place) {
    const auto n = Index(n_nodes());
    return place < n ? force(place) : point_force(place - n);
  }
  double* forces() { return force_.data(); }
  double* point_forces() { return point_force_.data(); }
  Index node_of_face(Index f) const { return mesh_.cells.n_local() + f - mesh_.n_interior; }
  /// The node on the other side of a flux face than its owner.
  Index node_across(Index f) const { return f < mesh_.n_interior ? mesh_.neighbour[f] : node_of_face(f); }
  std::size_t n_nodes() const { return force_.size() / stride; }
  /// take(point) for all points with a value.
  template <class Take>
  void visit_points(const Take& take) const {
    vertices_.visit(take);
    if (!joined_) return;
    for (const Index v : joined_->all()) take(v);
  }

  void clear_forces();
  void negate_forces();
  void add_springs(std::span<const double> known);
  void add_mass_forces(double factor);
  void spread_face_forces(std::span<const double> forces);
  void spread_cell_forces(std::span<const double> forces);
  void set_density(std::span<const double> of_cells);
  /// This rank's part, after set_density(): one a local node, one a local point [kg].
  const std::vector<double>& node_mass() const { return node_mass_; }
  const std::vector<double>& point_mass() const { return point_mass_; }
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
  void constrain_point_forces();
  void points_to_nodes();
  void spread_over_base(Index f, const Vec3& force_on_base);
  void spread_around(Index f, const Vec3& force_on_base);
  void held_at_points(std::span<const Index> patch_of, bool moved, std::vector<Wrench>& result);
  Vec3 place_of(const double* force, bool moved) const;
  /// Force k (u - g) of the springs on the mean of the trace of a face; back to its node and points by the same parts:
  /// take(place of the force, value).
  template <class Take>
  void visit_spring(Index f, std::span<const double> known, const Take& take);
  double* force(Index node) { return force_.data() + std::size_t(node) * stride; }
  double* point_force(Index v) { return point_force_.data() + std::size_t(v) * stride; }
  Vec3 vector(const double* at) const;
  void add(double* at, const Vec3& value) const {
    for (int a = 0; a < D; ++a) at[a] += value[a];
  }

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  ElasticNodes<D> nodes_;
  ElasticVertices vertices_;
  std::unique_ptr<JoinedVertices> joined_;  // on periodic patches; none without such
  std::vector<double> points_, force_, point_force_;
  std::vector<std::pair<Index, Vec3>> symmetry_;  // faces and normals
  std::vector<double> volume_;                    // sum of the pyramids of each owned cell
  std::vector<double> node_mass_, point_mass_;    // empty: none
};

/// Sum of the pyramids of each owned cell: warped faces fill it only nearly.
std::vector<double> pyramid_volumes(const mesh::Mesh& mesh, const mesh::Geometry& geometry);

/// Mean displacement of the trace of a boundary face: its node has the part 1/dim, its points the rest.
template <int D>
Vec3 face_mean(const SymmetricSpace<D>& space, Index f) {
  constexpr int stride = SymmetricSpace<D>::stride;
  const auto shares = point_shares(space.mesh(), space.rows().geometry(), f);
  const auto points = space.mesh().face_points[f];
  const double* node = space.nodes() + std::size_t(space.node_of_face(f)) * stride;
  Vec3 mean = Vec3::Zero();
  for (int a = 0; a < D; ++a) {
    mean[a] = node[a] / D;
    for (std::size_t i = 0; i < points.size(); ++i)
      mean[a] += (1 - 1.0 / D) * shares[i] * space.points()[std::size_t(points[i]) * stride + a];
  }
  return mean;
}

template <int D>
template <class Take>
void SymmetricSpace<D>::visit_spring(Index f, std::span<const double> known, const Take& take) {
  const BoundaryRow& s = rows_.at(f);
  if (s.spring.isZero(0)) return;
  const Tensor3 open = Tensor3::Identity() - s.known, spring = open * s.spring * open;
  Vec3 g = Vec3::Zero();
  if (!known.empty()) g = vector(known.data() + std::size_t(rows_.known_of_face(f)) * D);
  const auto shares = point_shares(mesh_, geometry_, f);
  const auto points = mesh_.face_points[f];
  const Vec3 pull = geometry_.face_area[f].norm() * (spring * (face_mean(*this, f) - g));
  take(force(node_of_face(f)), pull / D);
  for (std::size_t i = 0; i < points.size(); ++i)
    take(point_force(points[i]), (1 - 1.0 / D) * shares[i] * pull);
}

}  // namespace couplet::elastic
