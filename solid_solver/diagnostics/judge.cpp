// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/judge.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/io/archive.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

SolidJudge::SolidJudge(const SolidBody& body, const SolidStepper& stepper, const SolidFields& fields)
    : body_(body), stepper_(stepper), fields_(fields), mesh_(body.mesh()), geometry_(body.geometry()) {}

/// Of the accepted state; a doubtful one is told once, loudly. Collective.
void SolidJudge::look() {
  if (!body_.equilibrium().means().compares_gradients) return look_at_finite();
  const SolidState& state = stepper_.state();
  const std::vector<double> points = fields_.point_displacement();
  const StrainAudit strain = audit_strain(points, !body_.is_dynamic());
  latest_ = strain;
  steps_of_latest_ = state.steps;
  if (!audit_ || strain.is_doubtful() || !audit_->is_doubtful()) audit_ = strain;
  if (strain.is_doubtful() && strain.severity() > strain_told_) {
    strain_told_ = strain.severity();
    diagnostics::finding(
        parallel::comm_rank(mesh_.comm),
        {.id = "strain-energy",
         .severity = strain.severity(),
         .number = strain.mismatch(),
         .limit = StrainAudit::most_mismatch,
         .sentence = fmt::format("t = {:g} s: error indicator: {}: displacement not reliable", state.time,
                                 strain.text()),
         .advice = "refine the mesh, above all across the bending direction; typical causes: cells elongated "
                   "along it, few tetrahedra or prisms across, nu near 0.5"});
  }
  if (!body_.is_dynamic() || !body_.effects().empty() || !body_.prescribed().is_zero()) return;
  judge_energy(
      std::max(0.0, std::min(strain.strain_energy, strain.stress_work)),
      body_.kernel().is_symmetric()
          ? "a shorter step or 'time-scheme: {type: bathe}' prevents it"
          : "the operator of 'solution-method: {face-gradient: thesis}' and 'corrected' is not symmetric, "
            "so undamped motion grows on skewed, stretched or perturbed cells; use 'face-gradient: "
            "symmetric', or damp it by 'time-scheme: {type: bathe}' or a little 'damping: {stiffness: "
            "...}'; 'output: {spectrum: true}' computes its rate on a coarse mesh of the same kind");
}

StrainAudit SolidJudge::compared() const {
  if (latest_ && latest_->compares_gradients && steps_of_latest_ == stepper_.state().steps) return *latest_;
  return audit_strain(fields_.point_displacement(), true);
}

/// The strain energy at large strain is that of the law itself: nothing is compared in a static run. A dynamic one
/// must not hold more than loads and initial motion have brought in.
void SolidJudge::look_at_finite() {
  if (!body_.is_dynamic() || !body_.prescribed().is_zero()) return;
  const SolidState& state = stepper_.state();
  const double strain =
      body_.equilibrium().energy(body_.unknowns_of(state.cell_u, state.face_u), state.known);
  judge_energy(strain,
               "a time scheme that does not conserve the energy of a nonlinear law; a shorter step, "
               "'energy-momentum: true' or 'time-scheme: {type: bathe}' prevents it");
}

/// Kinetic and `strain` energy [J] against what was brought in: a growth is told once, one that leaves nothing of the
/// answer ends the run. Collective.
void SolidJudge::judge_energy(double strain, const char* cure) {
  const SolidState& state = stepper_.state();
  const double work = parallel::sum(mesh_.comm, state.load_work);
  energy_audit_.is_driven = work != 0;
  energy_audit_.given =
      parallel::sum(mesh_.comm, state.energies.initial_kinetic) + work + stepper_.ledger().initial_contact();
  const double kinetic = parallel::sum(mesh_.comm, stepper_.ledger().kinetic(state));
  largest_kinetic_ = std::max(largest_kinetic_, kinetic);
  largest_strain_energy_ = std::max(largest_strain_energy_, strain);
  energy_audit_.held = kinetic + strain + stepper_.ledger().contact(state);
  energy_audit_.scale = std::max(energy_audit_.scale, std::abs(energy_audit_.given));
  if (energy_audit_.is_hopeless())
    throw Error("t = {:g} s: energy balance: {}: spurious growth has replaced the solution; {}.", state.time,
                energy_audit_.text(), cure);
  if (!energy_audit_.is_doubtful() || energy_audit_.severity() <= energy_told_) return;
  energy_told_ = energy_audit_.severity();
  diagnostics::finding(
      parallel::comm_rank(mesh_.comm),
      {.id = "energy-growth",
       .severity = energy_told_,
       .number = energy_audit_.created(),
       .limit = energy_audit_.limit(),
       .sentence = fmt::format("t = {:g} s: energy balance: {} (limit {:+.2g} %): spurious growth; {}",
                               state.time, energy_audit_.text(), 100 * energy_audit_.limit(), cure)});
}

