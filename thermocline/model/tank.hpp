// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "common/app/program.hpp"
#include "common/coupling/participant.hpp"
#include "thermocline/model/model.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::thermocline {

/// tank.csv: one row per monitor interval. bed.csv, wall.csv, ground.csv: profiles, one row per cell, at
/// output times. Temperatures in degC.
class TankOutputFiles {
 public:
  TankOutputFiles(const TankModel& model, const std::filesystem::path& folder, double restart_time);
  void monitor(const TankModel& model, double time, const BedStep& last);
  void profiles(const TankModel& model, double time);

 private:
  /// End of a step.
  struct Moment {
    const TankModel& m;
    double time;
    const BedStep& last;
  };
  /// Cell of the bed, ring of the wall or cell of the ground at an output time.
  struct CellMoment {
    const TankModel& m;
    double time;
    std::size_t i;
    std::span<const double> filler;  ///< mean temperature of the grains in the cells of the bed [K]
  };
  /// Time of the next row after this time [s].
  double after(double time) const;
  static std::vector<OutputColumn<Moment>> quantities_of(const TankModel& model);

  QuantityFile<Moment> tank_;
  QuantityFile<CellMoment> bed_;
  std::optional<QuantityFile<CellMoment>> wall_, ground_;
  double interval_, next_ = 0;
};

/// State of a tank run after the last accepted step, as diagnostics see it.
struct TankView {
  const std::string& name;
  const TankModel& model;
  const TankStep& happened;  ///< in that step
  const coupling::Step& step;
  const Weather& weather;
  const DayReport* report = nullptr;  ///< nullptr if the case requests none

  const TankParameters& parameters() const { return model.setup().parameters; }
  const Medium& fluid() const { return model.setup().fluid; }
  double time() const { return step.time + step.dt; }
};

/// Tank as a participant with the elements requested in the YAML file. A tank is small, so every rank
/// computes all of it; rank 0 writes.
class Tank final : public coupling::Participant {
 public:
  Tank(const TankParameters& parameters, const app::ParticipantContext& context);

  coupling::Interface initialise() override;
  /// Limited by the lowest cell, because the flux of an external ground is held for a step.
  double suggest_dt() override;
  void begin_step(const coupling::Step& step) override { step_ = step; }
  coupling::Exchange solve(const coupling::Exchange& in) override;
  coupling::StepReport accept_step() override;
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  std::vector<std::string> finish() override;

  const TankModel& model() const { return accepted_; }
  /// View for diagnostics. It refers to this tank, which must outlive it.
  TankView view() const { return {name_, accepted_, happened_, step_, *weather_, report_.get()}; }
  /// Record of the last accepted step, valid until the next solve().
  TankRecord record() const;

 private:
  /// Quantity taken by other participants, at the end of the step.
  struct GivenQuantity {
    const char *name, *unit;
    std::vector<double> values;
  };
  std::vector<GivenQuantity> given() const;
  std::vector<double> received(const coupling::Exchange& in, const char* name) const;
  void visit(io::Archive& archive);

  std::string name_;
  std::unique_ptr<Weather> weather_;
  std::unique_ptr<FlowControl> control_;
  TankModel accepted_, next_;  // next_: state before the accepted step, until the next solve()
  FlowMemory memory_;          // of accepted_
  MPI_Comm comm_;
  TankStep happened_;  // in the last solve()
  coupling::Step step_;
  std::unique_ptr<DayReport> report_;
  std::unique_ptr<TankOutputFiles> files_;  // on rank 0
  std::optional<WallInterface> wall_;
};

}  // namespace couplet::thermocline
