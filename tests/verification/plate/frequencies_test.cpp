// SPDX-License-Identifier: Apache-2.0
// Frequencies against lambda = omega a^2 sqrt(rho h / D) of Leissa's tables ("Vibration of plates", NASA
// SP-160) and, for the cantilever and the free square, of converged computations.
#include <gtest/gtest.h>

#include "common/base/error.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::frequencies_test {
using namespace mesh;
using namespace modes;
namespace {

using namespace test;

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

}  // namespace
}  // namespace couplet::plate::frequencies_test
