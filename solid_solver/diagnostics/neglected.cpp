// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/diagnostics/neglected.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "common/csv/csv_reader.hpp"
#include "common/diagnostics/atmosphere.hpp"
#include "common/diagnostics/reference.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"
#include "solid_solver/diagnostics/view.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {
namespace {

using P = SolidParameters;

bool deforms(const P& p) { return p.analysis != P::Analysis::thermal; }

/// True if the volume strain of cells replaces that of faces, which avoids locking near incompressibility.
bool has_volume_strain_of_cells(const P& p) {
  return face_gradient_scheme(p) == elastic::FaceGradientScheme::symmetric &&
         volume_strain_of(p) != elastic::VolumeStrain::faces;
}

bool has_interface(const P& p) {
  return std::ranges::any_of(p.boundaries, [](const auto& one) { return is_interface(one.second); });
}

/// Largest constant expansion coefficient in the case [1/K].
std::optional<double> largest_expansion(const P& p) {
  std::optional<double> largest;
  for (const SolidMaterial& m : materials_of(p))
    if (m.heat.expansion)
      if (const auto given = csv::number_of(m.heat.expansion->text))
        largest = std::max(largest.value_or(0), std::abs(*given));
  return largest;
}

/// Relative change of a displacement: 0.4 times the squared tip rotation of a cantilever (elastica; the norm
/// of the gradient is sqrt(2) times the rotation), about the strain of a bar, and 1/(f - 1) for lateral
/// motion under 1/f of the buckling load.
double share_of_geometry(const Deformation& d, const std::optional<LargeStrainEstimate>& large_strain,
                         double buckling_factor) {
  const double strain = std::isnan(d.strain) ? 0 : d.strain;
  const double share = 0.2 * d.gradient * d.gradient + 0.8 * strain;
  if (large_strain) return large_strain->is_known() ? large_strain->change : std::max(1., share);
  if (std::isnan(buckling_factor)) return share;
  constexpr double all = 10;  // of a load beyond the buckling load nothing is left
  return std::max(share, buckling_factor > 1 ? std::min(1., 1 / (buckling_factor - 1)) : all);
}

}  // namespace

// The static response to a load of angular frequency w has a relative error r/(1 - r), r = inertia/load = (w/w_1)^2, if
// that is small, and is useless otherwise: a sudden load moves a body twice as far.
Opinion neglected_inertia(const P& p, double inertia_over_load) {
  // Static steps at large strain are load steps, so t is not a time.
  if (p.analysis != P::Analysis::static_ || has_finite_strain(p)) return {};
  return diagnostics::finding_of(
      {.effect = "inertia",
       .number = inertia_over_load,
       .what = fmt::format("inertia / load = {:.2g}", inertia_over_load),
       .advice = "use 'analysis: dynamic'",
       .share = inertia_over_load < 0.5 ? inertia_over_load / (1 - inertia_over_load) : 1});
}

// A damping ratio z takes the power 2 z w times twice the kinetic energy: a free vibration loses 1 - exp(-z w t) of its amplitude,
// a load at resonance as much of its growth. A fluid damps a coupled body.
Opinion neglected_damping(const P& p, double turns) {
  constexpr double usual = 0.02;  // welded steel has 0.005, wood and joints 0.05
  if (p.damping || has_interface(p)) return {};
  const double share = 1 - std::exp(-usual * turns);
  return diagnostics::finding_of(
      {.effect = "damping",
       .number = share,
       .limit = diagnostics::no_verdict,
       .what = fmt::format("{:g} % of critical damping would reduce the motion by {:.2g} %", 100 * usual,
                           100 * share)});
}

// In slow motion, the kinetic energy is (w/w_1)^2 of the strain energy.
Opinion spare_inertia(double kinetic_over_strain, double steps) {
  if (!(steps > 1) || kinetic_over_strain > 1e-3) return {};
  return diagnostics::finding_of(
      {.effect = "inertia",
       .number = kinetic_over_strain,
       .limit = 1e-3,
       .what = fmt::format(
           "max kinetic / largest strain energy = {:.2g}; 'analysis: static' computes the final state in one step",
           kinetic_over_strain),
       .left_out = false,
       .is_spare = true,
       .saves = 1 - 1 / steps});
}

