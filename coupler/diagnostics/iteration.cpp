// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/io/checkpoint.hpp"
#include "common/time/step_errors.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

// |1 - omega (1 + r)| = factor for the heaviest mode
std::string too_much_added_mass(double factor, int passes, double omega) {
  const double r = (factor + 1) / omega - 1;
  return fmt::format(
      "the coupling diverges: the residual grew {:.3g}-fold per iteration over {}. With constant relaxation "
      "{:g} this implies an added mass of about {:.3g} times the structure's; only relaxations below {:.3g} "
      "converge, at any step. Use `acceleration.type: aitken` or `iqn-ils`, which adapt it.",
      factor, passes == 1 ? "one iteration" : fmt::format("{} iterations", passes), omega, r, 2 / (1 + r));
}

/// Stops a diverging iteration within a few passes (see ResidualGrowth).
class IterationGrowth final : public CouplingDiagnostic {
 public:
  explicit IterationGrowth(const CouplingView& view) : view_(view) {}
  void begin_step() override { growth_.start_step(), scales_.clear(); }
  void passed(const std::vector<Residual>& residuals, double omega) override {
    scales_.resize(residuals.size(), 0);
    for (std::size_t i = 0; i < scales_.size(); ++i)
      if (scales_[i] == 0 && residuals[i].scale() > 0)
        scales_[i] = residuals[i].scale(), growth_.start_step();
    if (!has_converged(residuals, view_.parameters.convergence))
      growth_.pass(largest(residuals, scales_), omega, view_.parameters.acceleration.type);
  }
  std::optional<app::StepFailure> suspects() const override {
    const double omega = view_.parameters.acceleration.initial_relaxation;
    if (const auto grew = growth_.suspects(is_constant() ? omega : 0, predictor_order_of(view_.parameters)))
      return app::StepFailure(*grew, !is_constant());
    return {};
  }

 private:
  bool is_constant() const {
    return view_.parameters.acceleration.type == AccelerationParameters::Type::constant;
  }

  const CouplingView& view_;
  ResidualGrowth growth_;
  std::vector<double> scales_;  // of the data, as they first were in the step
};

// Part of the value above which a residual leaves the coupled problem of a step unsolved.
constexpr double useless_residual = 0.5;

/// Reports steps accepted without convergence (`at-max-iterations: accept`).
class UnconvergedStep final : public CouplingDiagnostic {
 public:
  explicit UnconvergedStep(const CouplingView& view) : view_(view) {}
  void observe(diagnostics::Report& report) override {
    const FixedPointResult& last = view_.last;
    if (last.converged) return;
    const ConvergenceParameters& wanted = view_.parameters.convergence;
    const double residual = last.residual.relative, part = last.residual.absolute / last.residual.size;
    report.findings.push_back(
        {.id = "unconverged-step",
         .severity = part < useless_residual ? base::Severity::warning : base::Severity::wrong,
         .number = residual,
         .limit = wanted.relative,
         .sentence = fmt::format("coupling: relative residual = {:.2e} (limit {:.1e}) after {} iterations: "
                                 "the step is accepted unconverged",
                                 residual, wanted.relative, last.iterations),
         .advice = "raise `convergence.max-iterations`, or remove `at-max-iterations: accept`"});
  }

 private:
  const CouplingView& view_;
};

// Contraction above which the residual only shows that the error is large.
constexpr double slowest = 0.99;
// Contraction assumed if one pass was enough.
constexpr double unseen = 0.5;
// Acceleration by residuals over that of the interface: worth a note, and a warning.
constexpr double most_noise = 0.01, loud_noise = 0.1;

/// Error of the unknown that the iteration between participants leaves below its tolerance. If the residual
/// of a step fell by the factor c in its last pass, |x - x*| <= c / (1 - c) |H(x) - x|. StepErrors sums it
/// over the steps. Each datum is judged separately, and the largest share counts.
class CouplingError final : public CouplingDiagnostic {
 public:
  explicit CouplingError(const CouplingView& view) : view_(view) {}
  void begin_step() override { residuals_.clear(), before_.clear(); }
  void passed(const std::vector<Residual>& residuals, double) override {
    before_ = std::exchange(residuals_, residuals);
  }
  void observe(diagnostics::Report&) override {
    const Iterate &before = view_.history.now, &now = view_.last.image;
    if (before.unknown.size() != now.unknown.size()) return;
    const std::vector<Residual> change = view_.unknown.measure(before, now);
    errors_.resize(change.size());
    see_noise();
    for (std::size_t i = 0; i < std::min(errors_.size(), residuals_.size()); ++i) {
      const Residual& last = residuals_[i];
      if (!(last.absolute > 0)) continue;
      const bool seen = !before_.empty() && before_[i].absolute > 0;
      const double c = seen ? std::min(last.absolute / before_[i].absolute, slowest) : unseen;
      errors_[i].add({.error = c / (1 - c) * last.absolute,
                      .rate = change[i].absolute / view_.dt,
                      .size = last.size,
                      .dt = view_.dt});
    }
  }
  void conclude(diagnostics::Report& report) override {
    for (const time::StepErrors& errors : errors_)
      report.errors.coupling = std::fmax(report.errors.coupling, errors.over_size());
    const double share = noise_[1] > 0 ? std::sqrt(noise_[0] / noise_[1]) : 0;
    if (!(share > most_noise)) return;
    // The part of the position decides instead where it is larger than that of the motion.
    const ConvergenceParameters& limits = view_.parameters.convergence;
    const bool by_motion = noise_[2] > std::pow(limits.least_change(), 2) * noise_[3];
    const double relative = (by_motion ? 1 : limits.least_change()) * limits.relative * most_noise / share;
    const std::string sentence = fmt::format(
        "coupling: the residuals correspond to {:.2g} of the interface acceleration (limit {}), so loads due to added mass "
        "contain noise of that relative size",
        share, most_noise);
    const std::string advice =
        fmt::format("use 'coupling.convergence.relative: {:.0e}', or a longer step", relative);
    if (share < loud_noise) report.sentences.push_back(sentence + "; " + advice);
    report.findings.push_back(
        {.id = "noise-of-the-coupling",
         .severity = share < loud_noise ? base::Severity::note : base::Severity::warning,
         .number = share,
         .limit = most_noise,
         .sentence = sentence,
         .advice = advice});
  }
  void visit(io::Archive& archive) override { archive.common("steps", errors_, noise_); }

