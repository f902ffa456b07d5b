// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/diagnostics/stability.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/base/error.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/diagnostics/neglected.hpp"
#include "solid_solver/equilibrium/load_path.hpp"

namespace couplet::solid {

void Stability::observe(diagnostics::Report& report) {
  const SolidBody& body = view_.body;
  if (const LoadPath* path = body.load_path()) return see_limits(*path);
  if (!body.finite_strain() || body.seat() || !body.rigid().empty() || is_lost_) return;
  if (!searches_ && !view_.stepper.step().is_last) return;
  const SolidState& now = view_.now();
  const double stiffness = body.lowest_stiffness(view_.stepper.last_solve().unknowns, now.known);
  const Vec3 load = view_.fields.total_load();
  if (stiffness >= 0) {
    time_ = now.time, stiffness_ = stiffness, load_ = load;
    return;
  }
  is_lost_ = true;
  const double part = stiffness_ / (stiffness_ - stiffness);
  const double lost = time_ + part * (now.time - time_);
  const Vec3 then = load_ + part * (load - load_);
  std::string where =
      fmt::format("it was lost near t = {:.4g} s, between {:g} and {:g} s", lost, time_, now.time);
  if (load.norm() > 0)
    where += fmt::format(", at a total load of about {:.4g} N, which is {:.3g} times the load of this step",
                         then.norm(), then.norm() / load.norm());
  report.findings.push_back(
      {.id = "unstable-equilibrium",
       .severity = base::Severity::wrong,
       .number = stiffness,
       .limit = 0,
       .sentence = fmt::format(
           "stability of the equilibrium: min stiffness loaded / unloaded = {:.2g} (limit 0): unstable; {}",
           stiffness, where),
       .advice =
           "a small lateral load or imperfection leads to the stable equilibrium; 'analysis: buckling' of the linear body "
           "gives load factors and mode shapes"});
}

void Stability::see_limits(const LoadPath& path) {
  if (path.limits().size() <= limits_told_) return;
  limits_told_ = path.limits().size();
  const LimitPoint& limit = path.limits().back();
  const double load = view_.fields.total_load().norm();
  std::string force;
  if (load > 0 && path.factor() != 0)
    force = fmt::format(", a total load of about {:.4g} N", load * std::abs(limit.factor / path.factor()));
  // Logged directly, because diagnostics do not report notes.
  diagnostics::finding(
      parallel::comm_rank(view_.comm()),
      {.id = "limit-load",
       .severity = base::Severity::note,
       .number = limit.factor,
       .sentence = fmt::format("t = {:g} s: load path: {} of the load factor = {:.5g}{}: limit point passed",
                               limit.time, limit.is_maximum ? "maximum" : "minimum", limit.factor, force)});
}

void Stability::conclude(diagnostics::Report& report) {
  const LoadPath* path = view_.body.load_path();
  if (!path) return;
  std::string found;
  for (const LimitPoint& l : path->limits())
    found += fmt::format("{}{:.5g} ({})", found.empty() ? "" : ", ", l.factor,
                         l.is_maximum ? "maximum" : "minimum");
  report.sentences.push_back(fmt::format("load path: load factor {:.5g} at the end; limit points: {}.",
                                         path->factor(), found.empty() ? "none" : found));
  if (path->stiffness() > 0) return;  // 0 if a slender body's is not surely negative
  report.findings.push_back(
      {.id = "unstable-equilibrium",
       .severity = base::Severity::warning,
       .number = path->stiffness(),
       .limit = 0,
       .sentence = fmt::format("stability of the last equilibrium: min stiffness loaded / unloaded = {:.2g} "
                               "(limit 0): unstable, on the load path between limit points",
                               path->stiffness()),
       .advice = "with a later 'end-time' the path may reach a stable equilibrium"});
}

void Stability::visit(io::Archive& archive) {
  archive.common("held", time_, stiffness_, load_, is_lost_, limits_told_);
}

namespace {

const char* cure_of(const SolidView& view) {
  if (view.body.large_strain())
    return "the time scheme does not conserve the energy of a nonlinear law; a shorter step, 'energy-momentum: true' or "
           "'time-scheme: {type: bathe}' prevents this growth";
  if (view.body.kernel().is_symmetric()) return "a shorter step or 'time-scheme: {type: bathe}' prevents it";
  return "the operator of 'solution-method: {face-gradient: thesis}' is not symmetric, so undamped motion grows on skewed, "
         "stretched or perturbed cells; use 'face-gradient: symmetric', or damp it by 'time-scheme: {type: bathe}' or a little "
         "'damping: {stiffness: ...}'; 'output: {spectrum: true}' computes the growth rate on a coarse mesh of the same kind";
}

}  // namespace

std::string EnergyAudit::text() const {
  return fmt::format(
      "the solid has {:.6g} J of kinetic and strain energy; loads and initial motion supplied {:.6g} J ({:+.2g} %)",
      held, given, 100 * created());
}

void EnergyBalance::observe(diagnostics::Report& report) {
  const SolidState &now = view_.now(), &before = view_.before();
  const mesh::Mesh& mesh = view_.body.mesh();
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double mass = view_.body.density(c) * view_.body.geometry().volume[c];
    const Vec3 v = elastic::vector_at(now.cell_v, c, mesh.dim),
               u = elastic::vector_at(before.cell_v, c, mesh.dim);
    rates_[0] += 0.25 * mass * (v + u).squaredNorm() * now.dt;
    rates_[1] += mass * (v - u).squaredNorm() / now.dt;
  }
  rates_[2] += work_by_vertices();
  if (is_time_to_look(view_)) look(report);
}

