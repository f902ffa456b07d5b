// SPDX-License-Identifier: Apache-2.0
// Data of walls moved by other programs or a prescribed motion.
#include "fluid_solver/participant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/diagnostics/results.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/output/derived.hpp"
#include "fluid_solver/state/state.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

namespace {

/// Datum of the interface; empty if not given, as at the start.
std::vector<double> datum(const coupling::Exchange& in, const char* name) {
  const auto given = in.find(name);
  return given == in.end() ? std::vector<double>{} : given->second;
}

// Ratio of the number of sub-steps to the one last logged, or its inverse, that is logged again.
constexpr double most_times_as_many = 2;
// Number of sub-steps, and share of the cells that limit them, from which implicit convection may pay.
constexpr int many_sub_steps = 10;
constexpr double few_cells = 0.05;

bool holds_volume(const FluidParameters& p) { return p.volume_level == VolumeLevelBy::structure; }

}  // namespace

/// One value per corner of each face of the patch, at the end of the step. Call after receive_points().
template <int D>
std::vector<Vec3> FluidParticipant<D>::body_velocities(const mesh::Patch& patch) const {
  if (!prescribed_) {
    std::vector<Vec3> corners;
    const std::vector<double>& given = motion_->velocity();
    if (given.empty())
      throw Error("boundaries.{}: the mesh mover does not move this body: set 'type: moving' there.",
                  patch.name);
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      for (const Index v : mesh_.face_points[f]) {
        corners.push_back(Vec3::Zero());
        corners.back().template head<D>() = Eigen::Map<const Vec<D>>(given.data() + std::size_t(v) * D);
      }
    return corners;
  }
  return prescribed_->velocities(face_corners(mesh_, patch, fluid_->points_at_rest()), step_.time + step_.dt,
                                 step_.dt);
}

/// Velocity w of all moving walls, at a face the mean of its vertices, and their turn (see turn_of()). Both
/// are empty if no wall moves. Call after receive_points().
template <int D>
std::pair<Vectors<D>, Vectors<D>> FluidParticipant<D>::wall_motion(const coupling::Exchange& in) const {
  const bool coupled = interface_ && step_.scheme != coupling::Scheme::standalone;
  if (!coupled && !moves_bodies()) return {};
  Vectors<D> w(mesh_.boundary.n_owned(), Vec<D>::Zero()), turn = w;
  const std::vector<Vec3>& points = points_.empty() ? fluid_->points_at_rest() : points_;
  for (const mesh::Patch* patch : fluid_->boundary().body_patches()) {
    const std::vector<Vec3> velocities = body_velocities(*patch);
    set_face_means<D>(mesh_, *patch, velocities, w);
    set_turn<D>(mesh_, *patch, points, velocities, turn);
  }
  if (!coupled) return {w, turn};
  const std::vector<double> at_points = interface_->scatter_vertices(datum(in, "velocity"), D);
  const std::vector<Index>& faces = interface_->faces();
  std::vector<Vec3> corners, velocities;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    Vec<D>& mean = w[faces[i] - mesh_.n_interior];
    corners.clear();
    velocities.clear();
    for (const Index v : mesh_.face_points[faces[i]]) corners.push_back(points[v]);
    for (const Index v : interface_vertices_[static_cast<Index>(i)]) {
      velocities.push_back(Vec3::Zero());
      velocities.back().template head<D>() = Eigen::Map<const Vec<D>>(at_points.data() + std::size_t(v) * D);
      mean += velocities.back().template head<D>();
    }
    mean /= static_cast<double>(velocities.size());
    turn[faces[i] - mesh_.n_interior] = turn_of<D>(corners, velocities);
  }
  return {w, turn};
}

