// SPDX-License-Identifier: Apache-2.0
// Constant curvature, rigid motions and mass on distorted meshes.
#include "common/linalg/linear_solver.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::patch_test {
using namespace mesh;
using namespace test;
using namespace modes;

struct Case {
  const char* name;
  RawMesh raw;
};

std::vector<Case> meshes() {
  return {{"triangles", square(6, BoxCells::triangles, 0.3)},
          {"quadrilaterals", square(6, BoxCells::quadrilaterals, 0.2)},
          {"disc", disc(5)}};
}

/// w, w,x, w,y of a quadratic at every point.
std::vector<double> quadratic(const PlateModel& plate, const std::array<double, 6>& c) {
  std::vector<double> points;
  for (const Vec2& p : plate.surface().points) {
    const double x = p.x(), y = p.y();
    points.push_back(c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y);
    points.push_back(c[1] + 2 * c[3] * x + c[4] * y);
    points.push_back(c[2] + c[4] * x + 2 * c[5] * y);
  }
  return points;
}

TEST(PlatePatch, constant_curvature_leaves_no_force_inside) {
  double worst = 0;
  for (const Case& mesh : meshes()) {
    const PlateModel plate = make_plate(mesh.raw, {});
    const std::vector<double> u = quadratic(plate, {0.1, 0.2, -0.3, 0.7, -0.4, 0.9});
    std::vector<double> force(u.size());
    plate.stiffness().multiply(u, force);
    std::vector<bool> inside(plate.surface().points.size(), true);
    for (const auto& edge : plate.surface().edges) inside[edge.from] = inside[edge.to] = false;
    double largest = 0, left = 0;
    for (std::size_t p = 0; p < inside.size(); ++p)
      for (int c = 0; c < 3; ++c) {
        largest = std::max(largest, std::abs(force[3 * p + c]));
        if (inside[p]) left = std::max(left, std::abs(force[3 * p + c]));
      }
    EXPECT_LT(left, 1e-10 * largest) << mesh.name;
    EXPECT_GT(largest, 0.1) << mesh.name;
    worst = std::max(worst, left / largest);
  }
  RecordProperty("worst", fmt::format("{:.3e}", worst));
}

TEST(PlatePatch, constant_curvature_is_what_its_boundary_values_give) {
  double worst = 0;
  for (const Case& mesh : meshes()) {
    // Clamped all around: prescribe the boundary, solve for the inside.
    const PlateModel free = make_plate(mesh.raw, {}),
                     held = make_plate(mesh.raw, all_edges(Support::clamped));
    const std::vector<double> exact = quadratic(free, {0, 0.1, 0.2, 0.5, 0.3, -0.8});
    std::vector<double> boundary = exact, force(exact.size());
    for (std::size_t r = 0; r < exact.size(); ++r)
      if (!held.is_supported(r)) boundary[r] = 0;
    free.stiffness().multiply(boundary, force);
    for (std::size_t r = 0; r < force.size(); ++r) force[r] = held.is_supported(r) ? 0 : -force[r];
    const std::vector<double> u = held.deflect(force);
    double apart = 0;
    for (std::size_t r = 0; r < u.size(); ++r)
      if (!held.is_supported(r)) apart = std::max(apart, std::abs(u[r] - exact[r]));
    EXPECT_LT(apart, 1e-10) << mesh.name;
    worst = std::max(worst, apart);
  }
  RecordProperty("worst", fmt::format("{:.3e}", worst));
}

TEST(PlatePatch, energy_of_constant_curvature_is_exact) {
  for (const Case& mesh : meshes()) {
    const PlateModel plate = make_plate(mesh.raw, {});
    const std::vector<double> u = quadratic(plate, {0, 0, 0, 0.5, 0.25, 1});
    std::vector<double> force(u.size());
    plate.stiffness().multiply(u, force);
    double twice = 0, area = 0;
    for (std::size_t r = 0; r < u.size(); ++r) twice += u[r] * force[r];
    for (const double a : plate.cell_areas()) area += a;
    // D ((wxx + wyy)^2 - 2 (1 - nu) (wxx wyy - wxy^2)), wxx = 1, wyy = 2, wxy = 1/4
    EXPECT_NEAR(twice, area * (9 - 2 * 0.7 * (2 - 0.0625)), 1e-9) << mesh.name;
  }
}

