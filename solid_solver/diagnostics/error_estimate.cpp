// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "common/base/error.hpp"
#include "common/diagnostics/results.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "common/time/step_errors.hpp"
#include "solid_solver/body/recovered_strain.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/diagnostics/heat_errors.hpp"
#include "solid_solver/diagnostics/stability.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"
#include "solid_solver/output/displacement_error.hpp"

namespace couplet::solid {
namespace {

constexpr double grown =
    1.5;  // strain energy over the largest so far with which what the mesh misses of it is looked at again

double product(MPI_Comm comm, std::span<const double> a, std::span<const double> b) {
  return parallel::sum(comm, std::inner_product(a.begin(), a.end(), b.begin(), 0.0));
}

/// Relative error that the results state beside the frequencies; NaN if none were sought. Collective.
double stated_error_of_modes(MPI_Comm comm) {
  double error = -1;
  for (const diagnostics::Result& result : diagnostics::results())
    if (result.name.starts_with("free vibrations")) error = result.error;
  error = parallel::max(comm, error);
  return error < 0 ? diagnostics::ErrorParts::unknown : error;
}

/// Strains of all flux faces: Green's strain of u, and its change by x.
struct FaceStrains {
  std::vector<Tensor3> of_u, of_x;
};

FaceStrains strains_by(const elastic::ElasticKernel& kernel, Index faces, std::span<const double> unknowns,
                       std::span<const double> known, std::span<const double> x) {
  FaceStrains found{std::vector<Tensor3>(std::size_t(faces)), std::vector<Tensor3>(std::size_t(faces))};
  std::vector<Tensor3>& gradient = found.of_x;
  kernel.face_gradients(
      unknowns, known, [&](Index f, const Tensor3& h) { gradient[std::size_t(f)] = h; }, 0, faces);
  const std::vector<double> at_rest(known.size(), 0);
  kernel.face_gradients(
      x, at_rest,
      [&](Index f, const Tensor3& change) {
        const Tensor3 h = gradient[std::size_t(f)];
        const Tensor3 turned = change + h.transpose() * change;
        found.of_u[std::size_t(f)] = 0.5 * (h + h.transpose() + h.transpose() * h);
        found.of_x[std::size_t(f)] = 0.5 * (turned + turned.transpose());
      },
      0, faces);
  return found;
}

double size_of(const std::vector<Tensor3>& strains) {
  double size = 0;
  for (const Tensor3& e : strains) size += e.squaredNorm();
  return std::sqrt(size);
}

/// Product of the variations of the face strains, from two squares.
double by_inner_variation(const SolidBody& body, const FaceStrains& s) {
  const mesh::Mesh& mesh = body.mesh();
  if (!InnerVariation::is_needed(mesh, body.elastic())) return 0;
  const double of_u = parallel::max(mesh.comm, size_of(s.of_u)),
               of_x = parallel::max(mesh.comm, size_of(s.of_x));
  if (!(of_u > 0) || !(of_x > 0)) return 0;
  const double factor = of_u / of_x;
  InnerVariation sum(mesh, body.elastic()), difference(mesh, body.elastic());
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Tensor3 x = factor * s.of_x[std::size_t(f)];
    sum.add(f, s.of_u[std::size_t(f)] + x);
    difference.add(f, s.of_u[std::size_t(f)] - x);
  }
  return (sum.energy() - difference.energy()) / (4 * factor);
}

/// Half the product of the differences, because each gradient has an error.
double by_gradients(const SolidBody& body, const FaceStrains& s, const FaceStrains& other) {
  const mesh::Mesh& mesh = body.mesh();
  double product = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const auto [here, there] = elastic::pyramids(mesh, body.geometry(), f);
    const auto i = std::size_t(f);
    product += (here + there) * body.elastic().lame(mesh.owner[f]).mu *
               (other.of_u[i] - s.of_u[i]).cwiseProduct(other.of_x[i] - s.of_x[i]).sum();
  }
  return parallel::sum(mesh.comm, product);
}

