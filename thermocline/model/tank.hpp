// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/app/program.hpp"
#include "common/coupling/participant.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "thermocline/model/model.hpp"
#include "thermocline/model/output.hpp"
#include "thermocline/wall/mechanics.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::thermocline {

/// Stresses of the wall with the bending that the rings leave out, sampled every two hours.
struct BendingSeen {
  double rings = 0, shell = 0,
         shell_z = 0;  ///< largest hoop stress, as rings and with bending, and where [Pa], [m]
  double axial = 0, axial_z = 0, axial_time = 0;  ///< largest bending stress, where and when [Pa], [m], [s]
  YieldShares share;                              ///< largest shares of the yield strength so far
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(rings, shell, shell_z, axial, axial_z, axial_time, share.rings, share.shell);
  }
};

/// The tank as a participant: runs the elements that the YAML asks for. A tank is small, so every rank
/// computes all of it; rank 0 writes.
class Tank final : public coupling::Participant {
 public:
  Tank(const TankParameters& parameters, const app::ParticipantContext& context);

  coupling::Interface initialise() override;
  /// A flux of the ground elsewhere is held for a step: no longer than the lowest cell allows.
  double suggest_dt() override;
  void begin_step(const coupling::Step& step) override { step_ = step; }
  coupling::Exchange solve(const coupling::Exchange& in) override;
  coupling::StepReport accept_step() override;
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  /// Judges effects of the scene by the run so far.
  std::vector<diagnostics::Finding> effects() const;
  std::vector<std::string> finish() override;
  /// Upwind advection spreads a front as a diffusion v dz / 2 does, implicit steps as v^2 dt / 2: over the way w by
  /// s^2 = dz w and v dt w, which changes the profile by s^2 / 2 of its second derivative; w is what the largest flow
  /// can have gone since time 0, at most the height. The limited scheme is taken to spread by a cell. Over the
  /// profile's distance from its mean, sums over the height. Of a plant at least what of the storage the spreading leaves unused.
  diagnostics::ErrorParts error_parts() const;

  const TankModel& model() const { return accepted_; }
  const Speed& speed() const { return speed_; }
  void add_observer(std::unique_ptr<TankObserver> observer) { observers_.push_back(std::move(observer)); }

 private:
  TankRecord record() const;
  /// Reports each sentence as a finding of this tank.
  void report(const char* id, const std::vector<std::string>& sentences) const;
  void look_at_bending();
  void visit_seen(io::Archive& archive);
  diagnostics::ErrorParts spread_profile() const;
  double unused_by_spreading(double finer = 1) const;  // with so many times the cells
  coupling::Exchange given() const;
  std::vector<double> received(const coupling::Exchange& in, const char* name) const;

  std::string name_;
  std::unique_ptr<Weather> weather_;
  std::unique_ptr<FlowControl> control_;
  std::vector<std::unique_ptr<TankObserver>> observers_;
  TankModel accepted_, next_;
  std::vector<double> control_state_;  // that of accepted_
  MPI_Comm comm_;
  std::vector<BedStep> steps_;  // of next_
  coupling::Step step_;
  Speed speed_;
  double peak_advance_ = 0;                 // largest |m| dt of a step of the bed in this run [kg]
  double peak_flow_ = 0;                    // largest |m| of this run [kg/s]
  BendingSeen bending_;                     // of this run; only where the wall is of rings
  std::unique_ptr<TankOutputFiles> files_;  // on rank 0
  std::optional<WallInterface> wall_;
  // Last accepted step, for its record.
  std::vector<double> filler_;
  double stored_ = 0, side_ = 0, roof_ = 0, ground_ = 0;
};

}  // namespace couplet::thermocline
