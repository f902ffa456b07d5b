// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/diagnostics/diagnostics.hpp"
#include "common/io/checkpoint.hpp"
#include "plate_modal/body/body_motion.hpp"
#include "plate_modal/body/body_surface.hpp"
#include "plate_modal/model/build_model.hpp"

namespace couplet::plate {

class BodyResults;

/// Rigid body as a participant. It takes forces on the faces of its surface and gives displacement and velocity of its vertices.
/// Rank 0 has the surface and sums the forces; every rank computes the same motion.
class RigidBody final : public coupling::Participant {
 public:
  /// `raw`: mesh on rank 0 instead of the mesh in the parameters. Collective.
  RigidBody(Parameters parameters, PlateContext context, const mesh::RawMesh* raw = nullptr);
  ~RigidBody() override;

  coupling::Interface initialise() override;
  void begin_step(const coupling::Step& step) override { step_ = step; }
  coupling::Exchange solve(const coupling::Exchange& in) override;
  coupling::StepReport accept_step() override;
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;

  const Parameters& parameters() const { return parameters_; }
  const BodyParameters& body() const { return *parameters_.body; }
  const PlateContext& context() const { return context_; }
  const BodySurface& surface() const { return surface_; }
  const BodyMotion& motion() const { return motion_; }
  const BodyState& before() const { return trial_; }  ///< after accept_step(): at the start of that step
  const BodyState& state() const { return state_; }
  /// Force and moment about the reference point of a partner, mean over the last accepted step [N], [N m].
  const BodyLoad& load() const { return load_; }
  /// Displacements [m] or velocities [m/s] of the vertices, one per dimension.
  std::vector<double> displacements(const BodyState& state) const;
  std::vector<double> velocities(const BodyState& state) const;

 private:
  BodyLoad received(const coupling::Exchange& in) const;
  void visit(io::Archive archive);

  Parameters parameters_;
  PlateContext context_;
  BodySurface surface_;     // on rank 0
  std::vector<Vec3> arms_;  // from the reference point to the faces at the start [m]
  BodyMotion motion_;
  BodyState state_, trial_;
  BodyLoad load_;
  coupling::Step step_;
  std::unique_ptr<BodyResults> results_;
};

/// Adds the diagnostics of a body, which it must outlive.
void add_diagnostics(const RigidBody& body, diagnostics::Diagnostics& all);

}  // namespace couplet::plate
