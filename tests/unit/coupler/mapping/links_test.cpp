// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/links.hpp"
#include "coupler/exchange/partners.hpp"
#include "coupler/mapping/surface_checks.hpp"
#include "coupler/output/record.hpp"
#include "tests/support/test.hpp"

namespace couplet::links_test {
using namespace coupling;
using namespace coupler;
using Place = Interface::Place;
using Data = std::vector<Interface::Datum>;
using testing::HasSubstr;

const Data motion{{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}};
const Data load{{"pressure-force", "N", Place::faces}, {"viscous-force", "N", Place::faces}};

/// Three vertices and two faces on a line, 2-D; the fluid's run the other way.
Interface solid(double shift = 0) {
  Interface i{2,
              {{shift, 0, 0}, {shift + 1, 0, 0}, {shift + 2, 0, 0}},
              {{shift + 0.5, 0, 0}, {shift + 1.5, 0, 0}},
              {{0, 1, 0}, {0, 1, 0}},
              load,
              motion};
  i.face_offset = {0, 2, 4};
  i.face_vertices = {0, 1, 1, 2};
  return i;
}
Interface fluid() {
  Interface i{
      2,   {{2, 0, 0}, {1, 0, 0}, {0, 0, 0}}, {{1.5, 0, 0}, {0.5, 0, 0}}, {{0, -1, 0}, {0, -1, 0}}, motion,
      load};
  i.face_offset = {0, 2, 4};
  i.face_vertices = {0, 1, 1, 2};
  return i;
}
Side side(const std::string& name, const Interface& interface) { return {MPI_COMM_SELF, name, interface}; }
Links links(const Interface& f, const Interface& s) {
  return {MPI_COMM_SELF, {side("fluid", f), side("solid", s)}, {}};
}

template <class F>
std::string message(const F& f) {
  return support::error_of([&] { f(); });
}

TEST(Links, motion_goes_to_the_fluid_and_load_to_the_structure) {
  const Links l = links(fluid(), solid());
  const Exchange from_fluid{{"pressure-force", {1, 2, 3, 4}}, {"viscous-force", {5, 6, 7, 8}}};
  const Exchange from_solid{{"displacement", {1, 2, 3, 4, 5, 6}}, {"velocity", {10, 20, 30, 40, 50, 60}}};
  const Exchange given = l.input(0, {from_fluid, from_solid}), taken = l.input(1, {from_fluid, from_solid});
  EXPECT_EQ(given.at("displacement"), (std::vector<double>{5, 6, 3, 4, 1, 2}));
  EXPECT_EQ(given.at("velocity"), (std::vector<double>{50, 60, 30, 40, 10, 20}));
  EXPECT_EQ(taken.at("pressure-force"), (std::vector<double>{3, 4, 1, 2}));
  EXPECT_EQ(taken.at("viscous-force"), (std::vector<double>{7, 8, 5, 6}));
}

TEST(Links, a_side_gets_only_what_it_takes) {
  Interface mover = fluid();
  mover.takes = {motion[0]};
  mover.gives = {};
  const Links l(MPI_COMM_SELF, {side("mover", mover), side("fluid", fluid()), side("solid", solid())}, {});
  const Exchange from_solid{{"displacement", std::vector<double>(6)}, {"velocity", std::vector<double>(6)}};
  EXPECT_EQ(l.input(0, {{}, {}, from_solid}).size(), 1u);
}

TEST(Links, two_bodies_in_one_fluid_get_their_own_part_of_it) {
  Interface both = fluid();
  for (const auto& v : fluid().vertices) both.vertices.push_back(v + Vec3(10, 0, 0));
  for (const auto& c : fluid().face_centres) both.face_centres.push_back(c + Vec3(10, 0, 0));
  both.face_areas.insert(both.face_areas.end(), 2, {0, -1, 0});
  for (const Index v : fluid().face_vertices)
    both.face_vertices.push_back(v + Index(fluid().vertices.size()));
  for (const Index end : {6, 8}) both.face_offset.push_back(end);
  const std::vector<Side> sides{side("fluid", both), side("left", solid()), side("right", solid(10))};
  MappingParameters nearest_map;
  nearest_map.type = MappingParameters::Type::nearest;
  const Links l(MPI_COMM_SELF, sides, nearest_map);
  const Exchange from_fluid{{"pressure-force", {1, 2, 3, 4, 5, 6, 7, 8}},
                            {"viscous-force", std::vector<double>(8)}};
  const Exchange left{{"displacement", {1, 2, 3, 4, 5, 6}}, {"velocity", std::vector<double>(6)}};
  const Exchange right{{"displacement", {7, 8, 9, 10, 11, 12}}, {"velocity", std::vector<double>(6)}};
  const std::vector<Exchange> given{from_fluid, left, right};
  EXPECT_EQ(l.input(0, given).at("displacement"),
            (std::vector<double>{5, 6, 3, 4, 1, 2, 11, 12, 9, 10, 7, 8}));
  EXPECT_EQ(l.input(1, given).at("pressure-force"), (std::vector<double>{3, 4, 1, 2}));
  EXPECT_EQ(l.input(2, given).at("pressure-force"), (std::vector<double>{7, 8, 5, 6}));
}

TEST(Links, a_datum_that_nobody_gives_or_in_other_units_is_named) {
  Interface f = fluid();
  f.takes.push_back({"temperature", "K", Place::vertices});
  EXPECT_THAT(message([&] { links(f, solid()); }),
              HasSubstr("'fluid' takes 'temperature', but no participant gives it."));
  f = fluid();
  f.takes[0].unit = "mm";
  EXPECT_EQ(message([&] { links(f, solid()); }),
            "'fluid' takes 'displacement' in mm, but 'solid' gives it in m.");
  f = fluid();
  f.dim = 3;
  EXPECT_THAT(message([&] { links(f, solid()); }),
              HasSubstr("with 3 components, but 'solid' gives it with 2."));
}

TEST(Links, a_load_that_nobody_takes_is_noted_and_data_of_the_wrong_length_are_refused) {
  Interface s = solid();
  s.takes.pop_back();
  EXPECT_THAT(links(fluid(), s).notes(),
              testing::Contains("note: no participant takes 'viscous-force' of 'fluid'"));
  EXPECT_THROW(links(fluid(), solid()).input(1, {{{"pressure-force", {1, 2}}}, {}}), Error);
}

TEST(Roles, a_structure_that_does_not_move_and_other_dimensions_are_refused) {
  CouplingParameters p;
  p.fluid = {"fluid"}, p.structure = {"solid"};
  Interface s = solid();
  EXPECT_EQ(message([&] { check_roles(p, {side("fluid", fluid()), side("solid", s)}); }), "");
  s.gives.pop_back();
  EXPECT_EQ(
      message([&] {
        check_roles(p, {side("fluid", fluid()), side("solid", s)});
      }),
      "'solid' cannot be the structure (`coupling.structure`): the role 'structure' takes a load [N or Pa] at faces or vertices "
      "and gives 'displacement' [m] at vertices and 'velocity' [m/s] at vertices; it gives no 'velocity' [m/s] at "
      "vertices (it takes 'pressure-force' [N] at faces, 'viscous-force' [N] at faces and gives 'displacement' [m] at "
      "vertices).");
  p.structure = {"fluid"}, p.fluid = {"solid"};
  EXPECT_THAT(message([&] {
                check_roles(p, {side("fluid", fluid()), side("solid", solid())});
              }),
              HasSubstr("'solid' cannot be the fluid"));
  p.structure = {"solid"}, p.fluid = {"fluid"};
  Interface f = fluid();
  f.dim = 3;
  EXPECT_EQ(message([&] {
              check_roles(p, {side("fluid", f), side("solid", solid())});
            }),
            "'fluid' has 3 dimensions and 'solid' has 2: both must have the same.");
}

TEST(Balance, sums_forces_moments_and_their_work) {
  const Balancing balancing(MPI_COMM_SELF, side("solid", solid()));
  const Exchange data{{"pressure-force", {0, 1, 0, 2}}, {"viscous-force", {0.5, 0, 0, 0}}};
  // Increment of the structure's vertices: (0, 0), (0, 1), (2, 1): faces move by (0, 0.5) and (1, 1).
  const Balance b = balancing(data, load, {0, 0, 0, 1, 2, 1});
  EXPECT_DOUBLE_EQ(b.force.x(), 0.5);
  EXPECT_DOUBLE_EQ(b.force.y(), 3);
  EXPECT_DOUBLE_EQ(b.moment.z(), 0.5 * 1 + 1.5 * 2);
  EXPECT_DOUBLE_EQ(b.work, 1 * 0.5 + 2 * 1 + 0.5 * 0);
  Interface lumped = solid();
  lumped.face_offset.clear(), lumped.face_vertices.clear();
  EXPECT_FALSE(Balancing(MPI_COMM_SELF, side("solid", lumped)).knows_work());
}

// Explicit: the fluid's wall is where it was put, not where the structure went.
TEST(Balance, each_side_counts_the_way_of_its_own_wall) {
  const std::vector<Side> sides{side("fluid", fluid()), side("solid", solid())};
  const Links l(MPI_COMM_SELF, sides, {});
  Mechanics mechanics(MPI_COMM_SELF, sides, l, {"fluid", "structure"});
  const Exchange force{{"pressure-force", {0, 1, 0, 1}}, {"viscous-force", std::vector<double>(4)}};
  const auto at = [](double y) { return Exchange{{"displacement", {0, y, 0, y, 0, y}}}; };
  const auto work = [&](double guess, double moved) {
    const auto sides_now = mechanics.accepted({force, at(moved)}, {at(guess), force});
    return std::pair{sides_now[0].balance.work, sides_now[1].balance.work};
  };
  EXPECT_EQ(work(0.5, 1), (std::pair{1., 2.}));
  EXPECT_EQ(work(1.5, 2), (std::pair{2., 2.})) << "from its own 0.5, not from the structure's 1";
}

}  // namespace couplet::links_test

