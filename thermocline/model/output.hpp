// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "common/io/series.hpp"
#include "thermocline/model/model.hpp"

namespace couplet::thermocline {

/// tank.csv: a row a monitor interval. bed.csv, wall.csv, ground.csv: profiles, a row a cell, at output
/// times. Temperatures in degC.
class TankOutputFiles {
 public:
  TankOutputFiles(const TankModel& model, const std::filesystem::path& folder, double restart_time);
  void monitor(const TankModel& model, double time, const BedStep& last);
  void profiles(const TankModel& model, double time);

 private:
  /// When the next row is due behind one at this time [s].
  double after(double time) const;

  io::Series tank_, bed_;
  std::unique_ptr<io::Series> wall_, ground_;
  double interval_, next_ = 0;
};

}  // namespace couplet::thermocline
