// SPDX-License-Identifier: Apache-2.0
// Motion and load by one map and its transpose, between surfaces of any meshes, however they are cut over ranks.
#include <Eigen/Geometry>

#include "coupler/mapping/links.hpp"
#include "coupler/output/record.hpp"
#include "tests/coupling/support/surfaces.hpp"

namespace couplet::conjugate_test {
using namespace coupling;
using namespace parallel;
using namespace coupler;

using Place = Interface::Place;
using Type = MappingParameters::Type;
using tests::add_face, tests::flap, tests::plate, tests::ring;

const MPI_Comm world = MPI_COMM_WORLD;
constexpr Type type = Type::projection;

/// A tube of radius 1 and length 2 by n faces around and m along it, or each cut into two triangles.
Interface tube(int n, int m, bool triangles, double sign) {
  Interface s;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      s.vertices.emplace_back(std::cos(angle), std::sin(angle), 2. * j / m);
    }
  const auto add = [&](const std::vector<Index>& v) {
    Vec3 area = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < v.size(); ++k)
      area += 0.5 * (s.vertices[v[k]] - s.vertices[v[0]]).cross(s.vertices[v[k + 1]] - s.vertices[v[0]]);
    add_face(s, v, sign * area);
  };
  for (Index j = 0; j < m; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index a = j * n + i, b = j * n + (i + 1) % n, c = b + n, d = a + n;
      if (triangles)
        add({a, b, c}), add({a, c, d});
      else
        add({a, b, c, d});
    }
  return s;
}

/// A sheet with a face on either side of each square: over the same vertices, or each over its own.
Interface sheet(int n, bool shared, double sign) {
  Interface s = plate(n, false, sign), other = plate(n, !shared, -sign);
  const Index first = shared ? 0 : Index(s.vertices.size());
  if (!shared) s.vertices.insert(s.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (std::size_t f = 0; f < other.face_centres.size(); ++f) {
    std::vector<Index> corners;
    for (Index k = other.face_offset[f]; k < other.face_offset[f + 1]; ++k)
      corners.push_back(first + other.face_vertices[std::size_t(k)]);
    add_face(s, corners, other.face_areas[f]);
  }
  return s;
}

/// Vertices inside the sheet moved along it, by part of an edge of n to a length of 1.
Interface shaken(Interface s, int n) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> random(-0.25, 0.25);
  for (Vec3& v : s.vertices)
    if (v.x() > 1e-9 && v.x() < 2 - 1e-9 && v.y() > 1e-9 && v.y() < 1 - 1e-9)
      v += Vec3(random(engine), random(engine), 0) / n;
  for (std::size_t f = 0; f < s.face_centres.size(); ++f) {
    const auto corner = [&](Index k) {
      return s.vertices[s.face_vertices[std::size_t(s.face_offset[f] + k)]];
    };
    const double sign = s.face_areas[f].z() > 0 ? 1 : -1;
    Vec3 mean = Vec3::Zero();
    for (Index k = 0; k < 3; ++k) mean += corner(k) / 3;
    s.face_centres[f] = mean;
    s.face_areas[f] = sign * 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }
  return s;
}

struct Pair {
  const char* name;
  Interface structure, fluid;
};
std::vector<Pair> pairs() {
  return {{"flap 3:2", flap(30, 6, 1), flap(20, 4, -1)},
          {"flap 2:3", flap(20, 4, 1), flap(30, 6, -1)},
          {"flap 5:8", flap(25, 5, 1), flap(40, 8, -1, 0.3)},
          {"flap 7:3, one face at its end", flap(21, 1, 1), flap(9, 3, -1)},
          {"ring 7:3", ring(49), ring(21)},
          {"ring 3:8", ring(15), ring(40)},
          {"plate 3:2", plate(9, false, 1), plate(6, false, -1)},
          {"plate 5:8", plate(5, false, 1), plate(8, false, -1)},
          {"triangles on quadrilaterals", plate(7, true, 1), plate(5, false, -1)},
          {"quadrilaterals on triangles", plate(5, false, 1), plate(7, true, -1)},
          {"tetrahedra on hexahedra", shaken(plate(9, true, 1), 9), plate(5, false, -1)},
          {"hexahedra on tetrahedra", plate(5, false, 1), shaken(plate(8, true, -1), 8)},
          {"tube 3:2", tube(36, 9, false, 1), tube(24, 6, false, -1)},
          {"tube 5:8, triangles", tube(20, 5, false, 1), tube(32, 8, true, -1)},
          {"tube 7:3", tube(42, 7, true, 1), tube(18, 3, false, -1)},
          {"plate's two faces", sheet(6, true, 1), sheet(4, false, -1)}};
}

