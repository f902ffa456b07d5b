// SPDX-License-Identifier: Apache-2.0
// A thin body that is wet on both sides: the Robin condition lets its two sides move together.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/verification/fluid/fluid_case.hpp"

namespace couplet::fluid::test::two_sided_walls_test {
namespace {

using mesh::BoxCells;
using mesh::RawMesh;

constexpr double thickness = 0.1, mass = 0.4, push = 7, dt = 0.01;  // [m], [kg/m^2] of both sides, [Pa], [s]

/// Two boxes of height 1 m above each other; between them is the body. Patches of the upper one begin with "up".
RawMesh two_boxes(int dim, int below, int above) {
  const BoxCells cells = dim == 2 ? BoxCells::quadrilaterals : BoxCells::hexahedra;
  RawMesh raw = mesh::make_box(cells, {below, 5, dim == 2 ? 1 : below}, Vec3::Zero(), Vec3::Ones());
  const RawMesh upper = mesh::make_box(cells, {above, 5, dim == 2 ? 1 : above}, Vec3(0, 1 + thickness, 0),
                                       Vec3(1, 2 + thickness, 1));
  const auto shift = static_cast<Index>(raw.points.size());
  const auto patches = static_cast<int>(raw.patches.size());
  raw.points.insert(raw.points.end(), upper.points.begin(), upper.points.end());
  raw.cell_type.insert(raw.cell_type.end(), upper.cell_type.begin(), upper.cell_type.end());
  raw.cell_zone.insert(raw.cell_zone.end(), upper.cell_zone.begin(), upper.cell_zone.end());
  const auto append = [&](mesh::Csr& to, const mesh::Csr& from) {
    for (Index i = 0; i < from.size(); ++i) {
      std::vector<Index> row(from[i].begin(), from[i].end());
      for (Index& v : row) v += shift;
      to.push_row(row);
    }
  };
  append(raw.cell_points, upper.cell_points);
  append(raw.boundary_points, upper.boundary_points);
  for (const int patch : upper.boundary_patch) raw.boundary_patch.push_back(patch + patches);
  for (const std::string& name : upper.patches) raw.patches.push_back("up" + name);
  return raw;
}

FluidParameters parameters(int dim, Sides sides) {
  FluidParameters p;
  p.density = 1.3;
  p.viscosity = 1e-6;
  p.pressure_tolerance = 1e-12;
  for (const std::string box : {"", "up"})
    for (const std::string side : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
      if (dim == 3 || side[0] != 'z') p.boundaries[box + side] = boundary(BoundaryType::slip);
  p.boundaries["ymin"] = boundary(BoundaryType::outlet, {}, std::to_string(push));
  p.boundaries["upymax"] = boundary(BoundaryType::outlet);
  for (const char* wall : {"ymax", "upymin"}) {
    p.boundaries[wall] = boundary(BoundaryType::interface);
    p.boundaries[wall].surface_density = mass / 2;
    p.boundaries[wall].sides = sides;
  }
  return p;
}

struct Speeds {
  double least = 1e9, largest = -1e9, mean = 0;
};

/// Of the two sides after one step, if the structure has answered to no load with rest.
template <int D>
std::array<Speeds, 2> speeds(const RawMesh& raw, Sides sides) {
  FluidCase<D> c(MPI_COMM_WORLD, raw, parameters(D, sides));
  c.fluid().begin_step(0, dt);
  c.fluid().yield_from(std::vector<double>(std::size_t(c.mesh().boundary.n_owned()), 0.));
  c.fluid().solve({}, {});
  c.fluid().accept();
  std::array<Speeds, 2> result;
  for (const mesh::Patch& patch : c.mesh().patches) {
    if (patch.name != "ymax" && patch.name != "upymin") continue;
    Speeds& side = result[patch.name == "ymax" ? 0 : 1];
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const double area = c.geometry().face_area[f][1], w = c.state().phi[f] / area;
      side.least = std::min(side.least, w), side.largest = std::max(side.largest, w);
      side.mean += std::abs(area) * w;  // over 1 m^2
    }
  }
  for (Speeds& side : result)
    side = {parallel::min(MPI_COMM_WORLD, side.least), parallel::max(MPI_COMM_WORLD, side.largest),
            parallel::sum(MPI_COMM_WORLD, side.mean)};
  return result;
}

// The body and the two columns of fluid are one mass: w = p dt/(m + 2 rho H).
constexpr double together = push * dt / (mass + 2 * 1.3);

template <int D>
void expect_one_body(const RawMesh& raw) {
  for (const Speeds& side : speeds<D>(raw, Sides::together)) {
    EXPECT_NEAR(side.least, together, 1e-9);
    EXPECT_NEAR(side.largest, together, 1e-9);
  }
}

TEST(TwoSidedWalls, move_as_one_body) {
  expect_one_body<2>(two_boxes(2, 6, 6));
  expect_one_body<3>(two_boxes(3, 4, 4));
}

// Faces that do not match share their areas by samples: each moves a little otherwise, which the structure's answer
// cures; both sides push the same volume.
template <int D>
void expect_one_volume(const RawMesh& raw) {
  const auto w = speeds<D>(raw, Sides::together);
  EXPECT_NEAR(w[0].mean, together, 0.01 * together);
  EXPECT_NEAR(w[1].mean, w[0].mean, 0.01 * together);
  EXPECT_GT(w[0].least, 0.5 * together);
  EXPECT_LT(w[1].largest, 1.5 * together);
}

TEST(TwoSidedWalls, faces_that_do_not_match) {
  expect_one_volume<2>(two_boxes(2, 6, 9));
  expect_one_volume<3>(two_boxes(3, 4, 6));
}

/// Only the side that is pushed moves, with half the mass.
void expect_apart(const std::array<Speeds, 2>& w) {
  const double alone = push * dt / (mass / 2 + 1.3);
  EXPECT_NEAR(w[0].least, alone, 1e-9);
  EXPECT_NEAR(w[0].largest, alone, 1e-9);
  EXPECT_NEAR(w[1].least, 0, 1e-9);
  EXPECT_NEAR(w[1].largest, 0, 1e-9);
}

// The neighbour: each side for itself.
TEST(TwoSidedWalls, apart_each_has_its_own_motion) {
  expect_apart(speeds<2>(two_boxes(2, 6, 6), Sides::apart));
}

/// A box of 8 x 8 cells, closed, without the cells that a plate takes in its midst.
RawMesh box_around_plate() {
  RawMesh raw = mesh::make_box(BoxCells::quadrilaterals, {8, 8, 1}, Vec3::Zero(), Vec3::Ones());
  const auto in_plate = [&](const Vec3& x) {
    return std::abs(x[0] - 0.5) < 0.3 && std::abs(x[1] - 0.5625) < 0.1;
  };
  std::map<std::set<Index>, int> sides;  // edges of the plate's cells: how many of these
  RawMesh kept = raw;
  kept.cell_points = {};
  kept.cell_type.clear(), kept.cell_zone.clear();
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    const auto corners = raw.cell_points[c];
    Vec3 centre = Vec3::Zero();
    for (const Index v : corners) centre += raw.points[std::size_t(v)] / 4;
    if (in_plate(centre)) {
      for (std::size_t i = 0; i < 4; ++i) ++sides[{corners[i], corners[(i + 1) % 4]}];
      continue;
    }
    kept.cell_points.push_row(corners);
    kept.cell_type.push_back(raw.cell_type[std::size_t(c)]),
        kept.cell_zone.push_back(raw.cell_zone[std::size_t(c)]);
  }
  for (const auto& [side, count] : sides)
    if (count == 1) {
      kept.boundary_points.push_row(std::vector<Index>(side.begin(), side.end()));
      kept.boundary_patch.push_back(int(kept.patches.size()));
    }
  kept.patches.push_back("plate");
  return kept;
}

// Two sides that move as one say nothing of the level of the pressure: without an outlet each side yields by itself.
TEST(TwoSidedWalls, closed_fluids_keep_their_sides_apart) {
  const auto pressure = [](Sides sides) {
    FluidParameters p;
    p.density = 1.3;
    p.viscosity = 1e-6;
    p.pressure_tolerance = 1e-12;
    all_sides(p, 2, boundary(BoundaryType::slip));
    p.boundaries["plate"] = boundary(BoundaryType::interface);
    p.boundaries["plate"].surface_density = mass / 2;
    p.boundaries["plate"].sides = sides;
    FluidCase<2> c(MPI_COMM_WORLD, box_around_plate(), p);
    std::vector<double> loads(std::size_t(c.mesh().boundary.n_owned()), 0.);
    for (std::size_t b = 0; b < loads.size(); ++b)
      loads[b] = push * std::max(0., c.geometry().face_area[c.mesh().n_interior + Index(b)][1]);
    c.fluid().begin_step(0, dt);
    c.fluid().yield_from(loads);
    c.fluid().solve({}, {});
    return c.fluid().boundary_pressure();
  };
  const std::vector<double> as_one = pressure(Sides::automatic);
  EXPECT_EQ(as_one, pressure(Sides::apart));
  EXPECT_THROW(pressure(Sides::together), Error);
  double most = 0;
  for (const double p : as_one) most = std::max(most, std::abs(p));
  most = parallel::max(MPI_COMM_WORLD, most);
  EXPECT_GT(most, 0.01 * push);
  EXPECT_LT(most, 10 * push);
}

// Another body's wet side, further along, is not this one's.
TEST(TwoSidedWalls, bodies_side_by_side_do_not_see_each_other) {
  RawMesh raw = two_boxes(2, 6, 6);
  for (Vec3& x : raw.points)
    if (x[1] > 1 + thickness / 2) x[0] += 1.02;
  expect_apart(speeds<2>(raw, Sides::automatic));
  EXPECT_THROW(speeds<2>(raw, Sides::together), Error);
}

// A body that is thicker than a quarter of the walls' extent is not seen through: sides apart.
TEST(TwoSidedWalls, thick_body_has_two_sides_of_its_own) {
  RawMesh raw = two_boxes(2, 6, 6);
  for (Vec3& x : raw.points)
    if (x[1] > 1 + thickness / 2) x[1] += 0.5;
  expect_apart(speeds<2>(raw, Sides::automatic));
  EXPECT_THROW(speeds<2>(raw, Sides::together), Error);
}

}  // namespace
}  // namespace couplet::fluid::test::two_sided_walls_test
