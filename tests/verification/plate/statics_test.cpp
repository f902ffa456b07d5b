// SPDX-License-Identifier: Apache-2.0
// Static deflections against closed forms, and by modes against the direct ones.
#include "plate_modal/model/midsurface.hpp"
#include "plate_modal/model/plate_model.hpp"
#include "plate_modal/structure.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::statics_test {
using namespace mesh;
using namespace modes;

using namespace test;

double largest(const PlateModel& plate, std::span<const double> unknowns) {
  const std::vector<double> points = plate.to_points(unknowns);
  double value = 0;
  for (std::size_t i = 0; i < points.size(); i += 3)
    if (std::abs(points[i]) > std::abs(value)) value = points[i];
  return value;
}

double deflection(const PlateModel& plate, double pressure) {
  const std::vector<double> p(plate.surface().cells.size(), pressure);
  return largest(plate, plate.deflect(plate.load_of(p)));
}

// Timoshenko, "Theory of plates and shells": clamped circle p a^4 / (64 D); hinged circle times (5 + nu) / (1
// + nu); squares p a^4 / D times 0.00126532 (clamped) and 0.00406235 (hinged).
TEST(PlateStatics, deflections_are_those_of_closed_forms_and_converge_at_second_order) {
  struct Case {
    const char* name;
    RawMesh (*mesh)(int);
    Support support;
    double exact;
  };
  const auto squares = [](int n) { return square(n, BoxCells::triangles); };
  for (const Case& c : {Case{"clamped-circle", disc, Support::clamped, 1. / 64},
                        Case{"hinged-circle", disc, Support::simply_supported, 5.3 / 1.3 / 64},
                        Case{"clamped-square", squares, Support::clamped, 0.00126532},
                        Case{"hinged-square", squares, Support::simply_supported, 0.00406235}}) {
    const double coarse = deflection(make_plate(c.mesh(12), all_edges(c.support)), 1) / c.exact - 1;
    const double fine = deflection(make_plate(c.mesh(24), all_edges(c.support)), 1) / c.exact - 1;
    EXPECT_LT(std::abs(fine), 0.005) << c.name;
    EXPECT_GT(std::log2(std::abs(coarse / fine)), 1.8) << c.name;
    RecordProperty(std::string(c.name) + "-error", fmt::format("{:.6f}", fine));
    RecordProperty(std::string(c.name) + "-slope", fmt::format("{:.3f}", std::log2(std::abs(coarse / fine))));
  }
}

/// A strip that bends in one direction: mirrors along its sides. Its root half is twice as thick.
RawMesh stepped_strip(int n) {
  RawMesh raw = make_box(BoxCells::triangles, {2 * n, 2, 1}, Vec3::Zero(), Vec3(1, 2. / (2 * n), 0));
  raw.zones = {"root", "tip"};
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    double x = 0;
    for (const Index p : raw.cell_points[c]) x += raw.points[p].x() / 3;
    raw.cell_zone[c] = x < 0.5 ? 0 : 1;
  }
  return raw;
}

TEST(PlateStatics, a_plate_of_two_thicknesses_and_its_weight_follow_the_closed_form) {
  Parameters p;
  p.analysis = Parameters::Analysis::static_;
  p.material = {1000, 1e9, 0.3};
  p.thickness = 0.01;
  p.zones["root"].thickness = 0.02;
  p.boundaries = {{"xmin", {Support::clamped}},
                  {"xmax", {}},
                  {"ymin", {Support::symmetry}},
                  {"ymax", {Support::symmetry}}};
  const PlateModel plate = plate_of(midsurface_of(stepped_strip(20)), p, "strip");
  const double d2 = plate.cell(plate.surface().cells.size() - 1).rigidity(), d1 = 8 * d2;
  // Cantilever of length 1 under q: w'' = q (1 - x)^2 / (2 D); tip = int (1 - x) w'' dx.
  const double pressure = 10;
  const double root = (1 - 1. / 16) / 4, tip = 1. / 64;  // int (1 - x)^3 over each half
  const double exact = pressure / 2 * (root / d1 + tip / d2);
  const double got = deflection(plate, pressure);
  EXPECT_NEAR(got / exact, 1, 0.005);
  RecordProperty("two-thicknesses", fmt::format("{:.6f}", got / exact - 1));
  // Its weight: q = rho g h of each half; M(x) for x > 1/2: q2 (1-x)^2/2; below: q2/2 (3/4 - x) + q1 (1/2 -
  // x)^2 / 2.
  const double g = 9.81, q1 = 1000 * g * 0.02, q2 = 1000 * g * 0.01;
  const double moment_root =
      q2 / 2 *
          (0.25 * 0 +
           [] {  // int_0^{1/2} (1 - x)(3/4 - x) dx
             const auto f = [](double x) { return 0.75 * x - 0.875 * x * x + x * x * x / 3; };
             return f(0.5) - f(0);
           }()) +
      q1 / 2 * [] {  // int_0^{1/2} (1 - x)(1/2 - x)^2 dx, with s = 1/2 - x: (1/2 + s) s^2
        return 0.5 / 3 * 0.125 + 0.25 * 0.0625;
      }();
  const double weight_exact = moment_root / d1 + q2 / 2 * tip / d2;
  p.gravity = {0, 0, -g};
  const RawMesh raw = stepped_strip(20);
  Structure structure(p, PlateContext{}, &raw);
  structure.begin_step({0, 1, coupling::Scheme::standalone, 0});
  structure.solve({});
  structure.accept_step();
  double deepest = 0;
  const std::vector<double> u = structure.displacement();
  for (std::size_t i = 2; i < u.size(); i += 3) deepest = std::min(deepest, u[i]);
  EXPECT_NEAR(-deepest / weight_exact, 1, 0.005);
  RecordProperty("weight", fmt::format("{:.6f}", -deepest / weight_exact - 1));
}

