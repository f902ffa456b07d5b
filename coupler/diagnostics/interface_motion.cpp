// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/io/checkpoint.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

double dot_over(MPI_Comm comm, const std::vector<double>& a, const std::vector<double>& b) {
  double total = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) total += a[i] * b[i];
  return parallel::sum(comm, total);
}

double norm(MPI_Comm comm, const std::vector<double>& values) {
  return std::sqrt(dot_over(comm, values, values));
}

/// Cure of a motion that the scheme itself makes, where tests show one (tests/stability/coupling); else empty.
const char* cure_of(coupling::Scheme scheme) {
  return scheme == coupling::Scheme::explicit_
             ? " This is the added-mass instability of explicit coupling: the structure is too light for the fluid "
               "moving with it, and smaller steps do not help. `scheme: semi-implicit` iterates the added mass, "
               "`scheme: implicit` the whole fluid."
             : "";
}

/// Detects a growing oscillation of the interface from step to step (see StepOscillation).
class InterfaceOscillation final : public CouplingDiagnostic {
 public:
  explicit InterfaceOscillation(const CouplingView& view)
      : view_(view), swings_(view.comm, view.parameters.convergence.relative) {}
  void observe(diagnostics::Report& report) override {
    const auto reason =
        swings_.accepted(view_.unknown.motion(view_.last.image), view_.dt, view_.scheme.now());
    if (!reason) return;
    if (stops())
      stop_ = *reason;
    else
      report.findings.push_back(
          {.id = "interface-oscillation", .severity = base::Severity::wrong, .sentence = *reason});
  }
  std::optional<app::StepFailure> suspects() const override {
    // Halving does not help a step that already oscillates.
    if (const auto swings = swings_.suspects(view_.scheme.now()); swings && stops())
      return app::StepFailure(*swings, false);
    return {};
  }
  std::string stop() const override { return stop_; }
  void visit(io::Archive& archive) override {
    swings_.visit_numbers(archive);
    std::size_t first = 0;
    for (const Unknown::Part& part : view_.unknown.parts()) {
      if (part.datum.name != "displacement") continue;
      const Side& side = view_.pass.sides()[part.giver];
      const std::string name = "motion-" + std::to_string(first);
      swings_.visit_fields(archive, side.order(view_.comm, part.datum.place), name, first, part.count,
                           std::size_t(part.components));
      first += part.count;
    }
  }

 private:
  /// A case that accepts the finding goes on.
  static bool stops() { return !diagnostics::is_accepted("interface-oscillation"); }

  const CouplingView& view_;
  StepOscillation swings_;
  std::string stop_;
};

/// Compares the work given and taken at the interface (see WorkBalance).
class InterfaceWork final : public CouplingDiagnostic {
 public:
  explicit InterfaceWork(const CouplingView& view) : view_(view) {}
  void observe(diagnostics::Report&) override {
    double given = 0, taken = 0;
    if (view_.record.balances().empty()) return;
    for (const SideBalance& side : view_.record.balances()) (side.gives ? given : taken) += side.balance.work;
    balance_.energy(energy_of_structures());
    balance_.accepted(given, taken);
  }
  void conclude(diagnostics::Report& report) override {
    const WorkBalance::WorkResult v = balance_.result(
        view_.parameters.mapping.type == MappingParameters::Type::nearest, !view_.pass.schedule().iterates);
    if (v.text.empty()) return;
    if (v.sound)
      report.sentences.push_back(v.text);
    else
      report.findings.push_back({.id = "interface-work",
                                 .severity = v.useless ? base::Severity::wrong : base::Severity::warning,
                                 .number = v.part,
                                 .limit = WorkBalance::sound_part,
                                 .sentence = v.text});
  }
  void visit(io::Archive& archive) override { archive.common("work", balance_); }

 private:
  /// Energy in the accepted state of all participants that take forces [J]; NaN if one does not report it.
  double energy_of_structures() const {
    double total = 0;
    for (std::size_t i = 0; i < view_.pass.sides().size(); ++i) {
      const auto& takes = view_.pass.sides()[i].interface.takes;
      if (std::ranges::find(takes, "N", &coupling::Interface::Datum::unit) != takes.end())
        total += view_.pass.partners()[i].report.energy;
    }
    return total;
  }

  const CouplingView& view_;
  WorkBalance balance_;
};

}  // namespace

std::string StepOscillation::message(double growth, coupling::Scheme scheme) const {
  return fmt::format(
      "interface oscillation: with a period of two steps ({:.3g} s) the amplitude grew {:.3g}-fold in {} steps, to {:.2g} of "
      "the largest motion, although every step was solved: unstable.{}",
      2 * dt_, growth, turns_, share(), cure_of(scheme));
}

double StepOscillation::pair(std::size_t i) const { return sizes_[i] + sizes_[i + 1]; }

// Each jump is four amplitudes over the step.
double StepOscillation::share() const { return largest_.share(0.125 * pair(sizes_.size() - 2) * dt_, 0); }

bool StepOscillation::counts() const {
  return share() > std::max(tolerance_, floor) && pair(sizes_.size() - 2) > 1.5 * before_.value();
}

