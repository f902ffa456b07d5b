// SPDX-License-Identifier: Apache-2.0
// What the boundaries promise: profiles, ramps, outlets, periodic pairs, and a body force in balance.
#include "fluid_case.hpp"
#include "fluid_solver/participant.hpp"
#include "tests/support/apart.hpp"
#include "tests/support/observed_run.hpp"

namespace couplet::fluid::test::boundaries_test {
using namespace mesh;

constexpr double pi = std::numbers::pi;

FluidParameters duct() {
  FluidParameters p = fluid_of(1.3, 0.05, 1e-10);
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  return p;
}

BoundaryParameters inlet(InletProfile profile, const std::string& mean) {
  BoundaryParameters b;
  b.type = BoundaryType::inlet;
  b.mean_speed = config::ExpressionText{mean};
  b.profile = profile;
  return b;
}

RawMesh quads(int nx, int ny, double length) {
  return make_box(BoxCells::quadrilaterals, {nx, ny, 1}, Vec3::Zero(), Vec3(length, 1, 1));
}

double flow_through(const FluidCase<2>& c, const char* patch) {
  double flow = 0;
  const Patch& faces = *c.mesh().find_patch(patch);
  for (Index f = faces.first; f < faces.first + faces.count; ++f) flow += c.state().phi[f];
  return parallel::sum(c.mesh().comm, flow);
}

TEST(Inlet, parabolic_profile_is_the_poiseuille_flow_of_that_mean_speed) {
  FluidParameters p = duct();
  p.boundaries["xmin"] = inlet(InletProfile::parabolic, "2");
  FluidCase<2> c(MPI_COMM_WORLD, quads(24, 16, 1.5), p);
  c.run(3, 30);
  EXPECT_NEAR(flow_through(c, "xmin"), -2, 1e-12);
  EXPECT_LT(c.velocity_error([](const Vec3& x) { return Vec3(12 * x.y() * (1 - x.y()), 0, 0); }), 0.02);
}

TEST(Inlet, parabolic_profile_is_largest_where_it_meets_a_symmetry_plane) {
  for (const char* plane : {"ymin", "ymax"}) {
    FluidParameters p = duct();
    p.boundaries[plane] = boundary(BoundaryType::symmetry);
    p.boundaries["xmin"] = inlet(InletProfile::parabolic, "2");
    FluidCase<2> c(MPI_COMM_WORLD, quads(24, 16, 1.5), p);
    c.run(3, 30);
    EXPECT_NEAR(flow_through(c, "xmin"), -2, 1e-12);
    EXPECT_LT(c.velocity_error([&](const Vec3& x) {
      const double r = plane == std::string("ymin") ? x.y() : 1 - x.y();
      return Vec3(3 * (1 - r * r), 0, 0);
    }),
              0.02)
        << plane;
  }
  FluidParameters p = duct();
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::symmetry);
  p.boundaries["xmin"] = inlet(InletProfile::parabolic, "2");
  EXPECT_THROW(FluidCase<2>(MPI_COMM_WORLD, quads(8, 8, 1), p), Error);
}

/// Velocity of the faces of xmin along x, as set in the flow, with its flow rate and largest error against a profile of the place.
struct AtInlet {
  double flow = 0, apart = 0;
  template <int D>
  static AtInlet of(RawMesh raw, FluidParameters p, const std::function<double(const Vec3&)>& profile) {
    p.dimension = D;
    const auto [mesh, geometry] =
        distribute(MPI_COMM_WORLD, parallel::comm_rank(MPI_COMM_WORLD) == 0 ? std::move(raw) : RawMesh{});
    const Boundary<D> boundary(mesh, geometry, p);
    const auto at = make_placement<D>(mesh, geometry);
    Vectors<D> w(mesh.boundary.n_owned(), Vec<D>::Zero());
    boundary.velocity_at(0, at->boundary_centre, w);
    AtInlet found;
    const Patch& inlet = *mesh.find_patch("xmin");
    for (Index f = inlet.first; f < inlet.first + inlet.count; ++f) {
      const Index b = f - mesh.n_interior;
      found.flow += w[b].dot(at->area[f]);
      found.apart = std::max(found.apart, std::abs(w[b][0] - profile(at->boundary_centre[b])));
    }
    return {parallel::sum(MPI_COMM_WORLD, found.flow), parallel::max(MPI_COMM_WORLD, found.apart)};
  }
};

