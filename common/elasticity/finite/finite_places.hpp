// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/finite/finite_strain.hpp"
#include "common/elasticity/symmetric/face_groups.hpp"

/// Plane stress: the stretch l = F_33 normal to the sheet follows from P_33 = dW/dl = 0 at each location.
/// In-plane forces are those of W(F, l(F)). Their derivative is condensed:
///   dP = dP|_l - D (D : dF) / c,   D = dP_33/dF = dP/dl,   c = dP_33/dl
namespace couplet::elastic::finite {

/// Data of the condensed derivative at four locations.
struct alignas(32) Sheet {
  Four d[2][2];
  Four c;
};

/// Smallest stretch, below which a location counts as inverted because no l > 0 is free of stress.
constexpr double thinnest = 1e-3;

/// Requires a state with known l and derivatives of W.
Sheet sheet_of(const StrainState& state);

/// Changes in-plane dP at fixed l to that with varying l.
[[gnu::always_inline]] inline void condense(const Sheet& sheet, const Tensor4& df, Tensor4& dp) {
  const Four along = (sheet.d[0][0] * df[0][0] + sheet.d[0][1] * df[0][1] + sheet.d[1][0] * df[1][0] +
                      sheet.d[1][1] * df[1][1]) /
                     sheet.c;
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) dp[a][b] -= sheet.d[a][b] * along;
}

/// States of one material at some locations (faces or edges), four at a time.
struct Places {
  const FiniteLaw* law = nullptr;
  std::vector<StrainState> states;
  std::vector<Start> start;   ///< start of the step; if empty, the stress is that of the states
  std::vector<Four> stretch;  ///< thermal; empty if there is none
  std::vector<Sheet> sheet;   ///< plane stress; otherwise empty
  double thinning = 0;        ///< nu / (1 - nu) at rest, for plane stress

  void set_plane_stress();
  /// Finds F_33 of the states from `first` on for plane stress; otherwise does nothing. `found` holds the
  /// invariants with F_33 = 1 on entry and with l on return (J = 0 if there is none). The initial guess
  /// follows from F, so that the result does not depend on earlier states.
  void relax(std::size_t first, std::span<Invariants> found);
  /// Evaluates the law at the states from `first` on and overwrites their invariants.
  void evaluate(std::size_t first, std::span<Invariants> found, bool with_bulk, std::span<Energy> energy);
  /// Starts an energy-conserving step at the states.
  void set_start(bool with_bulk);

 private:
  std::span<const Four> stretch_at(std::size_t first, std::size_t n) const {
    return stretch.empty() ? std::span<const Four>() : std::span(stretch).subspan(first, n);
  }
};

}  // namespace couplet::elastic::finite

namespace couplet::elastic {

/// Edges of SharedEdges at large strain. An edge has the mean displacement gradient of the faces around it,
/// since strains of rotated faces cannot be averaged, and the energy of the law at that mean.
class FiniteEdges {
 public:
  /// Edges of one material in blocks of four. The last block is padded with its last edge at volume 0.
  struct EdgeGroup : finite::Places {
    std::vector<std::array<Index, 4>> edges;
    std::vector<std::array<double, 4>> volume;  ///< of edges that this rank owns, otherwise 0
  };

  /// `faces` are the triangular flux faces, this rank's first. `volume` is V_f of this rank's, else 0. `laws`
  /// has one entry per material or one in total. Collective.
  FiniteEdges(const mesh::Mesh& mesh, const ElasticOperator& rows, const SharedFaces& shared,
              std::span<const FiniteLaw> laws);

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
  std::vector<EdgeGroup> groups_;
};

}  // namespace couplet::elastic
