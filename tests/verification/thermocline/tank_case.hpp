// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/config/load.hpp"
#include "thermocline/model/tank.hpp"

namespace couplet::thermocline {

/// The tank of configs/thermocline-solar-one, read as the program reads it.
inline TankParameters solar_one_parameters() {
  TankParameters p;
  const auto document =
      config::Document::read(std::string(COUPLET_CONFIGS) + "/thermocline-solar-one/case.yaml");
  config::load_or_throw(document, "participants.tank", [&p](config::Section& s) {
    std::string program;
    s.value("program", program).required().doc("");
    declare(s, p);
  });
  return p;
}

/// A tank without files.
struct TankRun {
  explicit TankRun(const TankParameters& p)
      : ambient(make_weather(p.ambient, ".")),
        control(make_flow_control(p.flow, make_fluid(p.fluid).specific_heat)),
        tank(std::make_shared<const TankSetup>(p), *ambient) {}
  const TankModel& model() const { return tank; }
  void until(double end, double step) {
    while (time < end - 1e-6) {
      const double dt = std::min(step, end - time);
      steps.clear();
      tank.advance(time, dt, *control, *ambient, steps, speed);
      time += dt;
    }
  }
  std::unique_ptr<Weather> ambient;
  std::unique_ptr<FlowControl> control;
  TankModel tank;
  std::vector<BedStep> steps;
  Speed speed;
  double time = 0;
};

}  // namespace couplet::thermocline