 private:
  /// A residual r at the end of a step is an error 4 r/dt^2 of the acceleration.
  void see_noise() {
    const CouplingHistory& known = view_.history;
    if (residuals_.empty() || !(known.old_dt > 0) || known.old.unknown.size() != known.now.unknown.size())
      return;
    const double before = known.old_dt, dt = view_.dt;
    const auto old = view_.unknown.motion(known.old), now = view_.unknown.motion(known.now),
               x = view_.unknown.motion(view_.last.x), image = view_.unknown.motion(view_.last.image);
    std::array<double, 4> squares{};
    for (std::size_t i = 0; i < now.size(); ++i) {
      squares[0] += std::pow(4 * (image[i] - x[i]) / (dt * dt), 2);
      squares[1] += std::pow(2 * ((image[i] - now[i]) / dt - (now[i] - old[i]) / before) / (dt + before), 2);
      squares[2] += std::pow(image[i] - now[i], 2), squares[3] += image[i] * image[i];
    }
    sum_over(view_.comm, squares);
    for (std::size_t k = 0; k < squares.size(); ++k) noise_[k] += squares[k];
  }

  const CouplingView& view_;
  std::vector<Residual> residuals_, before_;  // of the last two passes of the step under way
  std::vector<time::StepErrors> errors_;      // of each datum
  // Sums of squares over the steps: acceleration of displacements by residuals, and of the motion; motion; position.
  std::array<double, 4> noise_{};
};

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
             .what = fmt::format("added mass / mass of the structure = {:.3g}; explicit coupling diverges "
                                 "from {:.2g}, with any time step",
                                 returned_, limit_),
             .advice = "iterate the added mass: 'scheme: semi-implicit'",
             .left_out = false,
             .wrong_from = 1,                     // a pass returns more than it was given
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
            "the added-mass instability of explicit coupling: the added mass is {:.3g} times the mass of the "
            "structure, and one iteration per step diverges from {:.2g}, with any time step. Use `scheme: "
            "semi-implicit`, which iterates the added mass.",
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

void ResidualGrowth::pass(double residual, double omega, AccelerationParameters::Type type) {
  ++passes_;
  if (passes_ == 1) first_ = residual;
  if (passes_ > 1 && residual > last_) {
    if (growing_ == 0) at_turn_ = last_;
    ++growing_;
  } else {
    growing_ = 0;
  }
  last_ = residual;
  if (!grows()) return;
  const bool ran_away = residual > too_far * first_;
  if (growing_ < patience && !ran_away) return;
  using Type = AccelerationParameters::Type;
  if (type == Type::constant) throw SchemeFailure(too_much_added_mass(factor(), growing_, omega));
  throw SolveFailure(
      "the coupling diverges: the residual grew {:.3g}-fold per iteration over {} iterations, {:.3g}-fold in the last one; {}.",
      factor(), growing_, omega,
      type == Type::aitken ? "`acceleration.type: iqn-ils` handles several modes at once"
                           : "the participants' own tolerances may be too loose for quasi-Newton");
}

bool ResidualGrowth::grows() const { return growing_ > 0 && last_ > 2 * at_turn_; }

double ResidualGrowth::factor() const { return std::pow(last_ / at_turn_, 1. / growing_); }

std::optional<std::string> ResidualGrowth::suspects(double relaxation, int predictor) const {
  if (!grows()) return {};
  if (relaxation > 0) return too_much_added_mass(factor(), growing_, relaxation);
  return fmt::format(
      "the coupling diverges: the residual grew {:.3g}-fold per iteration before a participant failed. Use a lower "
      "`acceleration.initial-relaxation`{}.",
      factor(), predictor > 0 ? ", or `predictor.order: 0` for the first steps" : "");
}

std::shared_ptr<CouplingDiagnostic> iteration_growth(const CouplingView& view) {
  return view.pass.schedule().iterates ? std::make_shared<IterationGrowth>(view) : nullptr;
}

std::shared_ptr<CouplingDiagnostic> unconverged_step(const CouplingView& view) {
  return view.pass.schedule().iterates ? std::make_shared<UnconvergedStep>(view) : nullptr;
}

std::shared_ptr<CouplingDiagnostic> coupling_error(const CouplingView& view) {
  return view.pass.schedule().iterates ? std::make_shared<CouplingError>(view) : nullptr;
}

std::shared_ptr<CouplingDiagnostic> added_mass(const CouplingView& view) {
  return view.parameters.scheme == coupling::Scheme::explicit_ ? std::make_shared<AddedMass>(view) : nullptr;
}

}  // namespace couplet::coupler
