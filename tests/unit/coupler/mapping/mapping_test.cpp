// SPDX-License-Identifier: Apache-2.0
// Maps over the coupler's ranks: the same values as on one, however the two sides are cut.
#include "coupler/exchange/side.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/mapping/sparse_map.hpp"
#include "coupler/output/record.hpp"
#include "tests/coupling/support/surfaces.hpp"
#include "tests/support/world.hpp"

namespace couplet::maps_ranks_test {
using namespace coupling;
using namespace parallel;
using namespace coupler;
using Place = Interface::Place;

/// n points on a spiral, this rank's part of them; `turned`: the list runs the other way.
PointSet spiral(int n, bool turned) {
  PointSet set;
  set.starts = even_starts(n, comm_size(world));
  const auto rank = std::size_t(comm_rank(world));
  for (GlobalIndex p = set.starts[rank]; p < set.starts[rank + 1]; ++p) {
    const double t = double(turned ? n - 1 - p : p) / (n - 1);
    set.points.emplace_back(t * std::cos(9 * t), t * std::sin(9 * t), t);
    set.positions.push_back(p);
    set.ids.push_back(turned ? n - 1 - p : p);
    set.sizes.push_back(1 + 0.5 * t);
  }
  return set;
}

/// The list of all ranks.
PointSet gathered(const PointSet& set) {
  return whole_set({set.what, all_gather(world, set.points), all_gather(world, set.sizes)});
}

TEST(MapsOverRanks, nearest_points_are_those_of_one_rank) {
  for (const auto& [n, m] : {std::pair{101, 37}, std::pair{5, 200}, std::pair{2, 1}}) {
    const PointSet a = spiral(n, false), b = spiral(m, true);
    const auto found = nearest(world, a.points, b);
    const auto expected = nearest(MPI_COMM_SELF, a.points, gathered(b));
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].distance, expected[i].distance);
      EXPECT_EQ((found[i].point - expected[i].point).norm(), 0);
    }
  }
}

TEST(MapsOverRanks, both_kinds_carry_what_one_rank_carries_and_keep_sums) {
  MappingParameters parameters;
  parameters.type = MappingParameters::Type::nearest;
  for (const auto& [n, m] : {std::pair{101, 37}, std::pair{37, 101}, std::pair{1, 8}})
    for (const auto kind : {Mapping::Kind::consistent, Mapping::Kind::conservative}) {
      const PointSet from = spiral(std::max(n, 2), false), to = spiral(m, true);
      std::vector<double> values;
      for (const Vec3& p : from.points) values.insert(values.end(), {p.x() + 1, std::sin(5 * p.z())});
      const Mapping map(world, kind, from, to, parameters);
      const auto carried = all_gather(world, map.apply(values, 2));
      const Mapping alone(MPI_COMM_SELF, kind, gathered(from), gathered(to), parameters);
      const auto expected = alone.apply(all_gather(world, values), 2);
      ASSERT_EQ(carried.size(), expected.size());
      for (std::size_t i = 0; i < carried.size(); ++i) EXPECT_NEAR(carried[i], expected[i], 1e-14);
      if (kind == Mapping::Kind::consistent) continue;
      const auto all = all_gather(world, values);
      EXPECT_NEAR(std::accumulate(carried.begin(), carried.end(), 0.),
                  std::accumulate(all.begin(), all.end(), 0.), 1e-12);
    }
}

TEST(MapsOverRanks, matched_points_find_their_twins_on_any_rank) {
  const PointSet from = spiral(50, false), to = spiral(50, true);
  const Mapping map(world, Mapping::Kind::consistent, from, to, {});
  std::vector<double> z;
  for (const Vec3& p : from.points) z.push_back(p.z());
  const auto carried = map.apply(z, 1);
  for (std::size_t i = 0; i < carried.size(); ++i) EXPECT_EQ(carried[i], to.points[i].z());
}

/// Of values of two components at points of all ranks: sums, first moments about x and y.
std::vector<double> sums(const std::vector<Vec3>& points, const std::vector<double>& values) {
  std::vector<double> list(6, 0.);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Vec3& p = points[i / 2];
    list[i % 2] += values[i], list[2 + i % 2] += p.x() * values[i], list[4 + i % 2] += p.y() * values[i];
  }
  for (double& value : list) value = sum(world, value);
  return list;
}

