// SPDX-License-Identifier: Apache-2.0
// The bed's step where capsules melt: Newton's method on the heat of each shell [swaminathan1993]. With h_m,
// T_m of the last pass and c = dh/dT there,
//   (h_m + c (T - T_m) - h^n)/tau = what flows in at T
// is linear; h_m + c (T - T_m) is then exactly what flowed in, whatever the number of passes, and T_{m+1} the
// temperature that belongs to it.
#include <algorithm>
#include <cmath>

#include "thermocline/bed/grain_kernels.hpp"
#include "thermocline/bed/packed_bed.hpp"

namespace couplet::thermocline {

/// Apparent capacity and right-hand side of each shell at its temperature of the last pass [J/(m^3 K)],
/// [J/m^3].
void PackedBed::linearise_melting(const BedGrid::Run& run, const PhaseChange& phase) {
  const int n = grid_.size();
  const double share = (1 - run.layer.porosity) / shells_;
  for (int j = 0; j < shells_; ++j)
    for (int i = run.first; i < run.first + run.count; ++i) {
      const std::size_t k = std::size_t(j) * n + i;
      const double c = phase.capacity(shell_[k]);
      melt_.capacity[k] = share * c;
      melt_.right[k] = share * (c * shell_[k] - phase.heat(shell_[k]) + phase.heat(shell1_[k]));
    }
}

/// The elimination of GrainElimination with a capacity of each shell of each cell; adds to the fluid's rows.
void PackedBed::eliminate_melting(const Operator& op, const BedGrid::Run& run, const Grains& grains,
                                  const double* extra) {
  const int n = grid_.size();
  for (int i = run.first; i < run.first + run.count; ++i) {
    double rest_inside = 1, inside = 0;  // 1 - beta and alpha of the shell further in
    for (int j = shells_ - 1; j >= 1; --j) {
      const std::size_t k = std::size_t(j) * n + i;
      const double outward = grains.between[j - 1], inward = j + 1 < shells_ ? grains.between[j] : 0;
      const double held = melt_.capacity[k] / op.tau + inward * rest_inside, diagonal = held + outward;
      melt_.alpha[k] = inside = (melt_.right[k] / op.tau + inward * inside) / diagonal;
      melt_.beta[k] = outward / diagonal;
      rest_inside = held / diagonal;
    }
    const double between = shells_ > 1 ? grains.between[0] : 0;
    const double own = melt_.capacity[i] / op.tau + between * rest_inside;
    const double g = grains.exchange(film_[i]), dz = grid_.dz[i];
    melt_.alpha[i] = (melt_.right[i] / op.tau + between * inside) / (own + g);
    melt_.beta[i] = g / (own + g);
    melt_.diagonal[i] = diagonal_[i] - op.own_part[i] + own * melt_.beta[i] * dz;
    fluid_[i] = op.rate[i] * fluid_[i] + extra[i] + g * dz * melt_.alpha[i];
  }
}

/// Temperatures that belong to the heat that each shell got; by how much the linear ones were off at most
/// [K].
double PackedBed::settle_melting(const BedGrid::Run& run, const PhaseChange& phase) {
  const int n = grid_.size();
  const double share = (1 - run.layer.porosity) / shells_;
  double worst = 0;
  for (int i = run.first; i < run.first + run.count; ++i) {
    double outside = fluid_[i];
    for (int j = 0; j < shells_; ++j) {
      const std::size_t k = std::size_t(j) * n + i;
      outside = melt_.alpha[k] + melt_.beta[k] * outside;
      // capacity T - right = h - h^n, per volume of the bed
      const double heat = phase.heat(shell1_[k]) + (melt_.capacity[k] * outside - melt_.right[k]) / share;
      shell_[k] = phase.temperature(heat);
      worst = std::max(worst, std::abs(shell_[k] - outside));
    }
  }
  return worst;
}

void PackedBed::solve_with_melting(const Operator& op, const double* extra) {
  constexpr int most_passes = 30;
  constexpr double close = 1e-6;  // [K]
  fluid1_ = fluid_, shell1_ = shell_;
  for (int pass = 0; pass < most_passes; ++pass) {
    fluid_ = fluid1_;
    melt_.diagonal = diagonal_;
    for (std::size_t r = 0; r < grid_.runs.size(); ++r) {
      const BedGrid::Run& run = grid_.runs[r];
      if (!melting_[r]) {
        gather_grains(op.grains[r], cells_of(op, run), shell1_.data(), extra, fluid_.data(), sums_.data());
        continue;
      }
      linearise_melting(run, *melting_[r]);
      eliminate_melting(op, run, grains_[r], extra);
    }
    melt_.matrix.resize(grid_.size());
    melt_.matrix.factorise(lower_.data(), melt_.diagonal.data(), upper_.data());
    melt_.matrix.solve(fluid_.data());
    double worst = 0;
    for (std::size_t r = 0; r < grid_.runs.size(); ++r) {
      const BedGrid::Run& run = grid_.runs[r];
      if (melting_[r])
        worst = std::max(worst, settle_melting(run, *melting_[r]));
      else
        scatter_grains(op.grains[r], cells_of(op, run), shell1_.data(), fluid_.data(), shell_.data(),
                       sums_.data());
    }
    if (worst <= close) return;
  }
  ++fallbacks_;  // the books are right all the same
}

}  // namespace couplet::thermocline