/// Pressure to which the structure has responded, per boundary face [Pa]; empty at the start.
template <int D>
std::vector<double> FluidParticipant<D>::wall_load(const coupling::Exchange& in) const {
  std::vector<double> load(mesh_.boundary.n_owned(), 0.);
  const std::vector<double> at_faces = interface_->scatter_faces(datum(in, "own-wall-force"), 1);
  const std::vector<Index>& faces = interface_->faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    load[faces[i] - mesh_.n_interior] = at_faces[i] / interface_area_[i].norm();
  return load;
}

/// Largest mean displacement of an interface face over the height of its cell. Collective.
template <int D>
double FluidParticipant<D>::wall_displacement(const coupling::Exchange& in) const {
  const std::vector<double> at_points = interface_->scatter_vertices(datum(in, "displacement"), D);
  const std::vector<Index>& faces = interface_->faces();
  double largest = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto vertices = interface_vertices_[static_cast<Index>(i)];
    Vec<D> mean = Vec<D>::Zero();
    for (const Index v : vertices) mean += Eigen::Map<const Vec<D>>(at_points.data() + std::size_t(v) * D);
    mean /= static_cast<double>(vertices.size());
    largest = std::max(largest, mean.norm() / cell_height_[i]);
  }
  return parallel::max(mesh_.comm, largest);
}

template <int D>
FluidParticipant<D>::FluidParticipant(mesh::LoadedMesh loaded, const FluidParameters& parameters,
                                      FluidContext context, const MotionLink& link)
    : mesh_(std::move(loaded.mesh)),
      fluid_(std::make_unique<Fluid<D>>(mesh_, loaded.geometry, parameters, bool(link) || parameters.motion)),
      loads_at_rest_(context.loads_at_rest),
      output_(*fluid_, loaded.geometry, std::move(context)) {
  if (link) motion_ = link(mesh_, fluid_->points_at_rest());
  set_up_motion();
  if (parameters.statistics) statistics_.emplace(mesh_.cells.n_local(), mesh_.boundary.n_owned());
  if (!fluid_->boundary().interface_patches().empty()) set_up_interface(loaded.geometry);
  std::vector<std::string> conjugate;
  for (const auto& [patch, boundary] : parameters.boundaries)
    if (boundary.conjugate) conjugate.push_back(patch);
  if (conjugate.empty()) return;
  conjugate_ = std::make_unique<coupling::InterfaceMap>(mesh_, conjugate);
  if (!interface_) description_ = conjugate_->describe(loaded.geometry);
}

template <int D>
void FluidParticipant<D>::set_up_interface(const mesh::Geometry& geometry) {
  interface_ = std::make_unique<coupling::InterfaceMap>(mesh_, fluid_->boundary().interface_patches());
  description_ = interface_->describe(geometry);
  const std::vector<Index>& points = interface_->points();
  std::vector<Index> row;
  for (const Index face : interface_->faces()) {
    row.clear();
    for (const Index point : mesh_.face_points[face])
      row.push_back(
          static_cast<Index>(std::lower_bound(points.begin(), points.end(), point) - points.begin()));
    interface_vertices_.push_row(row);
    interface_area_.push_back(geometry.face_area[face].template head<D>());
    const Vec3 arm = geometry.face_centre[face] - geometry.cell_centre[mesh_.owner[face]];
    cell_height_.push_back(2 * std::abs(arm.dot(geometry.face_area[face].normalized())));
  }
  structure_area_.assign(mesh_.boundary.n_owned(), Vec<D>::Zero());
  for (std::size_t i = 0; i < interface_area_.size(); ++i)
    structure_area_[interface_->faces()[i] - mesh_.n_interior] = interface_area_[i];
  trial_area_ = structure_area_;
}