/// Both kinds of maps of second order between parts, against those between the whole surfaces on one rank.
void expect_as_on_one_rank(const Interface& a, const Interface& b, MappingParameters::Type type) {
  using Place = Interface::Place;
  MappingParameters parameters;
  parameters.type = type;
  const Side from(world, "a", tests::part_of(world, a)), to(world, "b", tests::part_of(world, b)),
      all_from(MPI_COMM_SELF, "a", a), all_to(MPI_COMM_SELF, "b", b);
  for (const auto kind : {Mapping::Kind::consistent, Mapping::Kind::conservative})
    for (const auto& [given, taken] :
         {std::pair{Place::vertices, Place::vertices}, std::pair{Place::vertices, Place::faces},
          std::pair{Place::faces, Place::vertices}, std::pair{Place::faces, Place::faces}}) {
      const PointSet mine = from.places(given), theirs = to.places(taken);
      std::vector<double> values;
      for (const Vec3& p : mine.points)
        values.insert(values.end(), {std::sin(9 * p.x() + p.y()), p.y() * p.y()});
      const Mapping map(world, kind, mine, theirs, parameters);
      const Mapping alone(MPI_COMM_SELF, kind, all_from.places(given), all_to.places(taken), parameters);
      const auto carried = all_gather(world, map.apply(values, 2)),
                 expected = alone.apply(all_gather(world, values), 2);
      ASSERT_EQ(carried.size(), expected.size());
      for (std::size_t i = 0; i < carried.size(); ++i)
        ASSERT_NEAR(carried[i], expected[i], 1e-14)
            << int(type) << int(kind) << int(given) << int(taken) << " at " << i;
      if (kind == Mapping::Kind::consistent) continue;
      const auto out = sums(mine.points, values), in = sums(theirs.points, map.apply(values, 2));
      for (std::size_t i = 0; i < out.size(); ++i)
        EXPECT_NEAR(out[i], in[i], 1e-12 * double(expected.size()))
            << int(type) << int(given) << int(taken) << " sum " << i;
    }
}

constexpr MappingParameters::Type type = MappingParameters::Type::projection;

TEST(MapsOverRanks, of_second_order_are_built_in_parts_as_on_one_rank) {
  using tests::flap, tests::plate;
  {
    expect_as_on_one_rank(flap(51, 9, 1), flap(17, 3, -1), type);
    // Regular meshes: many places are equally near.
    expect_as_on_one_rank(plate(6, false, 1), plate(12, false, -1, 0.01), type);
    // Fewer faces than neighbours wanted.
    expect_as_on_one_rank(plate(1, false, 1), plate(5, false, -1), type);
  }
}

/// Vertices on a line, joined by edges.
Interface line_through(const std::vector<double>& x, double side = 1) {
  Interface s;
  s.dim = 2;
  for (const double at : x) s.vertices.emplace_back(at, 0, 0);
  for (Index i = 0; i + 1 < Index(x.size()); ++i)
    tests::add_face(s, {i, i + 1}, {0, side * (x[std::size_t(i) + 1] - x[std::size_t(i)]), 0});
  return s;
}

/// n vertices on a line of 1 m.
Interface line(int n, double side = 1) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(i / (n - 1.));
  return line_through(x, side);
}

TEST(MapsOverRanks, a_face_that_is_much_larger_than_others_finds_all_that_it_covers) {
  std::vector<double> x{0};
  for (int i = 0; i <= 20; ++i) x.push_back(0.9 + 0.005 * i);
  expect_as_on_one_rank(line_through(x), line(41, -1), type);
}

TEST(MapsOverRanks, an_amount_at_a_vertex_goes_to_where_it_projects) {
  const Side from(world, "a", tests::part_of(world, line(5))), to(world, "b", tests::part_of(world, line(3)));
  MappingParameters parameters;
  {
    parameters.type = type;
    const PointSet mine = from.places(Place::vertices), theirs = to.places(Place::vertices);
    const Mapping map(world, Mapping::Kind::conservative, mine, theirs, parameters);
    const auto taken = all_gather(world, map.apply(std::vector<double>(mine.points.size(), 1.), 1));
    ASSERT_EQ(taken.size(), 3u);
    EXPECT_NEAR(taken[0] + taken[1] + taken[2], 5, 1e-14);
    EXPECT_NEAR(taken[1] / 2 + taken[2], 2.5, 1e-14);
    EXPECT_NEAR(taken[0], 1.5, 1e-14);
  }
}