const std::vector<Interface::Datum> motion{{"displacement", "m", Place::vertices}},
    load{{"pressure-force", "N", Place::faces}};

/// A fluid and a structure; the structure's rings look inwards as seen from the fluid.
struct Coupled {
  std::vector<Side> sides;
  Links links;
  static std::vector<Side> made(Interface fluid, Interface structure, bool uneven) {
    fluid.takes = motion, fluid.gives = load, structure.takes = load, structure.gives = motion;
    // A ring's areas are given outwards.
    if (fluid.face_areas.front().dot(structure.face_areas.front()) > 0)
      for (Vec3& area : fluid.face_areas) area = -area;
    // Uneven: the structure has its one rank, the coupler's last.
    const bool mine = comm_rank(world) == comm_size(world) - 1;
    Interface nothing;
    nothing.dim = structure.dim, nothing.takes = load, nothing.gives = motion;
    return {{world, "fluid", tests::part_of(world, fluid)},
            {world, "solid", uneven ? (mine ? structure : nothing) : tests::part_of(world, structure)}};
  }
  Coupled(const Pair& p, Type type, bool uneven = false)
      : sides(made(p.fluid, p.structure, uneven)), links(world, sides, {.type = type, .tolerance = {}}) {}
  std::vector<double> moved(const std::vector<double>& by) const {
    return links.input(0, {{}, {{"displacement", by}}}).at("displacement");
  }
  std::vector<double> loaded(const std::vector<double>& by) const {
    return links.input(1, {{{"pressure-force", by}}, {}}).at("pressure-force");
  }
};

template <class F>
std::vector<double> at(const std::vector<Vec3>& points, int dim, const F& f) {
  std::vector<double> values;
  for (const Vec3& p : points) {
    const Vec3 value = f(p);
    values.insert(values.end(), value.begin(), value.begin() + dim);
  }
  return values;
}

std::vector<double> random_values(std::size_t n, unsigned seed) {
  std::mt19937 engine(seed + 100 * unsigned(comm_rank(world)));
  std::uniform_real_distribution<double> random(-1, 1);
  std::vector<double> values(n);
  for (double& v : values) v = random(engine);
  return values;
}

double size(const std::vector<double>& values) {
  return std::sqrt(sum(world, std::inner_product(values.begin(), values.end(), values.begin(), 0.)));
}

TEST(ConjugateMaps, give_and_take_the_same_work_force_and_moment) {
  double work = 0, force = 0, moment = 0;
  for (const Pair& p : pairs())
    for (const bool uneven : {false, true}) {
      const Coupled c(p, type, uneven);
      const int dim = p.fluid.dim;
      const Interface &fluid = c.sides[0].interface, &solid = c.sides[1].interface;
      // Any motion and any load: no part of them is smooth.
      const auto u = random_values(solid.vertices.size() * std::size_t(dim), 1);
      const auto f = random_values(fluid.face_centres.size() * std::size_t(dim), 2);
      const Balance given = Balancing(world, c.sides[0])({{"pressure-force", f}}, load, c.moved(u));
      const Balance taken = Balancing(world, c.sides[1])({{"pressure-force", c.loaded(f)}}, load, u);
      const double forces = size(f), apart = std::abs(given.work - taken.work) / std::abs(given.work);
      EXPECT_LT(apart, 1e-12) << p.name;
      const double by_force = (given.force - taken.force).norm() / forces,
                   by_moment = (given.moment - taken.moment).norm() / forces;
      EXPECT_LT(by_force, 1e-12) << p.name;
      EXPECT_LT(by_moment, 1e-12) << p.name;
      work = std::max(work, apart), force = std::max(force, by_force), moment = std::max(moment, by_moment);
    }
  RecordProperty("work_apart", fmt::format("{:.1e}", work));
  RecordProperty("force_apart", fmt::format("{:.1e}", force));
  RecordProperty("moment_apart", fmt::format("{:.1e}", moment));
}

