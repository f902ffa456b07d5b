// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "common/io/checkpoint.hpp"
#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Detects cold fluid above hot fluid, which sinks (docs/thermocline.md, inversions). The effect depends on
/// flow and grains, so there is no error estimate.
class Inversions final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void observe(diagnostics::Report&) override {
    if (view_.happened.inversion.depth > worst_.depth) worst_ = view_.happened.inversion;
  }
  void look(diagnostics::Report& report) override {
    const auto [cold, hot] = range_to_come();
    if (view_.parameters().bed.mix_inversions || worst_.depth <= 0.01 || hot <= cold + 1) return;
    const double share = worst_.depth / (hot - cold);
    tell(report,
         {.effect = "mixing of inverted fluid",
          .number = share,
          .limit = 0.05,
          .what = fmt::format("fluid {:.3g} K colder than the fluid below it: {:.2g} of the run's range",
                              worst_.depth, share),
          .advice = "it would sink: set 'bed.mix-inversions: true', or check the signs of the mass flows "
                    "(upward above 0) and the inlet temperatures"});
  }
  void conclude(diagnostics::Report& report) override {
    if (worst_.depth > 0.01)
      report.sentences.push_back(fmt::format(
          "buoyancy: at t = {:.6g} s fluid at z = {:.3f} m was {:.2f} K colder than the fluid below it{}",
          worst_.time, worst_.z, worst_.depth,
          view_.parameters().bed.mix_inversions ? "; such fluid is mixed" : ""));
  }
  void visit(io::Archive& archive) override { archive.common("worst", worst_.depth, worst_.z, worst_.time); }

 private:
  Inversion worst_;
};

}  // namespace

Made inversions(const TankView& view, const Seen& seen) { return std::make_shared<Inversions>(view, seen); }

}  // namespace couplet::thermocline