TEST(MapsOverRanks, need_of_the_other_surface_what_is_near_alone) {
  const Side sheet(world, "sheet", tests::part_of(world, tests::plate(24, false, 1)));
  const PointSet mine = sheet.places(Interface::Place::faces);
  const PointSet near = nearby(world, mine.points, {}, 4, mine);
  // A rank's own part (rows of the sheet) and the row beside it on each side.
  const std::size_t rows = 24, row = 48;
  EXPECT_LE(near.positions.size(), comm_size(world) > 1 ? mine.points.size() + 2 * row : rows * row);
  EXPECT_GE(near.positions.size(), mine.points.size());
  for (std::size_t i = 0; i + 1 < near.positions.size(); ++i)
    EXPECT_LT(near.positions[i], near.positions[i + 1]);
}

TEST(MapsOverRanks, a_closed_curve_has_as_many_faces_as_vertices_and_values_at_faces_stay_there) {
  constexpr int n = 40;
  const Interface ring = tests::ring(n);
  const Side side(world, "ring", tests::part_of(world, ring));
  const PointSet faces = side.places(Interface::Place::faces);
  MappingParameters parameters;
  parameters.type = MappingParameters::Type::projection;
  const Mapping map(world, Mapping::Kind::consistent, faces, faces, parameters);
  std::vector<double> x;
  for (const Vec3& p : faces.points) x.push_back(p.x());
  const std::vector<double> carried = map.apply(x, 1);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(carried[i], x[i], 1e-12);
}

TEST(Transfers, entries_given_on_any_rank_add_up) {
  const Starts targets = even_starts(10, comm_size(world)), sources = even_starts(7, comm_size(world));
  std::vector<Transfer::Entry> entries;
  // Rank 0 alone knows the matrix: target t = source t mod 7 + twice source 0.
  if (comm_rank(world) == 0)
    for (GlobalIndex t = 0; t < 10; ++t) entries.insert(entries.end(), {{t, t % 7, 1.}, {t, 0, 2.}});
  const Transfer transfer(world, targets, sources, entries);
  std::vector<double> values;
  const auto rank = std::size_t(comm_rank(world));
  for (GlobalIndex s = sources[rank]; s < sources[rank + 1]; ++s) values.push_back(double(s) + 5);
  const auto all = all_gather(world, transfer.apply(values, 1));
  for (int t = 0; t < 10; ++t) EXPECT_EQ(all[std::size_t(t)], t % 7 + 5 + 2 * 5);
}

// Integrals over interfaces that a coupling watches, against values by hand, on any number of ranks.

Interface sheet(bool triangles) {
  Interface s = tests::plate(4, triangles, -1);  // (0, 2) x (0, 1), areas down, corners counted the other way
  s.takes = {{"pressure-force", "N", Place::faces},
             {"heat", "W", Place::faces, 1},
             {"weights", "N", Place::vertices}};
  s.gives = {{"displacement", "m", Place::vertices},
             {"velocity", "m/s", Place::vertices},
             {"temperature", "degC", Place::faces, 1},
             {"five", "1", Place::faces, 5},
             {"mass-flux", "kg/m^2/s", Place::faces}};
  return s;
}

std::vector<double> vectors(const std::vector<Vec3>& points, const std::function<Vec3(const Vec3&)>& of) {
  std::vector<double> values;
  for (const Vec3& p : points) {
    const Vec3 v = of(p);
    values.insert(values.end(), {v.x(), v.y(), v.z()});
  }
  return values;
}

std::vector<double> watch(const Interface& whole,
                          const std::map<std::string, coupler::IntegralParameters>& watched,
                          const std::function<void(const Interface&, Exchange&, Exchange&)>& fill) {
  std::vector<coupler::Side> sides;
  sides.emplace_back(world, "sheet", tests::part_of(world, whole));
  const coupler::InterfaceIntegrals integrals(world, sides, watched);
  Exchange given, taken;
  fill(sides[0].interface, given, taken);
  const auto row = integrals.row({given}, {taken});
  EXPECT_EQ(row.size(), integrals.columns().size());
  return row;
}

