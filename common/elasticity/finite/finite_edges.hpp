// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/finite/finite_places.hpp"
#include "common/elasticity/symmetric/shared_edges.hpp"

namespace couplet::elastic {

/// The edges of SharedEdges at large strain: the mean over the faces round an edge is one of displacement
/// gradients, not of strains (they differ by rotations there), and the edge has the law's energy at that mean.
class FiniteEdges {
 public:
  /// Of one material, four edges a block, the last one filled up with the last edge at volume 0.
  struct Group : finite::Places {
    std::vector<std::array<Index, 4>> edges;
    std::vector<std::array<double, 4>> volume;  ///< of edges that this rank owns; 0: another rank counts them
  };

  /// `faces`: the three-cornered flux faces, this rank's first; `volume`: V_f of this rank's, 0 of the others;
  /// `laws`: one a material or one of all. Collective.
  FiniteEdges(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const Index> faces,
              std::span<const double> volume, std::span<const FiniteLaw* const> laws);

  const SharedEdges& edges() const { return edges_; }
  double* at(Index edge) { return value_.data() + std::size_t(edge) * SharedEdges::gradient_stride; }
  double* values() { return value_.data(); }
  void clear() { std::fill(value_.begin(), value_.end(), 0.0); }
  /// The sums become means over all ranks. Collective.
  void finish_means() { edges_.finish_gradients(value_); }
  /// The means that stand at [0] are thermal stretches, less 1; or there are none any more.
  void take_stretch();
  void forget_stretch();
  /// From means to stresses P of the states there. Gives the smallest det F, and whether the law was evaluated (it
  /// is not from an edge on that is inside out); adds to the energy.
  double to_stress(bool with_bulk, double& energy);
  /// A step that conserves energy begins at the states of the last to_stress().
  void set_start(bool with_bulk);
  /// Its stress P* in place of that of the states.
  void to_conserving(bool with_bulk);
  /// From means of changes to changes of P.
  void to_tangent();
  /// F of an edge at the last to_stress(), less I: entry a * 3 + b.
  const double* gradient(Index edge) const {
    return kept_.data() + std::size_t(edge) * SharedEdges::gradient_stride;
  }

 private:
  SharedEdges edges_;
  std::vector<double> value_, kept_;
  std::vector<Group> groups_;
};

}  // namespace couplet::elastic
