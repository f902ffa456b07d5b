// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "common/base/error.hpp"
#include "common/diagnostics/results.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "common/time/step_errors.hpp"
#include "solid_solver/analysis/displacement_error.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"
#include "solid_solver/equilibrium/finite_strain.hpp"

namespace couplet::solid {
namespace {

constexpr double unknown = diagnostics::ErrorParts::unknown;
// Displacement over the largest so far with which what the mesh misses is looked at again.
constexpr double grown = 1.2;
// Swings of a motion from which errors of its phase, which nothing estimates, exceed those of its shape.
constexpr double most_swings = 2;
// Sensitivity to the stiffness from which the energies that a mesh misses say little: those of the soft motion are a small part.
constexpr double soft = 3;

double product(MPI_Comm comm, std::span<const double> a, std::span<const double> b) {
  return parallel::sum(comm, std::inner_product(a.begin(), a.end(), b.begin(), 0.0));
}

/// Relative error that the results state beside the frequencies; NaN if none were sought. Collective.
double stated_error_of_modes(MPI_Comm comm) {
  double error = -1;
  for (const diagnostics::Result& result : diagnostics::results())
    if (result.name.starts_with("free vibrations")) error = result.error;
  error = parallel::max(comm, error);
  return error < 0 ? unknown : error;
}

/// Estimates the error of the displacement:
///   mesh    static: displacement_error(), the root mean square over the body. In motion and beside a seat: strain energy of the
///           difference between face strains and recovered ones, also at large strain. At least the variation within quadrilaterals,
///           which neither shows. Unknown with another gradient than the symmetric one, after some swings of a motion, and near the
///           loss of stability, where small errors grow.
///   step    sum of the local errors, see VelocityErrors. None if static; unknown where a transient temperature strains the body.
///   linear  static: work of the equilibrium residual over that of the loads, the error of the compliance;
///           dynamic: relative residuals of all steps, see StepErrors
class ErrorEstimate final : public diagnostics::Diagnostic {
 public:
  ErrorEstimate(const SolidView& view, std::shared_ptr<StrainEnergy> strain)
      : view_(view), body_(view.body), strain_(std::move(strain)), steps_(scheme_of(body_.parameters())) {}
  void observe(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;

 private:
  double left_by_solver() const;
  double missed_work() const;
  double missed_now() const;
  bool gives_way() const;
  double mesh_error() const;
  void find_displacement_error();

  SolidView view_;
  const SolidBody& body_;
  std::shared_ptr<StrainEnergy> strain_;  // nullptr at large strain
  time::VelocityErrors steps_;
  time::StepErrors linear_;
  double largest_ = 0, missed_ = unknown;  // displacement of a motion [m], and the error of its mesh then
  std::optional<double> displacement_;     // relative error of a static displacement
};

/// Residual of the last solve relative to its rows.
double ErrorEstimate::left_by_solver() const {
  const LastSolve& last = view_.stepper.last_solve();
  const double residual = view_.stepper.effort().residual;
  if (body_.large_strain()) return residual;
  const double rows = norm(view_.comm(), last.rhs);
  return rows > 0 ? residual / rows : 0;
}

/// |u . (b - A u)| / |u . b| of the last linear static solve: relative error of u . b, which is twice the strain
/// energy; over the scale of that if larger.
double ErrorEstimate::missed_work() const {
  const LastSolve& last = view_.stepper.last_solve();
  if (!last.is_known(view_.comm())) return 0;
  std::vector<double> missed(last.unknowns.size());
  body_.kernel().apply(last.unknowns, {}, missed);
  for (std::size_t i = 0; i < missed.size(); ++i) missed[i] = last.rhs[i] - missed[i];
  const double work = product(view_.comm(), last.unknowns, last.rhs);
  const double scale = std::max(std::abs(work), 2 * strain_->now(true).scale);
  return scale > 0 ? std::abs(product(view_.comm(), last.unknowns, missed)) / scale : 0;
}

/// Relative error of the strain energy now; NaN of a body without strain.
double ErrorEstimate::missed_now() const {
  if (!strain_) return missed_at_large_strain(view_);
  const StrainAudit& audit = strain_->now(true);
  return audit.scale > 0 ? audit.missed_by_mesh : unknown;
}

/// True if a static body at large strain answers to its stiffness far more than in proportion, or not at all.
bool ErrorEstimate::gives_way() const {
  FiniteStrain* equilibrium = body_.finite_strain();
  if (body_.is_dynamic() || !equilibrium || body_.seat()) return false;
  try {
    return !(equilibrium->softness(view_.unknowns(), view_.now().known) < soft);
  } catch (const SolveFailure&) {
    return true;
  }
}

double ErrorEstimate::mesh_error() const {
  if (!body_.kernel().is_symmetric()) return unknown;
  if (gives_way()) return unknown;
  if (displacement_)
    return std::max(*displacement_, strain_->now(true).inner_variation);  // NaN without a displacement
  if (body_.parameters().expansion) return unknown;  // energies are no measure if heat strains the body
  if (!body_.is_dynamic()) return missed_now();
  return steps_.swings() > most_swings ? unknown : missed_;
}

/// While the solver is still available.
void ErrorEstimate::find_displacement_error() {
  SolutionMethod* method = view_.stepper.method();
  if (!strain_ || !method || !body_.kernel().is_symmetric() || body_.seat()) return;
  try {
    displacement_ = displacement_error(body_, view_.now(), view_.fields.loads_now(), *method);
    // Cells that do not carry a cubic, as in a single row, make it larger than the displacement itself.
    if (*displacement_ > 1) displacement_ = unknown;
  } catch (const SolveFailure&) {
    displacement_.reset();
  }
}

void ErrorEstimate::observe(diagnostics::Report&) {
  if (!body_.is_dynamic() && view_.stepper.step().is_last) find_displacement_error();
  if (!body_.is_dynamic()) return;
  const mesh::Mesh& mesh = body_.mesh();
  const std::size_t n = std::size_t(mesh.cells.n_owned()) * mesh.dim;
  const auto norm = [&](std::span<const double> cells) {
    return root_mean_square(mesh, body_.geometry(), mesh.dim, cells);
  };
  const SolidState &now = view_.now(), &before = view_.before();
  const time::StepErrors::Inputs step =
      steps_.add(std::span(before.cell_v).first(n), std::span(now.cell_v).first(n), now.dt, before.dt,
                 norm(now.cell_u), norm);
  linear_.add({.error = left_by_solver() * step.size, .rate = step.rate, .size = step.size, .dt = step.dt});
  // As a body swings through its rest position, only the short waves that its mesh resolves worst have energy.
  if (!(step.size > grown * largest_)) return;
  const double missed = missed_now();
  if (std::isfinite(missed)) largest_ = step.size, missed_ = missed;
}

void ErrorEstimate::conclude(diagnostics::Report& report) {
  diagnostics::ErrorParts& parts = report.errors;
  parts.dimension = body_.mesh().dim;
  if (view_.now().steps == 0) return;
  parts.field = "displacement", parts.unit = "m";
  parts.size = std::max(
      steps_.size(), root_mean_square(body_.mesh(), body_.geometry(), body_.mesh().dim, view_.now().cell_u));
  if (!body_.is_dynamic() && !view_.stepper.step().is_last)
    find_displacement_error();  // a partner's load may be the last
  const Heat* heat = body_.temperature() ? body_.temperature()->heat() : nullptr;
  const bool is_heated = heat && !heat->is_steady() && body_.parameters().expansion;
  if (body_.is_dynamic() && !is_heated) parts.step = steps_.over_size();
  parts.misses_step = std::isnan(parts.step) && (body_.is_dynamic() || is_heated);
  parts.linear = body_.is_dynamic() ? linear_.over_size() : strain_ ? missed_work() : left_by_solver();
  // Nothing estimates the error of load factors, the answer of a search for them.
  parts.mesh = body_.parameters().seeks_buckling ? unknown : mesh_error();
  // The frequencies are the answer of a body at rest whose modes were sought. Their error is bounded only.
  if (const double error = stated_error_of_modes(view_.comm()); parts.misses_step && !std::isnan(error))
    parts = {.mesh = error, .field = "frequencies", .dimension = parts.dimension};
}

void ErrorEstimate::visit(io::Archive& archive) {
  std::vector<double> numbers = steps_.numbers(), before(steps_.before().begin(), steps_.before().end());
  archive.common("error", linear_, largest_, missed_, numbers);
  archive.field(mesh::Entries::owned_cells, "velocity-before", before, std::size_t(body_.mesh().dim));
  if (archive.reads()) steps_.restore(numbers, before);
}

}  // namespace

diagnostics::Made solid_error(const SolidView& view, std::shared_ptr<StrainEnergy> strain) {
  return std::make_shared<ErrorEstimate>(view, std::move(strain));
}

}  // namespace couplet::solid
