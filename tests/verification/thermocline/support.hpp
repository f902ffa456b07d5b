// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/numbers.hpp"
#include "common/config/load.hpp"
#include "tests/support/csv.hpp"
#include "tests/support/test.hpp"
#include "thermocline/bed/packed_bed.hpp"
#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {

/// Columns of a file of reference data by name.
inline std::map<std::string, std::vector<double>> read_columns(const std::string& file) {
  return support::Csv(std::string(COUPLET_TEST_DATA) + "/" + file).columns();
}

inline Medium constant_fluid(double density, double specific_heat, double conductivity,
                             double viscosity = 1e-3) {
  return {"fluid", density, specific_heat, Curve(conductivity), Curve(viscosity), 1, 1e4};
}

/// One layer; conduction and film are constants.
inline BedParameters plain_bed(int cells, double height, double porosity, double diameter) {
  BedParameters p;
  p.cells = cells;
  p.layers = {{height, porosity, diameter}};
  p.closures.conduction = Conduction::constant;
  return p;
}

/// Fluid and all shells.
inline std::vector<double> temperatures_of(const PackedBed& bed) {
  std::vector<double> all(bed.fluid().begin(), bed.fluid().end());
  for (int j = 0; j < bed.shells(); ++j) all.insert(all.end(), bed.shell(j).begin(), bed.shell(j).end());
  return all;
}

/// Value at a height, linear between cell centres.
inline double value_at(const BedGrid& grid, std::span<const double> values, double z) {
  return Curve(grid.z, {values.begin(), values.end()})(z);
}

/// n steps of equal length up to `time`, no longer than the scheme allows.
inline int run(PackedBed& bed, double time, double mass_flow, double inlet, double longest = 1e300) {
  const double limit = std::min(longest, bed.largest_step(mass_flow));
  const int n = std::max(1, int(std::ceil(time / limit * (1 - 1e-12))));
  bed.prepare(time / n, mass_flow);
  for (int i = 0; i < n; ++i) bed.step(mass_flow, inlet);
  return n;
}

/// Of errors at doubled resolutions.
inline double slope(double coarse, double fine) { return std::log2(coarse / fine); }

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
  diagnostics::Diagnostics judged{0, diagnostics::When::with_errors};
  double time = 0;
};

}  // namespace couplet::thermocline
