// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/saved_numbers.hpp"
#include "thermocline/base/interfaces.hpp"
#include "thermocline/plant/plant.hpp"

namespace couplet::thermocline {

/// The plant decides what is pumped through the tank. Its memory is the process that runs.
class PlantControl final : public FlowControl {
 public:
  explicit PlantControl(const Plant& plant) : plant_(plant) {}

  Flow decide(double t, double t_top, double t_bottom, const Ambient& ambient) override;
  std::vector<double> state() const override { return {double(mode_)}; }
  void restore(std::span<const double> state) override {
    mode_ = PlantMode(base::SavedNumbers(state, "mode of the plant").count(2));
  }

  const Plant& plant() const { return plant_; }

 private:
  Plant plant_;
  PlantMode mode_ = PlantMode::standby;
};

}  // namespace couplet::thermocline
