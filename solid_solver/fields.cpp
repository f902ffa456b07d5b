// SPDX-License-Identifier: Apache-2.0
// What can be derived from the accepted state: point values, stresses, forces, and the state itself on file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/numbering.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/effect_cards.hpp"
#include "solid_solver/output.hpp"
#include "solid_solver/solid.hpp"
#include "solid_solver/system.hpp"

namespace couplet {
namespace {

template <int D>
void interpolate(const ElasticOperator& elastic, std::span<const Index> points, std::span<const double> cells,
                 std::span<const double> faces, std::span<const double> known, std::span<double> values) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const VertexConstraints& constraints = elastic.constraints();
    Vec<D> value = Vec<D>::Zero();
    if (!constraints.is_fixed(points[i])) {
      value = elastic.vertices().template scalar_at<D>(points[i], cells, faces);
      if (constraints.is_constrained(points[i]))
        value = constraints.free_part(points[i]).template topLeftCorner<D, D>() * value;
    }
    if (const Index column = constraints.column(points[i]); column >= 0)
      value += Eigen::Map<const Vec<D>>(known.data() + std::size_t(column) * D);
    for (int a = 0; a < D; ++a) values[i * D + a] = value[a];
  }
}

std::vector<double> at_points(const Mesh& mesh, const ElasticOperator& elastic, std::span<const Index> points,
                              std::span<const double> cells, std::span<const double> faces,
                              std::span<const double> known) {
  std::vector<double> values(points.size() * mesh.dim);
  if (mesh.dim == 2)
    interpolate<2>(elastic, points, cells, faces, known, values);
  else
    interpolate<3>(elastic, points, cells, faces, known, values);
  return values;
}

}  // namespace

Exchange Solid::interface_values() const {
  if (!interface_) return {};
  const auto& points = interface_->points();
  Exchange out;
  out["displacement"] = interface_->gather_vertices(
      at_points(mesh_, elastic_, points, trial_.cell_u, trial_.face_u, known_), mesh_.dim);
  out["velocity"] = interface_->gather_vertices(
      at_points(mesh_, elastic_, points, trial_.cell_v, trial_.face_v, known_rate_), mesh_.dim);
  return out;
}

std::vector<double> Solid::to_points(std::span<const double> cells, std::span<const double> faces,
                                     std::span<const double> known) const {
  if (!is_thesis()) return corrected_points(cells, faces, known);
  std::vector<Index> all(mesh_.points.n_local());
  for (Index v = 0; v < mesh_.points.n_local(); ++v) all[v] = v;
  std::vector<double> values = at_points(mesh_, elastic_, all, cells, faces, known);
  mesh_.points.update_ghosts(values, mesh_.dim);
  return values;
}

std::vector<double> Solid::point_displacement() const {
  return to_points(state_.cell_u, state_.face_u, known_accepted_);
}

std::vector<double> Solid::point_velocity() const {
  return to_points(state_.cell_v, state_.face_v, known_rate_accepted_);
}

std::vector<double> Solid::point_acceleration() const {
  return to_points(state_.acceleration, state_.face_acceleration, known_acceleration());
}

std::vector<PatchForce> Solid::reactions(std::span<const double> points) const {
  std::vector<PatchForce> forces;
  if (kernel_.is_symmetric()) {
    const std::vector<double> u = unknowns_of(state_.cell_u, state_.face_u);
    if (finite_) finite_->kernel().set_pressure(boundaries_.pressures(state_.time));
    const std::vector<Vec3> held = finite_ ? finite_->kernel().holding_forces(u, known_accepted_, loads_now())
                                           : kernel_.holding_forces(u, known_accepted_, loads_now());
    for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
      if (!boundaries_.holds(p)) continue;
      Vec3 force = held[p];
      for (int a = 0; a < 3; ++a) force[a] = sum(mesh_.comm, force[a]);
      forces.push_back({mesh_.patches[p].name, force});
    }
    return forces;
  }
  // One pass over the faces between the first and the last that is held, often few of the boundary's.
  Index first = mesh_.n_flux_faces(), end = mesh_.n_interior;
  for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
    const Patch& patch = mesh_.patches[p];
    if (!boundaries_.holds(p) || patch.count == 0) continue;
    first = std::min(first, patch.first);
    end = std::max(end, patch.first + patch.count);
  }
  const std::vector<Tensor3> stress = face_stress(first, std::max<Index>(end - first, 0), points);
  for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
    if (!boundaries_.holds(p)) continue;
    const Patch& patch = mesh_.patches[p];
    Vec3 force = Vec3::Zero();
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      force += elastic_.holding_force(f, stress[f - first], state_.face_u, known_accepted_);
    for (int a = 0; a < 3; ++a) force[a] = sum(mesh_.comm, force[a]);
    forces.push_back({mesh_.patches[p].name, force});
  }
  return forces;
}

