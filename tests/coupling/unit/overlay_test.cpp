// SPDX-License-Identifier: Apache-2.0
// What the faces of the other side cover of a face, and who gets what none covers.
#include "coupler/mapping/conjugate_map.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace couplet::overlay_test {
namespace {

/// A face looks up; those of the other side, which look down, cover it up to x = 0.4.
double length_given(const coupling::Interface& other) {
  coupling::Interface edge;
  edge.dim = 2;
  edge.vertices = {{0, 0, 0}, {1, 0, 0}};
  edge.face_centres = {{0.5, 0, 0}}, edge.face_areas = {{0, 1, 0}};
  edge.face_offset = {0, 2}, edge.face_vertices = {0, 1};
  std::vector<Index> all(other.face_centres.size());
  std::iota(all.begin(), all.end(), Index(0));
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  for (const coupler::Cover& c : coupler::covers(edge, 0, other, all)) products += c.products;
  // The samples stand for what they lie in: the mass matrix of an edge nearly, its sum exactly.
  EXPECT_NEAR(products(0, 0), 1. / 3, 0.05);
  EXPECT_NEAR(products(1, 1), 1. / 3, 0.05);
  return products.sum();
}

TEST(Overlay, a_part_of_an_edge_that_nothing_covers_goes_to_the_nearest_in_full) {
  coupling::Interface other;
  other.dim = 2;
  other.vertices = {{0, 0, 0}, {0.4, 0, 0}};
  other.face_centres = {{0.2, 0, 0}}, other.face_areas = {{0, -0.4, 0}};
  other.face_offset = {0, 2}, other.face_vertices = {0, 1};
  EXPECT_NEAR(length_given(other), 1, 1e-12);
}

TEST(Overlay, a_part_of_a_face_that_nothing_covers_goes_to_the_nearest_in_full) {
  coupling::Interface face, other;
  face.dim = other.dim = 3;
  face.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  face.face_centres = {{0.5, 0.5, 0}}, face.face_areas = {{0, 0, 1}};
  face.face_offset = {0, 4}, face.face_vertices = {0, 1, 2, 3};
  other.vertices = {{0, 0, 0}, {0.4, 0, 0}, {0.4, 1, 0}, {0, 1, 0}};
  other.face_centres = {{0.2, 0.5, 0}}, other.face_areas = {{0, 0, -0.4}};
  other.face_offset = {0, 4}, other.face_vertices = {0, 3, 2, 1};
  const std::vector<coupler::Cover> part = coupler::covers(face, 0, other, {0});
  ASSERT_EQ(part.size(), 1);
  EXPECT_NEAR(part[0].products.sum(), 1, 1e-12);
}

}  // namespace
}  // namespace couplet::overlay_test
