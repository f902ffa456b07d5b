// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/mover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/diagnostics/results.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/cut_mesh.hpp"
#include "common/log/log.hpp"
#include "common/mesh/quality.hpp"
#include "common/parallel/collective.hpp"
#include "mesh_mover/barrier.hpp"
#include "mesh_mover/methods.hpp"

namespace couplet::mesh_mover {

namespace {

// Largest relative motion of the two sides of periodic patches, over their distance.
constexpr double most_torn = 1e-9;

mesh::LoadedMesh load_checked(const Parameters& parameters, const app::ParticipantContext& context) {
  std::map<std::string, std::string> partner_of;
  for (const auto& [name, boundary] : parameters.boundaries)
    if (boundary.motion == BoundaryMotion::periodic) partner_of[name] = boundary.partner;
  mesh::LoadedMesh loaded = io::load_mesh(context.comm, context.case_folder / parameters.mesh,
                                          parameters.dimension, parameters.mesh_parameters,
                                          mesh::periodic_pairs(partner_of), {}, false, parameters.mesh_scale);
  const mesh::Mesh& mesh = loaded.mesh;
  std::string patches;
  for (const mesh::Patch& p : mesh.patches) patches += (patches.empty() ? "'" : ", '") + p.name + "'";
  for (const auto& [name, boundary] : parameters.boundaries)
    if (!mesh.find_patch(name))
      throw Error("participants.{}.boundaries: the mesh has no patch '{}'; it has {}.", context.name, name,
                  patches);
  for (const mesh::Patch& p : mesh.patches)
    if (!parameters.boundaries.contains(p.name))
      throw Error(
          "participants.{}.boundaries: patch '{}' has no entry; give it type: interface, moving, fixed, slip, "
          "free or periodic.",
          context.name, p.name);
  if (const auto fold = mesh::find_fold(mesh, loaded.geometry))
    throw Error(
        "participants.{}.mesh: the mesh is folded at ({:.4g}, {:.4g}, {:.4g}) m: cell {} (counted from 0 in the file) lies on "
        "the wrong side of its face there. Cells overlap or are bent over; remesh there.",
        context.name, fold->centre.x(), fold->centre.y(), fold->centre.z(), fold->cell_id);
  return loaded;
}

std::vector<std::string> interface_patches(const Parameters& parameters) {
  std::vector<std::string> names;
  for (const auto& [name, boundary] : parameters.boundaries)
    if (boundary.motion == BoundaryMotion::interface) names.push_back(name);
  return names;
}

// Times at which prescribed motions are tested: one per five steps, which costs a fifth of the mesh motion.
constexpr int most_looks = 40;
constexpr double looks_per_step = 0.2;

}  // namespace

Mover::Mover(const Parameters& parameters, const app::ParticipantContext& context)
    : Mover(load_checked(parameters, context), parameters, context) {}

Mover::Mover(mesh::LoadedMesh loaded, const Parameters& parameters, const app::ParticipantContext& context)
    : name_(context.name),
      parameters_(parameters),
      mesh_(std::move(loaded.mesh)),
      geometry_(std::move(loaded.geometry)),
      periodic_(mesh_, geometry_),
      measures_(mesh_, geometry_, parameters),
      curved_(mesh_, geometry_, parameters),
      moving_(mesh_, geometry_, parameters),
      chooses_(parameters.method == Method::automatic && periodic_.empty()),
      interface_(mesh_, interface_patches(parameters)),
      displacement_(std::size_t(mesh_.points.n_local()) * mesh_.dim, 0.0),
      accepted_(displacement_) {
  if (!context.coupled && moving_.empty() && context.mesh_peer == MPI_COMM_NULL &&
      interface_patches(parameters).empty())
    log::warn("participant '{}': no patch moves (type: moving, or interface in a coupled job).", name_);
  choose_method(context.simulation);
  if (context.mesh_peer != MPI_COMM_NULL)
    sink_ = std::make_unique<coupling::MeshMotionSink>(context.mesh_peer, mesh_, geometry_.points);
  if (!context.coupled && !context.output_folder.empty())
    base::when_started([this, folder = context.output_folder, restart_time = context.restart_time] {
      fields_ = std::make_unique<io::FieldWriter>(mesh_, geometry_.points, folder, name_, true, restart_time);
    });
  if (parallel::comm_rank(mesh_.comm) != 0) return;
  std::vector<std::string> columns{"time [s]"};
  columns.insert(columns.end(), measure_names.begin(), measure_names.end());
  for (const char* column :
       {"cell with the least scaled Jacobian [-]", "its x [m]", "its y [m]", "its z [m]"})
    columns.push_back(column);
  quality_ =
      std::make_unique<io::Series>(context.output_folder / "quality.csv", columns, context.restart_time);
}

void Mover::make_method() {
  switch (parameters_.method) {
    case Method::laplacian:
    case Method::automatic:
      method_ = std::make_unique<Laplacian>(mesh_, geometry_, parameters_);
      break;
    case Method::pseudo_solid:
      method_ = make_pseudo_solid(mesh_, geometry_, parameters_);
      break;
    case Method::barrier:
      method_ = make_barrier(mesh_, geometry_, parameters_);
      break;
  }
}

coupling::Interface Mover::initialise() {
  coupling::Interface interface = interface_.describe(geometry_);
  // Declared on all ranks, even on rank 0 without a part of the interface.
  if (!interface_patches(parameters_).empty())
    interface.takes = {{"displacement", "m", coupling::Interface::Place::vertices}};
  return interface;
}

/// Returns to the Laplacian of the step before in a repeated step: a poor guess may have folded the mesh.
void Mover::begin_step(const coupling::Step& step) {
  step_ = step;
  if (!laplacian_) return;
  method_ = std::move(laplacian_);
  parameters_.method = Method::automatic;
}

/// dim values per local point, for points of moving patches.
std::vector<double> Mover::prescribed(const coupling::Exchange& in) const {
  const int dim = mesh_.dim;
  std::vector<double> values(displacement_.size(), 0.0);
  moving_.displace(step_.time + step_.dt, values);
  const auto given = in.find("displacement");
  const std::vector<double> at_interface =
      interface_.scatter_vertices(given == in.end() ? std::vector<double>{} : given->second, dim);
  for (std::size_t i = 0; i < interface_.points().size(); ++i)
    for (int c = 0; c < dim; ++c)
      values[std::size_t(interface_.points()[i]) * dim + c] = at_interface[i * dim + c];
  return values;
}

void Mover::place() {
  if (placed_) return;
  std::vector<Vec3> points = std::move(moved_.points);
  points = geometry_.points;
  for (std::size_t v = 0; v < points.size(); ++v)
    for (int c = 0; c < mesh_.dim; ++c) points[v][c] += displacement_[v * mesh_.dim + c];
  moved_ = mesh::compute_geometry(mesh_, std::move(points));
  placed_ = true;
}

/// Refuses a motion that differs between the two sides of periodic patches.
void Mover::refuse_torn() const {
  if (periodic_.empty()) return;
  const double gap = periodic_.largest_gap(displacement_, mesh_.dim);
  double size = 0;
  for (const Vec3& shift : mesh_.neighbour_shift) size = std::max(size, shift.norm());
  if (gap > most_torn * parallel::max(mesh_.comm, size))
    throw SolveFailure(
        "participant '{}': the motion from t = {:.6g} s separates the two sides of periodic patches by {:.3g} m: both must "
        "move identically.",
        name_, step_.time, gap);
}

/// Describes a problem of the mesh of displacement_; empty if there is none. Collective.
std::string Mover::place_and_check(bool by_corners) {
  placed_ = false;
  curved_.put_back(displacement_);
  refuse_torn();
  place();
  return measures_.refusal(moved_, by_corners);
}

/// Sets displacement_ and moved_.
void Mover::move(const coupling::Exchange& in) {
  const std::vector<double> wanted = prescribed(in);
  displacement_ = method_->solve(wanted);
  const bool may_change = chooses_ && parameters_.method == Method::automatic;
  std::string refusal = place_and_check(may_change && sound_);
  if (!refusal.empty() && may_change) {
    laplacian_ = std::move(method_);
    parameters_.method = Method::barrier;
    make_method();
    reason_ = fmt::format("the motion from t = {:.4g} s with laplacian {}", step_.time,
                          refusal.substr(0, std::min(refusal.find(". "), refusal.size() - 1)));
    const std::vector<double> by_laplacian = displacement_;
    try {
      displacement_ = method_->solve(wanted);
      refusal = place_and_check();
    } catch (const SolveFailure&) {
      displacement_ = by_laplacian;
      refusal = place_and_check();
      if (!refusal.empty()) throw;
      begin_step(step_);  // the boundaries themselves fold a corner, which is a finding
    }
  }
  if (!refusal.empty())
    throw SolveFailure(
        "participant '{}': the mesh motion from t = {:.6g} s {}{}", name_, step_.time, refusal,
        parameters_.method == Method::barrier
            ? ""
            : " 'method: barrier', to which 'auto' switches automatically, handles larger motions.");
}

coupling::Exchange Mover::solve(const coupling::Exchange& in) {
  try {
    move(in);
  } catch (const SolveFailure&) {
    if (sink_) sink_->send_failure();
    throw;
  }
  if (sink_) sink_->send(displacement_, moving_.velocities(step_.time + step_.dt, step_.dt));
  return {};
}

coupling::StepReport Mover::accept_step() {
  const coupling::StepReport report{.dt = step_.dt, .iterations = method_->last().iterations};
  accepted_ = displacement_;
  if (laplacian_) log_choice();
  laplacian_.reset();
  quality_now_ = state();
  const double jacobian = quality_now_.worst[MeshState::scaled_jacobian].value;
  least_jacobian_ = std::min(least_jacobian_.value_or(jacobian), jacobian);
  return report;
}

MeshState Mover::state() {
  place();
  return measures_.measure(moved_);
}

void Mover::save(io::CheckpointWriter& file) const {
  file.on(mesh_);
  file.write(mesh::Entries::points, "displacement", accepted_);
  io::Archive archive(file);
  bool by_barrier = parameters_.method == Method::barrier && !laplacian_;
  archive.common("barrier-in-force", by_barrier);
  (laplacian_ ? laplacian_ : method_)->visit(archive);
}

void Mover::load(io::CheckpointReader& file) {
  file.on(mesh_);
  file.read(mesh::Entries::points, "displacement", accepted_);
  displacement_ = accepted_;
  laplacian_.reset();
  io::Archive archive(file);
  bool by_barrier = false;
  archive.common("barrier-in-force", by_barrier);
  // A later end time includes more motions: then the barrier is used from here on, from the mesh as read.
  const bool begins = chooses_ && ahead_ && !by_barrier;
  const Method wanted = by_barrier || ahead_ ? Method::barrier : Method::automatic;
  if (chooses_ && (begins || parameters_.method != wanted)) {
    parameters_.method = wanted;
    make_method();
  }
  placed_ = false;
  if (!begins) method_->visit(archive);
}

void Mover::write_monitors(double time) {
  if (!quality_) return;
  std::vector<double> row{time};
  for (const Worst& worst : quality_now_.worst) row.push_back(worst.value);
  const Worst& worst = quality_now_.worst[MeshState::scaled_jacobian];
  row.insert(row.end(), {double(worst.cell), worst.place.x(), worst.place.y(), worst.place.z()});
  quality_->row(row);
}

std::vector<std::string> Mover::finish() {
  if (least_jacobian_ && parallel::comm_rank(mesh_.comm) == 0)
    diagnostics::set_result(
        {.name = "least scaled Jacobian of the run", .unit = "1", .values = {*least_jacobian_}, .rank = 2});
  return {};
}

void Mover::write_output(double time, int) {
  if (!fields_) return;
  place();
  using Place = io::OutputField::Place;
  const std::vector<double> volume = measures_.of_cells(MeshState::volume_ratio, moved_),
                            jacobian = measures_.of_cells(MeshState::scaled_jacobian, moved_),
                            edges = measures_.of_cells(MeshState::edge_ratio, moved_);
  fields_->write(time, moved_.points,
                 {{"displacement", "m", Place::points, mesh_.dim, displacement_},
                  {"volume-ratio", "1", Place::cells, 1, volume},
                  {"scaled-jacobian", "1", Place::cells, 1, jacobian},
                  {"edge-ratio", "1", Place::cells, 1, edges}});
}

void Mover::log_choice() const {
  if (parallel::comm_rank(mesh_.comm) == 0) log::info("auto: method: barrier ({})", reason_);
}

/// Tests the Laplacian at some times of the run.
void Mover::choose_method(const app::SimulationParameters& simulation) {
  if (!chooses_) {
    if (parameters_.method == Method::automatic && parallel::comm_rank(mesh_.comm) == 0)
      log::info("auto: method: laplacian (the barrier is not available with periodic patches)");
    return make_method();
  }
  sound_ = measures_.measure(geometry_).worst[MeshState::scaled_jacobian].value > 0;
  try {
    make_method();
  } catch (const Error& error) {  // on all ranks alike
    reason_ = error.what();
    reason_ = reason_.substr(0, reason_.find(". "));
  }
  const double steps = simulation.time_step > 0 ? simulation.end_time / simulation.time_step : most_looks;
  const int looks = static_cast<int>(std::clamp(std::ceil(looks_per_step * steps), 1.0, double(most_looks)));
  for (int i = 1; i <= looks && reason_.empty() && !moving_.empty(); ++i) {
    step_ = {.time = 0, .dt = simulation.end_time * i / looks};
    displacement_ = method_->solve(prescribed({}));
    const std::string refusal = place_and_check();
    if (!refusal.empty())
      reason_ = fmt::format("at t = {:.4g} s the prescribed motion with laplacian {}", step_.dt,
                            refusal.substr(0, std::min(refusal.find(". "), refusal.size() - 1)));
  }
  step_ = {};
  std::ranges::fill(displacement_, 0.0);
  placed_ = false;
  ahead_ = !reason_.empty();
  if (!ahead_) return;
  parameters_.method = Method::barrier;
  make_method();
  log_choice();
}

}  // namespace couplet::mesh_mover