/// At the accepted time; of the interface what it had in the last solve.
ElasticLoads Solid::loads_now() const {
  ElasticLoads loads;
  loads.faces.assign(std::size_t(mesh_.boundary.n_owned()) * mesh_.dim, 0);
  boundaries_.add_forces(state_.time, loads.faces, !finite_);
  for (std::size_t i = 0; i < last_interface_load_.size(); ++i) loads.faces[i] += last_interface_load_[i];
  loads.cells = body_forces(state_.time);
  for (const auto& effect : effects_) {
    const std::vector<double> pressure = effect->pressure(state_.time);
    if (loads.pressure.empty()) loads.pressure.resize(pressure.size(), 0);
    for (std::size_t i = 0; i < pressure.size(); ++i) loads.pressure[i] += pressure[i];
  }
  return loads;
}

Vec3 Solid::total_load() const {
  Vec3 load = body_load_ + face_load_;
  if (finite_) load += finite_->kernel().pressure_force();
  for (int a = 0; a < 3; ++a) load[a] = sum(mesh_.comm, load[a]);
  return load;
}

double Solid::largest_gradient(std::span<const double> points) const {
  return deformation(points).largest_gradient;
}

SolidEvidence Solid::deformation(std::span<const double> points) const {
  double gradient = 0, strain = 0, rotation = 0;
  visit_gradients(state_.cell_u, state_.face_u, points, [&](Index, const Tensor3& g) {
    gradient = std::max(gradient, g.squaredNorm());
    strain = std::max(strain, (0.5 * (g + g.transpose())).squaredNorm());
    rotation = std::max(rotation, (0.5 * (g - g.transpose())).squaredNorm());
  });
  // The skew part of a rotation by a small angle phi holds phi twice.
  return {.largest_gradient = max(mesh_.comm, std::sqrt(gradient)),
          .largest_strain = max(mesh_.comm, std::sqrt(strain)),
          .largest_rotation = max(mesh_.comm, std::sqrt(rotation / 2))};
}

/// Largest equivalent stress (von Mises) over the yield strength, where that is known; else NaN. Collective.
double Solid::share_of_yield(std::span<const double> points) const {
  if (std::ranges::none_of(materials_, [](const SolidMaterial& m) { return m.yield_strength.has_value(); }))
    return SolidEvidence::unknown;
  const std::vector<Tensor3> stress = face_stress(0, mesh_.n_flux_faces(), points);
  double share = 0;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const auto& yield = materials_[mesh_.material_of(mesh_.owner[f])].yield_strength;
    if (!yield) continue;
    const Tensor3 deviator = stress[f] - stress[f].trace() / 3 * Tensor3::Identity();
    share = std::max(share, std::sqrt(1.5) * deviator.norm() / *yield);
  }
  return max(mesh_.comm, share);
}

void Solid::judge_inertia() {
  if (state_.steps < 1) return;
  const int dim = mesh_.dim;
  Vec3 inertia = Vec3::Zero();
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    for (int a = 0; a < dim; ++a) {
      const std::size_t i = std::size_t(c) * dim + a;
      inertia[a] += density(c) * mesh_.reference.volume[c] * (trial_.cell_v[i] - state_.cell_v[i]) /
                    (0.5 * (trial_.dt + state_.dt));
    }
  for (int a = 0; a < dim; ++a) inertia[a] = sum(mesh_.comm, inertia[a]);
  const double load = total_load().norm();
  if (load > 0) inertia_over_load_ = std::max(inertia_over_load_, inertia.norm() / load);
}