// Across a nearly flat surface the places hardly spread, so that round-off of positions far from the origin
// weighs most there.
TEST(ConjugateMaps, keep_amounts_on_a_nearly_flat_surface_far_from_the_origin) {
  const auto bent = [](Interface s) {
    for (Vec3& v : s.vertices) v += Vec3(30, 20, 10 + 1e-5 * std::sin(6 * v.x()) * std::sin(7 * v.y()));
    for (std::size_t f = 0; f < s.face_centres.size(); ++f) {
      s.face_centres[f].setZero();
      for (Index k = s.face_offset[f]; k < s.face_offset[f + 1]; ++k)
        s.face_centres[f] +=
            s.vertices[s.face_vertices[std::size_t(k)]] / (s.face_offset[f + 1] - s.face_offset[f]);
    }
    return s;
  };
  for (const int n : {6, 14, 31})
    EXPECT_NO_THROW(Coupled({"", bent(plate(n, false, 1)), bent(plate(2 * n / 3, false, -1))}, type)) << n;
}

TEST(ConjugateMaps, carry_linear_motion_exactly) {
  double worst = 0;
  const auto linear = [](const Vec3& p) {
    return Vec3(1 + 2 * p.x() - 3 * p.y() + p.z(), p.y() - p.x() + 0.5 * p.z(), 4 - p.x() + 2 * p.z());
  };
  for (const Pair& p : pairs()) {
    const Coupled c(p, type);
    const auto moved = c.moved(at(c.sides[1].interface.vertices, p.fluid.dim, linear)),
               wanted = at(c.sides[0].interface.vertices, p.fluid.dim, linear);
    double off = 0;
    for (std::size_t i = 0; i < moved.size(); ++i) off = std::max(off, std::abs(moved[i] - wanted[i]));
    off = max(world, off);
    EXPECT_LT(off, 1e-12) << p.name;
    worst = std::max(worst, off);
  }
  RecordProperty("linear_off", fmt::format("{:.1e}", worst));
}

TEST(ConjugateMaps, carry_quadratic_motion_to_second_order) {
  const auto quadratic = [](const Vec3& p) {
    return Vec3(p.x() * p.x() - p.x() * p.y(), p.y() * p.y() + p.z() * p.x(), p.x() * p.y());
  };
  double least = 10;
  {
    const auto error = [&](const Pair& p) {
      const Coupled c(p, type);
      const auto moved = c.moved(at(c.sides[1].interface.vertices, p.fluid.dim, quadratic)),
                 wanted = at(c.sides[0].interface.vertices, p.fluid.dim, quadratic);
      double off = 0;
      for (std::size_t i = 0; i < moved.size(); ++i) off = std::max(off, std::abs(moved[i] - wanted[i]));
      return max(world, off);
    };
    const std::vector<std::pair<Pair, Pair>> ladders{
        {{"flap", flap(15, 3, 1), flap(10, 2, -1)}, {"flap", flap(60, 12, 1), flap(40, 8, -1)}},
        {{"ring", ring(24), ring(36)}, {"ring", ring(96), ring(144)}},
        {{"plate", plate(5, false, 1), plate(8, true, -1)},
         {"plate", plate(20, false, 1), plate(32, true, -1)}},
        {{"tube", tube(14, 4, false, 1), tube(21, 6, false, -1)},
         {"tube", tube(56, 16, false, 1), tube(84, 24, false, -1)}}};
    for (const auto& [coarse, fine] : ladders) {
      const double order = std::log(error(coarse) / error(fine)) / std::log(4.);
      EXPECT_GT(order, 1.8) << coarse.name;
      least = std::min(least, order);
    }
  }
  RecordProperty("least_order", fmt::format("{:.2f}", least));
}