/// Relative error of a static large-strain displacement along its softest motion x. A mesh that is too stiff
/// by dK leaves a = x . dK u / x . K x of x in u, with the tangent K. Near the loss of stability this far
/// exceeds the share of strain energy. dK is the difference of two gradients, or of face strains and their
/// mean (InnerVariation), in Green's strain of u and of x about it. 0 if no stable motion is known.
/// `unknowns`, `known`: unknowns and known values of u. Collective.
double soft_mesh_error(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known,
                       const SoftMotion& softest) {
  const std::vector<double>& x = softest.shape;
  const mesh::Mesh& mesh = body.mesh();
  if (!parallel::any(mesh.comm, !x.empty()) || !(softest.stiffness > 0)) return 0;
  const FaceStrains used = strains_by(body.kernel(), mesh.n_flux_faces(), unknowns, known, x);
  const FaceStrains other =
      strains_by(elastic::ElasticKernel(mesh, body.elastic(), elastic::FaceGradientScheme::corrected),
                 mesh.n_flux_faces(), unknowns, known, x);
  const double missed =
      std::max(std::abs(by_inner_variation(body, used)), std::abs(by_gradients(body, used, other)));
  std::vector<double> force(x.size());
  body.kernel().apply(x, {}, force);
  std::array<double, 3> sums{};  // x . K x of the body at rest; squares of x and u over the cells
  for (std::size_t i = 0; i < x.size(); ++i) sums[0] += x[i] * force[i];
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (auto i = std::size_t(c) * mesh.dim; i < std::size_t(c + 1) * mesh.dim; ++i) {
      sums[1] += body.geometry().volume[c] * x[i] * x[i];
      sums[2] += body.geometry().volume[c] * unknowns[i] * unknowns[i];
    }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  if (!(sums[0] > 0) || !(sums[2] > 0)) return 0;
  return missed / (softest.stiffness * sums[0]) * std::sqrt(sums[1] / sums[2]);
}

/// Phase error of a motion by a wrong stiffness. A mesh with a relative stiffness error e oscillates faster
/// by e/2, so after an angle w t the displacement is wrong by e w t/2 of its amplitude, at most twice the
/// amplitude. Quasi-static responses do not drift: the ratio of mean kinetic to mean strain energy is 1 for
/// free vibrations and 0 for those.
struct PhaseDrift {
  double way = 0, size = 0;        // integral of |v|, largest |u| [m]
  double kinetic = 0, strain = 0;  // integrals of the energies of the whole body [J s]
  double largest = 0, missed = 0;  // strain energy [J], and the relative error of the mesh in it
  /// Relative error of the displacement for a relative error `stiffness` of the strain energy.
  double over_size(double stiffness) const {
    if (!(size > 0) || !(strain > 0)) return 0;
    // The mean |v| of an oscillation is 2/pi of its amplitude w A.
    const double angle = 0.5 * std::numbers::pi * way / size;
    return std::min(2.0, 0.5 * stiffness * angle * std::min(1.0, kinetic / strain));
  }
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(way, size, kinetic, strain, largest, missed);
  }
};

