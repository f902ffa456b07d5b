// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "solid_solver/boundary/checks.hpp"
#include "solid_solver/diagnostics/buckling_estimate.hpp"
#include "solid_solver/diagnostics/neglected.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {
namespace {

/// Reports what small strain neglects: by the largest gradient, by the distance from buckling, and where it may matter by an
/// expansion beyond the linear solution.
class LinearTheory final : public diagnostics::Diagnostic {
 public:
  explicit LinearTheory(const SolidView& view) : view_(view) {}

  void observe(diagnostics::Report& report) override {
    expand();
    if (!view_.body.is_dynamic()) see_buckling(report);
  }

  void look(diagnostics::Report& report) override {
    Deformation now = view_.fields.deformation(view_.fields.point_displacement());
    largest_gradient_ = now.gradient = std::max(largest_gradient_, now.gradient);
    const bool is_low = buckling_factor_ < BucklingEstimate::low;
    add(report, neglected_geometry(view_.body.parameters(), now, large_strain_,
                                   is_low ? buckling_factor_ : std::numeric_limits<double>::quiet_NaN()));
  }

  void conclude(diagnostics::Report& report) override {
    if (view_.body.is_dynamic()) see_buckling(report);
    const auto factor = view_.output.buckling_factor();
    if (factor && !view_.body.parameters().seeks_buckling)
      add(report, buckling_finding({.factor = *factor}, ""));
  }

  void visit(io::Archive& archive) override {
    archive.common("linear", largest_gradient_, large_strain_, gradient_seen_, buckling_factor_,
                   compression_seen_);
  }

 private:
  /// The largest change of the run. Heat, a seat, rigid patches, rings and orthotropic bodies are outside the expansion.
  void expand() {
    const SolidBody& body = view_.body;
    const SolidParameters& p = body.parameters();
    SolutionMethod* method = view_.stepper.method();
    if (body.is_dynamic() || !method || !body.kernel().is_symmetric() || is_axisymmetric(body.elastic()) ||
        has_orthotropic(p) || p.expansion || p.contact || !body.rigid().empty() || p.seeks_buckling)
      return;
    try {
      const auto found = estimate_large_strain(body, *method, view_.stepper.last_solve().unknowns,
                                               view_.now().known, gradient_seen_);
      if (found && (!large_strain_ || !found->is_known() || found->change > large_strain_->change))
        large_strain_ = found;
    } catch (const SolveFailure& failure) {
      log::warn("The estimate of large strain failed: {}", failure.what());
    }
  }

  void see_buckling(diagnostics::Report& report) {
    const SolidBody& body = view_.body;
    SolutionMethod* method = view_.stepper.method();
    if (!method || !body.kernel().is_symmetric() || is_axisymmetric(body.elastic()) ||
        body.parameters().output.buckling > 0 || body.parameters().output.modes > 0)
      return;
    for (const FreeMotion& free : free_motions(body.mesh(), body.elastic()))
      if (!free.modes.empty())
        return report.sentences.push_back(
            fmt::format("nothing holds the solid: {}; a body that can move freely has no buckling load.",
                        base::join(free.modes)));
    const BucklingEstimate found =
        estimate_buckling(body, view_.fields, view_.now(), *method, compression_seen_);
    if (!found.matters()) return;
    buckling_factor_ = std::min(buckling_factor_, found.factor);
    add(report, body.is_dynamic() ? dynamic_buckling_finding(found) : buckling_finding(found, "at most "));
  }

  SolidView view_;
  double largest_gradient_ = 0;
  std::optional<LargeStrainEstimate> large_strain_;  // empty if it cannot matter
  double gradient_seen_ = 0;                         // at the last look at large strain
  double buckling_factor_ = BucklingEstimate::low;   // lowest of the run
  double compression_seen_ = 0;                      // at the last look at buckling [Pa]
};

}  // namespace

diagnostics::Made linear_theory(const SolidView& view) {
  if (has_finite_strain(view.body.parameters())) return nullptr;
  return std::make_shared<LinearTheory>(view);
}

}  // namespace couplet::solid