template <int D>
void FluidParticipant<D>::set_up_motion() {
  const FluidParameters& parameters = fluid_->parameters();
  const auto& bodies = fluid_->boundary().body_patches();
  if (!parameters.motion) {
    if (!bodies.empty() && !motion_)
      throw Error(
          "boundaries.{}: a wall of type 'body' moves by the section 'motion' or with a mesh mover (`coupling.mesh`, "
          "where it has type 'moving' with its own 'motion'); both are missing.",
          bodies.front()->name);
    return;
  }
  if (motion_)
    throw Error(
        "motion: this fluid has a mesh mover, which already moves its mesh. Remove one of them; a wall that "
        "a mesh mover moves by itself ('type: moving' there) has type 'body' here.");
  prescribed_ = std::make_unique<fv::PrescribedMotion>(*parameters.motion, D);
  const double start = fluid_->state().time;
  const double largest =
      parallel::max(mesh_.comm, prescribed_->largest_displacement(fluid_->points_at_rest(), start));
  if (largest > 0)
    throw Error(
        "motion: at t = {:g} s it displaces the mesh by up to {:.3g} m, but the fluid starts from the "
        "reference configuration. Subtract the initial value, or multiply by a ramp.",
        start, largest);
}

template <int D>
coupling::Interface FluidParticipant<D>::initialise() {
  // This rank may have no part of the interface; the data are those of all ranks.
  coupling::Interface description = description_;
  using Place = coupling::Interface::Place;
  if (conjugate_) {
    description.takes = {{"film-coefficient", "W/(m^2 K)", Place::faces, 1},
                         {"ambient-temperature", "K", Place::faces, 1}};
    description.gives = {{"heat", "W", Place::faces, 1}};
  }
  if (!interface_) return description;
  for (const coupling::Interface::Datum& datum :
       {coupling::Interface::Datum{"displacement", "m", Place::vertices},
        {"velocity", "m/s", Place::vertices}})
    description.takes.push_back(datum);
  for (const coupling::Interface::Datum& datum :
       {coupling::Interface::Datum{"pressure-force", "N", Place::faces},
        {"viscous-force", "N", Place::faces}})
    description.gives.push_back(datum);
  if (yields()) {
    const coupling::Interface::Datum own{"own-wall-force", "N", Place::faces, 1};
    description.takes.push_back(own);
    description.gives.push_back(own);
  }
  if (holds_volume(fluid_->parameters())) description.gives.push_back({"inflow", "m^3/s", Place::faces, 2});
  return description;
}

/// Reports forces of the first step that are not caused by the flow.
template <int D>
void FluidParticipant<D>::log_impulse() const {
  const Boundary<D>& boundary = fluid_->boundary();
  if (boundary.body_patches().empty() || !prescribed_ || fluid_->state().start != Start::at_rest) return;
  Vectors<D> w(mesh_.boundary.n_owned()), no_turn;
  const double speed = set_body_start(mesh_, fluid_->points_at_rest(), boundary, *fluid_->parameters().motion,
                                      step_.time, w, no_turn);
  if (speed > 0 && parallel::comm_rank(mesh_.comm) == 0)
    log::warn(
        "motion: at t = {:g} s its bodies already move at {:.3g} m/s in a fluid at rest, so the first step is an impulse (its "
        "forces scale with one over the step). Let the motion start from rest (ramp), or set the fluid's 'initial-velocity'.",
        step_.time, speed);
}

template <int D>
void FluidParticipant<D>::begin_step(const coupling::Step& step) {
  if (conjugate_ && step.scheme == coupling::Scheme::standalone)
    throw Error(
        "The patches with 'conjugate: true' exchange heat with another participant, but this program runs alone: give them a "
        "'temperature', a 'heat-flux' or a 'film' instead.");
  if (step.number == 0 || holds_volume(fluid_->parameters())) check_cavity(*fluid_, step.scheme);
  step_ = step;
  if (interface_) {
    std::vector<Vec3> points = fluid_->state().points;
    keep_volume(*fluid_, points, step.time);
  }
  if (step.number == 0) log_impulse();
  judge_frozen_flow();
  predicted_ = renewed_now_ = false;
  fluid_->begin_step(step.time, step.dt);
}