TEST(PlatePatch, mass_of_a_quadratic_deflection_is_exact_on_the_square) {
  for (const BoxCells cells : {BoxCells::triangles, BoxCells::quadrilaterals}) {
    const PlateModel plate = make_plate(square(5, cells, 0.2), {});
    const std::vector<double> w = quadratic(plate, {1, 2, -1, 0.5, 0, 0});
    std::vector<double> m(w.size());
    plate.mass().multiply(w, m);
    double energy = 0;
    for (std::size_t r = 0; r < w.size(); ++r) energy += w[r] * m[r];
    // int_0^1 int_0^1 (1 + 2 x - y + x^2 / 2)^2 dx dy
    const double a0 = 1 + 1 + 1. / 6,
                 a2 = 1 + 4. / 3 + 1. / 20 + 2 + 1. / 3 + 0.5;  // of f(x) = 1 + 2x + x^2/2
    EXPECT_NEAR(energy, a2 - 2 * a0 * 0.5 + 1. / 3, 1e-12);
    const std::vector<double> means = plate.cell_means(w), areas = plate.cell_areas();
    double integral = 0;
    for (std::size_t c = 0; c < means.size(); ++c) integral += means[c] * areas[c];
    EXPECT_NEAR(integral, a0 - 0.5, 1e-13);
  }
}

TEST(PlatePatch, a_support_holds_what_it_says) {
  const PlateModel plate = make_plate(
      square(4),
      {{"xmin", Support::clamped}, {"xmax", Support::simply_supported}, {"ymin", Support::symmetry}});
  for (std::size_t p = 0; p < plate.surface().points.size(); ++p) {
    std::vector<double> one(plate.n_unknowns(), 0);
    const Vec2& x = plate.surface().points[p];
    const auto is_held = [&](int component) {  // nothing that is not held can be reached
      std::vector<double> direction(plate.n_unknowns(), 0);
      direction[3 * p + component] = 1;
      direction = plate.to_unknowns(direction);
      double free = 0;
      for (int c = 0; c < 3; ++c)
        if (!plate.is_supported(3 * p + c)) free += std::abs(direction[3 * p + c]);
      return free < 1e-12;
    };
    const bool clamped = x.x() == 0, hinged = x.x() == 1, mirror = x.y() == 0;
    EXPECT_EQ(is_held(0), clamped || hinged) << x.transpose();
    EXPECT_EQ(is_held(1), clamped) << x.transpose();
    EXPECT_EQ(is_held(2), clamped || hinged || mirror) << x.transpose();
  }
}

// Frequencies against lambda = omega a^2 sqrt(rho h / D) of Leissa's tables ("Vibration of plates", NASA
// SP-160) and, for the cantilever and the free square, of converged computations.

struct Reference {
  const char* name;
  RawMesh (*mesh)(int);
  std::map<std::string, Support> held;
  int skip;                    // rigid motions
  std::vector<double> lambda;  // in ascending order
};

void PrintTo(const Reference& r, std::ostream* out) { *out << r.name; }

RawMesh triangles(int n) { return square(n, BoxCells::triangles); }
RawMesh quadrilaterals(int n) { return square(n, BoxCells::quadrilaterals); }

class PlateFrequencies : public ::testing::TestWithParam<Reference> {
 protected:
  static std::vector<double> errors(int n) {
    const Reference& r = GetParam();
    const PlateModel plate = make_plate(r.mesh(n), r.held);
    const std::vector<double> found = lambdas(plate.modes(r.skip + int(r.lambda.size())));
    std::vector<double> result;
    for (std::size_t i = 0; i < r.lambda.size(); ++i) result.push_back(found[r.skip + i] / r.lambda[i] - 1);
    return result;
  }
};

TEST_P(PlateFrequencies, are_within_half_a_percent_and_converge_at_second_order) {
  const std::vector<double> coarse = errors(16), fine = errors(32);
  double worst = 0, sum_coarse = 0, sum_fine = 0;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    worst = std::max(worst, std::abs(fine[i]));
    sum_coarse += std::abs(coarse[i]), sum_fine += std::abs(fine[i]);
  }
  const double slope = std::log2(sum_coarse / sum_fine);
  EXPECT_LT(worst, 0.005);
  EXPECT_GT(slope, 1.8);
  RecordProperty("worst", fmt::format("{:.6f}", worst));
  RecordProperty("slope", fmt::format("{:.3f}", slope));
}

