// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/mover.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/quality.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh_mover {
namespace {

Mesh load_checked(const Parameters& parameters, const ParticipantContext& context) {
  Mesh mesh = load_mesh(context.comm, context.case_folder / parameters.mesh, parameters.dimension,
                        parameters.mesh_parameters);
  std::string patches;
  for (const Patch& p : mesh.patches) patches += (patches.empty() ? "'" : ", '") + p.name + "'";
  for (const auto& [name, boundary] : parameters.boundaries)
    if (!mesh.find_patch(name))
      throw Error("participants.{}.boundaries: the mesh has no patch '{}'; it has {}.", context.name, name,
                  patches);
  for (const Patch& p : mesh.patches)
    if (!parameters.boundaries.contains(p.name))
      throw Error(
          "participants.{}.boundaries: patch '{}' has no entry; give it type: interface, fixed or slip.",
          context.name, p.name);
  return mesh;
}

std::vector<std::string> interface_patches(const Parameters& parameters) {
  std::vector<std::string> names;
  for (const auto& [name, boundary] : parameters.boundaries)
    if (boundary.motion == BoundaryMotion::interface) names.push_back(name);
  return names;
}

}  // namespace

Mover::Mover(const Parameters& parameters, const ParticipantContext& context)
    : name_(context.name),
      mesh_(load_checked(parameters, context)),
      smallest_volume_ratio_(parameters.smallest_volume_ratio),
      laplacian_(mesh_, parameters),
      interface_(mesh_, interface_patches(parameters)),
      displacement_(std::size_t(mesh_.points.n_local()) * mesh_.dim, 0.0) {
  if (context.mesh_peer != MPI_COMM_NULL) sink_ = make_mesh_motion_sink(context.mesh_peer, mesh_);
  if (comm_rank(mesh_.comm) == 0)
    quality_ = std::make_unique<Series>(context.output_folder / "quality.csv",
                                        std::vector<std::string>{"time [s]", "least volume ratio [1]"},
                                        context.restart_time);
}

Interface Mover::initialise() {
  Interface interface = interface_.describe();
  interface.takes = {{"displacement", "m", Interface::Place::vertices}};
  return interface;
}

void Mover::begin_step(const Step& step) { step_ = step; }

Exchange Mover::solve(const Exchange& in) {
  const int dim = mesh_.dim;
  const auto given = in.find("displacement");
  const std::vector<double> at_interface =
      interface_.scatter_vertices(given == in.end() ? std::vector<double>{} : given->second, dim);
  std::vector<double> prescribed(displacement_.size(), 0.0);
  for (std::size_t i = 0; i < interface_.points().size(); ++i)
    for (int c = 0; c < dim; ++c)
      prescribed[std::size_t(interface_.points()[i]) * dim + c] = at_interface[i * dim + c];
  try {
    displacement_ = laplacian_.solve(prescribed);
    std::vector<Vec3> points = mesh_.reference_points;
    for (std::size_t v = 0; v < points.size(); ++v)
      for (int c = 0; c < dim; ++c) points[v][c] += displacement_[v * dim + c];
    refuse_bad_cells(compute_geometry(mesh_, points));
  } catch (const SolveFailure&) {
    if (sink_) sink_->send_failure();
    throw;
  }
  if (sink_) sink_->send(displacement_);
  return {};
}

void Mover::refuse_bad_cells(const Geometry& moved) {
  if (const auto trouble = find_inverted(mesh_, moved))
    throw SolveFailure(
        "participant '{}': the mesh motion from t = {:.6g} s inverts cell {} at ({:.6g}, {:.6g}, {:.6g}) "
        "(volume {:.3e} "
        "m^3). Try a smaller step, more stiffening, or a coarser mesh there.",
        name_, step_.time, trouble->cell_id, trouble->centre.x(), trouble->centre.y(), trouble->centre.z(),
        trouble->volume);
  double least = 1e300;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    least = std::min(least, moved.volume[c] / mesh_.reference.volume[c]);
  least_volume_ratio_ = min(mesh_.comm, least);
  if (least_volume_ratio_ < smallest_volume_ratio_)
    throw SolveFailure(
        "participant '{}': the mesh motion from t = {:.6g} s leaves a cell {:.3g} of its volume; "
        "smallest-volume-ratio is "
        "{:.3g}.",
        name_, step_.time, least_volume_ratio_, smallest_volume_ratio_);
}

void Mover::save(CheckpointWriter& file) const {
  file.write("displacement", displacement_);
  file.write("cell-displacement", laplacian_.cell_displacement());
}

void Mover::load(CheckpointReader& file) {
  file.read("displacement", displacement_);
  file.read("cell-displacement", laplacian_.cell_displacement());
}

void Mover::write_monitors(double time) {
  if (quality_) quality_->row(std::vector<double>{time, least_volume_ratio_});
}

}  // namespace couplet::mesh_mover