/// The same pressure prescribed and given by a partner: deflection of fields and probes, and the rate beside it.
TEST(PlateStatics, the_load_of_a_partner_deflects_like_a_prescribed_one) {
  for (const Wetted wetted : {Wetted::upper, Wetted::lower, Wetted::both}) {
    Parameters p;
    p.material = {1000, 1e9, 0.3};
    p.thickness = 0.02;
    p.number = 3;
    p.analysis = Parameters::Analysis::static_;
    p.output.fields = false;
    p.wetted = wetted;
    for (const char* patch : {"xmin", "xmax", "ymin", "ymax"}) p.boundaries[patch].support = Support::clamped;
    const RawMesh raw = square(8);
    std::vector<double> deflections[2];
    for (const bool by_partner : {false, true}) {
      Parameters one = p;
      if (!by_partner && wetted == Wetted::lower)
        one.load.emplace().lower = config::ExpressionText{"-100"};
      else if (!by_partner)
        one.load.emplace().upper = config::ExpressionText{"100"};
      Structure plate(one, {MPI_COMM_WORLD, "plate", {}, {}, std::numeric_limits<double>::quiet_NaN()}, &raw);
      const coupling::Interface interface = plate.initialise();
      coupling::Exchange in;
      // Pushed down from above, or drawn from below.
      for (const Vec3& area : interface.face_areas)
        for (const double f :
             {0., 0., wetted == Wetted::lower ? 100 * area.z() : -100 * std::max(area.z(), 0.)})
          in["pressure-force"].push_back(by_partner ? f : 0);
      plate.begin_step({0, 0.5, coupling::Scheme::implicit, 0});
      const coupling::Exchange out = plate.solve(in);
      if (out.contains("velocity")) {  // on rank 0
        for (std::size_t i = 0; i < out.at("velocity").size(); ++i)
          EXPECT_NEAR(0.5 * out.at("velocity")[i], out.at("displacement")[i], 1e-12);
      }
      plate.accept_step();
      deflections[by_partner] = plate.displacement();
    }
    double largest = 0;
    ASSERT_EQ(deflections[0].size(), deflections[1].size());
    for (std::size_t i = 0; i < deflections[0].size(); ++i) {
      EXPECT_NEAR(deflections[0][i], deflections[1][i], 1e-12);
      largest = std::max(largest, std::abs(deflections[1][i]));
    }
    EXPECT_NEAR(largest / (0.00126532 * 100 / (1e9 * 8e-6 / (12 * 0.91))), 1, 0.03);
  }
}

TEST(PlateStatics, deflection_by_modes_tends_to_the_direct_one) {
  const PlateModel plate = make_plate(square(16), all_edges(Support::clamped));
  const std::vector<double> ones(plate.surface().cells.size(), 1), load = plate.load_of(ones);
  const std::vector<double> direct = plate.deflect(load);
  double before = 1, last = 1;
  for (const int n : {1, 5, 15, 45, 120}) {
    const EigenModes modes = plate.modes(n);
    std::vector<double> sum(direct.size(), 0);
    for (int m = 0; m < n; ++m) {
      double q = 0;
      for (std::size_t r = 0; r < load.size(); ++r) q += modes.shape[m][r] * load[r] / modes.eigenvalue[m];
      for (std::size_t r = 0; r < load.size(); ++r) sum[r] += q * modes.shape[m][r];
    }
    last = std::abs(largest(plate, sum) / largest(plate, direct) - 1);
    EXPECT_LT(last, before) << n;
    if (n == 15) {
      EXPECT_LT(last, 0.01);
      RecordProperty("by-15", fmt::format("{:.3e}", last));
    }
    before = last;
  }
  EXPECT_LT(last, 1e-4);
  RecordProperty("by-120", fmt::format("{:.3e}", last));
}