/// Whole disk, half and quarter of one whose cut sides are symmetry planes.
TEST(Inlet, parabolic_profile_of_a_part_of_a_disk_is_that_of_the_disk) {
  for (const int part : {1, 2, 4}) {
    FluidParameters p = duct();
    for (const char* side : {"ymin", "ymax", "zmin", "zmax"})
      p.boundaries[side] = boundary(BoundaryType::no_slip);
    const double y0 = part < 2 ? -1 : 0, z0 = part < 4 ? -1 : 0;
    if (part > 1) p.boundaries["ymin"] = boundary(BoundaryType::symmetry);
    if (part > 2) p.boundaries["zmin"] = boundary(BoundaryType::symmetry);
    p.boundaries["xmin"] = inlet(InletProfile::parabolic, "2");
    RawMesh raw = make_box(BoxCells::hexahedra, {1, part < 2 ? 24 : 12, part < 4 ? 24 : 12}, Vec3(0, y0, z0),
                           Vec3(0.2, 1, 1));
    for (Vec3& x : raw.points)  // a square becomes a disk
      x = Vec3(x.x(), x.y() * std::sqrt(1 - x.z() * x.z() / 2), x.z() * std::sqrt(1 - x.y() * x.y() / 2));
    const AtInlet found =
        AtInlet::of<3>(raw, p, [](const Vec3& x) { return 4 * (1 - x.y() * x.y() - x.z() * x.z()); });
    EXPECT_NEAR(found.flow, -2 * pi / part, 0.01 * 2 * pi / part) << part;  // area of the polygon
    EXPECT_LT(found.apart, 0.1) << part;
  }
}

/// A profile is averaged over each face: the flow rate is that of the profile on any mesh.
TEST(Inlet, flow_rate_is_that_of_the_profile) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("couplet-inlet-" + std::to_string(parallel::comm_size(MPI_COMM_WORLD)) + ".csv");
  for (const int n : {1, 3, 8}) {
    const auto flow = [&](const std::string& u, auto dimension) {
      constexpr int D = decltype(dimension)::value;
      FluidParameters p = duct();
      if (D == 3) p.boundaries["zmin"] = p.boundaries["zmax"] = boundary(BoundaryType::slip);
      p.boundaries["xmin"] =
          D == 2 ? boundary(BoundaryType::inlet, {u, "0"}) : boundary(BoundaryType::inlet, {u, "0", "0"});
      if (u.empty()) {
        p.boundaries["xmin"] = boundary(BoundaryType::inlet);
        p.boundaries["xmin"].table.emplace();
        p.boundaries["xmin"].table->file = file;
        MPI_Barrier(MPI_COMM_WORLD);
        if (parallel::comm_rank(MPI_COMM_WORLD) == 0)
          std::ofstream(file) << (D == 2 ? "y [m],u [m/s],v\n0,0,0\n0.37,1,0\n1,0,0\n"
                                         : "y [m],u [m/s],v,w\n0,0,0,0\n0.37,1,0,0\n1,0,0,0\n");
        MPI_Barrier(MPI_COMM_WORLD);
      }
      return AtInlet::of<D>(D == 2 ? quads(4, n, 1)
                                   : make_box(BoxCells::hexahedra, {4, n, n}, Vec3::Zero(), Vec3(1, 1, 1)),
                            p, [](const Vec3&) { return 0.0; })
          .flow;
    };
    const std::integral_constant<int, 2> plane{};
    const std::integral_constant<int, 3> space{};
    EXPECT_NEAR(flow("6*y*(1-y)", plane), -1, 1e-12) << n;
    EXPECT_NEAR(flow("6*y*(1-y)", space), -1, 1e-12) << n;
    EXPECT_NEAR(flow("36*y*(1-y)*z*(1-z)", space), -1, 2e-3) << n;
    EXPECT_NEAR(flow("1.5*(1-y^2)", plane), -1, 1e-12) << n;
    EXPECT_NEAR(flow("", plane), -0.5, 1e-3) << n;
    EXPECT_NEAR(flow("", space), -0.5, 1e-3) << n;
  }
}

TEST(Inlet, mean_speed_follows_time_and_ramp) {
  FluidParameters p = duct();
  p.boundaries["xmin"] = inlet(InletProfile::uniform, "1+t");
  p.boundaries["xmin"].ramp = 0.4;
  FluidCase<2> c(MPI_COMM_WORLD, quads(8, 8, 1), p);
  c.run(0.1, 2);
  EXPECT_NEAR(flow_through(c, "xmin"), -1.1 * 0.5 * (1 - std::cos(pi * 0.25)), 1e-12);
  c.run(0.5, 4);
  EXPECT_NEAR(flow_through(c, "xmin"), -1.5, 1e-12);
  EXPECT_NEAR(flow_through(c, "xmax"), 1.5, 1e-8);
}

