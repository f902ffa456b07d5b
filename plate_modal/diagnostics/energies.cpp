// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/io/checkpoint.hpp"
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
  }
  void look(diagnostics::Report& report) override {
    if (!(largest_ > 0)) return;
    report_present(report, "balance of the energies", mismatch_ / largest_, 0.01,
                   fmt::format("max error of the energy balance (4.29-4.31) / largest energy = {:.2g}",
                               mismatch_ / largest_),
                   "use a smaller step, or 'trapezoidal' with 'contact.rule: conserving'", 0.5);
  }
  void conclude(diagnostics::Report& report) override {
    if (!(largest_ > 0)) return;
    report.sentences.push_back(fmt::format(
        "energy: max error of the balance of the structure (4.29-4.31): {:.2e} J, {:.2g} % of the largest "
        "energy.",
        mismatch_, 100 * mismatch_ / largest_));
  }
  void visit(io::Archive& archive) override { archive.common("energies", mismatch_, largest_); }

 private:
  PlateView view_;
  double mismatch_ = 0, largest_ = 0;  // [J]
};

}  // namespace

diagnostics::Made balance_of_energies(const PlateView& view, const std::shared_ptr<Motion>& motion) {
  return motion ? std::make_shared<BalanceOfEnergies>(view) : nullptr;
}

}  // namespace couplet::plate
