// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/stability/equilibrium.hpp"

#include <fmt/format.h>

#include "common/diagnostics/finding.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/large_strain/load_path.hpp"
#include "solid_solver/stability/prestress.hpp"

namespace couplet::solid {

void EquilibriumWatch::see(const SolidBody& body, const SolidStepper& stepper, const SolidFields& fields) {
  if (body.is_dynamic() || !body.equilibrium().means().has_tangent || !body.rigid().empty() || is_told_)
    return;
  const SolidState& now = stepper.trial();
  SoftMotion found = body.equilibrium().lowest_stiffness(
      stepper.last_solve().unknowns, now.known,
      [&](std::span<const double> x, std::span<double> y) { body.kernel().apply(x, {}, y); },
      any_start(body));
  const double stiffness = found.stiffness;
  if (LoadPath* path = body.equilibrium().load_path()) return path->set_stiffness(stiffness);
  softest_ = std::move(found);
  const Vec3 load = fields.total_load();
  if (stiffness >= 0) {
    time_ = now.time, stiffness_ = stiffness, load_ = load;
    return;
  }
  is_told_ = true;
  const double part = stiffness_ / (stiffness_ - stiffness);
  const double lost = time_ + part * (now.time - time_);
  const Vec3 then = load_ + part * (load - load_);
  std::string where =
      fmt::format("it was lost near t = {:.4g} s, between {:g} and {:g} s", lost, time_, now.time);
  if (load.norm() > 0)
    where += fmt::format(", at a total load of about {:.4g} N, {:.3g} of that of this step", then.norm(),
                         then.norm() / load.norm());
  diagnostics::finding(
      parallel::comm_rank(body.mesh().comm),
      {.id = "unstable-equilibrium",
       .severity = base::Severity::wrong,
       .number = stiffness,
       .limit = 0,
       .sentence = fmt::format(
           "t = {:g} s: stability of the equilibrium: min stiffness loaded / unloaded = {:.2g} (limit 0): "
           "unstable; {}",
           now.time, stiffness, where),
       .advice =
           "a small lateral load or imperfection leads to the stable equilibrium; 'analysis: buckling' of "
           "the linear body gives load factors and shapes"});
}

void EquilibriumWatch::follow(const SolidBody& body, const SolidFields& fields) {
  const LoadPath* path = body.equilibrium().load_path();
  if (!path || path->limits().size() <= limits_told_) return;
  limits_told_ = path->limits().size();
  const LimitPoint& limit = path->limits().back();
  const double load = fields.total_load().norm();
  std::string force;
  if (load > 0 && path->factor() != 0)
    force = fmt::format(", a total load of about {:.4g} N", load * std::abs(limit.factor / path->factor()));
  diagnostics::finding(
      parallel::comm_rank(body.mesh().comm),
      {.id = "limit-load",
       .severity = base::Severity::note,
       .number = limit.factor,
       .sentence = fmt::format("t = {:g} s: load path: {} of the load factor = {:.5g}{}: limit point passed",
                               limit.time, limit.is_maximum ? "maximum" : "minimum", limit.factor, force)});
}

void EquilibriumWatch::finish(const SolidBody& body, std::vector<std::string>& sentences) const {
  const LoadPath* path = body.equilibrium().load_path();
  if (!path) return;
  std::string found;
  for (const LimitPoint& l : path->limits())
    found += fmt::format("{}{:.5g} ({})", found.empty() ? "" : ", ", l.factor,
                         l.is_maximum ? "maximum" : "minimum");
  sentences.push_back(fmt::format("load path: load factor {:.5g} at the end; limit points: {}.",
                                  path->factor(), found.empty() ? "none" : found));
  if (path->stiffness() > 0) return;  // 0: not surely negative of a slender body
  diagnostics::finding(
      parallel::comm_rank(body.mesh().comm),
      {.id = "unstable-equilibrium",
       .severity = base::Severity::warning,
       .number = path->stiffness(),
       .limit = 0,
       .sentence = fmt::format("stability of the last equilibrium: min stiffness loaded / unloaded = {:.2g} "
                               "(limit 0): unstable, on the load path between limit points",
                               path->stiffness()),
       .advice = "a later 'end-time' follows the path to a stable one"});
}

}  // namespace couplet::solid