double EnergyBalance::strain_energy() const {
  if (!strain_) return view_.body.equilibrium().energy(view_.unknowns(), view_.now().known);
  const StrainAudit& found = strain_->now(false);
  return std::max(0.0, std::min(found.strain_energy, found.stress_work));
}

/// Work of a partner's loads in the last step on the motion that the partner sees, that of vertices, beyond their work on the
/// unknowns [J]; this rank's. On few faces the two differ, and energy comes from nowhere.
double EnergyBalance::work_by_vertices() const {
  const SolidBody& body = view_.body;
  const mesh::Mesh& mesh = body.mesh();
  if (body.boundaries().interface_patches().empty() || !body.prescribed().is_zero()) return 0;
  std::vector<double> load = view_.stepper.last_solve().interface, cells = view_.now().cell_u,
                      faces = view_.now().face_u;
  load.resize(std::size_t(mesh.boundary.n_owned()) * mesh.dim, 0);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] -= view_.before().cell_u[i];
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] -= view_.before().face_u[i];
  const std::vector<double> unknowns = body.unknowns_of(cells, faces);
  const std::vector<double> points =
      body.to_points(cells, faces, std::vector<double>(view_.now().known.size(), 0.));
  std::vector<double> rows(unknowns.size(), 0);
  body.kernel().add_face_forces(load, rows);
  double work = -std::inner_product(rows.begin(), rows.end(), unknowns.begin(), 0.);
  for (std::size_t i = 0; i < load.size(); ++i) {
    const auto corners = mesh.face_points[mesh.n_interior + Index(i / mesh.dim)];
    double moved = 0;
    for (const Index v : corners) moved += points[std::size_t(v) * mesh.dim + i % mesh.dim];
    work += load[i] * moved / double(corners.size());
  }
  return work;
}

/// Rounding of the strain energy [J]. A law of large strain subtracts terms of the size of its moduli; at small strain
/// the energy is a product of the displacement.
double EnergyBalance::rounding() const {
  if (strain_) return 0;
  double sum = 0;
  for (Index c = 0; c < view_.body.mesh().cells.n_owned(); ++c) {
    const elastic::LameConstants& lame = view_.body.elastic().lame(c);
    sum += (lame.lambda + 2 * lame.mu) * view_.body.geometry().volume[c];
  }
  return std::numeric_limits<double>::epsilon() * parallel::sum(view_.comm(), sum);
}

