// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/equilibrium/small_strain.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/linalg/krylov.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

constexpr int most_corrections = 60, most_multiplier_changes = 200, halvings = 50;
// Tolerances of a linear solve. A stiff seat leaves no more digits than the finest one; the next correction gains others.
constexpr double loosest_solve = 1e-3, finest_solve = 1e-8;

class ContactNewton {
 public:
  ContactNewton(const ContactProblem& problem, std::span<const double> b, std::span<double> u)
      : p_(problem),
        b_(b),
        u_(u),
        r_(u.size()),
        du_(u.size()),
        kdu_(u.size()),
        krylov_(
            "displacement", p_.comm, u.size(),
            [this](std::span<const double> x, std::span<double> y) {
              p_.stiffness(x, y);
              p_.pressing.add_stiffness(x, y);
            },
            [this](std::span<const double> r, std::span<double> z) { p_.method.approximate_inverse(r, z); }) {
  }

  linalg::SolveStatistics run() {
    look(p_.known);
    if (!touches()) {
      statistics_ = p_.method.solve(b_, u_);
      look(p_.known);
      if (!touches()) return statistics_;
      statistics_.inner_iterations += statistics_.iterations;
      statistics_.iterations = 0;
    }
    check_method();
    for (int i = 0; equilibrate() > 0 && p_.pressing.seat().is_rigid(); ++i) {
      const double change = p_.pressing.take_multipliers(p_.comm);
      p_.pressing.look(along_);
      if (i == most_multiplier_changes)
        throw SolveFailure(
            "The contact pressure on the rigid seat did not converge in {} corrections (last relative change {:.1e}). Set "
            "'contact.stiffness', or increase 'contact.scale'.",
            most_multiplier_changes, change);
    }
    return statistics_;
  }

 private:
  void look(std::span<const double> known) {
    along_ = p_.pressing.seat().along(u_, known);
    p_.pressing.look(along_);
  }
  bool touches() const {
    return parallel::any(p_.comm, std::ranges::any_of(p_.pressing.forces(), [](double f) { return f != 0; }));
  }
  void check_method() {
    if (!p_.method.approximate_inverse(u_, r_))
      throw Error(
          "contact: 'solution-method: {{preconditioner: mixed}}' does not support a seat; use 'preconditioner: multigrid' or "
          "'factors'.");
  }

  /// r = b + C^T f - K u, and its scale.
  double residual() {
    p_.stiffness(u_, r_);
    for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = b_[i] - r_[i];
    std::vector<double> push(r_.size(), 0);
    p_.pressing.seat().add_to_rows(p_.pressing.forces(), push);
    for (std::size_t i = 0; i < r_.size(); ++i) r_[i] += push[i];
    scale_ = std::max(norm(p_.comm, b_), norm(p_.comm, push));
    return norm(p_.comm, r_);
  }

  /// Newton's method for the current multipliers. Returns the number of corrections, zero for a converged rigid seat.
  int equilibrate() {
    double size = residual();
    int i = 0;
    for (; size > p_.tolerance * scale_; ++i) {
      if (i == most_corrections)
        throw SolveFailure(
            "The contact did not converge in {} corrections: residual {:.1e} of the forces (tolerance {:.0e}). Try a smaller "
            "step.",
            most_corrections, size / scale_, p_.tolerance);
      const double wanted = std::min(loosest_solve, 0.3 * p_.tolerance * scale_ / size);
      std::ranges::fill(du_, 0.0);
      const linalg::SolveStatistics one =
          krylov_.solve(r_, du_, {std::max(wanted, finest_solve), p_.most_iterations, true});
      statistics_.inner_iterations += one.iterations;
      ++statistics_.iterations;
      correct();
      const double before = size;
      size = residual();
      // Newton's method has stalled at round-off.
      if (size >= 0.999 * before && size <= 1e3 * p_.tolerance * scale_ && i > 3) break;
    }
    statistics_.residual = size;
    return i;
  }

