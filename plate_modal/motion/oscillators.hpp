// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "common/time/time_scheme.hpp"
#include "plate_modal/motion/contact.hpp"

namespace couplet::plate {

/// Energies since the start of the run [J]: thesis (4.29)-(4.31) and the corresponding works.
struct Energies {
  double kinetic = 0, strain = 0, gravity = 0, contact = 0;  ///< at the accepted time
  double initial = 0;                                        ///< total at the start
  double load_work = 0;    ///< done by the fluid and by prescribed pressures
  double impact_work = 0;  ///< done by the seat
  double damping_loss = 0;
  double largest = 0;  ///< largest own() so far
  double total() const { return kinetic + strain + gravity + contact; }
  /// Energy created or lost by the scheme, for the structure with the seat's springs.
  double mismatch() const { return total() - initial - load_work + damping_loss; }
  /// The larger of the work of the loads and of the energy without gravity and the scheme's contribution.
  double own() const {
    return std::max(kinetic + strain + contact - std::max(0.0, mismatch()), std::abs(load_work));
  }
  /// Data for checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(kinetic, strain, gravity, contact, initial, load_work, impact_work, damping_loss, largest);
  }
};

/// Generalized coordinates of the modes, thesis (4.26)-(4.27), at an accepted or trial time.
struct ModalState {
  std::vector<double> q, v, a;       ///< displacement, rate, acceleration
  std::vector<double> q_old, v_old;  ///< one more level back, for schemes that use it
  double dt = 0;                     ///< of the last step [s]; 0 if none
  std::vector<double> partner;       ///< loads of a partner in the last step, for schemes that use them
  Energies energies;
  /// Data for checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(q, v, a, q_old, v_old, dt, partner, energies);
  }
};

/// Static analysis: largest deflections of the plate itself and by its modes, and their largest difference
/// [m].
struct Deflection {
  double direct = 0, by_modes = 0, apart = 0;
};

/// Integrates q'' + c q' + omega^2 q = Q + impact of all modes over one step. Without contact, the modes are
/// independent. Contact forces couple the modes, which are then solved together by Newton's method.
class Oscillators final {
 public:
  /// `damping`: c of each mode [1/s]. `gravity`: its load on each mode. `contact`: nullptr without a seat.
  Oscillators(std::vector<double> omega, std::vector<double> damping, std::vector<double> gravity,
              time::TimeSchemeParameters scheme, const Contact* contact);

  /// State with these displacements and rates and no acceleration.
  ModalState start(std::vector<double> q, std::vector<double> v) const;
  /// Advances `now` over dt to `next`; `load(t, Q)` sets the modal loads at t within the step. Throws
  /// SolveFailure if Newton's method does not converge.
  using LoadAt = std::function<void(double, std::span<double>)>;
  void step(const ModalState& now, double dt, const LoadAt& load, ModalState& next);

  int newton_iterations() const { return iterations_; }  ///< of the last step, maximum over its stages
  /// Load of fluid and prescribed pressures on each mode in the last stage of the last solve.
  std::span<const double> load() const { return load_; }
  std::span<const double> damping() const { return damping_; }
  const Contact::ContactResult& seat() const { return seat_; }  ///< at the end of the last step

 private:
  double known(const time::Levels& levels, const ModalState& at, std::size_t mode) const;
  void advance(const time::Stage& stage, const ModalState& at, ModalState& next);
  void solve_contact(const time::Stage& stage, const ModalState& at);
  void add_energies(const time::Stage& stage, const ModalState& at, ModalState& next);
  void finish(ModalState& state);

  std::vector<double> omega_, damping_, gravity_;
  time::TimeSchemeParameters scheme_;
  const Contact* contact_;
  std::vector<double> load_, diagonal_, rhs_, x_, shown_;
  ModalState work_;
  Contact::ContactResult seat_;
  Eigen::VectorXd residual_, correction_;
  Eigen::MatrixXd jacobian_;
  int iterations_ = 0;
};

}  // namespace couplet::plate
