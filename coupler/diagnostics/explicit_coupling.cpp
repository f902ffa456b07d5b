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

namespace {

// Participants solve to about 1e-8 of their values; a response below this part of the velocity is noise.
constexpr double noise = 1e-6;

/// Bounds the error of explicit coupling in the motion. The load of a step uses a predicted velocity w, then
/// the structure moves with v. A share c of d = v - w returns through the load in the same step. If errors of
/// steps do not cancel, the velocity error is c sum |d|. The displacement error is this over the frequency,
/// w^2 = sum dt v.v / sum dt u.u, or times the duration if smaller. Pure added mass has a much smaller error,
/// because it cancels between steps.
class ExplicitLag final : public CouplingDiagnostic {
 public:
  explicit ExplicitLag(const CouplingView& view) : view_(view) {}
  void returned(GlobalIndex step, const Iterate& x, const Iterate& image, const Iterate& again) override {
    if (step == 1) return;         // of an impulse
    std::array<double, 3> sums{};  // (again - image).d, d.d, v.v
    for (std::size_t i = 0; i < image.rider.size(); ++i) {
      const double v = image.rider[i], d = v - x.rider[i];
      sums[0] += (again.rider[i] - v) * d;
      sums[1] += d * d;
      sums[2] += v * v;
    }
    sum_over(view_.comm, sums);
    if (!(sums[1] > noise * noise * sums[2])) return;
    answer_ = std::max(answer_, std::abs(sums[0] / sums[1]));
    is_known_ = true;
  }
  void observe(diagnostics::Report&) override {
    const Iterate &x = view_.last.x, &image = view_.last.image;
    if (x.rider.size() != image.rider.size() || view_.history.now.rider.empty()) return;
    std::array<double, 3> sums{};  // u.u, v.v, d.d
    for (std::size_t i = 0; i < image.rider.size(); ++i) {
      const double v = image.rider[i], u = image.unknown[i], d = v - x.rider[i];
      sums[0] += u * u;
      sums[1] += v * v;
      sums[2] += d * d;
    }
    sum_over(view_.comm, sums);
    jumps_ += std::sqrt(sums[2]);
    time_ += view_.dt;
    displacement_ += view_.dt * sums[0];
    velocity_ += view_.dt * sums[1];
    size_ = std::max(size_, std::sqrt(sums[0]));
  }
  void conclude(diagnostics::Report& report) override {
    if (!is_known_ || !(size_ > 0) || !(velocity_ > 0))
      report.sentences.push_back(
          "the error of explicit coupling is unknown (no step was examined; the first is the fourth).");
    else
      report.sentences.push_back(fmt::format(
          "the error of explicit coupling is at most about {:.2g} of the motion, not included in other "
          "estimates; a run with an iterating 'scheme' would show.",
          answer_ * jumps_ * std::min(std::sqrt(displacement_ / velocity_), time_) / size_));
  }
  void visit(io::Archive& archive) override {
    archive.common("sums", answer_, jumps_, time_, displacement_, velocity_, size_, is_known_);
  }

 private:
  const CouplingView& view_;
  double answer_ = 0;                       // largest |c| of all looks
  double jumps_ = 0, time_ = 0;             // sum of |d|; duration [s]
  double displacement_ = 0, velocity_ = 0;  // integrals over time of their squares
  double size_ = 0;                         // largest displacement
  bool is_known_ = false;
};

/// Replaces ExplicitLag if an unknown is not purely a motion.
class UnknownLag final : public CouplingDiagnostic {
 public:
  void conclude(diagnostics::Report& report) override {
    report.sentences.push_back(
        "the error of explicit coupling is unknown (it is estimated only for motions, without sub-steps and "
        "closed fluids).");
  }
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> explicit_lag(const CouplingView& view) {
  const Schedule& schedule = view.pass.schedule();
  if (schedule.iterates) return nullptr;
  const auto parts = view.unknown.parts();
  // Sub-steps use linear input in time; the level of closed fluids responds by itself.
  const bool possible = schedule.sub_steps.empty() && !view.pass.has_closed_fluid() && !parts.empty() &&
                        std::ranges::all_of(parts, [](const auto& p) { return p.rides || p.velocity; });
  if (!possible) return std::make_shared<UnknownLag>();
  return std::make_shared<ExplicitLag>(view);
}

}  // namespace couplet::coupler
