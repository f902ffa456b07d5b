// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/elasticity/finite/finite_strain.hpp"

/// Plane stress: the stretch l = F_33 across the sheet is the one that leaves P_33 = dW/dl = 0, found at each place by itself.
/// In-plane forces are then those of W(F, l(F)), P of the whole F, and their derivative is condensed:
///   dP = dP|_l - D (D : dF) / c,   D = dP_33/dF = dP/dl,   c = dP_33/dl.
namespace couplet::elastic::finite {

/// What the condensed derivative needs of four places.
struct alignas(32) Sheet {
  Four d[2][2];
  Four c;
};

/// Below this stretch a place counts as inside out: there is no l > 0 without stress.
constexpr double thinnest = 1e-3;

/// Requires a state with known l and derivatives of W.
Sheet sheet_of(const State& state);

/// In-plane dP of a change without l to that with it.
[[gnu::always_inline]] inline void condense(const Sheet& sheet, const Tensor4& df, Tensor4& dp) {
  const Four along = (sheet.d[0][0] * df[0][0] + sheet.d[0][1] * df[0][1] + sheet.d[1][0] * df[1][0] +
                      sheet.d[1][1] * df[1][1]) /
                     sheet.c;
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) dp[a][b] -= sheet.d[a][b] * along;
}

/// The states of one material at some places (faces or edges), four side by side.
struct Places {
  const FiniteLaw* law = nullptr;
  std::vector<State> states;
  std::vector<Start> start;   ///< of the step; empty: its stress is that of the states
  std::vector<Four> stretch;  ///< thermal; empty: none
  std::vector<Sheet> sheet;   ///< plane stress; empty: none
  double thinning = 0;        ///< Poisson's ratio over 1 - itself at rest, plane stress

  void set_plane_stress();
  /// Plane stress: finds F_33 of the states from `first` on. `found`: invariants of F with F_33 = 1 on entry, of F with l
  /// at the end (J = 0: there is none). The first guess follows from F, so that the answer does not depend on what was
  /// before. Nothing to do elsewhere.
  void relax(std::size_t first, std::span<Invariants> found);
  /// The law at the states from `first` on, whose invariants are spoilt.
  void evaluate(std::size_t first, std::span<Invariants> found, bool with_bulk, std::span<Energy> energy);
  /// A step that conserves energy begins at the states.
  void set_start(bool with_bulk);

 private:
  std::span<const Four> stretch_at(std::size_t first, std::size_t n) const {
    return stretch.empty() ? std::span<const Four>() : std::span(stretch).subspan(first, n);
  }
};

}  // namespace couplet::elastic::finite