const std::vector<double> free_square{13.4682, 19.5961, 24.2702, 34.8009, 34.8009, 61.0932, 61.0932};
INSTANTIATE_TEST_SUITE_P(Plates, PlateFrequencies,
                         ::testing::Values(Reference{"clamped_circle",
                                                     disc,
                                                     all_edges(Support::clamped),
                                                     0,
                                                     {10.2158, 21.2604, 21.2604, 34.8770, 34.8770, 39.7711}},
                                           Reference{"simply_supported_circle",
                                                     disc,
                                                     all_edges(Support::simply_supported),
                                                     0,
                                                     {4.9351, 13.8982, 13.8982, 25.6133, 25.6133, 29.7200}},
                                           Reference{"clamped_square",
                                                     triangles,
                                                     all_edges(Support::clamped),
                                                     0,
                                                     {35.985, 73.394, 73.394, 108.22, 131.58, 132.20}},
                                           Reference{"clamped_square_quadrilaterals",
                                                     quadrilaterals,
                                                     all_edges(Support::clamped),
                                                     0,
                                                     {35.985, 73.394, 73.394, 108.22, 131.58, 132.20}},
                                           Reference{"simply_supported_square",
                                                     triangles,
                                                     all_edges(Support::simply_supported),
                                                     0,
                                                     {19.7392, 49.3480, 49.3480, 78.9568, 98.6960, 98.6960}},
                                           Reference{"cantilever_square",
                                                     triangles,
                                                     {{"xmin", Support::clamped}},
                                                     0,
                                                     {3.4710, 8.5063, 21.284, 27.199, 30.955, 54.187}},
                                           Reference{"free_square", triangles, {}, 3, free_square},
                                           // A quarter with two mirrors has the modes of the whole that are
                                           // even in both directions.
                                           Reference{"quarter_of_a_simply_supported_square",
                                                     triangles,
                                                     {{"xmin", Support::symmetry},
                                                      {"ymin", Support::symmetry},
                                                      {"xmax", Support::simply_supported},
                                                      {"ymax", Support::simply_supported}},
                                                     0,
                                                     {19.7392 / 4, 98.6960 / 4, 98.6960 / 4}}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(PlateModes, are_mass_normalised_and_orthogonal) {
  const PlateModel plate = make_plate(square(12), all_edges(Support::clamped));
  const EigenModes modes = plate.modes(10);
  double worst = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    std::vector<double> m(plate.n_unknowns());
    plate.mass().multiply(modes.shape[i], m);
    for (std::size_t j = 0; j < 10; ++j) {
      double product = 0;
      for (std::size_t r = 0; r < m.size(); ++r) product += m[r] * modes.shape[j][r];
      worst = std::max(worst, std::abs(product - (i == j ? 1 : 0)));
    }
  }
  EXPECT_LT(worst, 1e-10);
  EXPECT_LT(modes.worst_residual, 1e-10);
}

TEST(PlateModes, a_free_plate_has_three_rigid_motions_and_no_more) {
  const std::vector<double> values = make_plate(square(8), {}).modes(5).eigenvalue;
  for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(values[i]), 1e-6);
  EXPECT_GT(values[3], 100);
}

TEST(PlateModes, both_members_of_a_pair_are_found_and_a_cut_pair_is_noticed) {
  const PlateModel plate = make_plate(square(12, BoxCells::quadrilaterals), all_edges(Support::clamped));
  EXPECT_TRUE(cuts_a_group(plate.modes(2), 1e-3));
  EXPECT_FALSE(cuts_a_group(plate.modes(3), 1e-3));
  const std::vector<double> all = lambdas(plate.modes(3));
  EXPECT_NEAR(all[1], all[2], 1e-6 * all[1]);
}

TEST(PlateModes, more_modes_than_unknowns_are_refused) {
  const PlateModel plate = make_plate(square(1), all_edges(Support::clamped));
  EXPECT_THROW(plate.modes(13), Error);
}

}  // namespace couplet::plate::patch_test