TEST(ConjugateMaps, a_uniform_pressure_stays_uniform_on_a_finer_structure) {
  double worst = 0;
  const Pair finer[] = {{"flap 3:1", flap(60, 9, 1), flap(20, 3, -1)},
                        {"flap 7:3", flap(70, 7, 1), flap(30, 3, -1)},
                        {"ring 7:3", ring(84), ring(36)},
                        {"plate 7:3", plate(14, false, 1), plate(6, false, -1)},
                        {"plate 5:2, triangles", plate(10, true, 1), plate(4, false, -1)},
                        {"tetrahedra on hexahedra", shaken(plate(15, true, 1), 15), plate(5, false, -1)},
                        {"tube 7:3", tube(84, 14, false, 1), tube(36, 6, false, -1)}};
  for (const Pair& p : finer) {
    const Coupled c(p, type);
    const Interface &fluid = c.sides[0].interface, &solid = c.sides[1].interface;
    const int dim = p.fluid.dim;
    std::vector<double> pressure;
    for (const Vec3& area : fluid.face_areas)
      pressure.insert(pressure.end(), area.begin(), area.begin() + dim);
    const std::vector<double> taken = c.loaded(pressure);
    double most = 0, total = 0, areas = 0;
    const double fluid_face = p.fluid.face_areas.front().norm();
    // Beside the sharp corners of the flap a vertex moves with both sides, so each takes a part of the other's load.
    const double edge = dim == 2 && p.structure.vertices.front().x() == 0 ? 2 * fluid_face : 0;
    for (std::size_t f = 0; f < solid.face_areas.size(); ++f) {
      const Vec3& at = solid.face_centres[f];
      if (std::min((at - Vec3(0, 1, 0)).norm(), (at - Vec3(0.1, 1, 0)).norm()) < edge) continue;
      const double area = solid.face_areas[f].norm(),
                   force = Eigen::Map<const Eigen::VectorXd>(&taken[f * std::size_t(dim)], dim).norm();
      most = std::max(most, force / area), total += force, areas += area;
    }
    const double uneven = max(world, most) / (sum(world, total) / sum(world, areas));
    EXPECT_LT(uneven, 1.05) << p.name;
    worst = std::max(worst, uneven);
  }
  RecordProperty("largest_over_mean", fmt::format("{:.4f}", worst));
}

Interface stretched(Interface s, const Vec3& by) {
  for (Vec3& v : s.vertices) v = v.cwiseProduct(by);
  for (Vec3& c : s.face_centres) c = c.cwiseProduct(by);
  for (Vec3& area : s.face_areas) area = by.prod() * area.cwiseQuotient(by);
  return s;
}

