// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/model.hpp"
#include "common/config/load.hpp"
#include "tests/support/test.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline::table_5_3_test {

/// Table 5.3 of the thesis: tonnes and MWh.
struct Column {
  const char *name, *folder;
  double diameter;
  double filler, fluid, filler_capacity, fluid_capacity, capacity;
};
class Table53 : public testing::TestWithParam<Column> {};

TEST_P(Table53, masses_and_capacities_of_the_cases_are_the_published_ones) {
  const Column& c = GetParam();
  TankParameters p;
  config::Document document =
      config::Document::read(std::string(COUPLET_CONFIGS) + "/" + c.folder + "/case.yaml");
  document.set("participants.tank.diameter=" + std::to_string(c.diameter));
  config::load_or_throw(document, "participants.tank", [&p](config::Section& s) {
    std::string program;
    s.value("program", program).required().doc("");
    declare(s, p);
  });
  const TankSetup setup(p);
  double liquid = 0, solid = 0;  // [m^3]
  for (const BedGrid::Run& run : setup.grid.runs)
    for (int i = run.first; i < run.first + run.count; ++i) {
      const double volume = M_PI / 4 * p.diameter * p.diameter * setup.grid.dz[std::size_t(i)];
      liquid += run.layer.porosity * volume;
      solid += (1 - run.layer.porosity) * volume;
    }
  const double span = p.flow.plant.hot - p.flow.plant.cold, megawatt_hour = 3.6e9;
  const PackedBed bed(p.bed, setup.fluid, setup.filler, p.diameter);
  const std::pair<double, double> pairs[] = {
      {solid * setup.filler.density / 1000, c.filler},
      {liquid * setup.fluid.density / 1000, c.fluid},
      {solid * setup.filler.volumetric(300) * span / megawatt_hour, c.filler_capacity},
      {liquid * setup.fluid.volumetric() * span / megawatt_hour, c.fluid_capacity},
      {bed.heat_capacity() * span / megawatt_hour, c.capacity}};
  double worst = 0;
  for (const auto& [ours, published] : pairs) {
    EXPECT_NEAR(ours, published, 0.005 * published);
    worst = std::max(worst, std::abs(ours / published - 1));
  }
  RecordProperty("worst", std::to_string(worst));
}

INSTANTIATE_TEST_SUITE_P(
    Thesis, Table53,
    testing::Values(Column{"A_11", "thermocline-andasol", 1.1 * 38, 35758, 8487, 994, 354, 1348},
                    Column{"A_10", "thermocline-andasol", 38, 29552, 7014, 821, 293, 1114},
                    Column{"G_085", "thermocline-gemasolar", 0.85 * 23, 6242, 1481, 477, 170, 647},
                    Column{"G_10", "thermocline-gemasolar", 23, 8639, 2050, 660, 235, 895}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace couplet::thermocline::table_5_3_test