template <int D>
std::vector<Vec3> FluidParticipant<D>::receive_points() {
  const double end = step_.time + step_.dt;
  std::vector<Vec3> points = fluid_->points_at_rest();
  if (prescribed_) {
    points = prescribed_->places(points, end);
  } else if (motion_) {
    const std::vector<double> displacement = motion_->receive();
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i].template head<D>() += Eigen::Map<const Vec<D>>(displacement.data() + i * D);
  } else {
    return {};
  }
  check_walls_at_rest<D>(*fluid_, points, end, step_.scheme != coupling::Scheme::standalone);
  if (!interface_) keep_volume(*fluid_, points, end);
  return points;
}

namespace {

/// Area vector of the face with these corners; in 2-D of an edge, 1 m deep.
template <int D>
Vec<D> area_of(const std::vector<Vec3>& places, std::span<const Index> corners) {
  const auto edge = [&](std::size_t k) { return Vec3(places[corners[k]] - places[corners[0]]); };
  if constexpr (D == 2) return edge(1).cross(Vec3::UnitZ()).template head<D>();
  Vec3 area = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) area += 0.5 * edge(k).cross(edge(k + 1));
  return area.template head<D>();
}

}  // namespace

/// Sets the area of the structure at the end of the step. That of a linear structure stays as it was at rest.
template <int D>
void FluidParticipant<D>::place_structure(const coupling::Exchange& in) {
  if (loads_at_rest_) return;
  const std::vector<double> u = interface_->scatter_vertices(datum(in, "displacement"), D);
  std::vector<Vec3> places;
  for (const Index point : interface_->points()) {
    const std::size_t first = places.size() * D;
    places.push_back(fluid_->points_at_rest()[point]);
    places.back().template head<D>() += Eigen::Map<const Vec<D>>(u.data() + first);
  }
  for (std::size_t i = 0; i < interface_area_.size(); ++i)
    trial_area_[interface_->faces()[i] - mesh_.n_interior] =
        area_of<D>(places, interface_vertices_[static_cast<Index>(i)]);
}

/// The pressure acts on the structure, from which the mesh of a guess differs. With their mean areas S' and S over the step,
///   F' = F + F.S/|S|^2 (S' - S)                                                                        (15a)
template <int D>
coupling::Exchange FluidParticipant<D>::forces() const {
  coupling::Exchange out;
  if (conjugate_) give_heat(out);
  if (!interface_) return out;
  const std::vector<Index>& faces = interface_->faces();
  const bool is_carried = !prescribed_ && step_.scheme != coupling::Scheme::standalone;
  std::vector<double> pressure(faces.size() * D), viscous(faces.size() * D);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Index b = faces[i] - mesh_.n_interior;
    Vec<D> force = fluid_->pressure_force()[b];
    const Vec<D> mean = 0.5 * (fluid_->state().placement->area[faces[i]] + fluid_->end().area[faces[i]]);
    const Vec<D> change = 0.5 * (structure_area_[b] + trial_area_[b]) - mean;
    if (is_carried) force += force.dot(mean) / mean.squaredNorm() * change;
    Eigen::Map<Vec<D>>(pressure.data() + i * D) = force;
    Eigen::Map<Vec<D>>(viscous.data() + i * D) = fluid_->viscous_force()[b];
  }
  out["pressure-force"] = interface_->gather_faces(pressure, D);
  out["viscous-force"] = interface_->gather_faces(viscous, D);
  if (yields()) {
    std::vector<double> wall(faces.size());
    for (std::size_t i = 0; i < faces.size(); ++i)
      wall[i] = fluid_->boundary_pressure()[faces[i] - mesh_.n_interior] * interface_area_[i].norm();
    out["own-wall-force"] = interface_->gather_faces(wall, 1);
  }
  if (holds_volume(fluid_->parameters()))
    out["inflow"] = interface_->gather_faces(inflow_shares(*fluid_, faces, step_.time, step_.dt), 2);
  return out;
}

