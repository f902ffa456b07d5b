// SPDX-License-Identifier: Apache-2.0
// Consistency of a solution: stress work against strain energy, and the strains within cells.
#include "solid_solver/diagnostics/strain_energy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/diagnostics/error_parts.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/recovered_strain.hpp"

namespace couplet::solid {
namespace {

/// Vector from the owner to the opposite node.
Vec3 line_of(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  const mesh::Geometry& g = geometry;
  const Vec3 across =
      f < mesh.n_interior ? Vec3(g.cell_centre[mesh.neighbour[f]] + mesh.shift(f)) : g.face_centre[f];
  return across - g.cell_centre[mesh.owner[f]];
}

/// Half the work of a face force over the difference of the displacements on both sides.
double work_on(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, const SolidState& state, Index f,
               const Vec3& force) {
  const Vec3& area = rows.geometry().face_area[f];
  const Vec3 here = elastic::vector_at(state.cell_u, mesh.owner[f], mesh.dim);
  if (f < mesh.n_interior)
    return 0.5 * force.dot(elastic::vector_at(state.cell_u, mesh.neighbour[f], mesh.dim) - here);
  if (rows.mirrored(f)) return -(0.5 * area.dot(force) * area.dot(here) / area.squaredNorm());
  return 0.5 * force.dot(elastic::vector_at(state.face_u, f - mesh.n_interior, mesh.dim) - here);
}

/// True if the temperature strains or softens the body. Thermal strain would count as a variation.
bool is_strained(const SolidBody& body) {
  return body.thermal() && (body.parameters().expansion.has_value() || !body.thermal()->stiffness().empty());
}

Tensor3 small_strain(const Tensor3& h) { return 0.5 * (h + h.transpose()); }
Tensor3 greens_strain(const Tensor3& h) { return 0.5 * (h + h.transpose() + h.transpose() * h); }

/// A static body at small strain has displacement_error() instead of recovered strains.
bool recovers(const SolidBody& body) {
  return body.is_dynamic() || body.seat() || has_finite_strain(body.parameters());
}

/// Finds what the mesh misses of the strains within its cells. Nothing is known with another gradient than the symmetric
/// one. Collective.
MissedStrain missed_within(const SolidBody& body, std::span<const double> unknowns,
                           std::span<const double> known) {
  if (!body.kernel().is_symmetric()) return {.is_one_row = true};
  MissedStrain missed =
      missed_strain(body, unknowns, known,
                    has_finite_strain(body.parameters()) ? greens_strain : small_strain, recovers(body));
  if (is_strained(body)) missed.variation = 0;
  return missed;
}

/// Equilibrium residual times the displacement. If it is zero, the strain energy of a symmetric operator is
/// half the loads' work. Static solves; this rank's part.
double residual_work(const SolidView& view, std::span<const double> unknowns) {
  const std::vector<double>& rhs = view.stepper.last_solve().rhs;
  if (view.body.is_dynamic() || !view.stepper.last_solve().is_known(view.comm())) return 0;
  std::vector<double> force(unknowns.size());
  view.body.kernel().apply(unknowns, {}, force);
  double work = 0;
  for (std::size_t i = 0; i < force.size(); ++i) work += unknowns[i] * (rhs[i] - force[i]);
  return work;
}

}  // namespace

double StrainAudit::mismatch() const { return scale > 0 ? std::abs(stress_work - strain_energy) / scale : 0; }

bool StrainAudit::is_doubtful() const {
  return mismatch() > most_mismatch || inner_variation > most_variation;
}

std::string StrainAudit::text() const {
  std::string text = fmt::format(
      "energy balance: half the work of the loads is {:.6g} J and the strain energy {:.6g} J ({:.2g} % apart)",
      stress_work, strain_energy, 100 * mismatch());
  if (inner_variation > most_variation)
    text += fmt::format(
        "; the strains vary so much within its quadrilaterals that they are {:.2g} % too stiff (use more "
        "cells across, or 'volume-strain: shared')",
        100 * inner_variation);
  return text;
}

namespace {

/// Energies with which that of the body is compared, over all ranks.
struct Scales {
  double energy = 0;  ///< of free thermal strain e: e : C : e / 2 [J]
  double load = 0;    ///< mu (|u|/L)^2 with the size L of the body [J]
  double of(double value) const { return diagnostics::scale_of(std::max({value, energy, 0.0}), load); }
};

Scales scales_of(const SolidView& view) {
  const SolidBody& body = view.body;
  const mesh::Mesh& mesh = body.mesh();
  const std::vector<double>& volume = body.geometry().volume;
  const int axes = body.parameters().plane == SolidParameters::Plane::stress ? 2 : 3;
  Scales scales;
  if (body.thermal())
    if (const std::vector<double> pressure = body.thermal()->pressure(view.now().time); !pressure.empty())
      elastic::visit_pyramids(mesh, body.geometry(), [&](Index c, Index f, double v) {
        const elastic::LameConstants& lame = body.elastic().lame(c);
        const double strain = pressure[f] / (axes * lame.lambda + 2 * lame.mu);
        scales.energy += 0.5 * v * axes * pressure[f] * strain;
      });
  const double length = mesh::extent_of(mesh, body.geometry()).diagonal();
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    scales.load += volume[c] * body.elastic().lame(c).mu *
                   elastic::vector_at(view.now().cell_u, c, mesh.dim).squaredNorm() / (length * length);
  for (double* sum : {&scales.energy, &scales.load}) *sum = parallel::sum(mesh.comm, *sum);
  return scales;
}

}  // namespace

StrainAudit audit_strain(const SolidView& view, bool looks_within) {
  const SolidBody& body = view.body;
  const mesh::Mesh& mesh = body.mesh();
  const mesh::Geometry& geometry = body.geometry();
  const SolidState& state = view.now();
  StrainAudit audit;
  audit.looks_within_cells = looks_within;
  const std::vector<double> unknowns = body.unknowns_of(state.cell_u, state.face_u);
  const std::vector<double> known =
      body.known_of({state.cell_u, state.face_u, view.fields.point_displacement()});
  const elastic::ElasticOperator& rows = body.elastic();
  const elastic::ElasticField u{unknowns, known};
  double energy = 0, work = 0;
  if (body.kernel().is_symmetric()) {
    energy = 0.5 * body.kernel().product(elastic::ElasticPart::stiffness, u, u);
    work = energy + 0.5 * residual_work(view, unknowns);
  } else {
    const auto add = [&](Index f, const Tensor3& gradient) {
      if (mesh.owner[f] >= mesh.cells.n_owned()) return;  // another rank's
      const Tensor3 stress = rows.stress(mesh.owner[f], gradient);
      energy += 0.5 * std::abs(geometry.face_area[f].dot(line_of(mesh, geometry, f))) / mesh.dim *
                contraction(stress, gradient);
      work += work_on(mesh, rows, state, f, stress * geometry.face_area[f]);
    };
    body.kernel().face_gradients(unknowns, known, add, 0, mesh.n_flux_faces());
  }
  audit.strain_energy = parallel::sum(mesh.comm, energy);
  audit.stress_work = parallel::sum(mesh.comm, work);
  audit.scale = scales_of(view).of(audit.strain_energy);
  if (!looks_within) return audit;
  const MissedStrain missed = missed_within(body, unknowns, known);
  audit.inner_variation = missed.variation;
  if (recovers(body) && !missed.is_one_row) {
    const double share = audit.scale > 0 ? std::min(1.0, audit.strain_energy / audit.scale) : 1;
    audit.missed_by_mesh = std::max(share * missed.recovered, missed.variation);
  }
  return audit;
}

double missed_at_large_strain(const SolidView& view) {
  const MissedStrain missed = missed_within(view.body, view.unknowns(), view.known());
  return missed.is_one_row ? diagnostics::ErrorParts::unknown : std::max(missed.recovered, missed.variation);
}

bool is_time_to_look(const SolidView& view) {
  constexpr int steps_between = 50;
  return view.body.is_dynamic() &&
         (view.body.parameters().output.energies || view.now().steps % steps_between == 0);
}

const StrainAudit& StrainEnergy::now(bool within_cells) {
  const bool holds =
      latest_ && steps_of_latest_ == view_.now().steps && (latest_->looks_within_cells || !within_cells);
  if (!holds) latest_ = audit_strain(view_, within_cells);
  steps_of_latest_ = view_.now().steps;
  return *latest_;
}

void StrainEnergy::observe(diagnostics::Report& report) {
  if (!view_.body.is_dynamic() || is_time_to_look(view_)) look(report);
}

void StrainEnergy::look(diagnostics::Report& report) {
  const StrainAudit& audit = now(!view_.body.is_dynamic());
  if (!worst_ || audit.is_doubtful() || !worst_->is_doubtful()) worst_ = audit;
  if (!audit.is_doubtful()) return;
  report.findings.push_back(
      {.id = "strain-energy",
       .severity = audit.severity(),
       .number = audit.mismatch(),
       .limit = StrainAudit::most_mismatch,
       .sentence = fmt::format("{}: displacement not reliable", audit.text()),
       .advice =
           "refine the mesh, especially across the bending direction; typical causes are cells elongated along it, few "
           "tetrahedra or prisms across, and nu near 0.5"});
}

void StrainEnergy::conclude(diagnostics::Report& report) {
  if (worst_)
    report.sentences.push_back(
        fmt::format("{}{}.", worst_->text(), worst_->is_doubtful() ? "; NOT reliable" : ""));
}

void StrainEnergy::visit(io::Archive& archive) {
  archive.common("audit", worst_);
  if (archive.reads()) latest_.reset();
}

}  // namespace couplet::solid
