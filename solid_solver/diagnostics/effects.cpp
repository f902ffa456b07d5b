// SPDX-License-Identifier: Apache-2.0
// Effects that the case neglects, judged by results of the run.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/diagnostics/neglected.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {
namespace {

/// Inertia of a static run with several steps, from the velocities between them.
class NeglectedInertia final : public diagnostics::Diagnostic {
 public:
  explicit NeglectedInertia(const SolidView& view) : view_(view) {}

  void observe(diagnostics::Report&) override {
    const SolidState &now = view_.now(), &before = view_.before();
    if (before.steps < 1) return;
    const mesh::Mesh& mesh = view_.body.mesh();
    Vec3 inertia = Vec3::Zero();
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      for (int a = 0; a < mesh.dim; ++a) {
        const std::size_t i = std::size_t(c) * mesh.dim + a;
        inertia[a] += view_.body.density(c) * view_.body.geometry().volume[c] *
                      (now.cell_v[i] - before.cell_v[i]) / (0.5 * (now.dt + before.dt));
      }
    for (int a = 0; a < mesh.dim; ++a) inertia[a] = parallel::sum(mesh.comm, inertia[a]);
    const double load = view_.fields.total_load().norm();
    if (load > 0) over_load_ = std::max(over_load_, inertia.norm() / load);
  }

  void look(diagnostics::Report& report) override {
    if (view_.now().steps > 1) add(report, neglected_inertia(view_.body.parameters(), over_load_));
  }

  void visit(io::Archive& archive) override { archive.common("inertia", over_load_); }

 private:
  SolidView view_;
  double over_load_ = 0;
};

/// Yielding and volumetric locking.
class NeglectedOfMaterial final : public diagnostics::Diagnostic {
 public:
  explicit NeglectedOfMaterial(const SolidView& view) : view_(view) {}

  void look(diagnostics::Report& report) override {
    add(report, neglected_yielding(share_of_yield()));
    if (Opinion locks = near_incompressibility(view_.body.parameters())) {
      report.position.push_back({"Poisson's ratio", locks->number, locks->limit, "solid-nu"});
      add(report, std::move(locks));
    }
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

  SolidView view_;
};

/// Thermal strain and heat of deformation, for a case with temperatures.
class NeglectedOfHeat final : public diagnostics::Diagnostic {
 public:
  explicit NeglectedOfHeat(const SolidView& view) : view_(view) {}

  void look(diagnostics::Report& report) override {
    const SolidParameters& p = view_.body.parameters();
    const ThermalStrain& thermal = *view_.body.thermal();
    const auto [low, high] = thermal.temperatures_seen();
    const double reference = p.expansion.value_or(ThermalExpansion{}).reference_temperature;
    const double gradient = view_.fields.deformation(view_.fields.point_displacement()).gradient;
    largest_gradient_ = std::max(largest_gradient_, gradient);
    add(report, neglected_thermal_strain(p, largest_gradient_, high - low,
                                         std::max(std::abs(high - reference), std::abs(low - reference))));
    if (const double number = thermal.coupling_number(); number > 0)
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

diagnostics::Made limits_of_material(const SolidView& view) {
  return std::make_shared<NeglectedOfMaterial>(view);
}

diagnostics::Made effects_of_heat(const SolidView& view) {
  if (!view.body.thermal()) return nullptr;
  return std::make_shared<NeglectedOfHeat>(view);
}

}  // namespace couplet::solid