/// The disc with its outline, and the rings within in proportion, drawn in onto the sides of a regular polygon.
RawMesh polygon(int sides, int rings) {
  RawMesh raw = disc(rings);
  const double part = 2 * std::numbers::pi / sides;
  for (Vec3& x : raw.points) {
    const double angle = std::atan2(x.y(), x.x()) + 2 * std::numbers::pi;
    x *= std::cos(part / 2) / std::cos(angle - part * (std::floor(angle / part + 1e-9) + 0.5));
  }
  return raw;
}

struct Centre {
  double deflection;
  std::size_t corners;  ///< blunt ones
};
Centre centre_of(const RawMesh& raw, std::span<const int> curves = {}) {
  Midsurface surface = midsurface_of(raw, curves);
  const std::size_t cells = surface.cells.size();
  const std::vector<Support> held{Support::simply_supported};
  const std::size_t corners = blunt_corners(surface, outline_of(surface), held).size();
  const PlateModel plate(std::move(surface), std::vector<PlateCell>(cells, unit_cell()), held);
  return {plate.to_points(plate.deflect(plate.load_of(std::vector<double>(cells, 1))))[0], corners};
}

// Babuska's paradox: the limit of simply supported polygons with ever more sides is 3 / 64, a circle has
// (5 + nu) / (64 (1 + nu)). 18 sides about the radius 1: Poisson's equation twice by harmonic polynomials.
TEST(PlateStatics, a_circle_is_a_circle_on_any_mesh_and_a_polygon_with_blunt_corners_is_told) {
  const double circle = 5.3 / (64 * 1.3), polygon_of_18 = 0.04493;
  double before_circle = 1, before = 0.3;
  for (const int rings : {6, 12, 24}) {  // 2, 4, 8 edges a side
    const Centre round = centre_of(disc(rings)), straight = centre_of(polygon(18, rings));
    const double of_circle = std::abs(round.deflection / circle - 1);
    EXPECT_EQ(round.corners, 0u) << rings;
    EXPECT_LT(of_circle, 0.3 * before_circle) << rings;
    before_circle = of_circle;
    const double of_polygon = straight.deflection / polygon_of_18 - 1;
    EXPECT_EQ(straight.corners, 18u) << rings;
    EXPECT_GT(of_polygon, 0) << rings;  // from above, and slowly
    EXPECT_LT(of_polygon, before) << rings;
    before = of_polygon;
    RecordProperty(fmt::format("rings-{}", rings),
                   fmt::format("circle {:.4f}, polygon {:.4f}", of_circle, of_polygon));
  }
}

// Between hinged edges the deflection is as smooth as r^(pi / angle): a hexagon converges as h, a square as h^2, an inner
// corner of 270 degrees as h^(2/3). The hexagon of side 1 by Poisson's equation twice, extrapolated: 0.030696.
TEST(PlateStatics, a_hexagon_converges_as_its_corners_let_it_and_is_told) {
  const double degree = std::numbers::pi / 180;
  EXPECT_NEAR(order_at_corner(60 * degree), 1, 1e-12);
  EXPECT_NEAR(order_at_corner(90 * degree), 2, 1e-12);
  EXPECT_NEAR(order_at_corner(120 * degree), 2, 1e-12);
  EXPECT_NEAR(order_at_corner(-90 * degree), 2. / 3, 1e-12);
  EXPECT_NEAR(order_at_corner(30 * degree), 0.4, 1e-12);
  double before = 0;
  for (const int rings : {4, 8, 16}) {
    const Centre hexagon = centre_of(polygon(6, rings));
    const double error = std::abs(hexagon.deflection / 0.030696 - 1);
    EXPECT_EQ(hexagon.corners, 6u) << rings;
    if (before > 0) {
      EXPECT_NEAR(std::log2(before / error), 1, 0.25) << rings;
    }
    before = error;
  }
  EXPECT_EQ(with_corners(0.0045, 0.0045, {}), 0.0045);
  const std::array<double, 1> sixty{60 * degree}, faint{degree};
  EXPECT_NEAR(with_corners(0.0015, 0.0045, sixty), std::sqrt(0.0045), 1e-12);
  EXPECT_LT(with_corners(0.0015, 0.0045, faint), 0.05);
}

