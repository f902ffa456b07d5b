// SPDX-License-Identifier: Apache-2.0
// Consistency of a solution: stress work against strain energy, and one face gradient against another.
#include "solid_solver/diagnostics/strain_energy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

elastic::FaceGradientScheme other_scheme(elastic::FaceGradientScheme scheme) {
  return scheme == elastic::FaceGradientScheme::corrected ? elastic::FaceGradientScheme::thesis
                                                          : elastic::FaceGradientScheme::corrected;
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

/// Estimates of the variation within cells, where available.
struct WithinCells {
  std::optional<InnerVariation> variation;
  std::optional<RecoveredStrain> recovered;
  void add(Index f, const Tensor3& gradient) {
    const Tensor3 strain = 0.5 * (gradient + gradient.transpose());
    if (variation) variation->add(f, strain);
    if (recovered) recovered->add(f, strain);
  }
  /// Call after all faces. Collective.
  void finish(const elastic::ElasticKernel& kernel, const elastic::ElasticField& u, StrainAudit& audit) {
    if (variation) audit.inner_variation = variation->missed();
    if (!recovered) return;
    recovered->recover();
    const auto compare = [&](Index f, const Tensor3& g) { recovered->compare(f, 0.5 * (g + g.transpose())); };
    kernel.face_gradients(u.unknowns, u.known, compare, 0, recovered->n_faces());
    audit.recovered_difference = recovered->missed();
  }
};

WithinCells within_cells(const mesh::Mesh& mesh, const SolidBody& body) {
  WithinCells within;
  const elastic::ElasticOperator& rows = body.elastic();
  // A static body with the symmetric gradient has displacement_error().
  if (body.is_dynamic() || body.seat() || !body.kernel().is_symmetric()) within.recovered.emplace(mesh, rows);
  if (!body.kernel().is_symmetric() || is_strained(body)) return within;
  if (InnerVariation::is_needed(mesh, rows)) within.variation.emplace(mesh, rows);
  return within;
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

double StrainAudit::missed_by_mesh(int dim) const {
  const double of_gradients = gradient_difference * gradient_difference;
  if (!recovered_difference) return of_gradients;
  // A single cell across shows no slope to neighbors, so all of its bending would be missed.
  const double missed = dim == 3 ? std::min(*recovered_difference, of_gradients) : *recovered_difference;
  return std::max(missed, inner_variation);
}

double StrainAudit::mismatch() const { return scale > 0 ? std::abs(stress_work - strain_energy) / scale : 0; }

bool StrainAudit::is_doubtful() const {
  return mismatch() > most_mismatch || (compares_gradients && gradient_difference > most_difference) ||
         inner_variation > most_variation;
}

std::string StrainAudit::text() const {
  std::string text =
      fmt::format("half the work of the loads is {:.6g} J, the strain energy {:.6g} J ({:.2g} % apart)",
                  stress_work, strain_energy, 100 * mismatch());
  if (compares_gradients)
    text +=
        fmt::format("; the strains of the two face gradients differ by {:.2g} %", 100 * gradient_difference);
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
  double energy = 0, size = 0;  ///< of free thermal strain e: e : C : e / 2 and mu |e|^2 [J]
  double load = 0;              ///< mu (|u|/L)^2 with the size L of the body [J]
  double of(double value, double thermal) const {
    return diagnostics::scale_of(std::max({value, thermal, 0.0}), load);
  }
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
        scales.size += v * lame.mu * axes * strain * strain;
      });
  const double length = mesh::extent_of(mesh, body.geometry()).diagonal();
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    scales.load += volume[c] * body.elastic().lame(c).mu *
                   elastic::vector_at(view.now().cell_u, c, mesh.dim).squaredNorm() / (length * length);
  for (double* sum : {&scales.energy, &scales.size, &scales.load}) *sum = parallel::sum(mesh.comm, *sum);
  return scales;
}

}  // namespace