std::vector<EffectVerdict> Solid::audit() const {
  const std::vector<double> points = point_displacement();
  SolidEvidence evidence = deformation(points);
  evidence.share_of_yield = share_of_yield(points);
  evidence.largest_gradient = std::max(largest_gradient_, evidence.largest_gradient);
  if (!is_dynamic() && state_.steps > 1) evidence.inertia_over_load = inertia_over_load_;
  for (const auto& effect : effects_) effect->add_evidence(evidence);
  return couplet::audit(solid_effect_cards(), parameters_, evidence);
}

std::vector<std::string> Solid::finish() {
  std::vector<std::string> sentences;
  if (is_dynamic()) audit_answer();
  if (audit_)
    sentences.push_back(fmt::format("error indicator: {}{}.", audit_->text(),
                                    audit_->is_doubtful() ? "; NOT to be trusted" : ""));
  if (energy_audit_.scale > 0) sentences.push_back(fmt::format("energy balance: {}.", energy_audit_.text()));
  if (is_dynamic() && !parameters_.damping && !kernel_.is_symmetric())
    sentences.push_back(
        "structural damping left out: free vibration does not decay, and modes that the time step resolves "
        "may grow; a "
        "little 'damping: {stiffness: ...}' or 'time-scheme: {type: bathe}' would stop that, 'output: "
        "{spectrum: true}' "
        "tells the rate on a coarse mesh of the same kind.");
  for (const auto& effect : effects_) effect->judge(sentences);
  return sentences;
}

void Solid::write_output(double time, int) {
  const std::vector<double> points = point_displacement();
  largest_gradient_ = std::max(largest_gradient_, largest_gradient(points));
  if (is_dynamic()) audit_answer();
  output_->write_fields(time, points);
}

void Solid::write_monitors(double time) {
  if (is_dynamic() && parameters_.output.energies)
    audit_answer();  // growth may come and go between two outputs
  output_->write_series(time, point_displacement());
}

void Solid::save(CheckpointWriter& file) const {
  write_numbering(file, mesh_);
  file.write("cell-displacement", state_.cell_u);
  file.write("cell-velocity", state_.cell_v);
  if (!state_.cell_a.empty()) file.write("cell-acceleration", state_.cell_a);
  if (has_mass_) {
    if (!state_.face_a.empty()) file.write("nodes-face-acceleration", state_.face_a);
    if (!state_.face_u_old.empty()) {
      file.write("old-face-displacement", state_.face_u_old);
      file.write("old-face-velocity", state_.face_v_old);
    }
  }
  if (!state_.acceleration.empty()) {
    file.write("acceleration", state_.acceleration);
    file.write("mean-acceleration", state_.mean_acceleration);
    file.write("face-acceleration", state_.face_acceleration);
  }
  if (!state_.cell_u_old.empty()) {
    file.write("old-cell-displacement", state_.cell_u_old);
    file.write("old-cell-velocity", state_.cell_v_old);
  }
  file.write("face-displacement", state_.face_u);
  file.write("face-velocity", state_.face_v);
  file.write("face-offset", state_.offset);
  file.write("face-offset-rate", state_.offset_rate);
  file.write("known-displacement", known_accepted_);
  file.write("known-rate", known_rate_accepted_);
  file.write_scalar("time", state_.time);
  if (parameters_.output.energies) {
    const SolidEnergies& e = state_.energies;
    file.write("energies", std::vector<double>{e.kinetic, e.initial_kinetic, e.internal_work, e.external_work,
                                               e.damping_loss});
  }
  if (is_dynamic())
    file.write("load-work", std::vector<double>{state_.load_work, state_.energies.initial_kinetic});
  file.write_scalar("audit-scale", energy_audit_.scale);
  if (parameters_.step_control) file.write_scalar("error", state_.error);
  file.write_scalar("dt", state_.dt);
  file.write_scalar("stage-dt", state_.stage_dt);
  file.write_scalar("offset-lag", state_.offset_lag);
  file.write_scalar("steps", state_.steps);
  file.write_scalar("largest-gradient", largest_gradient_);
  file.write_scalar("inertia-over-load", inertia_over_load_);
  for (const auto& effect : effects_) effect->save(file);
  save_projections(file);
}

