// SPDX-License-Identifier: Apache-2.0
// The passes of the pressure equation on oblique meshes.
#include <algorithm>

#include "common/base/error.hpp"
#include "fluid_solver/pressure/projection.hpp"

namespace couplet::fluid {
namespace {

constexpr int oblique_passes = 2, most_oblique_passes = 200;
constexpr double standing = 1e-3;  // change of the pressure gradient in a pass
constexpr linalg::Acceleration pass_acceleration{linalg::Acceleration::Type::anderson, 1, 6};
// The first pass only gives the second one the gradient of its non-orthogonal part: what that share of the
// operator leaves of a looser tolerance.
constexpr double first_pass_tolerance = 10, loosest_tolerance = 0.5;

}  // namespace

/// phi^p without and with -(dt/rho) grad p~ . k.
template <int D>
void PressureProjection<D>::add_oblique_pressure() {
  const Placement<D>& now = *k_.step.to;
  const double factor = k_.step.dt / k_.rho;
  const Placement<D>& around = k_.pressure_placement();
  k_.phi_p = k_.phi_orthogonal;
  for (Index f = 0; f < k_.mesh.n_interior; ++f) {
    const double w = now.weight[f];
    k_.phi_p[f] -=
        factor * (w * k_.gradient_guess[k_.mesh.owner[f]] + (1 - w) * k_.gradient_guess[k_.mesh.neighbour[f]])
                     .dot(around.oblique_of(f));
  }
  for (const Index b : k_.boundary.rows().of_pressure) {
    const Index f = k_.mesh.n_interior + b;
    k_.phi_p[f] -= factor * k_.gradient_guess[k_.mesh.owner[f]].dot(around.oblique_of(f));
  }
}

/// On an oblique mesh in passes: the gradient in the non-orthogonal part is that of the steps before in the
/// first, then that of the pass before. Two are enough where no old pressure is in the predictor (|z| = q,
/// see extrapolate_pressure()) or q is small; an implicit predictor gives the old one back unsmoothed, and
/// what two passes leave of it grows from about 45 degrees on: there the passes go on until the gradient
/// stands.
template <int D>
void PressureProjection<D>::project(const State<D>& from, const Vectors<D>& w, double answer) {
  k_.gradient_guess = k_.gradient_start;
  const bool to_the_end = k_.oblique && k_.by.implicit && k_.very_oblique;
  const int passes = to_the_end ? most_oblique_passes : k_.oblique ? oblique_passes : 1;
  for (int pass = 1; pass <= passes; ++pass) {
    if (k_.gradient_guess.empty())
      k_.phi_p = k_.phi_orthogonal;
    else
      add_oblique_pressure();
    const double tolerance = (pass < passes ? first_pass_tolerance : 1) * k_.parameters.pressure_tolerance;
    solve_pressure(from, w, std::min(tolerance, loosest_tolerance), answer);
    if (pass == passes && to_the_end)
      throw SolveFailure(
          "The non-orthogonal correction of the pressure equation did not converge in {} passes at t = "
          "{:.6g} s: the mesh is too skewed, {:.0f} degrees between a face normal and the line of its cell "
          "centres.",
          passes, k_.by.time + k_.step.dt, k_.degrees);
    if (pass == passes) break;
    if (to_the_end) gradient_before_ = k_.gradient_guess;
    pressure_gradient(*k_.step.to, k_.p, k_.p_boundary, nullptr, k_.gradient_guess);
    for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c) k_.gradient_guess[c] /= k_.step.to->volume[c];
    const bool stands = to_the_end && mix_gradients(pass);
    k_.mesh.cells.update_ghosts(flat<D>(k_.gradient_guess), D);
    if (stands && pass >= oblique_passes) break;
  }
}

/// The gradient that the next pass starts from, by Anderson's acceleration: the mode of a few cells that falls by 0.97 a pass where
/// a face is 87 degrees oblique costs a dozen passes in place of two hundred. Whether the gradient stands. Collective.
template <int D>
bool PressureProjection<D>::mix_gradients(int pass) {
  const std::size_t owned = static_cast<std::size_t>(k_.mesh.cells.n_owned()) * D;
  if (!accelerator_)
    accelerator_ = std::make_unique<linalg::Accelerator>(k_.mesh.comm, owned, pass_acceleration);
  if (pass == 1) accelerator_->restart();
  gradient_before_.resize(k_.gradient_guess.size(), Vec<D>::Zero());
  double sums[2] = {0, 0};
  for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c) {
    sums[1] += k_.gradient_guess[c].squaredNorm();
    k_.gradient_guess[c] -= gradient_before_[c];
    sums[0] += k_.gradient_guess[c].squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, k_.mesh.comm);
  accelerator_->advance(flat<D>(gradient_before_).first(owned), flat<D>(k_.gradient_guess).first(owned));
  k_.gradient_guess.swap(gradient_before_);
  return sums[0] <= standing * standing * sums[1];
}

template void PressureProjection<2>::add_oblique_pressure();
template void PressureProjection<3>::add_oblique_pressure();
template bool PressureProjection<2>::mix_gradients(int);
template bool PressureProjection<3>::mix_gradients(int);
template void PressureProjection<2>::project(const State<2>&, const Vectors<2>&, double);
template void PressureProjection<3>::project(const State<3>&, const Vectors<3>&, double);

}  // namespace couplet::fluid
