// SPDX-License-Identifier: Apache-2.0
// Checks of the energies, the error of the time step and the impacts on a seat.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "common/io/checkpoint.hpp"
#include "common/time/step_errors.hpp"
#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {
namespace {

/// Error of the energy balance, thesis (4.29)-(4.31), relative to the largest energy or work of the loads.
class BalanceOfEnergies final : public diagnostics::Diagnostic {
 public:
  explicit BalanceOfEnergies(const PlateView& view) : view_(view) {}
  void observe(diagnostics::Report&) override {
    const Energies& e = view_.state.energies;
    mismatch_ = std::max(mismatch_, std::abs(e.mismatch()));
    largest_ = std::max({largest_, e.kinetic + e.strain + e.contact, std::abs(e.load_work)});
    moved_ = std::max(moved_, e.kinetic + e.strain);
    for (std::size_t m = 0; m < view_.state.v.size(); ++m)
      turns_ += view_.surface.omega()[m] * view_.state.v[m] * view_.state.v[m] * view_.state.dt;
  }
  void look(diagnostics::Report& report) override {
    if (!(largest_ > 0)) return;
    report_present(report, "balance of the energies", mismatch_ / largest_, 0.01,
                   fmt::format("max error of the energy balance (4.29-4.31) / largest energy = {:.2g}",
                               mismatch_ / largest_),
                   "use a smaller step, or 'trapezoidal' with 'contact.rule: conserving'", 0.5,
                   "energy-growth");
    if (view_.parameters.damping || !view_.fluid_force.empty()) return;
    const double share = 1 - std::exp(-usual_damping * turns_ / moved_);
    report_neglected(report, "damping", share,
                     fmt::format("{:g} % of critical damping would reduce the motion by {:.2g} %",
                                 100 * usual_damping, 100 * share),
                     "", unknown, diagnostics::no_verdict);
  }
  void visit(io::Archive& archive) override {
    archive.common("energies", mismatch_, largest_, moved_, turns_);
  }

 private:
  PlateView view_;
  static constexpr double usual_damping = 0.02;
  double mismatch_ = 0, largest_ = 0, moved_ = 0;  // [J]; moved_: without the seat
  double turns_ = 0;  // integral over time of the angular frequency times twice the kinetic energy [J]
};

double norm_of(std::span<const double> amplitudes) {
  return std::sqrt(std::inner_product(amplitudes.begin(), amplitudes.end(), amplitudes.begin(), 0.0));
}

/// Error of all steps so far, for modes of unit mass.
class StepError final : public diagnostics::Diagnostic {
 public:
  explicit StepError(const PlateView& view) : view_(view), errors_(view.parameters.time_scheme) {}
  void observe(diagnostics::Report&) override {
    const ModalState &before = view_.before, &now = view_.state;
    errors_.add(before.v, now.v, now.dt, before.dt, norm_of(now.q), norm_of, rate_of_decay());
  }
  void conclude(diagnostics::Report& report) override { report.errors.step = errors_.over_size(); }
  void visit(io::Archive& archive) override {
    std::vector<double> state = errors_.state();
    archive.common("errors", state);
    if (archive.reads()) errors_.restore(state);
  }

 private:
  /// Decay rate of the present motion by damping [1/s].
  double rate_of_decay() const {
    const std::span<const double> c = view_.oscillators.damping();
    const std::vector<double>&omega = view_.surface.omega(), &v = view_.state.v;
    double lost = 0, all = 0;
    for (std::size_t m = 0; m < c.size(); ++m) {
      // Above critical damping, the slower of two rates.
      lost += v[m] * v[m] * (c[m] <= 2 * omega[m] ? 0.5 * c[m] : omega[m] * omega[m] / c[m]);
      all += v[m] * v[m];
    }
    return all > 0 ? lost / all : 0;
  }

  PlateView view_;
  time::VelocityErrors errors_;
};

/// Minimum share of the energy for an impact to be counted, because a structure resting on its seat vibrates.
constexpr double least_work = 0.02;

/// Shortest impact on the seat in steps, and whether there was contact. The error of the impact time is a
/// third of a step, and that of the speed after it a corresponding share. Twenty steps per contact give 1 %
/// (docs/plate.md).
class ImpactOnSeat final : public diagnostics::Diagnostic {
 public:
  explicit ImpactOnSeat(const PlateView& view) : view_(view) {}
  void observe(diagnostics::Report&) override {
    const ModalState &before = view_.before, &now = view_.state;
    const Energies& e = now.energies;
    has_met_ = has_met_ || e.impact_work != 0;
    energy_ = std::max({energy_, e.kinetic + e.strain + e.contact, std::abs(e.load_work)});
    const double work = e.impact_work - before.energies.impact_work;
    if (work != 0) {
      const double stiffness =
          view_.contact->stiffness_of_impact(before.q, now.q, view_.oscillators.seat().force);
      const double duration = std::numbers::pi / std::sqrt(stiffness);
      if (stiffness > 0 && std::abs(work) > least_work * energy_ && view_.step.dt / duration > share_)
        share_ = view_.step.dt / duration, duration_ = duration;
    }
  }
  void look(diagnostics::Report& report) override {
    if (!(share_ > 0)) return;
    constexpr double limit = 0.1;
    report_present(
        report, "step that resolves the contact", share_, limit,
        fmt::format(
            "an impact on the seat lasts {:.2g} s (pi sqrt(m / kappa)), and one step is {:.2g} times this duration",
            duration_, share_),
        fmt::format("the rebound is not resolved: use 'simulation.time-step: {:.2g} s', or a softer seat",
                    duration_ / 20));
    report.position.push_back({"step over the duration of an impact", share_, limit, "plate-contact"});
  }
  void conclude(diagnostics::Report& report) override {
    if (has_met_) return;
    const Contact::DeepestPoint nearest = view_.contact->deepest(view_.state.q);
    if (nearest.depth > 0) return;
    report.sentences.push_back(fmt::format(
        "contact: the structure never touched the seat; final minimum gap {:.3g} m, at ({:.4g}, {:.4g}, {:.4g}).",
        -nearest.depth, nearest.centre.x(), nearest.centre.y(), nearest.centre.z()));
  }
  void visit(io::Archive& archive) override {
    archive.common("impacts", has_met_, share_, duration_, energy_);
  }

 private:
  PlateView view_;
  bool has_met_ = false;
  double share_ = 0, duration_ = 0;  // longest step over the duration of an impact; that duration [s]
  double energy_ = 0;                // largest so far, or work of the loads [J]
};

}  // namespace

diagnostics::Made balance_of_energies(const RunOfPlate& run) {
  return run.motion ? std::make_shared<BalanceOfEnergies>(run.view) : nullptr;
}

diagnostics::Made step_error(const RunOfPlate& run) {
  return run.motion ? std::make_shared<StepError>(run.view) : nullptr;
}

diagnostics::Made impact_on_seat(const RunOfPlate& run) {
  return run.view.contact ? std::make_shared<ImpactOnSeat>(run.view) : nullptr;
}

}  // namespace couplet::plate
