// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/io/checkpoint.hpp"
#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {
namespace {

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
        fmt::format("an impact on the seat lasts {:.2g} s (pi sqrt(m / kappa)), one step is {:.2g} of that",
                    duration_, share_),
        fmt::format("the rebound is not resolved: use 'simulation.time-step: {:.2g} s', or a softer seat",
                    duration_ / 20));
    report.position.push_back({"step over the duration of an impact", share_, limit, "plate-contact"});
  }
  void conclude(diagnostics::Report& report) override {
    if (has_met_) return;
    const Contact::Place nearest = view_.contact->deepest(view_.state.q);
    if (nearest.depth > 0) return;
    report.sentences.push_back(fmt::format(
        "contact: the structure never touched the seat; final minimum gap {:.3g} m, at ({:.4g}, {:.4g}, "
        "{:.4g}).",
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

diagnostics::Made impact_on_seat(const PlateView& view, const std::shared_ptr<Motion>&) {
  return view.contact ? std::make_shared<ImpactOnSeat>(view) : nullptr;
}

}  // namespace couplet::plate