// In linear theory the stretch of a fiber that rotates by phi without strain has the error phi^2/2. For a
// gradient of 0.02 that is a fiftieth of the strain itself.
Opinion neglected_geometry(const P& p, const Deformation& d,
                           const std::optional<LargeStrainEstimate>& large_strain, bool is_bounded,
                           double buckling_factor) {
  if (!deforms(p) || has_finite_strain(p)) return {};
  const std::string parts = std::isnan(d.strain)
                                ? ""
                                : fmt::format(" (at the end: strain {:.2g}, rotation {:.2g} degrees)",
                                              d.strain, 57.29578 * d.rotation);
  const double share = share_of_geometry(d, large_strain, buckling_factor);
  const bool is_estimated = large_strain || !std::isnan(buckling_factor);
  // The share by the gradient is a lower bound: a clamped sheet stretches long before its gradient is large.
  const bool is_known = is_estimated || is_bounded || share >= diagnostics::share_limit();
  return diagnostics::finding_of(
      {.effect = "geometric non-linearity",
       .number = d.gradient,
       .limit = 0.02,
       .what = fmt::format("max |grad u| = {:.2g}{}{}", d.gradient, parts,
                           large_strain   ? "; " + large_strain->text()
                           : is_estimated ? "; the buckling shape would grow"
                                          : ""),
       .advice = d.gradient > 1 ? "check the units of 'youngs-modulus', of the loads and of the mesh"
                 : !std::isnan(buckling_factor)
                     ? "lateral motion grows as the load nears the buckling load: use "
                       "'kinematics: finite-strain'"
                 : large_strain ? "use 'kinematics: finite-strain'"
                 : d.gradient < 0.1
                     ? "expect errors of a few percent"
                     : "linear theory does not describe the real body here: use 'kinematics: finite-strain'",
       .share = is_known ? share : std::nan("")});
}

Opinion neglected_yielding(double share_of_yield) {
  return diagnostics::finding_of(
      {.effect = "yielding",
       .number = share_of_yield,
       .what = fmt::format("max equivalent stress / yield strength = {:.2g}", share_of_yield),
       .advice =
           "the body would yield, but the result is that of an elastic body; use a program with plasticity",
       .share = std::clamp(share_of_yield - 1, 0., 1.)});  // of a place
}

// Metals yield at strains of 0.1 to 0.9 %; plastics and rubber are softer and yield later or not at all.
Opinion unknown_yielding(const P& p, double strain) {
  constexpr double soft = 10e9;  // [Pa]
  double stiffest = 0;
  for (const SolidMaterial& m : materials_of(p)) {
    if (m.yield_strength) return {};
    stiffest = std::max(stiffest, m.youngs_modulus);
  }
  if (stiffest < soft || !(strain > 0.002)) return {};
  return diagnostics::finding_of(
      {.effect = "yielding",
       .number = strain,
       .limit = 0.01,
       .what =
           fmt::format("largest stress = {:.2g} of Young's modulus, and no yield strength is given", strain),
       .advice = "give 'yield-strength' in 'material'"});
}

Opinion near_incompressibility(const P& p) {
  if (!deforms(p) || has_volume_strain_of_cells(p)) return {};
  if (is_plane_stress(p)) return {};  // its thickness is free: no locking
  const double nu = std::max(0.0, largest_poissons_ratio(p));
  return diagnostics::finding_of(
      {.effect = "near incompressibility",
       .number = nu,
       .limit = 0.45,
       .what = fmt::format("max Poisson's ratio = {:g}", nu),
       .advice =
           has_orthotropic(p)
               ? "coarse meshes may be too stiff there, and an orthotropic material has no "
                 "volume strain per cell: compare two meshes"
               : "coarse meshes are too stiff or otherwise inaccurate there: use 'solution-method: {face-gradient: symmetric}' "
                 "with one volume strain per cell",
       .left_out = false});
}

// Free thermal strain relative to the largest displacement gradient. Uses the material's coefficient and the
// default reference temperature of `thermal-expansion`, otherwise, for information, 1e-5 1/K over the range of temperatures.
Opinion neglected_thermal_strain(const P& p, double gradient, double range, double change) {
  if (!deforms(p) || p.expansion) return {};
  const auto own = largest_expansion(p);
  const double coefficient = own.value_or(1e-5), kelvins = own ? std::fmax(range, change) : range,
               strain = coefficient * kelvins,
               share = gradient == 0 && strain > 0 ? 1 : strain / std::max(gradient, 1e-300);
  return diagnostics::finding_of(
      {.effect = "thermal strain",
       .number = share,
       .limit = diagnostics::no_verdict,
       .what = fmt::format(
           "a temperature {} of {:.3g} K times {:.3g} 1/K would cause a free thermal strain of {:.2g}; max |grad u| = {:.2g}",
           own ? "change" : "range", kelvins, coefficient, strain, gradient),
       .advice = "use 'thermal-expansion'",
       .share = own ? share : std::nan("")});
}