namespace couplet::mapping_test {
using namespace coupler;
using Kind = Mapping::Kind;
using MapType = MappingParameters::Type;

PointSet line(const std::string& what, int n, double y = 0) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.emplace_back(i / double(n - 1), y, 0);
  return {what, points};
}

std::string message(const PointSet& from, const PointSet& to, const MappingParameters& parameters) {
  return support::error_of([&] { const Mapping mapping(Kind::consistent, from, to, parameters); });
}

TEST(MatchedMapping, carries_values_to_their_twins_in_any_order) {
  const PointSet from = line("a", 50);
  PointSet to = from;
  std::shuffle(to.points.begin(), to.points.end(), std::mt19937(5));
  for (const Kind kind : {Kind::consistent, Kind::conservative}) {
    std::vector<double> values;
    for (const Vec3& p : from.points) values.insert(values.end(), {p.x(), -p.x()});
    const std::vector<double> result = Mapping(kind, from, to, {}).apply(values, 2);
    for (std::size_t i = 0; i < to.points.size(); ++i) {
      EXPECT_EQ(result[2 * i], to.points[i].x());
      EXPECT_EQ(result[2 * i + 1], -to.points[i].x());
    }
  }
}

TEST(MatchedMapping, reports_numbers_and_distances) {
  const Mapping mapping(Kind::consistent, line("a", 11), line("b", 11, 1e-9), {});
  EXPECT_NEAR(mapping.max_distance(), 1e-9, 1e-20);
  EXPECT_NEAR(mapping.mean_distance(), 1e-9, 1e-20);
}