/// Estimates the error of the displacement:
///   mesh    static: displacement_error(), the rms over the body. In motion, and where that is not available: difference of stress
///           work and strain energy, equal in equilibrium; if larger, that of recovered and face strains (symmetric gradient:
///           its work has no error), or the squared relative difference of two gradients' strains; see
///           StrainAudit::missed_by_mesh(). Motion adds PhaseDrift.
///   step    sum of the local errors, see VelocityErrors; none if static
///   linear  static: work of the equilibrium residual over that of the loads, the error of the compliance;
///           dynamic: relative residuals of all steps, see StepErrors
/// With thermal strain the mesh part of a motion is unknown. Computed temperatures
/// add their error, relative to the distance from the reference, times the thermal share of strain energy. At
/// finite strain the mesh part is half the squared difference of two gradients' Green strains, times the
/// sensitivity of the deformed body to its stiffness (static runs: one solve with the tangent), or if larger
/// the effect on the softest motion, see soft_mesh_error().
class ErrorEstimate final : public diagnostics::Diagnostic {
 public:
  ErrorEstimate(const SolidView& view, std::shared_ptr<StrainEnergy> strain,
                std::shared_ptr<Stability> stability)
      : view_(view),
        body_(view.body),
        strain_(std::move(strain)),
        stability_(std::move(stability)),
        steps_(scheme_of(body_.parameters())) {
    if (heat() && body_.parameters().expansion)
      heat_.emplace(body_.mesh(), body_.geometry(), *body_.parameters().heat);
  }
  void observe(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;

 private:
  const Heat* heat() const { return body_.thermal() ? body_.thermal()->heat() : nullptr; }
  void see_swing(const time::StepErrors::Seen& step);
  double left_by_solver() const;
  double missed_work() const;
  void add_heat(diagnostics::ErrorParts& parts) const;
  double missed_of_large_strain() const;
  double finite_mesh_error() const;
  double missed_now() const;
  double linear_mesh_error() const;
  void find_displacement_error();

  SolidView view_;
  const SolidBody& body_;
  std::shared_ptr<StrainEnergy> strain_;  // nullptr at large strain
  std::shared_ptr<Stability> stability_;  // nullptr but in a static run at large strain
  time::VelocityErrors steps_;
  time::StepErrors linear_;
  PhaseDrift drift_;
  std::optional<double> displacement_;  // relative error of a static displacement
  std::optional<HeatErrors> heat_;      // of temperatures that are solved for and strain the body
};

/// Residual of the last solve relative to its rows.
double ErrorEstimate::left_by_solver() const {
  const LastSolve& last = view_.stepper.last_solve();
  return body_.equilibrium().share_left(view_.stepper.effort().residual, norm(view_.comm(), last.rhs));
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

/// Adds the effect of a temperature error: the thermal displacement changes in proportion, by its share |u .
/// b_T| / u . K u of the whole.
void ErrorEstimate::add_heat(diagnostics::ErrorParts& parts) const {
  if (!heat_) return;
  const diagnostics::ErrorParts load =
      heat_->parts(*heat(), body_.parameters().expansion->reference_temperature);
  if (!load.known()) return;
  const std::vector<double> u = view_.unknowns();
  std::vector<double> force(u.size()), forces(u.size(), 0.0);
  body_.kernel().apply(u, {}, force);
  body_.thermal()->add_loads(view_.now().time, body_.kernel(), forces);
  const double energy = product(view_.comm(), u, force), work = product(view_.comm(), u, forces);
  const double share = energy > 0 ? std::min(1.0, std::abs(work) / energy) : 1;
  if (!std::isnan(parts.mesh)) parts.mesh = std::fmax(parts.mesh, share * load.mesh);
  parts.step = std::fmax(parts.step, share * load.step);  // a number beats NaN
}

/// Relative strain energy error of the mesh: half of sum V mu |E1 - E2|^2 / sum V mu |E1|^2 with Green
/// strains E = (H + H^T + H^T H)/2 of this gradient and the corrected one, which are invariant to rotations.
/// Half, because each gradient has an error. If larger, the error of quadrilaterals, with the law's moduli at
/// rest.
double ErrorEstimate::missed_of_large_strain() const {
  const StrainGap gap = strain_gap(body_, view_.unknowns(), view_.known(), [](const Tensor3& h) {
    return Tensor3(0.5 * (h + h.transpose() + h.transpose() * h));
  });
  return std::max(0.5 * gap.missed, gap.variation);
}

/// The displacement changes with the sensitivity of the deformed body. NaN if its tangent has no solution.
double ErrorEstimate::finite_mesh_error() const {
  const double energy = missed_of_large_strain();
  if (!stability_) return energy;
  try {
    const std::vector<double> unknowns = view_.unknowns();
    return std::max(energy * body_.equilibrium().softness(unknowns, view_.now().known),
                    soft_mesh_error(body_, unknowns, view_.known(), stability_->softest()));
  } catch (const SolveFailure&) {
    return diagnostics::ErrorParts::unknown;
  }
}

/// Relative error of the strain energy now; NaN of a body without strain.
double ErrorEstimate::missed_now() const {
  const StrainAudit& audit = strain_->now(true);
  if (!(audit.scale > 0)) return diagnostics::ErrorParts::unknown;
  return std::max(audit.mismatch(), audit.missed_by_mesh(body_.mesh().dim));
}

/// Static: at least the variation within quadrilaterals, which no reconstruction shows. Energies alone are no measure if heat strains
/// the body.
double ErrorEstimate::linear_mesh_error() const {
  if (displacement_)
    return std::max(*displacement_, strain_->now(true).inner_variation);  // NaN without a displacement
  if (body_.parameters().expansion) return diagnostics::ErrorParts::unknown;
  if (!body_.is_dynamic()) return missed_now();
  return drift_.largest > 0 ? drift_.missed + drift_.over_size(drift_.missed)
                            : diagnostics::ErrorParts::unknown;
}

/// While the solver is still available. Without it the estimate is that of the strain energy.
void ErrorEstimate::find_displacement_error() {
  SolutionMethod* method = view_.stepper.method();
  if (!strain_ || !method || !body_.kernel().is_symmetric() || body_.seat()) return;
  try {
    displacement_ = displacement_error(body_, view_.now(), view_.fields.loads_now(), *method);
    // Cells that do not carry a cubic, as in a single row, make it larger than the displacement itself.
    if (*displacement_ > 1) displacement_ = diagnostics::ErrorParts::unknown;
  } catch (const SolveFailure&) {
    displacement_.reset();
  }
}

void ErrorEstimate::observe(diagnostics::Report&) {
  if (heat_) heat_->see_step(heat()->trial(), heat()->accepted());
  if (!body_.is_dynamic() && view_.stepper.step().is_last) find_displacement_error();
  if (!body_.is_dynamic()) return;
  const mesh::Mesh& mesh = body_.mesh();
  const std::size_t n = std::size_t(mesh.cells.n_owned()) * mesh.dim;
  const auto norm = [&](std::span<const double> cells) {
    return root_mean_square(mesh, body_.geometry(), mesh.dim, cells);
  };
  const SolidState &now = view_.now(), &before = view_.before();
  const time::StepErrors::Seen step =
      steps_.add(std::span(before.cell_v).first(n), std::span(now.cell_v).first(n), now.dt, before.dt,
                 norm(now.cell_u), norm);
  linear_.add({.error = left_by_solver() * step.size, .rate = step.rate, .size = step.size, .dt = step.dt});
  if (strain_) see_swing(step);
}

/// Half of u . K u is the strain energy, approximately also for gradients without an energy. What the mesh misses of it is looked at
/// where it is large: as a body swings through its rest position, only the short waves that its mesh resolves worst have energy.
void ErrorEstimate::see_swing(const time::StepErrors::Seen& step) {
  const SolidState& now = view_.now();
  const std::vector<double> u = view_.unknowns();
  std::vector<double> force(u.size());
  body_.kernel().apply(u, now.known, force);
  const double strain = 0.5 * std::abs(product(view_.comm(), u, force)),
               kinetic = parallel::sum(view_.comm(), view_.stepper.ledger().kinetic(now));
  if (!std::isfinite(step.rate + step.size + kinetic + strain)) return;
  drift_.way += now.dt * step.rate;
  drift_.size = std::max(drift_.size, step.size);
  drift_.kinetic += now.dt * kinetic;
  drift_.strain += now.dt * strain;
  if (!(strain > grown * drift_.largest)) return;
  const double missed = missed_now();
  if (std::isfinite(missed)) drift_.largest = strain, drift_.missed = missed;
}

void ErrorEstimate::conclude(diagnostics::Report& report) {
  diagnostics::ErrorParts& parts = report.errors;
  parts.dimension = body_.mesh().dim;
  if (view_.now().steps == 0) return;
  if (!body_.is_dynamic() && !view_.stepper.step().is_last)
    find_displacement_error();  // a partner's load may be the last
  if (body_.is_dynamic()) {
    parts.step = steps_.over_size();
    parts.too_few_steps = std::isnan(parts.step);
    parts.linear = linear_.over_size();
  } else {
    parts.linear = strain_ ? missed_work() : left_by_solver();
  }
  parts.mesh = strain_ ? linear_mesh_error() : finite_mesh_error();
  // Nothing estimates the error of load factors, the answer of a search for them. That of frequencies is bounded only.
  if (body_.parameters().seeks_buckling) parts.mesh = std::numeric_limits<double>::quiet_NaN();
  if (strain_) add_heat(parts);
  // The frequencies are the answer of a body at rest whose modes were sought.
  if (const double error = stated_error_of_modes(view_.comm()); parts.too_few_steps && !std::isnan(error))
    parts = {.mesh = error, .dimension = parts.dimension};
}

void ErrorEstimate::visit(io::Archive& archive) {
  std::vector<double> numbers = steps_.numbers(), before(steps_.before().begin(), steps_.before().end());
  archive.common("error", linear_, drift_, numbers);
  archive.field(mesh::Entries::owned_cells, "velocity-before", before, std::size_t(body_.mesh().dim));
  if (archive.reads()) steps_.restore(numbers, before);
  if (heat_) heat_->visit(archive);
}

}  // namespace

diagnostics::Made solid_error(const SolidView& view, std::shared_ptr<StrainEnergy> strain,
                              std::shared_ptr<Stability> stability) {
  return std::make_shared<ErrorEstimate>(view, std::move(strain), std::move(stability));
}

}  // namespace couplet::solid