Opinion thermoelastic_coupling(const P& p, double coupling_number) {
  diagnostics::EffectFinding found{
      .effect = "thermoelastic coupling",
      .number = coupling_number,
      .what = fmt::format("heat of deformation / stiffness = {:.1e}", coupling_number),
      .advice = "use 'thermoelastic-coupling: true'",
      .share = coupling_number};
  if (p.thermoelastic_coupling)
    found = {.effect = found.effect,
             .number = coupling_number,
             .limit = 0.005,
             .what = found.what,
             .left_out = false,
             .is_spare = true};
  return diagnostics::finding_of(found);
}

namespace {

/// Inertia of a static run with several steps, from the velocities between them: its work on the displacement over that of the
/// loads, because loads whose sum is zero move a body, too.
class NeglectedInertia final : public diagnostics::Diagnostic {
 public:
  explicit NeglectedInertia(const SolidView& view) : view_(view) {}

  void observe(diagnostics::Report&) override {
    const SolidState &now = view_.now(), &before = view_.before();
    const LastSolve& last = view_.stepper.last_solve();
    if (before.steps < 1 || !last.is_known(view_.comm())) return;
    const auto dim = std::size_t(view_.body.mesh().dim),
               n = std::size_t(view_.body.mesh().cells.n_owned()) * dim;
    double inertia = 0;
    for (std::size_t i = 0; i < n; ++i)
      inertia += view_.body.density(Index(i / dim)) * view_.body.geometry().volume[i / dim] *
                 (now.cell_v[i] - before.cell_v[i]) / (0.5 * (now.dt + before.dt)) * now.cell_u[i];
    inertia_ = std::max(inertia_, std::abs(parallel::sum(view_.comm(), inertia)));
    const double work = std::inner_product(last.rhs.begin(), last.rhs.end(), last.unknowns.begin(), 0.);
    load_.add(std::abs(parallel::sum(view_.comm(), work)), now.dt);
  }

  void conclude(diagnostics::Report& report) override {
    if (load_.value() > 0 && view_.now().steps > 1)
      add(report, neglected_inertia(view_.body.parameters(), load_.share(inertia_, 0)));
  }

  void visit(io::Archive& archive) override { archive.common("inertia", inertia_, load_); }

 private:
  SolidView view_;
  double inertia_ = 0;  // largest work of the run [J]
  diagnostics::Reference load_{"solid: work of the loads"};
};

/// Weight of a body at rest without gravity, for information. By reciprocity, its work on the displacement by the loads over the work
/// of the loads is the change of the displacement at the loads. It counts along the axis along which it is largest.
class NeglectedWeight final : public diagnostics::Diagnostic {
 public:
  NeglectedWeight(const SolidView& view, std::shared_ptr<StrainEnergy> strain)
      : view_(view), strain_(std::move(strain)) {}

  void conclude(diagnostics::Report& report) override {
    constexpr double gravity = 9.81;  // [m/s^2]
    const StrainAudit& strain = strain_->now(false);
    const SolidBody& body = view_.body;
    const mesh::Mesh& mesh = body.mesh();
    // Without loads a given motion is the answer, and what is below the scale is round-off.
    if (!(strain.strain_energy > 0) || strain.strain_energy < strain.scale ||
        !(view_.fields.total_load().norm() > 0))
      return;
    Vec3 moved = Vec3::Zero();  // mass times displacement
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      for (int a = 0; a < mesh.dim; ++a)
        moved[a] +=
            body.density(c) * body.geometry().volume[c] * view_.now().cell_u[std::size_t(c) * mesh.dim + a];
    for (int a = 0; a < mesh.dim; ++a) moved[a] = std::abs(parallel::sum(mesh.comm, moved[a]));
    int axis = 1;  // the only one along which a body of revolution can weigh
    if (!is_axisymmetric(body.parameters())) moved.maxCoeff(&axis);
    const double share = gravity * moved[axis] / (2 * strain.strain_energy);
    add(report,
        diagnostics::finding_of(
            {.effect = "gravity",
             .number = share,
             .limit = diagnostics::no_verdict,
             .what = share > 1 ? fmt::format("the weight along {} would move the body {:.2g} times as far "
                                             "as the loads do",
                                             "xyz"[axis], share)
                               : fmt::format("the weight along {} would change the displacement by {:.2g} %",
                                             "xyz"[axis], 100 * share)}));
  }

