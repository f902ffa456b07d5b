// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Participants solve to about 1e-8 of their values: less than that would be a ratio of their noise.
double ratio(const std::vector<Residual>& first, const std::vector<Residual>& second) {
  std::vector<double> scales;
  for (const Residual& r : first) scales.push_back(r.scale());
  const double ratio = largest(second, scales) / largest(first, scales);
  return worst(first).relative > 1e-6 && std::isfinite(ratio) ? ratio : unknown;
}

/// Explicit coupling neglects the response of the load. Two additional passes in some steps measure which
/// share of a change in motion returns through the load, |H(H(x)) - H(x)| / |H(x) - x|. With pure added mass
/// it is added mass over structural mass (Causin, Gerbeau and Nobile 2005).
///
/// One pass per step is stable while the guess for the load is. A guess with velocity v^n returns r = added
/// mass / mass of the last change, lambda = -r; one with 2 v^n - v^{n-1} (predictor of order 2) gives
/// lambda^2 + r (2 lambda - 1) = 0, which reaches -1 at r = 1/3. The error goes with r: the limit is half.
class AddedMass final : public CouplingDiagnostic {
 public:
  explicit AddedMass(const CouplingView& view)
      : view_(view), limit_(predictor_order_of(view.parameters) >= 2 ? 1. / 3 : 1) {}
  void returned(GlobalIndex step, const Iterate& x, const Iterate& image, const Iterate& again) override {
    const double r = ratio(view_.unknown.measure(x, image), view_.unknown.measure(image, again));
    // At a start the ratio is that of an impulse: it may explain a failure, but is no evidence about the run.
    double& seen = step == 1 ? at_start_ : returned_;
    seen = std::fmax(seen, r);
  }
  void observe(diagnostics::Report& report) override {
    if (std::isnan(returned_)) return;
    if (auto finding = diagnostics::finding_of(
            {.effect = "iteration of pressure and structure",
             .number = returned_,
             .limit = limit_ / 2,
             .what = fmt::format("added-mass ratio: {:.3g} of a change of the motion returns through the "
                                 "load in the next pass; one pass per step diverges from {:.2g}",
                                 returned_, limit_),
             .advice = "iterate the added mass: 'scheme: semi-implicit'",
             .share = std::min(returned_, 1.)}))  // what the load of this step leaves to the next
      report.findings.push_back(std::move(*finding));
  }
  void look(diagnostics::Report& report) override {
    const double r = std::isnan(returned_) ? at_start_ : returned_;
    if (!std::isnan(r)) report.position.push_back({"added mass over mass", r, limit_, "coupling-mass"});
  }
  std::optional<app::StepFailure> suspects() const override {
    const double r = std::fmax(at_start_, returned_);
    if (!(r > limit_)) return {};
    return app::StepFailure(
        fmt::format(
            "the added-mass instability of explicit coupling: {:.3g} of a change of the motion returns "
            "through the load in the next pass, and one pass per step diverges from {:.2g}, whatever "
            "the step. Use `scheme: semi-implicit`, which iterates the added mass.",
            r, limit_),
        false);
  }
  void visit(io::Archive& archive) override { archive.common("returned", returned_, at_start_); }

 private:
  const CouplingView& view_;
  double limit_;  // share of a change that one pass a step bears to have returned
  double returned_ = unknown, at_start_ = unknown;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> added_mass(const CouplingView& view) {
  return view.parameters.scheme == coupling::Scheme::explicit_ ? std::make_shared<AddedMass>(view) : nullptr;
}

}  // namespace couplet::coupler