TEST(Inlet, round_patch_in_3d_is_asked_for) {
  FluidParameters p = duct();
  p.boundaries["zmin"] = p.boundaries["zmax"] = boundary(BoundaryType::slip);
  p.boundaries["xmin"] = inlet(InletProfile::parabolic, "1");
  const auto make = [&] {
    FluidCase<3> c(MPI_COMM_WORLD, make_box(BoxCells::hexahedra, {4, 4, 4}, Vec3::Zero(), Vec3(1, 1, 3)), p);
  };
  EXPECT_THAT(make, ::testing::ThrowsMessage<Error>(::testing::HasSubstr("not round")));
}

/// A gust of vorticity leaves the domain; what is left behind an ideal outlet is the uniform stream.
double disturbance_left(BoundaryType type) {
  FluidParameters p = fluid_of(1, 1e-3, 1e-8);
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"1", "0"});
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::slip);
  p.boundaries["xmax"] = boundary(type);
  p.initial_velocity = {{"1-4*(y-0.5)*exp(-((x-1)^2+(y-0.5)^2)/0.02)"},
                        {"4*(x-1)*exp(-((x-1)^2+(y-0.5)^2)/0.02)"}};
  FluidCase<2> c(MPI_COMM_WORLD, quads(64, 32, 2), p);
  const double before = c.velocity_error([](const Vec3&) { return Vec3(1, 0, 0); });
  c.run(2.5, 100);
  EXPECT_NEAR(flow_through(c, "xmax"), 1, 1e-7);
  return c.velocity_error([](const Vec3&) { return Vec3(1, 0, 0); }) / before;
}

TEST(ConvectiveOutlet, lets_a_vortex_out) {
  EXPECT_LT(disturbance_left(BoundaryType::convective_outlet), 0.08);
}
TEST(Outlet, lets_a_vortex_out) { EXPECT_LT(disturbance_left(BoundaryType::outlet), 0.08); }

/// A slug without friction between two openings at the same pressure. What comes in brings half its momentum,
/// the rest is the head it left in the room it came from: L du/dt = -u^2/2, u = 1/(1/u_0 + t/(2 L)). Without
/// the stabilisation it goes on for ever.
TEST(Outlet, backflow_pays_its_head) {
  for (const bool stabilised : {true, false}) {
    FluidParameters p = fluid_of(1.3, 0, 1e-10);
    p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::slip);
    p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::outlet);
    p.boundaries["xmin"].backflow_stabilisation = stabilised;
    p.initial_velocity = {{"1"}, {"0"}};
    FluidCase<2> c(MPI_COMM_WORLD, quads(16, 4, 2), p);
    c.run(1, 100);
    const double expected = stabilised ? 1 / (1 + 1 / (2 * 2.0)) : 1;
    // of first order in the width of the cell that the fluid comes in by: L less one cell
    EXPECT_NEAR(flow_through(c, "xmax"), expected, stabilised ? 0.012 : 1e-10)
        << (stabilised ? "with" : "without");
  }
}

/// The Taylor-Green array that travels through a doubly periodic box returns after a period as if it had not
/// moved (nu = 0.01).
// Without an outlet the pressure of a part has any level beside that of the others.
TEST(Parts, of_a_fluid_that_no_cell_connects_need_an_outlet_each) {
  const auto told = [](int apart, const std::string& last, FluidParameters p) {
    RawMesh raw = quads(4, 4, 1);
    for (int i = 1; i <= apart; ++i)
      raw = support::beside(std::move(raw), make_box(BoxCells::quadrilaterals, {3, 4, 1}, Vec3(2 * i, 0, 0),
                                                     Vec3(2 * i + 1, 1, 1)));
    p.boundaries["xmin"] = boundary(BoundaryType::no_slip);
    raw.patches.push_back("last");
    for (Index b = 0; b < raw.boundary_points.size(); ++b) {
      bool right = true;
      for (const Index v : raw.boundary_points[b]) right = right && raw.points[v][0] == 2 * apart + 1;
      if (right) raw.boundary_patch[b] = int(raw.patches.size()) - 1;
    }
    p.boundaries["last"] = p.boundaries[last];
    return support::error_of([&] { FluidCase<2>(MPI_COMM_WORLD, raw, p); });
  };
  FluidParameters closed = duct(), open = duct();
  closed.boundaries["xmax"] = boundary(BoundaryType::no_slip);
  EXPECT_EQ(told(0, "xmin", closed), "");
  EXPECT_THAT(told(1, "xmin", closed),
              ::testing::HasSubstr("has 2 parts that no cell connects, and 2 of them have no outlet"));
  EXPECT_EQ(told(2, "xmax", open), "");
  EXPECT_THAT(told(2, "xmin", open),
              ::testing::HasSubstr("has 3 parts that no cell connects, and 1 of them have no outlet"));
}

