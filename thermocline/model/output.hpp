// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "thermocline/model/model.hpp"

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
  struct Place {
    const TankModel& m;
    double time;
    std::size_t i;
    std::span<const double> filler;  ///< mean temperature of the grains in the cells of the bed [K]
  };
  /// Time of the next row after this time [s].
  double after(double time) const;
  static std::vector<Quantity<Moment>> quantities_of(const TankModel& model);

  QuantityFile<Moment> tank_;
  QuantityFile<Place> bed_;
  std::optional<QuantityFile<Place>> wall_, ground_;
  double interval_, next_ = 0;
};

}  // namespace couplet::thermocline