TEST(PlateStatics, sides_of_one_edge_are_told_from_a_curve_by_the_drawing) {
  const RawMesh raw = disc(3);  // 18 edges
  std::vector<int> lines, arcs, many;
  for (int e = 0; e < 18; ++e) lines.push_back(e), arcs.push_back(e / 9), many.push_back(e / 2);
  EXPECT_EQ(centre_of(raw, lines).corners, 18u);
  EXPECT_EQ(centre_of(raw, arcs).corners, 0u);
  EXPECT_EQ(centre_of(raw, many).corners, 0u);  // nine arcs of two edges each
  EXPECT_EQ(centre_of(raw).corners, 0u);
}

// A circle of 12 edges in four arcs turns by 30 degrees from edge to edge: were these corners, both slopes would be held.
TEST(PlateStatics, a_coarse_circle_is_not_held_as_a_polygon) {
  std::vector<int> quarters;
  for (int e = 0; e < 12; ++e) quarters.push_back(e / 3);
  const double circle = 5.3 / (64 * 1.3);
  EXPECT_NEAR(centre_of(disc(2), quarters).deflection / circle, 1, 0.1);
  EXPECT_EQ(centre_of(disc(2), quarters).corners, 0u);
  std::vector<int> lines;
  for (int e = 0; e < 12; ++e) lines.push_back(e);
  EXPECT_EQ(centre_of(disc(2), lines).corners, 12u);
}

/// Sector of the unit disc between two planes of symmetry: n rings, m edges of its arc; patches arc and planes.
RawMesh sector(double angle, int n, int m) {
  RawMesh raw;
  raw.dim = 2;
  raw.points.push_back(Vec3::Zero());
  for (int r = 1; r <= n; ++r)
    for (int i = 0; i <= m; ++i)
      raw.points.emplace_back(std::cos(angle * i / m) * r / n, std::sin(angle * i / m) * r / n, 0);
  const auto at = [m](int ring, int i) { return Index(ring == 0 ? 0 : 1 + (ring - 1) * (m + 1) + i); };
  for (int r = 1; r <= n; ++r)
    for (int i = 0; i < m; ++i) {
      raw.cell_points.push_row(std::array{at(r, i), at(r, i + 1), at(r - 1, i)});
      if (r > 1) raw.cell_points.push_row(std::array{at(r, i + 1), at(r - 1, i + 1), at(r - 1, i)});
    }
  raw.cell_type.assign(raw.cell_points.size(), CellType::triangle);
  raw.cell_zone.assign(raw.cell_points.size(), 0);
  raw.zones = {"plate"};
  raw.patches = {"arc", "planes"};
  for (int i = 0; i < m; ++i) raw.boundary_points.push_row(std::array{at(n, i), at(n, i + 1)});
  raw.boundary_patch.assign(m, 0);
  for (const int side : {0, m})
    for (int r = 1; r <= n; ++r) {
      raw.boundary_points.push_row(std::array{at(r - 1, side), at(r, side)});
      raw.boundary_patch.push_back(1);
    }
  return raw;
}

// The narrower the sector, the more its planes turn at the middle: up to 170 degrees, where they are nearly one line. Where a
// coarse arc meets a plane, its chord does not, but the arc does, at a right angle: one slope is held there.
TEST(PlateStatics, a_sector_deflects_as_the_disc_whatever_its_angle_and_its_arc) {
  const double degree = std::numbers::pi / 180;
  struct Case {
    double angle;
    int edges;
    double bound;
  };
  for (const auto& [kind, value] :
       {std::pair{Support::clamped, 1. / 64}, {Support::simply_supported, 5.3 / (64 * 1.3)}})
    for (const Case& c : {Case{10, 2, 0.03}, {20, 2, 0.03}, {24, 2, 0.03}, {90, 9, 0.04}, {90, 3, 0.12}}) {
      const PlateModel plate =
          make_plate(sector(c.angle * degree, 12, c.edges), {{"arc", kind}, {"planes", Support::symmetry}});
      EXPECT_NEAR(deflection(plate, 1) / value, 1, c.bound) << c.angle << " degrees, " << c.edges << " edges";
    }
}

TEST(PlateStatics, a_plate_that_nothing_holds_is_refused) {
  Parameters p;
  p.analysis = Parameters::Analysis::static_;
  p.material = {1000, 1e9, 0.3};
  p.thickness = 0.01;
  p.number = 4;
  for (const char* patch : {"xmin", "xmax", "ymin", "ymax"}) p.boundaries[patch];
  const RawMesh raw = square(4);
  EXPECT_THROW(Structure(p, PlateContext{}, &raw), Error);
  p.boundaries["xmin"].support = Support::clamped;
  EXPECT_NO_THROW(Structure(p, PlateContext{}, &raw));
}

}  // namespace couplet::plate::statics_test