TEST(Periodic, travelling_vortices_keep_second_order) {
  double error[2];
  for (int i = 0; i < 2; ++i) {
    const int n = 32 << i;
    FluidParameters p = fluid_of(1, 0.01, 1e-9);
    all_sides(p, 2, boundary(BoundaryType::periodic));
    p.initial_velocity = {{"0.8+sin(x)*cos(y)"}, {"0.3-cos(x)*sin(y)"}};
    RawMesh raw = make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(2 * pi, 2 * pi, 1));
    raw.periodic = {{"xmin", "xmax"}, {"ymin", "ymax"}};
    FluidCase<2> c(MPI_COMM_WORLD, raw, p);
    c.run(1, 60 << i);
    error[i] = c.velocity_error([&](const Vec3& x) {
      const double a = x.x() - 0.8, b = x.y() - 0.3, f = std::exp(-0.02);
      return Vec3(0.8 + f * std::sin(a) * std::cos(b), 0.3 - f * std::cos(a) * std::sin(b), 0);
    });
  }
  printf("periodic: %.2e %.2e slope %.2f\n", error[0], error[1], std::log2(error[0] / error[1]));
  RecordProperty("slope", std::to_string(std::log2(error[0] / error[1])));
  EXPECT_GT(std::log2(error[0] / error[1]), 1.95);
}

TEST(Periodic, channel_under_a_body_force_becomes_poiseuille_3d) {
  FluidParameters p = fluid_of(2, 0.5, 1e-9);
  p.viscous = ViscousTreatment::implicit;
  all_sides(p, 3, boundary(BoundaryType::periodic));
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.body_force = {{"1"}, {"0"}, {"0"}};
  RawMesh raw = make_box(BoxCells::hexahedra, {4, 24, 2}, Vec3::Zero(), Vec3(1, 1, 0.5));
  raw.periodic = {{"xmin", "xmax"}, {"zmin", "zmax"}};
  FluidCase<3> c(MPI_COMM_WORLD, raw, p);
  c.run(4, 100);
  const double error =
      c.largest_velocity_error([](const Vec3& x) { return Vec3(2 * x.y() * (1 - x.y()), 0, 0); });
  printf("channel: %.2e of 0.5\n", error);
  EXPECT_LT(error, 2e-3);
}

TEST(Periodic, patches_that_do_not_fit_are_refused_with_the_place) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 4, 1}, Vec3::Zero(), Vec3::Ones());
  raw.periodic = {{"xmin", "ymax"}};
  EXPECT_THAT([&] { distribute(MPI_COMM_SELF, raw); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("has no match on 'ymax'")));
}

TEST(BodyForce, that_grows_with_time_moves_a_fluid_without_walls_to_rounding) {
  FluidParameters p = fluid_of(2, 0.5, 1e-12);
  all_sides(p, 2, boundary(BoundaryType::periodic));
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::slip);
  p.body_force = {{"3*t"}, {"0"}};
  RawMesh raw = make_box(BoxCells::quadrilaterals, {6, 4, 1}, Vec3::Zero(), Vec3::Ones());
  raw.periodic = {{"xmin", "xmax"}};
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  c.run(1, 8);  // the middle of a step has the mean of the force
  EXPECT_LT(c.largest_velocity_error([](const Vec3&) { return Vec3(1.5, 0, 0); }), 1e-9);
}

TEST(BodyForce, is_balanced_by_the_pressure_of_a_fluid_at_rest) {
  FluidParameters p = duct();
  p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::no_slip);
  p.body_force = {{"3"}, {"-9.81"}};
  p.pressure_tolerance = 1e-13;
  RawMesh raw = quads(12, 10, 1);
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  c.run(0.5, 20);
  EXPECT_LT(c.largest_velocity_error([](const Vec3&) { return Vec3(0, 0, 0); }), 1e-11);
  EXPECT_LT(c.pressure_error([&](const Vec3& x) { return 1.3 * (3 * x.x() - 9.81 * x.y()); }), 1e-10);
}