void SolidJudge::see_gradient(std::span<const double> points) {
  largest_gradient_ = std::max(largest_gradient_, fields_.deformation(points).largest_gradient);
}

void SolidJudge::see_inertia() {
  const SolidState &state = stepper_.state(), &trial = stepper_.trial();
  if (state.steps < 1) return;
  const int dim = mesh_.dim;
  Vec3 inertia = Vec3::Zero();
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    for (int a = 0; a < dim; ++a) {
      const std::size_t i = std::size_t(c) * dim + a;
      inertia[a] += body_.density(c) * geometry_.volume[c] * (trial.cell_v[i] - state.cell_v[i]) /
                    (0.5 * (trial.dt + state.dt));
    }
  for (int a = 0; a < dim; ++a) inertia[a] = parallel::sum(mesh_.comm, inertia[a]);
  const double load = fields_.total_load().norm();
  if (load > 0) inertia_over_load_ = std::max(inertia_over_load_, inertia.norm() / load);
}

void SolidJudge::estimate_large_strain() {
  large_strain_.reset();
  try {
    large_strain_ =
        solid::estimate_large_strain(body_, stepper_.last_solve().unknowns, stepper_.trial().known);
  } catch (const SolveFailure& failure) {
    log::warn("output.large-strain-estimate: the estimate failed: {}", failure.what());
  }
}

void SolidJudge::see_buckling() {
  SolutionMethod* method = stepper_.method();
  if (!method || !body_.kernel().is_symmetric() || is_axisymmetric(body_.elastic()) ||
      body_.parameters().output.buckling > 0)
    return;
  const BucklingEstimate found =
      estimate_buckling(body_, fields_, stepper_.state(), *method, compression_seen_);
  if (!found.matters()) return;
  buckling_factor_ = std::min(buckling_factor_, found.factor);
  if (body_.is_dynamic()) return tell_dynamic_buckling(mesh_.comm, found);
  if (found.factor < buckling_told_) {
    buckling_told_ = found.factor >= 1 ? std::min(1.0, found.factor) : 0;
    tell_buckling(mesh_.comm, found, "at most ");
  }
}

SolidEvidence SolidJudge::evidence() const {
  const std::vector<double> points = fields_.point_displacement();
  SolidEvidence evidence = fields_.deformation(points);
  evidence.share_of_yield = fields_.share_of_yield(points);
  evidence.largest_gradient = std::max(largest_gradient_, evidence.largest_gradient);
  if (!body_.is_dynamic() && stepper_.state().steps > 1) evidence.inertia_over_load = inertia_over_load_;
  if (large_strain_) {
    evidence.large_strain = large_strain_->text();
    evidence.large_strain_change = large_strain_->change;
    evidence.large_strain_estimated = true;
  }
  if (buckling_factor_ < BucklingEstimate::low) evidence.buckling_factor = buckling_factor_;
  if (body_.is_dynamic() && largest_strain_energy_ > 0) {
    evidence.kinetic_over_strain = largest_kinetic_ / largest_strain_energy_;
    evidence.dynamic_steps = double(stepper_.state().steps);
  }
  for (const auto& effect : body_.effects()) effect->add_evidence(evidence);
  return evidence;
}

std::vector<std::string> SolidJudge::sentences() const {
  std::vector<std::string> sentences;
  if (audit_)
    sentences.push_back(
        fmt::format("error indicator: {}{}.", audit_->text(), audit_->is_doubtful() ? "; NOT reliable" : ""));
  if (large_strain_) sentences.push_back(large_strain_->text() + ".");
  if (energy_audit_.scale > 0) sentences.push_back(fmt::format("energy balance: {}.", energy_audit_.text()));
  if (body_.is_dynamic() && !body_.parameters().damping && !body_.kernel().is_symmetric())
    sentences.push_back(
        "structural damping neglected: free vibration does not decay, and modes resolved by the time step "
        "may grow; a little 'damping: {stiffness: ...}' or 'time-scheme: {type: bathe}' prevents that; "
        "'output: {spectrum: true}' computes the rate on a coarse mesh of the same kind.");
  return sentences;
}

void SolidJudge::visit(io::Archive& archive) {
  archive.common("judge", largest_gradient_, inertia_over_load_, largest_kinetic_, largest_strain_energy_,
                 audit_, energy_audit_, large_strain_, equilibrium_, buckling_told_, buckling_factor_,
                 compression_seen_, strain_told_, energy_told_);
  if (archive.reads()) latest_.reset();
}

}  // namespace couplet::solid