 private:
  SolidView view_;
  std::shared_ptr<StrainEnergy> strain_;
};

/// Yielding, volumetric locking, and an absolute pressure on one side.
class NeglectedOfMaterial final : public diagnostics::Diagnostic {
 public:
  explicit NeglectedOfMaterial(const SolidView& view) : view_(view) {}

  void look(diagnostics::Report& report) override {
    add(report, neglected_yielding(share_of_yield()));
    if (Opinion locks = near_incompressibility(view_.body.parameters())) {
      report.position.push_back({"Poisson's ratio", locks->number, locks->limit, "solid-nu"});
      add(report, std::move(locks));
    }
    look_at_interface(report);
  }

 private:
  /// Largest von Mises stress over the yield strength; NaN if unknown.
  double share_of_yield() const {
    const SolidBody& body = view_.body;
    const mesh::Mesh& mesh = body.mesh();
    if (std::ranges::none_of(body.materials(),
                             [](const SolidMaterial& m) { return m.yield_strength.has_value(); }))
      return std::numeric_limits<double>::quiet_NaN();
    const std::vector<Tensor3> stress =
        view_.fields.face_stress(0, mesh.n_flux_faces(), view_.fields.point_displacement());
    double share = 0;
    for (Index f = 0; f < mesh.n_flux_faces(); ++f)
      if (const auto& yield = body.materials()[mesh.material_of(mesh.owner[f])].yield_strength)
        share = std::max(share, equivalent_stress(stress[f]) / *yield);
    return parallel::max(mesh.comm, share);
  }
  /// A body with a pressure of its own may be loaded on its other side.
  void look_at_interface(diagnostics::Report& report) const {
    using Type = SolidCondition::Type;
    if (std::ranges::any_of(view_.body.parameters().boundaries, [](const auto& one) {
          return one.second.type == Type::pressure || one.second.type == Type::traction;
        }))
      return;
    const mesh::Mesh& mesh = view_.body.mesh();
    const mesh::Geometry& geometry = view_.body.geometry();
    const std::span<const double> force = view_.stepper.last_solve().interface;
    const std::size_t first = std::size_t(mesh.n_interior), count = force.size() / std::size_t(mesh.dim);
    add(report, diagnostics::atmosphere_on_one_side(mesh.comm, mesh.dim, force,
                                                    std::span(geometry.face_area).subspan(first, count),
                                                    std::span(geometry.face_centre).subspan(first, count)));
  }

  SolidView view_;
};

/// Thermal strain and heat of deformation, for a case with temperatures.
class NeglectedOfHeat final : public diagnostics::Diagnostic {
 public:
  explicit NeglectedOfHeat(const SolidView& view) : view_(view) {}

  void look(diagnostics::Report& report) override {
    const SolidParameters& p = view_.body.parameters();
    const auto [low, high] = view_.body.temperature()->seen();
    const double reference = p.expansion.value_or(ThermalExpansion{}).reference_temperature;
    const double gradient = view_.fields.deformation(view_.fields.point_displacement()).gradient;
    largest_gradient_ = std::max(largest_gradient_, gradient);
    add(report, neglected_thermal_strain(p, largest_gradient_, high - low,
                                         std::max(std::abs(high - reference), std::abs(low - reference))));
    if (const double number = view_.body.thermal()->coupling_number(); number > 0)
      add(report, thermoelastic_coupling(p, number));
  }

  void visit(io::Archive& archive) override { archive.common("gradient", largest_gradient_); }

 private:
  SolidView view_;
  double largest_gradient_ = 0;
};

}  // namespace

diagnostics::Made neglected_inertia(const SolidView& view) {
  if (view.body.is_dynamic()) return nullptr;
  return std::make_shared<NeglectedInertia>(view);
}

diagnostics::Made neglected_weight(const SolidView& view, const std::shared_ptr<StrainEnergy>& strain) {
  const P& p = view.body.parameters();
  if (!strain || view.body.is_dynamic() || !p.gravity.empty() || !p.body_force.empty() ||
      view.body.thermal() || has_interface(p))
    return nullptr;
  return std::make_shared<NeglectedWeight>(view, strain);
}

diagnostics::Made limits_of_material(const SolidView& view) {
  return std::make_shared<NeglectedOfMaterial>(view);
}

diagnostics::Made effects_of_heat(const SolidView& view) {
  if (!view.body.thermal()) return nullptr;
  return std::make_shared<NeglectedOfHeat>(view);
}

}  // namespace couplet::solid