/// Triangles, whose centres of gravity lie beside the lines through their faces, make no flow of still water; the errors are told
/// by what its weight would do.
TEST(BodyForce, leaves_still_water_at_rest_on_triangles) {
  for (const BoundaryType vent : {BoundaryType::outlet, BoundaryType::no_slip}) {
    FluidParameters p = fluid_of(1000, 0.1, 1e-4, "box");
    all_sides(p, 2, boundary(BoundaryType::no_slip));
    p.boundaries["ymax"] = boundary(vent);
    p.body_force = {{"0"}, {"-9.81"}};
    RawMesh raw = make_box(BoxCells::triangles, {10, 10, 1}, Vec3::Zero(), Vec3::Ones());
    perturb_interior(raw, 0.3, 7);
    FluidParticipant<2> fluid(distribute(MPI_COMM_WORLD, raw), p, FluidContext{}, MotionLink{});
    const auto run = support::observe(fluid, 50, 0.02);
    double speed = 0, error = 0;
    const auto pressure = fluid.fluid().pressure();
    const double level = vent == BoundaryType::outlet ? 1 : 0.5;
    for (Index c = 0; c < fluid.fluid().mesh().cells.n_owned(); ++c) {
      speed = std::max(speed, fluid.fluid().state().u[c].norm());
      error = std::max(
          error, std::abs(pressure->p[c] - 9810 * (level - fluid.fluid().state().placement->centre[c].y())));
    }
    EXPECT_LT(parallel::max(MPI_COMM_WORLD, speed), 1e-9);
    EXPECT_LT(parallel::max(MPI_COMM_WORLD, error), 1e-6);
    const diagnostics::ErrorParts& errors = run.diagnostics().errors();
    for (const double part : {errors.mesh, errors.step, errors.linear})
      EXPECT_FALSE(part > 0.02) << errors.text();
  }
}

/// A body force that varies and has a potential makes no flow either, on any cells, at rest or sheared to and fro; one
/// without a potential still drives.
template <int D>
double speed_of_still_fluid(BoxCells cells, const std::vector<config::ExpressionText>& force, bool moves) {
  FluidParameters p = fluid_of(1000, 0.1, 1e-4, "box");
  all_sides(p, D, boundary(BoundaryType::no_slip));
  p.body_force = force;
  const int n = D == 2 ? 8 : 4;
  RawMesh raw = make_box(cells, {n, n, D == 2 ? 1 : n}, Vec3::Zero(), Vec3(1, 1, D == 2 ? 0 : 1));
  perturb_interior(raw, 0.2, 7);
  const auto shears = [](const Vec3& x, GlobalIndex, double t) -> Vec3 {
    return x + 0.1 * std::sin(3 * t) * std::sin(pi * x.x()) * std::sin(pi * x.y()) * Vec3::UnitX();
  };
  FluidCase<D> c(MPI_COMM_WORLD, raw, p, moves ? PointMotion(shears) : PointMotion());
  c.run(0.5, 25);
  return c.largest_velocity_error([](const Vec3&) { return Vec3(0, 0, 0); });
}

TEST(BodyForce, that_varies_and_has_a_potential_leaves_fluid_at_rest) {
  const std::vector<config::ExpressionText> pull{{"4*cos(2*x)*exp(y)"}, {"2*sin(2*x)*exp(y)-9.81"}};
  const double fall = 9.81 * 0.5;
  for (const bool moves : {false, true}) {
    for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles})
      EXPECT_LT(speed_of_still_fluid<2>(cells, pull, moves), 1e-10 * fall) << int(cells) << moves;
    for (const BoxCells cells :
         {BoxCells::hexahedra, BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed})
      EXPECT_LT(speed_of_still_fluid<3>(cells, {pull[0], pull[1], {"0"}}, moves), 1e-10 * fall)
          << int(cells) << moves;
  }
  EXPECT_GT(speed_of_still_fluid<2>(BoxCells::quadrilaterals, {{"y"}, {"-9.81-x"}}, false), 1e-3)
      << "it turns";
}

/// What enters through an outlet pays rho U^2/2 unless told otherwise; the run says so.
TEST(Outlet, that_takes_the_total_pressure_of_inflow_says_so) {
  for (const bool stabilised : {true, false}) {
    FluidParameters p = fluid_of(1000, 1e-3, 1e-8, "box");
    p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::slip);
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"-sin(t)", "0"});
    p.boundaries["xmax"] = boundary(BoundaryType::outlet);
    p.boundaries["xmax"].backflow_stabilisation = stabilised;
    FluidParticipant<2> fluid(distribute(MPI_COMM_WORLD, quads(8, 2, 1)), p, FluidContext{}, MotionLink{});
    const auto run = support::observe(fluid, 50, 0.02);
    int told = 0;
    for (const diagnostics::Finding& f : run.diagnostics().findings())
      if (f.effect == "pressure of inflow") {
        ++told;
        EXPECT_EQ(f.severity, base::Severity::note);
      }
    EXPECT_EQ(told, stabilised ? 1 : 0);
  }
}

}  // namespace couplet::fluid::test::boundaries_test