/// Share of a change between passes that the pressure solver may leave. Passes of the semi-implicit scheme
/// start from the last one, so the rest decreases; those of the implicit scheme start from the beginning. The audit of
/// explicit coupling measures the response to a change and must resolve it (1 % more iterations).
template <int D>
double FluidParticipant<D>::answer() const {
  return !interface_ || step_.scheme == coupling::Scheme::standalone ? 0
         : step_.scheme == coupling::Scheme::semi_implicit           ? 0.1
                                                                     : 1e-3;
}

template <int D>
void FluidParticipant<D>::prepare(const Vectors<D>& w) {
  renewed_now_ = false;
  if (!predicted_) {
    fluid_->prepare(points_, w);
    renewal_.start(w);
    predicted_ = step_.scheme == coupling::Scheme::semi_implicit;
    return;
  }
  const auto [unseen, of_all] = fluid_->unseen_share(w);
  if (!renewal_.wanted(mesh_.comm, w, unseen, of_all)) {
    if (!conjugate_) return;
    // A film acts in all sub-steps; only the last one is still at hand.
    return fluid_->statistics().sub_steps > 1 ? fluid_->prepare(points_, renewal_.guess())
                                              : fluid_->repeat_heat();
  }
  renewed_now_ = true;
  fluid_->prepare(points_, renewal_.guess());
}

template <int D>
coupling::Exchange FluidParticipant<D>::solve(const coupling::Exchange& in) {
  if (!predicted_) points_ = receive_points();
  auto [w, turn] = wall_motion(in);
  if (yields() && step_.scheme != coupling::Scheme::standalone) {
    fluid_->yield_from(wall_load(in));
  }
  if (conjugate_) take_film(in);
  prepare(w);
  fluid_->set_turn(std::move(turn));
  fluid_->solve_pressure(w, answer());
  if (stands_still()) trial_displacement_ = wall_displacement(in);
  if (interface_) place_structure(in);
  return forces();
}

template <int D>
coupling::StepReport FluidParticipant<D>::accept_step() {
  const auto effort = [&] {
    return fluid_->statistics().pressure_iterations + fluid_->statistics().viscous_iterations;
  };
  const long before = effort();
  displacement_ = trial_displacement_;
  structure_area_.swap(trial_area_);
  fluid_->accept();
  log_sub_steps();
  if (statistics_ && fluid_->state().time > fluid_->parameters().statistics->start)
    statistics_->add(fluid_->state(), fluid_->pressure().get(), step_.dt);
  const double energy = fluid_->state().ledger.energy;
  const bool only_conducts = fluid_->heat() && energy == 0;  // a fluid at rest, but not without effect
  return {.dt = step_.dt,
          .iterations = effort() - before,
          .energy = only_conducts ? coupling::StepReport::unknown : energy};
}

template <int D>
void FluidParticipant<D>::save(io::CheckpointWriter& file) const {
  file.on(mesh_);
  write_state(file, fluid_->state());
  fluid_->solvers().save(file);
  if (interface_) file.write(mesh::Entries::owned_boundary, "structure-area", flat(structure_area_));
  // Writing changes nothing.
  if (statistics_) const_cast<RunningStatistics<D>&>(*statistics_).visit(io::Archive(file));
}

template <int D>
void FluidParticipant<D>::load(io::CheckpointReader& file) {
  file.on(mesh_);
  fluid_->restore(read_state<D>(file, mesh_, fluid_->moving() ? nullptr : fluid_->state().placement,
                                fluid_->parameters().heat.has_value()));
  fluid_->solvers().load(file);
  if (interface_) file.read(mesh::Entries::owned_boundary, "structure-area", flat(structure_area_));
  if (statistics_) statistics_->visit(io::Archive(file));
}