  /// u + s du with the s <= 1 at which du . r changes sign; the energy is convex along du.
  void correct() {
    const std::vector<double> change = p_.pressing.seat().along(du_, {}), start = along_;
    p_.stiffness(du_, kdu_);
    double smooth[2] = {0, 0};  // du . (b - K u), du . K du
    for (std::size_t i = 0; i < du_.size(); ++i) {
      smooth[0] += du_[i] * r_[i];
      smooth[1] += du_[i] * kdu_[i];
    }
    for (std::size_t i = 0; i < change.size(); ++i) smooth[0] -= change[i] * p_.pressing.forces()[i];
    const auto slope = [&](double s) {
      for (std::size_t i = 0; i < along_.size(); ++i) along_[i] = start[i] + s * change[i];
      p_.pressing.look(along_);
      double sum = smooth[0] - s * smooth[1];
      for (std::size_t i = 0; i < change.size(); ++i) sum += change[i] * p_.pressing.forces()[i];
      return parallel::sum(p_.comm, sum);
    };
    const double enough = 0.1 * slope(0);
    double low = 0, high = 1, s = 1, here = slope(1);
    for (int i = 0; i < halvings && std::abs(here) > enough && !(s == 1 && here > 0); ++i) {
      (here < 0 ? high : low) = s;
      s = 0.5 * (low + high);
      here = slope(s);
    }
    for (std::size_t i = 0; i < u_.size(); ++i) u_[i] += s * du_[i];
  }

  const ContactProblem& p_;
  std::span<const double> b_;
  std::span<double> u_;
  std::vector<double> r_, du_, kdu_, along_;
  linalg::KrylovSolver krylov_;
  double scale_ = 0;
  linalg::SolveStatistics statistics_;
};

}  // namespace

void clear_stress_across(const SolidParameters& parameters, std::span<Tensor3> stress) {
  if (!is_plane_stress(parameters)) return;
  for (Tensor3& s : stress) s(2, 2) = 0;
}

linalg::SolveStatistics solve_with_contact(const ContactProblem& problem, std::span<const double> b,
                                           std::span<double> u) {
  return ContactNewton(problem, b, u).run();
}

linalg::SolveStatistics SmallStrain::find(const EquilibriumLoad& load, SolidSystem& system,
                                          std::span<double> u) {
  if (!load.pressing) return system.method->solve(load.rows, u);
  const linalg::LinearMap stiffness = [&](std::span<const double> x, std::span<double> y) {
    if (load.mass_factor > 0) return kernel_.apply_with_mass(x, {}, load.mass_factor, true, y);
    kernel_.apply(x, {}, y);
  };
  return solve_with_contact({mesh_.comm, stiffness, *system.method, *load.pressing, load.known,
                             parameters_.method.relative_tolerance, parameters_.method.max_iterations},
                            load.rows, u);
}

std::vector<double> SmallStrain::forces(std::span<const double> unknowns, std::span<const double> known) {
  std::vector<double> force(unknowns.size());
  kernel_.apply(unknowns, known, force);
  return force;
}

double SmallStrain::energy(std::span<const double> unknowns, std::span<const double> known) {
  const elastic::ElasticField u{unknowns, known};
  return parallel::sum(mesh_.comm, 0.5 * kernel_.product(elastic::ElasticPart::stiffness, u, u));
}

std::vector<elastic::Wrench> SmallStrain::holding_forces(std::span<const double> unknowns,
                                                         std::span<const double> known,
                                                         const elastic::ElasticLoads& loads) {
  return kernel_.holding_forces(unknowns, known, loads);
}

std::vector<Tensor3> SmallStrain::face_stress(const Displaced& state, Index first, Index count) {
  std::vector<Tensor3> stress = state.face_gradients(first, count);
  for (Index i = 0; i < count; ++i) stress[i] = rows_.stress(mesh_.owner[first + i], stress[i]);
  if (thermal_) thermal_->add_face_stress(first, stress);
  clear_stress_across(parameters_, stress);
  return stress;
}

std::vector<Tensor3> SmallStrain::cell_stress(const Displaced& state) {
  std::vector<Tensor3> stress = state.cell_gradients();
  for (std::size_t c = 0; c < stress.size(); ++c) stress[c] = rows_.stress(Index(c), stress[c]);
  if (thermal_) thermal_->add_cell_stress(stress);
  clear_stress_across(parameters_, stress);
  return stress;
}

}  // namespace couplet::solid
