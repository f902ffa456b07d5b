// SPDX-License-Identifier: Apache-2.0
// The weights of corners keep the moment of a force at a face's centre, wherever in the face that is.
#include "coupler/mapping/face_weights.hpp"

#include <gtest/gtest.h>

namespace couplet::corner_weights_test {
namespace {

TEST(CornerWeights, meet_the_centre_of_a_face_that_is_no_parallelogram) {
  coupling::Interface s;
  s.vertices = {{0, 0, 0}, {4, 0, 0}, {1.5, 2, 0}, {0.5, 2, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  s.face_offset = {0, 4, 7};
  s.face_vertices = {0, 1, 2, 3, 4, 5, 6};
  // The centroid of the trapezoid is not the mean of its corners, and some participants say yet another place.
  const Vec3 corners_mean(1.5, 1, 0);
  for (const Vec3& centre : {Vec3(1.7, 0.8, 0), Vec3(1.6, 0.9, 0), corners_mean}) {
    s.face_centres = {centre, {0.3, 0.4, 1}};
    for (Index f = 0; f < 2; ++f) {
      const std::vector<double> weights = coupler::corner_weights(s, f);
      const auto vertex = coupler::corners(s, f);
      Vec3 met = Vec3::Zero();
      double sum = 0;
      for (std::size_t i = 0; i < weights.size(); ++i)
        met += weights[i] * s.vertices[vertex[i]], sum += weights[i];
      EXPECT_NEAR(sum, 1, 1e-13);
      EXPECT_LT((met - s.face_centres[std::size_t(f)]).norm(), 1e-13);
    }
  }
}

// Over the triangles about the mean (3/2, 3/4) of the corners, whose areas are as 6, 7, 4 and 3: a third of both
// triangles at a corner and 1/12 of all.
TEST(CornerWeights, are_those_of_the_triangles_about_the_mean_of_the_corners) {
  coupling::Interface s;
  s.vertices = {{0, 0, 0}, {4, 0, 0}, {2, 2, 0}, {0, 1, 0}};
  s.face_offset = {0, 4};
  s.face_vertices = {0, 1, 2, 3};
  s.face_centres = {{26. / 15, 11. / 15, 0}};
  const std::vector<double> weights = coupler::corner_weights(s, 0);
  const double wanted[] = {14. / 60, 18. / 60, 16. / 60, 12. / 60};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(weights[std::size_t(i)], wanted[i], 1e-13) << i;
}

}  // namespace
}  // namespace couplet::corner_weights_test
