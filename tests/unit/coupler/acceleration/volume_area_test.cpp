// SPDX-License-Identifier: Apache-2.0
// The level of a closed fluid acts on the areas half way through the step: then its work is that on the volume.
#include "coupler/acceleration/volume_level.hpp"
#include "tests/support/test.hpp"

namespace couplet::volume_area_test {
using namespace coupling;
using namespace coupler;

using Place = Interface::Place;
using Data = std::vector<Interface::Datum>;

const Data motion{{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}};
const Data load{{"pressure-force", "N", Place::faces}};
constexpr double dt = 0.1, stiffness = 40;
/// How the three points of the wall move: it rises, turns and is stretched.
const std::vector<double> shape{-0.8, 0.3, 0.2, 1.0, 0.9, 0.5};

Interface wall(const Data& takes, const Data& gives) {
  Interface i{
      2, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0.5, 0, 0}, {1.5, 0, 0}}, {{0, 1, 0}, {0, 1, 0}}, takes, gives};
  i.face_offset = {0, 2, 4};
  i.face_vertices = {0, 1, 1, 2};
  return i;
}

/// Over the face, by its ends.
double middle(const std::vector<double>& at_points, std::size_t face, std::size_t c) {
  return (at_points[2 * face + c] + at_points[2 * face + 2 + c]) / 2;
}

/// Area of a face where its ends are displaced so: the line between them, turned.
std::array<double, 2> area(const std::vector<double>& u, std::size_t face) {
  return {-(u[2 * face + 3] - u[2 * face + 1]), 1 + u[2 * face + 2] - u[2 * face]};
}

struct Scene {
  explicit Scene(bool moves)
      : sides{{MPI_COMM_SELF, "bag", wall(motion, {load[0], {"inflow", "m^3/s", Place::faces, 2}})},
              {MPI_COMM_SELF, "wall", wall(load, motion)}},
        links(MPI_COMM_SELF, sides, {}),
        level(MPI_COMM_SELF, sides, links, schedule(moves), {0, 1}) {}
  static Schedule schedule(bool moves) {
    Schedule s;
    s.group = {"bag", "wall"};
    if (moves) s.moved = "bag";
    return s;
  }
  /// The wall under its load: a spring of one degree of freedom.
  void answer() {
    const std::vector<double> force = links.input(1, known).at("pressure-force");
    double along = 0;
    for (std::size_t f = 0; f < 2; ++f)
      for (std::size_t c = 0; c < 2; ++c) along += force[2 * f + c] * middle(shape, f, c);
    const double q = along / stiffness;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      known[1]["displacement"][i] = q * shape[i];
      known[1]["velocity"][i] = 2 * (q * shape[i] - begin[i]) / dt - begin_velocity[i];
    }
  }
  void step(double inflow_begin, double inflow_end) {
    level.start_step(dt);
    for (int pass = 0; pass < 40; ++pass) {
      const Exchange taken = links.input(0, known);
      known[0] = {{"pressure-force", {0, 0, 0, 0}},
                  {"inflow", {inflow_end / 2, inflow_begin / 2, inflow_end / 2, inflow_begin / 2}}};
      level.add_level(0, taken, known[0]);
      answer();
      level.find(known, [&] { answer(); });
    }
    level.accept(known);
  }
  std::vector<Side> sides;
  Links links;
  VolumeLevel level;
  std::vector<double> begin = std::vector<double>(6, 0.), begin_velocity = begin;
  std::vector<Exchange> known{{}, {{"displacement", begin}, {"velocity", begin}}};
};

TEST(VolumeArea, the_work_of_the_level_is_that_on_the_volume_where_the_wall_turns_and_stretches) {
  Scene s(true);
  double before = 0, size = 0;
  for (int n = 0; n < 6; ++n) {
    s.step(0.5 * n, 0.5 * (n + 1));
    const std::vector<double> row = s.level.row();  // level, volume change, inflow, error
    const std::vector<double>&force = s.known[0].at("pressure-force"), &u = s.known[1].at("displacement");
    double work = 0;
    for (std::size_t f = 0; f < 2; ++f)
      for (std::size_t c = 0; c < 2; ++c) {
        work += force[2 * f + c] * (middle(u, f, c) - middle(s.begin, f, c));
        EXPECT_NEAR(force[2 * f + c], row[0] * (area(s.begin, f)[c] + area(u, f)[c]) / 2,
                    1e-6 * std::abs(row[0]));
      }
    EXPECT_NEAR(work, row[0] * (row[1] - before), 1e-7 * std::abs(work));
    EXPECT_NEAR(row[1], row[2], 1e-4);  // but what the swing of the start may take
    before = row[1];
    s.begin = u;
    s.begin_velocity = s.known[1].at("velocity");
    size = std::max(size, std::abs(u[0]));
  }
  EXPECT_GT(size, 0.1) << "the wall is stretched by enough to tell one area from another";
}