template <int D>
void FluidParticipant<D>::write_output(double time, int number) {
  const RunningStatistics<D>* statistics = statistics_ ? &*statistics_ : nullptr;
  std::optional<RunningStatistics<D>> none;
  if (statistics && !(statistics->duration() > 0))
    statistics =
        &none.emplace(RunningStatistics<D>::nothing_yet(statistics->cells(), mesh_.boundary.n_owned()));
  output_.write_fields(time, number, statistics);
  output_.write_surfaces(time);
  output_.write_samples(time, statistics);
}

template <int D>
void FluidParticipant<D>::write_monitors(double time) {
  output_.write_series(time);
}

template <int D>
std::vector<std::string> FluidParticipant<D>::finish() {
  const State<D>& s = fluid_->state();
  std::pair<double, Vec3> most{0, Vec3::Zero()};
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    if (const double speed = s.u[c].norm(); speed > most.first) {
      most.first = speed;
      most.second.template head<D>() = s.placement->centre[c];
    }
  diagnostics::set_largest(mesh_.comm, "largest speed", "m/s", most.first, most.second);
  if (!statistics_ || statistics_->duration() > 0) return {};
  return {fmt::format("Running statistics start at t = {:g} s, but this run ended before: there are none.",
                      fluid_->parameters().statistics->start)};
}

/// Logs the number of sub-steps, with the limiting cell, if it has changed much since the last entry.
template <int D>
void FluidParticipant<D>::log_sub_steps() {
  const int now = fluid_->statistics().sub_steps;
  const bool as_told =
      now < most_times_as_many * told_sub_steps_ && told_sub_steps_ < most_times_as_many * now;
  if (as_told) return;
  told_sub_steps_ = now;
  const double end = step_.time + step_.dt;
  if (const auto own = fluid_->parameters().time_step) {
    if (parallel::comm_rank(mesh_.comm) == 0)
      log::info("t = {:.6g} s: {} sub-steps of {:.3g} s: time-step is {:.3g} s", end, now, step_.dt / now,
                *own);
    return;
  }
  const StepLimiter limiter = fluid_->sizes().limiter(fluid_->state());
  const FluidParameters& p = fluid_->parameters();
  // Implicit convection lets the sub-steps follow from the other cells.
  const bool few =
      now >= many_sub_steps && limiter.share < few_cells && !limiter.friction && !limiter.frame && !p.courant;
  if (parallel::comm_rank(mesh_.comm) == 0)
    log::info(
        "t = {:.6g} s: {} sub-steps of {:.3g} s, which are {:.0f} % of the stability limit of {} in cell {} at "
        "({:.4g}, {:.4g}, {:.4g}) m{}",
        end, now, step_.dt / now, 100 * p.safety_factor, limiter.cause(), limiter.cell, limiter.place.x(),
        limiter.place.y(), limiter.place.z(),
        few ? fmt::format(
                  "; only {:.2g} % of the cells have a limit below twice that: 'courant: 5' would save sub-steps",
                  100 * limiter.share)
            : "");
}

template class FluidParticipant<2>;
template class FluidParticipant<3>;

void add_diagnostics(const coupling::Participant& participant, diagnostics::Diagnostics& all) {
  if (const auto* flat = dynamic_cast<const FluidParticipant<2>*>(&participant))
    add_diagnostics(flat->view(), all);
  else
    add_diagnostics(dynamic_cast<const FluidParticipant<3>&>(participant).view(), all);
}

std::unique_ptr<coupling::Participant> make_participant(mesh::LoadedMesh loaded,
                                                        const FluidParameters& parameters,
                                                        FluidContext context, const MotionLink& link) {
  if (parameters.dimension == 2)
    return std::make_unique<FluidParticipant<2>>(std::move(loaded), parameters, std::move(context), link);
  return std::make_unique<FluidParticipant<3>>(std::move(loaded), parameters, std::move(context), link);
}

}  // namespace couplet::fluid