TEST(ConjugateMaps, faces_that_nothing_covers_move_with_what_is_nearest_and_no_load_is_lost) {
  const Pair uncovered[] = {
      {"flap, a fluid beyond its foot", flap(20, 4, 1), stretched(flap(24, 3, -1), {1, 1.4, 1})},
      {"flap, a fluid that is cut by its end", flap(20, 4, 1), stretched(flap(7, 3, -1), {1, 0.93, 1})},
      {"plate, a fluid beyond its edges", plate(5, false, 1), stretched(plate(7, false, -1), {1.4, 1.3, 1})},
      {"plate, triangles beyond its edges", plate(6, true, 1), stretched(plate(4, true, -1), {1.4, 1.9, 1})},
      {"plate, a structure on one side of it", plate(6, false, 1), sheet(4, false, -1)}};
  for (const Pair& p : uncovered) {
    const Coupled c(p, type);
    const Interface &fluid = c.sides[0].interface, &solid = c.sides[1].interface;
    const int dim = p.fluid.dim;
    const auto moved = c.moved(at(solid.vertices, dim, [](const Vec3&) { return Vec3(1, -2, 3); })),
               wanted = at(fluid.vertices, dim, [](const Vec3&) { return Vec3(1, -2, 3); });
    for (std::size_t i = 0; i < moved.size(); ++i) ASSERT_NEAR(moved[i], wanted[i], 1e-11) << p.name;
    const auto f = random_values(fluid.face_centres.size() * std::size_t(dim), 6),
               u = random_values(solid.vertices.size() * std::size_t(dim), 7), by_u = c.moved(u);
    for (const double v : by_u) ASSERT_LT(std::abs(v), 20) << p.name;
    const Balance given = Balancing(world, c.sides[0])({{"pressure-force", f}}, load, by_u),
                  taken = Balancing(world, c.sides[1])({{"pressure-force", c.loaded(f)}}, load, u);
    EXPECT_NEAR(given.work, taken.work, 1e-11 * std::abs(given.work)) << p.name;
    EXPECT_LT((given.force - taken.force).norm(), 1e-11 * size(f)) << p.name;
  }
}

TEST(ConjugateMaps, a_motion_given_at_faces_and_a_load_taken_at_vertices_are_conjugate_too) {
  for (const auto& [moves, takes] :
       {std::pair{Place::faces, Place::faces}, std::pair{Place::vertices, Place::vertices}}) {
    Interface solid = flap(30, 6, 1), fluid = flap(20, 4, -1);
    solid.gives = {{"displacement", "m", moves}}, solid.takes = {{"pressure-force", "N", takes}};
    fluid.takes = motion, fluid.gives = load;
    const std::vector<Side> sides{{world, "fluid", tests::part_of(world, fluid)},
                                  {world, "solid", tests::part_of(world, solid)}};
    const Links links(world, sides, {.type = type, .tolerance = {}});
    const auto u = random_values(sides[1].entries(moves) * 2, 3),
               f = random_values(sides[0].entries(Place::faces) * 2, 4);
    const auto moved = links.input(0, {{}, {{"displacement", u}}}).at("displacement"),
               taken = links.input(1, {{{"pressure-force", f}}, {}}).at("pressure-force");
    const double given = Balancing(world, sides[0])({{"pressure-force", f}}, load, moved).work;
    EXPECT_NEAR(sum(world, std::inner_product(u.begin(), u.end(), taken.begin(), 0.)), given,
                1e-12 * std::abs(given));
  }
}

TEST(ConjugateMaps, pressures_and_temperatures_go_consistently_and_heats_with_their_sum_kept) {
  Interface solid = flap(30, 6, 1), fluid = flap(20, 4, -1);
  fluid.gives = {{"pressure", "Pa", Place::faces, 1}, {"heat", "W", Place::faces, 1}};
  solid.takes = {{"pressure", "Pa", Place::faces, 1}, {"heat", "W", Place::faces, 1}, load[0]};
  fluid.gives.push_back(load[0]), fluid.takes = solid.gives = motion;
  {
    const std::vector<Side> sides{{world, "fluid", tests::part_of(world, fluid)},
                                  {world, "solid", tests::part_of(world, solid)}};
    const Links links(world, sides, {.type = type, .tolerance = {}});
    const std::size_t n = sides[0].interface.face_centres.size();
    const std::vector<double> heat = random_values(n, 5);
    const Exchange taken = links.input(1, {{{"pressure", std::vector<double>(n, 7.)}, {"heat", heat}}, {}});
    for (const double p : taken.at("pressure")) EXPECT_NEAR(p, 7, 1e-11);
    const auto total = [](const std::vector<double>& v) {
      return sum(world, std::accumulate(v.begin(), v.end(), 0.));
    };
    EXPECT_NEAR(total(taken.at("heat")), total(heat), 1e-12);
  }
}

}  // namespace couplet::conjugate_test
