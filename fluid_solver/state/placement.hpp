// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::fluid {

template <int D>
using Vectors = std::vector<Vec<D>>;

/// The doubles of an array of vectors, for halo updates, output and checkpoints.
template <int D>
std::span<double> flat(Vectors<D>& values) {
  return {values.empty() ? nullptr : values.front().data(), values.size() * D};
}
template <int D>
std::span<const double> flat(const Vectors<D>& values) {
  return {values.empty() ? nullptr : values.front().data(), values.size() * D};
}

/// Data of one placement of the points for the face loops. Faces are the flux faces of the mesh (interior,
/// then the boundary of owned cells).
template <int D>
struct Placement {
  std::vector<double> volume;  ///< V [m^3], per local cell
  Vectors<D> area;             ///< S [m^2], out of the owner
  /// g = |S|^2 / (S.d) [m], over-relaxed; d from owner to neighbour (or face) centre.
  std::vector<double> conductance;
  Vectors<D> oblique;          ///< k = S - g d [m^2], tangential; empty on orthogonal meshes
  std::vector<double> weight;  ///< of the owner in the linear interpolation to the face, per interior face
  Vectors<D> centre;           ///< per local cell [m]
  std::vector<Vec3> boundary_centre;  ///< per owned boundary face [m]
  double obliqueness = 0;             ///< largest |k|/|S| on this rank
  /// From where the weights lead to the face's centre, per interior face [m]; empty if the mesh is not skewed.
  Vectors<D> skew;
  /// Per local cell, with `skew`: B that makes the Gauss gradient G of values at the weights' places exact
  /// for linear fields: G B of vectors (du_i/dx_j), B^T G of scalars.
  std::vector<Tensor<D>> gradient_cure;
  bool skewed() const { return !skew.empty(); }
  /// From the middle between the cells to the face's centre, skewed meshes only [m].
  Vec<D> offset(Index f) const {
    return skew[f] + (0.5 - weight[f]) / conductance[f] * (area[f] - oblique_of(f));
  }
  /// Placements that are translations of each other share it; nullptr if nothing is known.
  std::shared_ptr<const char> shape{};
  /// k of a face [m^2], whether or not there is the array.
  Vec<D> oblique_of(Index face) const { return oblique.empty() ? Vec<D>(Vec<D>::Zero()) : oblique[face]; }
};
/// Error of a value linear between the cells at an interior face of a skewed mesh.
template <int D>
double skew_part(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& gradient, Index f) {
  const double weight = at.weight[f];
  return (weight * gradient[mesh.owner[f]] + (1 - weight) * gradient[mesh.neighbour[f]]).dot(at.skew[f]);
}
/// |k|/|S| up to which a mesh counts as orthogonal.
constexpr double orthogonal = 1e-9;

/// Collective.
template <int D>
std::shared_ptr<const Placement<D>> make_placement(const mesh::Mesh& mesh, const mesh::Geometry& geometry);
template <int D>
std::shared_ptr<const Placement<D>> make_placement(const mesh::Mesh& mesh, std::span<const Vec3> points);
/// Moves a placement: only the centres differ. `from` must have a shape.
template <int D>
std::shared_ptr<const Placement<D>> translated(const Placement<D>& from, const Vec3& by);

/// Placement with values at the marked interior faces that are means of the cells' values, wherever the face lies between them.
template <int D>
std::shared_ptr<const Placement<D>> in_the_middle(const mesh::Mesh& mesh, const Placement<D>& from,
                                                  std::span<const char> faces);

}  // namespace couplet::fluid