/// First guesses decide what is left below the tolerance: a run that continues makes the same ones.
void Solid::save_projections(CheckpointWriter& file) const {
  std::vector<double> factors;
  for (const auto& system : systems_) {
    const ResidualProjection* projection = projection_of(*system);
    if (!projection) continue;
    file.write(fmt::format("projection-{}", factors.size()), projection->values());
    factors.push_back(system->mass_factor);
  }
  file.write_scalar("projections", double(factors.size()));
  for (std::size_t i = 0; i < factors.size(); ++i)
    file.write_scalar(fmt::format("projection-{}-mass-factor", i), factors[i]);
}

void Solid::load_projections(CheckpointReader& file) {
  for (int i = static_cast<int>(file.read_scalar("projections")); i-- > 0;) {
    System& system = system_for(file.read_scalar(fmt::format("projection-{}-mass-factor", i)));
    const SolidProblem problem = problem_of(system);
    const auto apply = [&](std::span<const double> x, std::span<double> y) { problem.apply(x, y); };
    if (ResidualProjection* projection = projection_of(system))
      projection->set_values(file.read(fmt::format("projection-{}", i)), apply);
  }
}

void Solid::load(CheckpointReader& file) {
  check_numbering(file, mesh_);
  file.read("cell-displacement", state_.cell_u);
  file.read("cell-velocity", state_.cell_v);
  if (!state_.cell_a.empty()) file.read("cell-acceleration", state_.cell_a);
  if (has_mass_) {
    if (!state_.face_a.empty()) file.read("nodes-face-acceleration", state_.face_a);
    if (!state_.face_u_old.empty()) {
      file.read("old-face-displacement", state_.face_u_old);
      file.read("old-face-velocity", state_.face_v_old);
    }
  }
  if (!state_.acceleration.empty()) {
    file.read("acceleration", state_.acceleration);
    file.read("mean-acceleration", state_.mean_acceleration);
    file.read("face-acceleration", state_.face_acceleration);
  }
  if (!state_.cell_u_old.empty()) {
    file.read("old-cell-displacement", state_.cell_u_old);
    file.read("old-cell-velocity", state_.cell_v_old);
  }
  file.read("face-displacement", state_.face_u);
  file.read("face-velocity", state_.face_v);
  file.read("face-offset", state_.offset);
  file.read("face-offset-rate", state_.offset_rate);
  file.read("known-displacement", known_accepted_);
  file.read("known-rate", known_rate_accepted_);
  state_.time = file.read_scalar("time");
  if (parameters_.output.energies) {
    const std::vector<double> e = file.read("energies");
    state_.energies = {e.at(0), e.at(1), 0, e.at(2), e.at(3), e.at(4)};
  }
  if (is_dynamic()) {
    const std::vector<double> work = file.read("load-work");
    state_.load_work = work.at(0);
    state_.energies.initial_kinetic = work.at(1);
  }
  energy_audit_.scale = file.read_scalar("audit-scale");
  if (parameters_.step_control) state_.error = file.read_scalar("error");
  state_.dt = file.read_scalar("dt");
  state_.stage_dt = file.read_scalar("stage-dt");
  state_.offset_lag = file.read_scalar("offset-lag");
  state_.steps = static_cast<int>(file.read_scalar("steps"));
  largest_gradient_ = file.read_scalar("largest-gradient");
  inertia_over_load_ = file.read_scalar("inertia-over-load");
  for (const auto& effect : effects_) effect->load(file);
  apply_stiffness();
  load_projections(file);
}

}  // namespace couplet
