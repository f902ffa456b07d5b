// SPDX-License-Identifier: Apache-2.0
// 1000 bounces of a mass under gravity over contact stiffness and step: mechanism, the penalty's spring is
// met and left within a step, and a rule that does not know where adds or takes energy each time; criterion,
// the energy over that of the start. The conserving rule holds everywhere; the midpoint rule beside it is the
// failing neighbour.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "plate_modal/oscillators.hpp"

namespace couplet::plate {
namespace {

ModalModel mass() {
  ModalModel model;
  model.vertices = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
  model.faces.push_row(std::array<Index, 4>{0, 1, 2, 3});
  model.frequency = {0};
  for (int v = 0; v < 4; ++v) model.vertex_shape.insert(model.vertex_shape.end(), {0, 0, 1});
  model.participation = {0, 0, 1};
  model.mass = 1;
  average_faces(model);
  return model;
}

/// Largest and last energy over the first, minus 1, in `bounces` bounces (or as long as they would take).
struct Drift {
  double largest = 0, last = 0;
};

Drift drift(ContactRule rule, double kappa, double dt, int bounces) {
  const double g = 9.81, speed = 1;
  ContactParameters p;
  p.stiffness = kappa;
  p.rule = rule;
  const Share share(MPI_COMM_SELF, mass());
  const Contact contact(share, p, Vec3::UnitZ(), 0);
  Oscillators body({0}, {0}, {-g}, {TimeScheme::trapezoidal}, &contact);
  ModalState now = body.start({0}, {speed}), next = now;
  const Oscillators::LoadAt no_load = [](double, std::span<double> load) { load[0] = 0; };
  const double first = now.energies.total();
  const long most = std::lround(bounces * (2 * speed / g + std::numbers::pi / std::sqrt(kappa)) / dt);
  Drift result;
  int done = 0;
  for (long i = 0; i < most && done < bounces && result.largest < 100; ++i) {
    const double before = now.v[0];
    body.step(now, dt, no_load, next);
    std::swap(now, next);
    if (before < 0 && now.v[0] > 0) ++done;
    result.last = now.energies.total() / first - 1;
    result.largest = std::max(result.largest, result.last);
  }
  return result;
}

TEST(PlateContactMap, conserving_holds_over_stiffness_and_step_and_midpoint_does_not) {
  double worst_conserving = 0, worst_midpoint = 0;
  for (const double kappa : {1e3, 1e4, 1e5, 1e6, 1e7})
    for (const double dt : {3e-4, 1e-3, 3e-3, 1e-2}) {
      const Drift kept = drift(ContactRule::conserving, kappa, dt, 1000);
      const Drift plain = drift(ContactRule::midpoint, kappa, dt, 1000);
      EXPECT_LT(kept.largest, 1e-8) << kappa << " " << dt;
      EXPECT_GT(kept.last, -1e-8) << kappa << " " << dt;
      worst_conserving = std::max({worst_conserving, kept.largest, -kept.last});
      worst_midpoint = std::max(worst_midpoint, plain.largest);
      RecordProperty(
          fmt::format("map-{:g}-{:g}", kappa, dt),
          fmt::format("{:.3e} {:.3e} {:.3e} {:.3e}", kept.largest, kept.last, plain.largest, plain.last));
    }
  EXPECT_GT(worst_midpoint, 0.1);
  RecordProperty("conserving", fmt::format("{:.3e}", worst_conserving));
  RecordProperty("midpoint", fmt::format("{:.3e}", worst_midpoint));
}

}  // namespace
}  // namespace couplet::plate