TEST(MatchedMapping, names_points_without_a_twin) {
  PointSet to = line("vertices of 'fluid'", 5);
  to.points[3] += Vec3(0.05, 0.02, 0);
  EXPECT_EQ(message(line("vertices of 'solid'", 5), to, {}),
            "1 of 5 vertices of 'fluid' match none of the 5 vertices of 'solid' within 1e-06 m:\n"
            "  (0.8, 0.02, 0): the nearest is 0.0539 m away\n"
            "Give both meshes the same points on the interface, or set `coupling.mapping.type: projection`.");
}

TEST(MatchedMapping, names_points_that_only_the_other_side_lacks) {
  EXPECT_THAT(message(line("vertices of 'solid'", 9), line("vertices of 'fluid'", 5), {}),
              testing::StartsWith("4 of 9 vertices of 'solid' match none of the 5 vertices of 'fluid'"));
}

TEST(MatchedMapping, names_five_points_at_most) {
  EXPECT_THAT(message(line("a", 20), line("b", 20, 0.3), {}), testing::HasSubstr("\n  and 15 more"));
}

TEST(MatchedMapping, obeys_the_tolerance_of_the_user) {
  MappingParameters parameters;
  parameters.tolerance = 0.02;
  EXPECT_EQ(message(line("a", 5), line("b", 5, 0.01), parameters), "");
  parameters.tolerance = 0.005;
  EXPECT_NE(message(line("a", 5), line("b", 5, 0.01), parameters), "");
}

