// SPDX-License-Identifier: Apache-2.0
// Checks of a rigid body: balance of its energies, error of the time step and impacts on its stops.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/io/checkpoint.hpp"
#include "common/time/step_errors.hpp"
#include "plate_modal/body/rigid_body.hpp"

namespace couplet::plate {
namespace {

/// Error of the energy balance relative to the largest energy or work of the loads.
class BodyBalance final : public diagnostics::Diagnostic {
 public:
  explicit BodyBalance(const RigidBody& body) : body_(body) {}
  void observe(diagnostics::Report&) override {
    const Energies& e = body_.state().energies;
    mismatch_ = std::max(mismatch_, std::abs(e.mismatch()));
    largest_ = std::max({largest_, e.kinetic + e.strain + e.contact, std::abs(e.load_work)});
  }
  void look(diagnostics::Report& report) override {
    if (!(largest_ > 0)) return;
    const double share = mismatch_ / largest_;
    if (auto finding = diagnostics::finding_of(
            {.effect = "balance of the energies",
             .id = "energy-growth",
             .number = share,
             .limit = 0.01,
             .what = fmt::format("max error of the energy balance / largest energy = {:.2g}", share),
             .advice = "use a smaller 'simulation.time-step'",
             .left_out = false,
             .wrong_from = 0.5}))
      report.findings.push_back(std::move(*finding));
  }
  void visit(io::Archive& archive) override { archive.common("energies", mismatch_, largest_); }

 private:
  const RigidBody& body_;
  double mismatch_ = 0, largest_ = 0;  // [J]
};

double weighted_norm(std::span<const double> v) {
  return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
}

/// Error of all steps so far, for velocities that are weighted by the square root of their inertia. At least that of the angle turned:
/// the Cayley transform turns by 2 atan(omega dt/2), which is short of omega dt by the share (omega dt)^2/12.
class BodyStepError final : public diagnostics::Diagnostic {
 public:
  explicit BodyStepError(const RigidBody& body) : body_(body), errors_(time::TimeSchemeParameters{}) {}
  void observe(diagnostics::Report&) override {
    const BodyMotion& motion = body_.motion();
    const BodyState &before = body_.before(), &now = body_.state();
    const Vec3 arm = body_.body().center_of_mass - body_.body().reference();
    double size = body_.body().mass * motion.displacement(now, arm).squaredNorm();
    size += motion.n_free() > 0 ? now.turned.squaredNorm() * motion.inertia(motion.n_free() - 1) : 0;
    errors_.add(motion.weighted_velocity(before), motion.weighted_velocity(now), now.dt, before.dt,
                std::sqrt(size), weighted_norm);
    const double angle = now.spin.norm() * now.dt;
    turned_ += angle;
    missed_ += angle - 2 * std::atan(angle / 2);
  }
  void conclude(diagnostics::Report& report) override {
    report.errors.step = errors_.over_size();
    if (turned_ > 0) report.errors.step = std::fmax(report.errors.step, missed_ / turned_);
    report.errors.mesh = 0;  // a rigid body has none
  }
  void visit(io::Archive& archive) override {
    std::vector<double> state = errors_.state();
    archive.common("errors", state, turned_, missed_);
    if (archive.reads()) errors_.restore(state);
  }

 private:
  const RigidBody& body_;
  time::VelocityErrors errors_;
  double turned_ = 0, missed_ = 0;  // angle, and its part that the steps miss [rad]
};

/// Step over the shortest impact, once the body has met a stop.
class ImpactOnStop final : public diagnostics::Diagnostic {
 public:
  explicit ImpactOnStop(const RigidBody& body) : body_(body) {}
  void observe(diagnostics::Report&) override {
    if (body_.state().energies.contact > 0)
      share_ = std::max(share_, body_.state().dt / body_.motion().shortest_impact());
  }
  void look(diagnostics::Report& report) override {
    if (!(share_ > 0)) return;
    constexpr double limit = 0.1;
    const double impact = body_.motion().shortest_impact();
    if (auto finding = diagnostics::finding_of(
            {.effect = "step that resolves the contact",
             .number = share_,
             .limit = limit,
             .what = fmt::format(
                 "an impact on a stop lasts {:.2g} s (pi sqrt(m / k)), one step is {:.2g} of that", impact,
                 share_),
             .advice = fmt::format(
                 "the rebound is not resolved: use 'simulation.time-step: {:.2g} s', or a softer stop",
                 impact / 20),
             .left_out = false}))
      report.findings.push_back(std::move(*finding));
    report.position.push_back({"step over the duration of an impact", share_, limit, "plate-contact"});
  }
  void conclude(diagnostics::Report& report) override {
    if (!(share_ > 0)) report.sentences.emplace_back("stops: the body never touched a stop.");
  }
  void visit(io::Archive& archive) override { archive.common("impacts", share_); }

 private:
  const RigidBody& body_;
  double share_ = 0;
};

diagnostics::Made balance(const RigidBody& body) { return std::make_shared<BodyBalance>(body); }
diagnostics::Made step_error_of(const RigidBody& body) { return std::make_shared<BodyStepError>(body); }
diagnostics::Made impacts(const RigidBody& body) {
  return body.body().stops ? std::make_shared<ImpactOnStop>(body) : nullptr;
}

using BodyRow = diagnostics::TableRow<RigidBody>;
constexpr std::array body_table{BodyRow{"balance-of-energies", diagnostics::When::always, balance},
                                BodyRow{"impact-on-stop", diagnostics::When::always, impacts},
                                BodyRow{"step-error", diagnostics::When::with_errors, step_error_of}};

}  // namespace

void add_diagnostics(const RigidBody& body, diagnostics::Diagnostics& all) {
  all.add(std::span<const BodyRow>(body_table), body);
}

}  // namespace couplet::plate
