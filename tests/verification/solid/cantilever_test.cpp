// SPDX-License-Identifier: Apache-2.0
// Cantilever of Slone et al. (2003): L = 20 m, square 2 m x 2 m, E = 10 MPa, nu = 0.3, clamped at x = 0,
// transverse traction of 125 Pa on the tip face. Static tip deflection of the clamped 3-D continuum: 0.10008
// m (p-refined finite elements; Euler-Bernoulli gives 0.1 m).
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/io/probes/probe.hpp"
#include "common/parallel/collective.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::cantilever_test {
namespace {

struct Tip {
  double deflection, imbalance;
};

Tip tip_of(const std::array<int, 3>& n) {
  SolidParameters p = box_parameters(3);
  p.material = {2600, 10e6, 0.3};
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0", "0"});
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "-125", "0"});
  const auto start = std::chrono::steady_clock::now();
  const auto solid =
      make_solid(mesh::make_box(mesh::BoxCells::hexahedra, n, Vec3(0, -1, -1), Vec3(20, 1, 1)), p);
  step(*solid, 1);
  const std::vector<double> points = solid->fields().point_displacement();
  const io::Probe probe(solid->body().mesh(), solid->body().geometry().points, "tip", Vec3(20, 0, 0));
  const double deflection = -probe.sample(points, 3)[1];
  Vec3 total = solid->fields().total_load();
  const double load = total.norm();
  EXPECT_NEAR(load, 500, 1e-9);
  for (const PatchForce& r : solid->fields().reactions(points)) total += r.force;
  fmt::print("{}x{}x{}: tip {:.5f} m ({:+.2f} %), {:.2f} s\n", n[0], n[1], n[2], deflection,
             100 * (deflection / 0.10008 - 1),
             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return {deflection, total.norm() / load};
}

TEST(Cantilever, tip_deflection_converges_to_the_clamped_continuum) {
  constexpr double reference = 0.10008;
  const Tip coarse = tip_of({20, 2, 2}), medium = tip_of({40, 4, 4}), fine = tip_of({80, 8, 8});
  RecordProperty("tip_coarse", fmt::format("{:.6f}", coarse.deflection));
  RecordProperty("tip_medium", fmt::format("{:.6f}", medium.deflection));
  RecordProperty("tip_fine", fmt::format("{:.6f}", fine.deflection));
  RecordProperty("imbalance",
                 fmt::format("{:.3e}", std::max({coarse.imbalance, medium.imbalance, fine.imbalance})));
  EXPECT_LT(std::abs(medium.deflection - reference), 0.5 * std::abs(coarse.deflection - reference));
  EXPECT_LT(std::abs(fine.deflection - reference), 0.5 * std::abs(medium.deflection - reference));
  EXPECT_NEAR(fine.deflection, reference, 0.015 * reference);
  // Reactions hold the load.
  for (const Tip& tip : {coarse, medium, fine}) EXPECT_LT(tip.imbalance, 1e-8);
}

}  // namespace
}  // namespace couplet::testing::cantilever_test