// What is near is a part of the surfaces' size, wherever they lie.
TEST(MatchedMapping, matches_alike_on_every_side_of_the_origin) {
  for (const double along : {-1000., -10., 10.}) {
    const auto moved = [&](const std::string& what, double aside) {
      PointSet set = line(what, 5, aside);
      for (Vec3& p : set.points) p.x() += along;
      return set;
    };
    EXPECT_EQ(message(moved("a", 0), moved("b", 5e-7), {}), "") << along;
    EXPECT_THAT(message(moved("a", 0), moved("b", 2e-6), {}), testing::HasSubstr("within 1e-06 m")) << along;
  }
}

TEST(MatchedMapping, refuses_twins_that_are_not_clear) {
  PointSet from = line("a", 5), to = line("b", 5);
  to.points[2] = to.points[3];
  from.points[2] = from.points[3];
  EXPECT_THAT(message(from, to, {}), testing::HasSubstr("Ambiguous matching"));
}

TEST(Mapping, refuses_an_empty_side) {
  EXPECT_THAT(message(line("vertices of 'solid'", 5), PointSet{"vertices of 'fluid'", {}}, {}),
              testing::StartsWith("There are 5 vertices of 'solid' and 0 vertices of 'fluid'"));
}

TEST(NearestMapping, keeps_a_constant_motion_and_the_sum_of_forces) {
  MappingParameters parameters;
  parameters.type = MapType::nearest;
  const PointSet a = line("a", 17, 0.01), b = line("b", 40);
  const std::vector<double> moved =
      Mapping(Kind::consistent, a, b, parameters).apply(std::vector<double>(17, 2.5), 1);
  EXPECT_THAT(moved, testing::Each(2.5));
  std::vector<double> force(40);
  std::iota(force.begin(), force.end(), 1.);
  const std::vector<double> given = Mapping(Kind::conservative, b, a, parameters).apply(force, 1);
  EXPECT_EQ(given.size(), 17u);
  EXPECT_DOUBLE_EQ(std::accumulate(given.begin(), given.end(), 0.), 40 * 41 / 2);
}

TEST(NearestMapping, shares_a_force_among_the_finer_faces_under_it_by_their_size) {
  MappingParameters parameters;
  parameters.type = MapType::nearest;
  const PointSet coarse{"a", {Vec3(0.5, 0, 0), Vec3(1.5, 0, 0)}, {1, 1}};
  const PointSet fine{"b", {Vec3(0.3, 0, 0), Vec3(0.8, 0, 0), Vec3(1.5, 0, 0)}, {0.6, 0.4, 1}};
  const std::vector<double> given = Mapping(Kind::conservative, coarse, fine, parameters).apply({10, 7}, 1);
  EXPECT_THAT(given, testing::ElementsAre(testing::DoubleEq(6), testing::DoubleEq(4), testing::DoubleEq(7)));
}

}  // namespace couplet::mapping_test