void EnergyBalance::look(diagnostics::Report& report) {
  const SolidBody& body = view_.body;
  if (body.thermal()) return;  // heat does work that is not counted
  const SolidState& state = view_.now();
  const double kinetic = parallel::sum(view_.comm(), view_.stepper.ledger().kinetic(state));
  const double strain = strain_energy();
  largest_kinetic_ = std::max(largest_kinetic_, kinetic);
  largest_strain_ = std::max(largest_strain_, strain);
  if (!body.prescribed().is_zero()) return;
  const double by_vertices = parallel::sum(view_.comm(), rates_[2]),
               work = parallel::sum(view_.comm(), state.load_work) + by_vertices;
  audit_.is_driven = work != 0;
  audit_.given = parallel::sum(view_.comm(), state.energies.initial_kinetic) + work +
                 view_.stepper.ledger().initial_contact() + by_changes_;
  audit_.held = kinetic + strain + view_.stepper.ledger().contact(state);
  audit_.rounding = rounding();
  audit_.supplied.add(std::abs(audit_.given), state.dt);
  // Loads of a partner may go on growing; the run then ends as useless.
  const bool is_by_partner = -by_vertices > 0.5 * (audit_.held - audit_.given);
  const char* cure =
      is_by_partner
          ? "the partner's loads act on faces, but the partner receives the motion of vertices, which differs on so few faces: "
            "refine the mesh at the interface"
          : cure_of(view_);
  if (audit_.is_hopeless() && !is_by_partner)
    throw Error("t = {:g} s: energy balance: {}: spurious growth has replaced the solution; {}.", state.time,
                audit_.text(), cure);
  if (!audit_.is_doubtful()) return;
  report.findings.push_back(
      {.id = "energy-growth",
       .severity = audit_.severity(),
       .number = audit_.created(),
       .limit = audit_.limit(),
       .sentence = fmt::format("energy balance: {} (limit {:+.2g} %): spurious growth; {}", audit_.text(),
                               100 * audit_.limit(), cure)});
}

void EnergyBalance::conclude(diagnostics::Report& report) {
  if (audit_.supplied.value() > 0)
    report.sentences.push_back(fmt::format("energy balance: {}.", audit_.text()));
  if (!view_.body.parameters().damping && !view_.body.kernel().is_symmetric())
    report.sentences.emplace_back(
        "structural damping neglected: free vibration does not decay, and modes resolved by the time step "
        "may grow; a little 'damping: {stiffness: ...}' or 'time-scheme: {type: bathe}' prevents that; "
        "'output: {spectrum: true}' computes the rate on a coarse mesh of the same kind.");
  const double velocity = parallel::sum(view_.comm(), rates_[0]),
               acceleration = parallel::sum(view_.comm(), rates_[1]);
  // The energies of a heated body are not known.
  if (const double energy = std::max(largest_kinetic_, largest_strain_); energy > 0)
    add(report, neglected_damping(view_.body.parameters(), std::sqrt(velocity * acceleration) / energy));
  if (largest_strain_ > 0)
    add(report, spare_inertia(largest_kinetic_ / largest_strain_, double(view_.now().steps)));
}

void EnergyBalance::visit(io::Archive& archive) {
  archive.common("audit", audit_, largest_kinetic_, largest_strain_, by_changes_);
  archive.sums("rates", rates_);
  if (strain_ && view_.body.thermal()) return;
  const double kinetic = parallel::sum(view_.comm(), view_.stepper.ledger().kinetic(view_.now()));
  const double now = kinetic + strain_energy() + view_.stepper.ledger().contact(view_.now());
  double then = now;
  archive.common("held", then);
  if (std::abs(now - then) > 1e-9 * then + rounding()) by_changes_ += now - then;
}

}  // namespace couplet::solid
