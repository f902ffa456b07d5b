// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/numbers.hpp"
#include "common/config/load.hpp"
#include "thermocline/diagnostics/tank_diagnostic.hpp"

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

/// A tank without files, with its diagnostics.
struct TankRun {
  explicit TankRun(const TankParameters& p)
      : ambient(make_weather(p.ambient, ".")),
        control(make_flow_control(p.flow, make_fluid(p.fluid).specific_heat)),
        tank(std::make_shared<const TankSetup>(p), *ambient) {
    add_diagnostics({name, tank, happened, now, *ambient}, judged);
  }
  TankRun(const TankRun&) = delete;
  const TankModel& model() const { return tank; }
  void until(double end, double step) {
    while (time < end - 1e-6) {
      now = {time, std::min(step, end - time)};
      happened = tank.advance(time, now.dt, *control, *ambient);
      time += now.dt;
      judged.accepted(time);
    }
  }
  /// Findings with this id so far.
  std::vector<diagnostics::Finding> found(const std::string& id) {
    judged.look();
    std::vector<diagnostics::Finding> all;
    for (const diagnostics::Finding& f : judged.findings())
      if (f.id == id) all.push_back(f);
    return all;
  }
  std::unique_ptr<Weather> ambient;
  std::unique_ptr<FlowControl> control;
  TankModel tank;
  std::string name = "tank";
  coupling::Step now;
  TankStep happened;
  diagnostics::Diagnostics judged{0, true};
  double time = 0;
};

}  // namespace couplet::thermocline
