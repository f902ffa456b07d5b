// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/finite/finite_places.hpp"
#include "common/elasticity/symmetric/shared_edges.hpp"

namespace couplet::elastic {

/// Edges of SharedEdges at large strain. An edge has the mean displacement gradient of the faces around it,
/// since strains of rotated faces cannot be averaged, and the energy of the law at that mean.
class FiniteEdges {
 public:
  /// Edges of one material in blocks of four. The last block is padded with its last edge at volume 0.
  struct Group : finite::Places {
    std::vector<std::array<Index, 4>> edges;
    std::vector<std::array<double, 4>> volume;  ///< of edges that this rank owns, otherwise 0
  };

  /// `faces` are the triangular flux faces, this rank's first. `volume` is V_f of this rank's, else 0. `laws`
  /// has one entry per material or one in total. Collective.
  FiniteEdges(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const Index> faces,
              std::span<const double> volume, std::span<const FiniteLaw* const> laws);

  const SharedEdges& edges() const { return edges_; }
  double* at(Index edge) { return value_.data() + std::size_t(edge) * SharedEdges::gradient_stride; }
  double* values() { return value_.data(); }
  void clear() { std::fill(value_.begin(), value_.end(), 0.0); }
  /// Completes the means over all ranks. Collective.
  void finish_means() { edges_.finish_gradients(value_); }
  /// Takes the means at [0] as thermal stretches minus 1. forget_stretch() removes them.
  void take_stretch();
  void forget_stretch();
  /// Converts means to stresses P, adds to the energy and returns the smallest det F. The second value is
  /// false if the law was not evaluated because an edge is inverted.
  double to_stress(bool with_bulk, double& energy);
  /// Starts an energy-conserving step at the states of the last to_stress().
  void set_start(bool with_bulk);
  /// Replaces the stress by the energy-conserving stress P* of the step.
  void to_conserving(bool with_bulk);
  /// Converts mean changes of the gradient to changes of P.
  void to_tangent();
  /// F - I of an edge at the last to_stress(), entry a * 3 + b.
  const double* gradient(Index edge) const {
    return kept_.data() + std::size_t(edge) * SharedEdges::gradient_stride;
  }

 private:
  SharedEdges edges_;
  std::vector<double> value_, kept_;
  std::vector<Group> groups_;
};

}  // namespace couplet::elastic
