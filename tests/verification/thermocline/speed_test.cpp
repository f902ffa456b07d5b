// SPDX-License-Identifier: Apache-2.0
// Cost of the bed: nanoseconds per cell-step, and how it grows with the number of cells.
#include "tests/verification/thermocline/support.hpp"

namespace couplet::thermocline::speed_test {

/// Best of many short runs: what other processes take is left out [s per cell and step].
double cost(int cells, Advection advection) {
  BedParameters p = plain_bed(cells, 13, 0.22, 0.0046);
  p.closures.conduction = Conduction::wakao;
  p.advection = advection;
  p.initial_temperature = 563;
  PackedBed bed(p, solar_salt(), Filler{}, 40);
  const int steps = std::max(5, 200000 / cells);
  bed.prepare(std::min(60.0, bed.largest_step(-500)), -500);
  double best = 1e300;
  for (int repeat = 0; repeat < 60; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < steps; ++i) bed.step(-500, 663);
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best / steps / cells;
}

TEST(Speed, cost_is_linear_in_the_number_of_cells) {
  for (const auto& [name, advection] :
       {std::pair{"upwind", Advection::upwind}, std::pair{"tvd", Advection::tvd},
        std::pair{"implicit", Advection::implicit}}) {
    double few = 1e300, many = 1e300, exponent = 2;
    for (int attempt = 0; attempt < 4 && exponent > 1.05; ++attempt) {
      few = std::min(few, cost(500, advection)), many = std::min(many, cost(8000, advection));
      exponent = 1 + std::log(many / few) / std::log(16.0);
    }
    RecordProperty(std::string("ns_") + name, fmt::format("{:.2f}", 1e9 * few));
    RecordProperty(std::string("exponent_") + name, fmt::format("{:.3f}", exponent));
    EXPECT_LT(exponent, 1.05) << name << ": " << 1e9 * few << " and " << 1e9 * many << " ns per cell-step";
  }
}

}  // namespace couplet::thermocline::speed_test