TEST(VolumeArea, of_a_mesh_that_rests_is_that_of_its_reference) {
  Scene s(false);
  s.step(0, 0.5);
  const std::vector<double>& force = s.known[0].at("pressure-force");
  for (std::size_t f = 0; f < 2; ++f) {
    EXPECT_NEAR(force[2 * f], 0, 1e-12);
    EXPECT_NEAR(force[2 * f + 1], s.level.row()[0], 1e-9);
  }
}

/// Two triangles and a square in space, which share no point.
Interface patch() {
  Interface i;
  i.dim = 3;
  i.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {3, 0, 0},
                {2, 1, 0}, {5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}};
  i.face_centres = {{1. / 3, 1. / 3, 0}, {7. / 3, 1. / 3, 0}, {5.5, 0.5, 0}};
  i.face_areas = {
      {0, 0, 0.5}, {0, 0, -0.5}, {0, 0, 1}};  // the second looks the other way than its corners' order says
  i.face_offset = {0, 3, 6, 10};
  i.face_vertices = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  i.takes = motion;
  i.gives = load;
  return i;
}

std::vector<double> by_points(const std::function<Vec3(const Vec3&)>& u) {
  std::vector<double> values;
  for (const Vec3& x : patch().vertices) {
    const Vec3 there = u(x);
    values.insert(values.end(), there.data(), there.data() + 3);
  }
  return values;
}

TEST(CavityWall, areas_and_fluxes_in_space_are_those_of_the_corners_where_they_are) {
  const CavityWall wall(MPI_COMM_SELF, {MPI_COMM_SELF, "bag", patch()}, true);
  // Sheared, stretched and lifted: x -> (2 x, y, x + 3 y), area e_z -> (-2, -6, 2) / 1 a unit of reference area.
  const auto moved = by_points([](const Vec3& x) { return Vec3(x.x(), 0, x.x() + 3 * x.y()); });
  const std::vector<Vec3> areas = wall.areas(moved);
  const Vec3 unit = Vec3(2, 0, 1).cross(Vec3(0, 1, 3));
  const double reference[] = {0.5, -0.5, 1};
  for (std::size_t f = 0; f < 3; ++f) EXPECT_LT((areas[f] - reference[f] * unit).norm(), 1e-12) << f;
  const CavityWall::Flux flux = wall.flux(by_points([](const Vec3&) { return Vec3(1, 2, 5); }), areas);
  const double one = unit.dot(Vec3(1, 2, 5));
  EXPECT_NEAR(flux.net, one, 1e-12);
  EXPECT_NEAR(flux.size, 2 * std::abs(one), 1e-12);
}

// What lies between two places of a triangle is a prism, however it is turned on the way.
TEST(CavityWall, sweeps_the_volume_between_two_places) {
  const CavityWall wall(MPI_COMM_SELF, {MPI_COMM_SELF, "bag", patch()}, true),
      resting(MPI_COMM_SELF, {MPI_COMM_SELF, "bag", patch()}, false);
  const auto lifted = by_points([](const Vec3& x) { return Vec3(0, 0, 0.3 + 0.6 * x.x()); });
  // Heights over the centres, and the second against its own direction.
  EXPECT_NEAR(wall.swept({}, lifted), 0.5 * 0.5 - 0.5 * 1.7 + 3.6, 1e-12);
  EXPECT_NEAR(wall.swept(lifted, {}), -(0.5 * 0.5 - 0.5 * 1.7 + 3.6), 1e-12);
  EXPECT_NEAR(resting.swept({}, lifted), 0.5 * 0.5 - 0.5 * 1.7 + 3.6, 1e-12);
  // Grown to twice its size about its first corner while it rises by 1: a frustum of 7/3 of the triangle.
  const auto grown =
      by_points([](const Vec3& x) { return x.x() < 1.5 ? Vec3(x.x(), x.y(), 1) : Vec3(0, 0, 0); });
  EXPECT_NEAR(wall.swept({}, grown), 0.5 * 7 / 3, 1e-12);
}

}  // namespace couplet::volume_area_test