StrainAudit audit_strain(const SolidView& view, bool compare) {
  const SolidBody& body = view.body;
  const mesh::Mesh& mesh = body.mesh();
  const mesh::Geometry& geometry = body.geometry();
  const SolidState& state = view.now();
  const std::vector<double> points = view.fields.point_displacement();
  StrainAudit audit;
  audit.compares_gradients = compare;
  const Index n_faces = mesh.n_flux_faces(), half = n_faces / 2;
  Index first = 0;  // face of the first of the strains below
  std::vector<std::array<float, 6>> strains(compare ? std::size_t(n_faces - half) : 0);
  const std::vector<double> unknowns = body.unknowns_of(state.cell_u, state.face_u);
  const std::vector<double> known = body.known_of({state.cell_u, state.face_u, points});
  const elastic::ElasticOperator& rows = body.elastic();
  WithinCells within = compare ? within_cells(mesh, body) : WithinCells{};
  const auto is_mine = [&](Index f) { return mesh.owner[f] < mesh.cells.n_owned(); };
  const auto volume = [&](Index f) {
    return std::abs(geometry.face_area[f].dot(line_of(mesh, geometry, f))) / mesh.dim;
  };
  double energy = 0, work = 0, difference = 0, size = 0;
  const auto own = [&](Index f, const Tensor3& gradient) {
    within.add(f, gradient);
    if (!is_mine(f)) return;  // another rank's
    const Tensor3 stress = rows.stress(mesh.owner[f], gradient);
    energy += 0.5 * volume(f) * contraction(stress, gradient);
    work += work_on(mesh, rows, state, f, stress * geometry.face_area[f]);
    if (!compare) return;
    const Tensor3 symmetric = 0.5 * (gradient + gradient.transpose());
    size += volume(f) * rows.lame(mesh.owner[f]).mu * symmetric.squaredNorm();
    std::ranges::copy(pack(symmetric), strains[f - first].begin());
  };
  const auto other = [&](Index f, const Tensor3& gradient) {
    if (!is_mine(f)) return;
    PackedTensor gap = pack(0.5 * (gradient + gradient.transpose()));
    if (is_axisymmetric(rows)) gap[2] = strains[f - first][2];  // it knows no hoop strain
    for (std::size_t i = 0; i < gap.size(); ++i) gap[i] -= strains[f - first][i];
    difference += volume(f) * rows.lame(mesh.owner[f]).mu * unpack(gap).squaredNorm();
  };
  if (!compare) {
    body.kernel().face_gradients(unknowns, known, own, 0, n_faces);
  } else {
    // Processes half of the faces at a time, because this is the peak of memory (half the strains: 2 %).
    const elastic::ElasticKernel beside(mesh, rows, other_scheme(body.kernel().scheme()));
    for (const Index end : {half, n_faces}) {
      body.kernel().face_gradients(unknowns, known, own, first, end);
      beside.face_gradients(unknowns, known, other, first, end);
      first = end;
    }
    difference = parallel::sum(mesh.comm, difference);
    size = parallel::sum(mesh.comm, size);
  }
  if (body.kernel().is_symmetric()) {
    const elastic::ElasticField u{unknowns, known};
    energy = 0.5 * body.kernel().product(elastic::ElasticPart::stiffness, u, u);
    work = energy + 0.5 * residual_work(view, unknowns);
  }
  audit.strain_energy = parallel::sum(mesh.comm, energy);
  audit.stress_work = parallel::sum(mesh.comm, work);
  within.finish(body.kernel(), {unknowns, known}, audit);
  const Scales scales = scales_of(view);
  audit.scale = scales.of(audit.strain_energy, scales.energy);
  if (audit.recovered_difference && audit.scale > 0)
    *audit.recovered_difference *= std::min(1.0, audit.strain_energy / audit.scale);
  if (const double of_size = scales.of(size, scales.size); of_size > 0)
    audit.gradient_difference = std::sqrt(difference / of_size);
  return audit;
}

bool is_time_to_look(const SolidView& view) {
  constexpr int steps_between = 50;
  return view.body.is_dynamic() &&
         (view.body.parameters().output.energies || view.now().steps % steps_between == 0);
}

const StrainAudit& StrainEnergy::now(bool compare_gradients) {
  const bool holds =
      latest_ && steps_of_latest_ == view_.now().steps && (latest_->compares_gradients || !compare_gradients);
  if (!holds) latest_ = audit_strain(view_, compare_gradients);
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
       .sentence = fmt::format("error indicator: {}: displacement not reliable", audit.text()),
       .advice = "refine the mesh, above all across the bending direction; typical causes: cells elongated "
                 "along it, few tetrahedra or prisms across, nu near 0.5"});
}

void StrainEnergy::conclude(diagnostics::Report& report) {
  if (worst_)
    report.sentences.push_back(
        fmt::format("error indicator: {}{}.", worst_->text(), worst_->is_doubtful() ? "; NOT reliable" : ""));
}

void StrainEnergy::visit(io::Archive& archive) {
  archive.common("audit", worst_);
  if (archive.reads()) latest_.reset();
}

}  // namespace couplet::solid
