// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

// No mesh follows a wall that far; millimeters instead of meters give a factor of a thousand.
constexpr double farthest = 30;

/// Detects displacements much larger than the interface, probably in another unit.
class DisplacementScale final : public CouplingDiagnostic {
 public:
  explicit DisplacementScale(const CouplingView& view) : view_(view) {
    for (const Side& side : view.pass.sides()) {
      const PointBox box(side.interface.vertices);
      const double extent = parallel::max(view.comm, (box.high - box.low).norm());
      extents_.push_back(find_datum(side.interface.gives, "displacement") ? extent : 0);
    }
  }

  void observe(diagnostics::Report& report) override {
    for (std::size_t s = 0; s < extents_.size(); ++s) {
      if (!(extents_[s] > 0)) continue;
      double most = 0;
      for (const double u : values_of(view_.pass.given()[s], "displacement"))
        most = std::max(most, std::abs(u));
      const double share = parallel::max(view_.comm, most) / extents_[s];
      if (!(share > farthest)) continue;
      const std::string& name = view_.pass.sides()[s].name;
      report.findings.push_back(
          {.id = "displacement-scale",
           .number = share,
           .limit = farthest,
           .sentence = fmt::format("displacement of '{}': {:.3g} times the extent of its interface, {:.3g} m "
                                   "(limit {:g}): implausible",
                                   name, share, extents_[s], farthest),
           .advice = "check the unit of the 'displacement' [m] that this program gives",
           .subject = name});
    }
  }

 private:
  const CouplingView& view_;
  std::vector<double> extents_;  // by side [m]; 0: gives no displacement, or has no extent
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> displacement_scale(const CouplingView& view) {
  return std::make_shared<DisplacementScale>(view);
}

}  // namespace couplet::coupler