TEST(InterfaceIntegrals, amounts_are_summed_and_scalars_have_integral_and_mean) {
  const auto row = watch(sheet(false),
                         {{"a", {"sheet", "heat"}},
                          {"c", {"sheet", "temperature"}},
                          {"d", {"sheet", "pressure-force"}},
                          {"e", {"sheet", "weights"}}},
                         [](const Interface& i, Exchange& given, Exchange& taken) {
                           for (const Vec3& c : i.face_centres) {
                             taken["heat"].push_back(c.x());
                             given["temperature"].push_back(20 + 10 * c.x());
                           }
                           taken["pressure-force"] =
                               vectors(i.face_centres, [](const Vec3&) { return Vec3(1, 2, 3); });
                           taken["weights"] = vectors(i.vertices, [](const Vec3&) { return Vec3(0, 0, 1); });
                         });
  // 32 faces, 45 vertices: sum of x over 8 columns of 4; int of 20 + 10 x over (0, 2) x (0, 1), and its mean.
  const std::vector<double> expected{32, 60, 30, 32, 64, 96, 0, 0, 45};
  ASSERT_EQ(row.size(), expected.size());
  for (std::size_t k = 0; k < row.size(); ++k) EXPECT_NEAR(row[k], expected[k], 1e-12) << k;
}

TEST(InterfaceIntegrals, a_flux_goes_through_the_moved_surface) {
  // The sheet is stretched 3 to 1 along x and tilted: (x, y, 0) to (3 x, y, x); its area vector is (1, 0, -3) * 2.
  for (const bool triangles : {false, true}) {
    const auto row =
        watch(sheet(triangles), {{"v", {"sheet", "velocity"}}, {"w", {"sheet", "mass-flux"}}},
              [](const Interface& i, Exchange& given, Exchange&) {
                given["displacement"] =
                    vectors(i.vertices, [](const Vec3& x) { return Vec3(2 * x.x(), 0, x.x()); });
                given["velocity"] = vectors(i.vertices, [](const Vec3& x) { return Vec3(x.x(), 0, x.y()); });
                given["mass-flux"] = vectors(i.face_centres, [](const Vec3&) { return Vec3(0, 7, 1); });
              });
    // int of x over (0, 2) x (0, 1) is 2, of -3 y it is -3.
    EXPECT_NEAR(row[0], 2 - 3, 1e-12);
    EXPECT_NEAR(row[1], -6, 1e-12);
  }
  // At rest where no displacement is known.
  const auto still =
      watch(sheet(false), {{"v", {"sheet", "velocity"}}}, [](const Interface& i, Exchange& given, Exchange&) {
        given["velocity"] = vectors(i.vertices, [](const Vec3& x) { return Vec3(x.x(), 0, x.y()); });
      });
  EXPECT_NEAR(still[0], -1, 1e-12);
}

TEST(InterfaceIntegrals, in_the_plane_a_growing_circle_sweeps_its_circumference) {
  constexpr int n = 64;
  Interface ring = tests::ring(n);
  ring.gives = {{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}};
  const auto row =
      watch(ring, {{"v", {"sheet", "velocity"}}}, [](const Interface& i, Exchange& given, Exchange&) {
        for (const Vec3& x : i.vertices)
          for (int c = 0; c < 2; ++c)
            given["displacement"].push_back(x[c]), given["velocity"].push_back(x[c]);
      });
  // Radius 2, growing at 1: the polygon's area n R^2 sin(2 pi / n) / 2 changes at that rate.
  EXPECT_NEAR(row[0], n * 2 * std::sin(2 * M_PI / n), 1e-12);
}

TEST(InterfaceIntegrals, what_has_not_gone_over_yet_is_no_number) {
  const auto row = watch(sheet(false), {{"a", {"sheet", "heat"}}, {"v", {"sheet", "velocity"}}},
                         [](const Interface&, Exchange&, Exchange&) {});
  EXPECT_TRUE(std::isnan(row[0]) && std::isnan(row[1]));
}

void expect_refused(const Interface& whole, const coupler::IntegralParameters& p, const std::string& text) {
  try {
    watch(whole, {{"it", p}}, [](const Interface&, Exchange&, Exchange&) {});
    ADD_FAILURE() << "not refused: " << text;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
  }
}

TEST(InterfaceIntegrals, what_is_not_there_is_refused_with_what_is) {
  Interface blind = sheet(false);
  blind.face_offset.clear(), blind.face_vertices.clear();
  expect_refused(sheet(false), {"shet", "heat"}, "'shet' is not a participant");
  expect_refused(
      sheet(false), {"sheet", "heath"},
      "neither gives nor takes 'heath'. Its data are: displacement, velocity, temperature, five, mass-flux, "
      "pressure-force, heat, weights");
  expect_refused(sheet(false), {"sheet", "five"}, "has 5 components");
  expect_refused(blind, {"sheet", "velocity"}, "does not provide the corners of its faces");
}

}  // namespace couplet::maps_ranks_test
