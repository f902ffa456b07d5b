// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/body/rigid_body.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/log/log.hpp"
#include "plate_modal/body/body_results.hpp"

namespace couplet::plate {
namespace {

/// Surface of the body from its mesh; empty if it has none.
BodySurface read_surface(const Parameters& p, const PlateContext& context, const mesh::RawMesh* raw) {
  BodySurface surface;
  surface.dimension = p.body->dimension;
  if (!raw && !p.mesh) return surface;
  mesh::on_root(context.comm, [&] {
    const std::string key = "participants." + context.name + ".body.surface";
    surface = surface_of(raw ? *raw : read_raw(p, context.case_folder, p.body->dimension), p.body->surface,
                         p.body->dimension, key);
  });
  return surface;
}

Vec3 gravity_of(const Parameters& p) {
  return p.gravity.empty() ? Vec3(Vec3::Zero()) : Vec3(p.gravity.data());
}

}  // namespace

RigidBody::RigidBody(Parameters parameters, PlateContext context, const mesh::RawMesh* raw)
    : parameters_(std::move(parameters)),
      context_(std::move(context)),
      surface_(read_surface(parameters_, context_, raw)),
      motion_(*parameters_.body, gravity_of(parameters_)) {
  for (const Vec3& x : surface_.centres) arms_.push_back(x - body().reference());
  state_ = trial_ = motion_.start(parameters_.initial_velocity);
  results_ = std::make_unique<BodyResults>(*this);
}

RigidBody::~RigidBody() = default;

coupling::Interface RigidBody::initialise() {
  coupling::Interface interface = surface_.describe();
  interface.takes = {{"pressure-force", "N", coupling::Interface::Place::faces},
                     {"viscous-force", "N", coupling::Interface::Place::faces}};
  interface.gives = {{"displacement", "m", coupling::Interface::Place::vertices},
                     {"velocity", "m/s", coupling::Interface::Place::vertices}};
  base::when_started([this] { results_->write_start(); });
  return interface;
}

/// Sums rank 0's forces on the faces for all ranks.
BodyLoad RigidBody::received(const coupling::Exchange& in) const {
  std::vector<double> sums(12, 0);
  mesh::on_root(context_.comm, [&] {
    BodyLoad load;
    const std::size_t dim = std::size_t(surface_.dimension);
    for (const char* name : {"pressure-force", "viscous-force"}) {
      const auto given = in.find(name);
      if (given == in.end() || given->second.empty()) continue;
      const std::vector<double>& force = given->second;
      if (force.size() != dim * arms_.size())
        throw Error(
            "The rigid body received {} force values, but its surface has {} faces with {} components.",
            force.size(), arms_.size(), dim);
      for (std::size_t f = 0; f < arms_.size(); ++f) {
        Vec3 one = Vec3::Zero();
        for (std::size_t c = 0; c < dim; ++c) one[Eigen::Index(c)] = force[dim * f + c];
        load.add(arms_[f], one);
      }
    }
    Eigen::Map<Vec3>(sums.data()) = load.force;
    Eigen::Map<Tensor3>(sums.data() + 3) = load.moment;
  });
  mesh::broadcast(context_.comm, sums);
  return {Vec3(sums.data()), Tensor3(sums.data() + 3)};
}

coupling::Exchange RigidBody::solve(const coupling::Exchange& in) {
  load_ = received(in);
  motion_.step(state_, step_.dt, load_, trial_);
  coupling::Exchange out;
  if (surface_.vertices.empty()) return out;
  out["displacement"] = displacements(trial_);
  out["velocity"] = velocities(trial_);
  return out;
}

std::vector<double> RigidBody::displacements(const BodyState& state) const {
  std::vector<double> values;
  values.reserve(surface_.vertices.size() * std::size_t(surface_.dimension));
  const Tensor3 turned = state.rotation() - Tensor3::Identity();
  for (const Vec3& x : surface_.vertices) {
    const Vec3 u = state.translation + turned * (x - body().reference());
    values.insert(values.end(), u.data(), u.data() + surface_.dimension);
  }
  return values;
}

std::vector<double> RigidBody::velocities(const BodyState& state) const {
  std::vector<double> values;
  values.reserve(surface_.vertices.size() * std::size_t(surface_.dimension));
  const Tensor3 rotation = state.rotation();
  const Vec3 speed = motion_.reference_velocity(state), omega = state.angular_velocity();
  for (const Vec3& x : surface_.vertices) {
    const Vec3 v = speed + omega.cross(rotation * (x - body().reference()));
    values.insert(values.end(), v.data(), v.data() + surface_.dimension);
  }
  return values;
}

coupling::StepReport RigidBody::accept_step() {
  std::swap(state_, trial_);
  Energies& e = state_.energies;
  e.largest = std::max(e.largest, e.own());
  return {.dt = step_.dt, .iterations = motion_.newton_iterations(), .energy = e.total()};
}

void RigidBody::save(io::CheckpointWriter& file) const {
  const_cast<RigidBody*>(this)->visit(io::Archive(file));  // writing changes nothing
}

void RigidBody::load(io::CheckpointReader& file) {
  visit(io::Archive(file));
  // A restart may change mass, springs, stops or gravity. The balance then starts from the energy in the new case.
  BodyState now = state_;
  motion_.set_energies(now);
  const Energies &kept = state_.energies, &e = now.energies;
  const double scale =
      std::abs(kept.kinetic) + std::abs(kept.strain) + std::abs(kept.gravity) + std::abs(kept.contact);
  const double jump = e.total() - kept.total();
  if (std::abs(jump) > 1e-9 * scale) {
    if (parallel::comm_rank(context_.comm) == 0)
      log::warn(
          "energy: with the changes of this restart the body holds {:.4g} J instead of {:.4g} J: this jump is not part of the balance.",
          e.total(), kept.total());
    now.energies.initial += jump;
    state_ = now;
  }
  trial_ = state_;
}

void RigidBody::visit(io::Archive archive) { archive.common("state", state_); }

void RigidBody::write_output(double time, int) { results_->write_fields(time); }
void RigidBody::write_monitors(double time) { results_->write_series(time); }

}  // namespace couplet::plate
