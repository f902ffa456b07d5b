// SPDX-License-Identifier: Apache-2.0
// balance.csv: volume, energy and divergence of every step.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/output/output.hpp"
#include "fluid_solver/state/face_sums.hpp"

namespace couplet::fluid {
namespace {

struct CellSums {
  double divergence = 0, volume = 0, squares = 0;  ///< |sum phi|, V, V |u|^2
  double worst = 0;                                ///< largest |sum phi| / V
};

template <int D>
[[gnu::always_inline]] inline CellSums sums_of(std::span<const double> volume, const double* outflow,
                                               const Vec<D>* u) {
  CellSums sums;
  for (std::size_t c = 0; c < volume.size(); ++c) {
    const double out = std::abs(outflow[c]);
    sums.divergence += out;
    sums.volume += volume[c];
    sums.squares += volume[c] * u[c].squaredNorm();
    if (out > sums.worst * volume[c]) sums.worst = out / volume[c];
  }
  return sums;
}
COUPLET_PROCESSOR_CLONES CellSums sum_cells(std::span<const double> volume, const double* outflow,
                                            const Vec<2>* u) {
  return sums_of<2>(volume, outflow, u);
}
COUPLET_PROCESSOR_CLONES CellSums sum_cells(std::span<const double> volume, const double* outflow,
                                            const Vec<3>* u) {
  return sums_of<3>(volume, outflow, u);
}

}  // namespace

template <int D>
void FluidOutput<D>::write_balance(double time) {
  const State<D>& s = fluid_.state();
  const Placement<D>& at = *s.placement;
  enum { inflow, outflow, volume, energy, divergence, taken_up };
  double sums[6] = {};
  divergence_.assign(mesh_.cells.n_local(), 0.0);
  subtract_outflow(mesh_, -1, s.phi, divergence_);
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    divergence_[mesh_.owner[f]] += s.phi[f];
    (s.phi[f] < 0 ? sums[inflow] : sums[outflow]) += std::abs(s.phi[f]);
  }
  if (s.blocked)  // held by their gaps as a whole
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
      if ((*s.blocked)[c]) divergence_[c] = 0;
  const CellSums over_cells =
      sum_cells(std::span(at.volume).first(mesh_.cells.n_owned()), divergence_.data(), s.u.data());
  sums[divergence] = over_cells.divergence, sums[volume] = over_cells.volume;
  sums[energy] = 0.5 * fluid_.parameters().density * over_cells.squares;
  if (s.pressure[0]) sums[taken_up] = s.pressure[0]->taken_up;
  double worst = over_cells.worst;
  MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  worst = parallel::max(mesh_.comm, worst);
  if (!root_) return;
  if (!balance_)
    balance_.emplace(
        open("balance.csv", {"time [s]", "inflow [m^3/s]", "outflow [m^3/s]", "volume [m^3]",
                             "kinetic energy [J]", "largest divergence [1/s]", "mean divergence [1/s]",
                             "mass defect [m^3/s]", "sub-steps [-]", "pressure iterations so far [-]"}));
  balance_->row(std::array<double, 10>{
      time, sums[inflow], sums[outflow], sums[volume], sums[energy], worst, sums[divergence] / sums[volume],
      sums[outflow] - sums[inflow] + sums[taken_up], double(fluid_.statistics().sub_steps),
      double(fluid_.statistics().pressure_iterations)});
}

template void FluidOutput<2>::write_balance(double);
template void FluidOutput<3>::write_balance(double);

}  // namespace couplet::fluid