std::optional<std::string> StepOscillation::accepted(const std::vector<double>& x, double dt,
                                                     coupling::Scheme scheme) {
  std::vector<double> velocity(x.size()), jump;
  if (levels_ >= 1)
    for (std::size_t i = 0; i < x.size(); ++i) velocity[i] = (x[i] - x_[i]) / dt;
  if (levels_ >= 2) {
    jump = velocity;
    for (std::size_t i = 0; i < x.size(); ++i) jump[i] -= velocity_[i];
  }
  const double size = norm(comm_, jump), old_size = norm(comm_, jump_);
  speed_.push_back(norm(comm_, velocity));
  // What led to a step that was halved is no measure of later oscillations.
  if (dt < (1 - 1e-9) * dt_) largest_.forget(), before_.forget();
  largest_.add(norm(comm_, x), dt);
  if (speed_.size() > 4) speed_.pop_front();
  // The motion reverses: most of its shape equals the last one with opposite sign.
  const bool turned = levels_ >= 3 && dot_over(comm_, jump, jump_) < -0.3 * size * old_size;
  double before = 0;
  if (turned) {
    if (turns_ == 0) sizes_.assign(1, old_size);
    ++turns_;
    sizes_.push_back(size);
  } else {
    for (std::size_t i = 0; i + 1 < sizes_.size(); ++i) before = std::max(before, pair(i));
    turns_ = 0;
    sizes_.clear();
  }
  before_.add(before, dt);
  levels_ = std::min(levels_ + 1, 3);
  dt_ = dt;
  x_ = x;
  velocity_ = std::move(velocity);
  jump_ = std::move(jump);
  if (turns_ < 2 * periods || !counts()) return {};
  // Pairs of adjacent values, because the growth may be uneven.
  const std::size_t last = sizes_.size() - 2;
  const double then = pair(0), middle = pair(last / 2), now = pair(last);
  if (!(now > 3 * then) || now < *std::ranges::max_element(speed_)) return {};
  // Two frequencies that beat, and a load that rises, grow less and less. A rise like n^k has 1.33, 1.16, 1.10 here.
  if (middle * middle > 1.1 * then * now) return {};
  return message(now / then, scheme);
}

std::optional<std::string> StepOscillation::suspects(coupling::Scheme scheme) const {
  if (turns_ < 2 || !counts()) return {};
  const double factor = sizes_.back() / sizes_.front();
  if (factor < 3 || 2 * sizes_.back() < *std::ranges::max_element(speed_)) return {};
  return message(factor, scheme);
}

void StepOscillation::visit_numbers(io::Archive& archive) {
  archive.common("swings", turns_, levels_, sizes_, speed_, largest_, before_, dt_);
}

void StepOscillation::visit_fields(io::Archive& archive, const parallel::GlobalOrder& order,
                                   const std::string& name, std::size_t first, std::size_t count,
                                   std::size_t width) {
  int k = 0;
  for (std::vector<double>* values : {&x_, &velocity_, &jump_}) {
    const bool known = levels_ > k++;
    std::vector<double> part;
    if (known && !archive.reads())
      part.assign(values->begin() + std::ptrdiff_t(first), values->begin() + std::ptrdiff_t(first + count));
    archive.field(order, name + "-" + std::to_string(k), part, width);
    if (!archive.reads()) continue;
    values->resize(first);
    values->insert(values->end(), part.begin(), part.end());
  }
}

void WorkBalance::accepted(double fluid, double structure) {
  fluid_ += fluid;
  structure_ += structure;
  exchanged_ += std::max(std::abs(fluid), std::abs(structure));
  stored_ = std::max(stored_, std::abs(structure_));
  ++steps_;
}

WorkBalance::WorkResult WorkBalance::result(bool by_nearest, bool lagging) const {
  if (steps_ == 0 || exchanged_ == 0) return {};
  const double apart = std::abs(fluid_ - structure_), net = std::min(std::abs(fluid_), std::abs(structure_)),
               energy = energy_ > 0 ? energy_ : stored_, against = std::max(net, energy);
  WorkResult v;
  // Only noise has been exchanged if the difference is at round-off.
  v.part = apart <= 1e-12 * exchanged_ ? 0 : apart / std::max(against, 1e-12 * exchanged_);
  v.sound = v.part < sound_part;
  v.useless = !lagging && apart / exchanged_ >= useless_part && steps_ >= judged_steps;
  v.text = fmt::format(
      "energy at the interface: in {} steps the fluid gave {:.6g} J and the structure took {:.6g} J, which differ by {:.2g} % of the {}: {}",
      steps_, fluid_, structure_, 100 * v.part, net >= energy ? "net work" : "structure's largest energy",
      v.sound ? "balanced."
      : lagging
          ? "NOT BALANCED: in explicit coupling load and motion belong to different times, and loads alternate from step to "
            "step; 'scheme: semi-implicit' avoids this."
      : by_nearest
          ? "NOT BALANCED: the steps are not converged, or `mapping.type: nearest` transfers motion and load by maps that are "
            "not transposes of each other; tighten `convergence`, or use `projection`, which conserves the work on any meshes."
          : "NOT BALANCED: the wall seen by the fluid moved differently from the structure; use smaller steps "
            "or an iterating scheme.");
  return v;
}

std::shared_ptr<CouplingDiagnostic> interface_oscillation(const CouplingView& view) {
  return std::make_shared<InterfaceOscillation>(view);
}

std::shared_ptr<CouplingDiagnostic> interface_work(const CouplingView& view) {
  return view.record.mechanics().knows_work() ? std::make_shared<InterfaceWork>(view) : nullptr;
}

}  // namespace couplet::coupler
