// SPDX-License-Identifier: Apache-2.0
// Velocities from files and rotating inlets; lines and planes in the output, with means and rms.
#include "fluid_case.hpp"
#include "fluid_solver/participant.hpp"
#include "tests/support/csv.hpp"

namespace couplet::fluid::test::samples_test {
using namespace mesh;
namespace fs = std::filesystem;

/// A folder of this test on this number of ranks, made anew. Collective.
fs::path folder_of(const std::string& name) {
  const fs::path folder = fs::temp_directory_path() /
                          ("couplet-" + name + "-" + std::to_string(parallel::comm_size(MPI_COMM_WORLD)));
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  return folder;
}

void write(const fs::path& file, const std::string& text) {
  MPI_Barrier(MPI_COMM_WORLD);  // nobody still reads the one before
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::ofstream(file) << text;
  MPI_Barrier(MPI_COMM_WORLD);
}

RawMesh box(std::array<Index, 3> cells) {
  return parallel::comm_rank(MPI_COMM_WORLD) == 0
             ? make_box(BoxCells::quadrilaterals, cells, Vec3::Zero(), Vec3(2, 1, 1))
             : RawMesh{};
}

/// u = y between a wall at rest and one that moves, exact on any mesh; what comes in is in a file.
FluidParameters couette() {
  FluidParameters p = fluid_of(1.3, 0.02, 1e-13, "box");
  p.initial_velocity = {{"y"}, {"0"}};
  p.boundaries["xmin"] = boundary(BoundaryType::inlet);
  p.boundaries["xmin"].table.emplace();
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "0.7");
  p.boundaries["ymin"] = boundary(BoundaryType::no_slip);
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  p.initial_pressure = config::ExpressionText{"0.7"};
  return p;
}

TEST(VelocityTable, is_linear_in_space_and_time_between_its_places) {
  const fs::path folder = folder_of("table");
  write(folder / "in.csv", "# u = y (1 + t)\nt [s],y [m],v,u [m/s]\n0,1,0,1\n0,0,0,0\n2,0,0,0\n2,1,0,3\n");
  FluidParameters p = couette();
  p.boundaries["xmin"].table->file = folder / "in.csv";
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, box({4, 10, 1}));
  const Boundary<2> boundary(mesh, geometry, p);
  const auto at = make_placement<2>(mesh, geometry);
  Vectors<2> w(mesh.boundary.n_owned(), Vec<2>::Zero());
  boundary.velocity_at(0.5, at->boundary_centre, w);
  const Patch& inlet = *mesh.find_patch("xmin");
  for (Index f = inlet.first; f < inlet.first + inlet.count; ++f) {
    const Index b = f - mesh.n_interior;
    EXPECT_NEAR(w[b][0], at->boundary_centre[b][1] * 1.5, 1e-14);
    EXPECT_EQ(w[b][1], 0);
  }
}

TEST(VelocityTable, repeats_in_time) {
  const fs::path file = folder_of("repeated-table") / "in.csv";
  write(file, "t,y,u,v\n0,0,0,0\n0,1,1,0\n0.3,0,0,0\n0.3,1,4,0\n");
  const auto value = [&](double period, double y, double t) {
    std::array<double, 2> values{};
    fv::GridTable::read(file, {"u", "v"}, fv::GridTable::Outside::error, period)
        .evaluate(Vec3(0, y, 0), t, values);
    return values[0];
  };
  for (const int n : {-2, 0, 7}) {
    EXPECT_NEAR(value(1, 1, 0.1 + n), 2, 1e-13);
    EXPECT_NEAR(value(1, 0.5, 0.65 + n), 1.25, 1e-13);  // between the last time and the end of the period
  }
  EXPECT_THAT(support::error_of([&] { value(0.2, 1, 0); }),
              ::testing::HasSubstr("longer than the period of 0.2 s"));
  EXPECT_THAT(support::error_of([&] { value(0.3, 1, 0); }), ::testing::HasSubstr("differ by up to 3 m/s"));
}

std::string refusal(const fs::path& file, const std::string& text, double y = 0.5) {
  write(file, text);
  return support::error_of([&] {
    const fv::GridTable table = fv::GridTable::read(file, {"u", "v"}, fv::GridTable::Outside::error);
    std::array<double, 2> values{};
    table.evaluate(Vec3(0, y, 0), 0, values);
  });
}

TEST(VelocityTable, what_is_wrong_is_said_with_file_and_place) {
  using ::testing::HasSubstr;
  const fs::path file = folder_of("wrong-table") / "in.csv";
  EXPECT_EQ(refusal(file, "y,u,v\n0,0,0\n1,1,0\n"), "");
  EXPECT_THAT(refusal(file, "y,u,v\n0,0,0\n1,1,0\n", 1.5),
              HasSubstr("covers y = 0 m to 1 m, but its value at 1.5 m"));
  EXPECT_THAT(refusal(file, "y,u,v\n0,0,0\n1,one,0\n"), HasSubstr("in.csv:3: 'one' is not a number"));
  EXPECT_THAT(refusal(file, "y,u,v\n0,0,0\n1,1\n"),
              HasSubstr("in.csv:3: 2 values, but the file has 3 columns"));
  EXPECT_THAT(refusal(file, "y,u\n0,0\n"), HasSubstr("in.csv:1: the column 'v' is missing"));
  EXPECT_THAT(refusal(file, "q,u,v\n0,0,0\n"), HasSubstr("in.csv:1: unknown column 'q'"));
  EXPECT_EQ(refusal(file, "y [m],u [m/s],v\n0,0,0\n1,1,0\n"), "");
  EXPECT_THAT(refusal(file, "y [mm],u,v\n0,0,0\n1,1,0\n"),
              HasSubstr("the column 'y' is in 'mm'; only m is accepted"));
  EXPECT_THAT(refusal(file, "y,u [cm/s],v\n0,0,0\n1,1,0\n"),
              HasSubstr("'u' is in 'cm/s'; only m/s is accepted"));
  EXPECT_THAT(refusal(file, "u,v\n0,0\n"), HasSubstr("no column is an axis"));
  EXPECT_THAT(refusal(file, "y,t,u,v\n0,0,1,0\n0,1,1,0\n1,0,1,0\n"), HasSubstr("no value at y = 1, t = 1"));
  EXPECT_THAT(refusal(file, "y,u,v\n0,0,0\n0,0,0\n"), HasSubstr("in.csv:3: duplicate grid point"));
  EXPECT_THAT(refusal(file.parent_path() / "none" / "in.csv", ""), HasSubstr("this table does not exist"));
}

TEST(RotatingInlet, adds_omega_cross_r_and_a_ring_between_turning_walls_carries_it) {
  FluidParameters p = couette();
  p.boundaries["xmin"].table.reset();
  p.boundaries["xmin"].velocity = {{"3"}, {"0"}};
  p.boundaries["xmin"].rotation = RotationParameters{{"2*t"}, Vec3(0.5, 0.25, 0), Vec3::UnitZ()};
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, box({4, 10, 1}));
  const Boundary<2> boundary(mesh, geometry, p);
  const auto at = make_placement<2>(mesh, geometry);
  Vectors<2> w(mesh.boundary.n_owned(), Vec<2>::Zero());
  boundary.velocity_at(0.5, at->boundary_centre, w);
  const Patch& inlet = *mesh.find_patch("xmin");
  for (Index f = inlet.first; f < inlet.first + inlet.count; ++f) {
    const Index b = f - mesh.n_interior;
    EXPECT_NEAR(w[b][0], 3 - (at->boundary_centre[b][1] - 0.25), 1e-14);
    EXPECT_NEAR(w[b][1], 0 - 0.5, 1e-14);
  }
  p.boundaries["xmin"].rotation->speed = {"x"};
  EXPECT_THROW(Boundary<2>(mesh, geometry, p), Error);
}

/// omega x r with the speed that is given, whatever the length of the axis.
TEST(RotatingInlet, has_an_axis_of_any_length) {
  FluidParameters p = fluid_of(1, 0.1, 1e-12);
  all_sides(p, 3, boundary(BoundaryType::moving_wall));
  p.boundaries["zmax"].rotation = RotationParameters{{"2*t"}, Vec3(0.5, 0.25, 0), Vec3(3, 0, 4)};
  const auto [mesh, geometry] =
      distribute(MPI_COMM_WORLD, make_box(BoxCells::hexahedra, {3, 3, 2}, Vec3::Zero(), Vec3::Ones()));
  const Boundary<3> walls(mesh, geometry, p);
  Vectors<3> w(mesh.boundary.n_owned(), Vec3::Zero());
  const auto at = make_placement<3>(mesh, geometry);
  walls.velocity_at(0.5, at->boundary_centre, w);
  const Patch& lid = *mesh.find_patch("zmax");
  for (Index b = lid.first - mesh.n_interior; b < lid.first - mesh.n_interior + lid.count; ++b)
    EXPECT_LT((w[b] - Vec3(0.6, 0, 0.8).cross(at->boundary_centre[b] - Vec3(0.5, 0.25, 0))).norm(), 1e-14);
}

/// What passes a wall that turns about the middle of a box is round-off on faces whose normals are no axes: it was
/// refused as a closed fluid that is let in more than out.
TEST(RotatingInlet, walls_of_a_closed_ring_may_turn) {
  FluidParameters p = fluid_of(1, 0.1);
  RawMesh raw = make_box(BoxCells::quadrilaterals, {6, 24, 1}, Vec3::Zero(), Vec3(1, 1, 1));
  for (Vec3& x : raw.points) {
    const double r = 1 + x[0], a = 0.7 + x[1];
    x = Vec3(r * std::cos(a), r * std::sin(a), 0);
  }
  all_sides(p, 2, boundary(BoundaryType::slip));
  p.boundaries["xmin"] = boundary(BoundaryType::moving_wall);
  p.boundaries["xmin"].rotation = RotationParameters{{"1"}, Vec3::Zero(), Vec3::UnitZ()};
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  EXPECT_NO_THROW(c.run(0.1, 5));
  EXPECT_GT(c.velocity_error([](const Vec3&) { return Vec3(0, 0, 0); }), 1e-2);
}

TEST(RotatingInlet, walls_that_turn_by_rotation_do_what_the_expression_of_it_does) {
  FluidParameters p = fluid_of(1, 0.1, 1e-12);
  BoundaryParameters wall = boundary(BoundaryType::moving_wall);
  wall.rotation = RotationParameters{{"2*t"}, Vec3(0.5, 0.5, 0), Vec3::UnitZ()};
  all_sides(p, 2, wall);
  const auto raw = [] {
    return make_box(BoxCells::quadrilaterals, {12, 12, 1}, Vec3::Zero(), Vec3(1, 1, 1));
  };
  FluidCase<2> turned(MPI_COMM_WORLD, raw(), p);
  all_sides(p, 2, boundary(BoundaryType::moving_wall, {"-2*t*(y-0.5)", "2*t*(x-0.5)"}));
  FluidCase<2> told(MPI_COMM_WORLD, raw(), p);
  turned.run(0.2, 10);
  told.run(0.2, 10);
  // two distributions in one process need not be the same: no cell by cell comparison
  const auto exact = [](const Vec3& x) { return Vec3(-0.4 * (x[1] - 0.5), 0.4 * (x[0] - 0.5), 0); };
  const auto rest = [](const Vec3&) { return Vec3(0, 0, 0); };
  EXPECT_NEAR(turned.velocity_error(rest), told.velocity_error(rest), 1e-11);
  EXPECT_NEAR(turned.velocity_error(exact), told.velocity_error(exact), 1e-11);
  EXPECT_GT(turned.velocity_error(rest), 1e-2);
}

/// Distributed once: a second time in one process PT-Scotch may part it in another way, and no checkpoint would fit.
const LoadedMesh& the_mesh() {
  static const LoadedMesh mesh = distribute(MPI_COMM_WORLD, box({20, 10, 1}));
  return mesh;
}

/// Writes three outputs of Couette flow with a line and a plane.
fs::path run(FluidParameters p, const std::string& name, int begin = 0, int end = 3) {
  const fs::path folder =
      begin == 0 ? folder_of(name)
                 : fs::temp_directory_path() /
                       ("couplet-" + name + "-" + std::to_string(parallel::comm_size(MPI_COMM_WORLD)));
  if (begin == 0) write(folder / "in.csv", "y,u,v\n0,0,0\n1,1,0\n");
  p.boundaries["xmin"].table->file = folder / "in.csv";
  FluidContext context{"fluid", folder};
  if (begin > 0) context.restart_time = 0.01 * begin;
  FluidParticipant<2> fluid(the_mesh(), p, context, MotionLink{});
  fluid.initialise();
  if (begin > 0) {
    io::CheckpointReader file(MPI_COMM_WORLD, folder / "state.h5");
    fluid.load(file);
  }
  for (int i = begin; i < end; ++i) {
    fluid.begin_step({0.01 * i, 0.01, coupling::Scheme::standalone, i});
    fluid.solve({});
    fluid.accept_step();
    fluid.write_output(0.01 * (i + 1), i + 1);
    if (i != 1) continue;
    io::CheckpointWriter file(MPI_COMM_WORLD, folder / "state.h5");
    fluid.save(file);
    file.close();
  }
  MPI_Barrier(MPI_COMM_WORLD);
  return folder;
}

FluidParameters with_samples() {
  FluidParameters p = couette();
  p.statistics.emplace();
  p.output.samples["across"] = {.from = Vec3(0.33, 0, 0), .to = Vec3(0.33, 1, 0), .points = 11};
  p.output.samples["sheet"] = {.type = SampleParameters::Type::plane,
                               .from = Vec3(1, -0.5, 0),
                               .to = Vec3(3, -0.5, 0),
                               .up = Vec3(1, 1.5, 0),
                               .points = 3,
                               .rows = 5};
  return p;
}

TEST(Samples, linear_fields_are_exact_on_lines_and_planes_with_their_means) {
  const fs::path folder = run(with_samples(), "samples");
  for (const std::string name : {"across", "sheet"}) {
    const auto [header, rows] = support::Csv(folder / ("sample-" + name + ".csv"));
    EXPECT_EQ(
        header,
        "time [s],along [-],up [-],x [m],y [m],z [m],velocity x [m/s],velocity y [m/s],pressure [Pa],"
        "velocity-mean x [m/s],velocity-mean y [m/s],pressure-mean [Pa],velocity-rms x [m/s],velocity-rms y "
        "[m/s],pressure-rms [Pa]");
    // of the sheet, 2 of 3 columns and 3 of 5 rows lie in the box
    ASSERT_EQ(rows.size(), 3u * (name == "across" ? 11 : 6));
    for (const auto& row : rows) {
      EXPECT_NEAR(row[6], row[4], 1e-9);
      EXPECT_NEAR(row[9], row[4], 1e-9);
      EXPECT_NEAR(row[8], 0.7, 1e-9);
      EXPECT_NEAR(row[11], 0.7, 1e-9);
      EXPECT_LT(std::abs(row[7]) + std::abs(row[12]) + std::abs(row[14]), 1e-8);
    }
  }
}

TEST(Samples, a_run_from_a_checkpoint_writes_the_same_numbers) {
  const fs::path folder = run(with_samples(), "resumed");
  const support::Csv through(folder / "sample-across.csv");
  run(with_samples(), "resumed", 2);
  EXPECT_EQ(through.rows, support::Csv(folder / "sample-across.csv").rows);
}

TEST(Samples, places_that_all_lie_outside_are_refused_and_none_are_written_unless_asked_for) {
  FluidParameters p = couette();
  const fs::path folder = run(p, "no-samples", 0, 1);
  for (const auto& entry : fs::directory_iterator(folder))
    EXPECT_FALSE(entry.path().filename().string().starts_with("sample-")) << entry.path();
  p.output.samples["far"] = {.from = Vec3(5, 5, 0), .to = Vec3(6, 6, 0), .points = 3};
  EXPECT_THAT(support::error_of([&] { run(p, "far-samples", 0, 0); }),
              ::testing::HasSubstr("output.samples.far: none of its points is in the mesh"));
}

}  // namespace couplet::fluid::test::samples_test

// Series of the walls: force and moment coefficients, shear and y+, against a flow whose numbers are known.
namespace couplet::fluid::test::wall_output_test {

constexpr double rho = 1.3, mu = 0.02, length = 2, pressure = 0.7;

/// u = y between a wall at rest and one that moves, at a uniform pressure: exact on any mesh.
FluidParameters couette() {
  FluidParameters p = fluid_of(rho, mu, 1e-13, "box");
  p.initial_velocity = {{"y"}, {"0"}};
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"y", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "0.7");
  p.boundaries["ymin"] = boundary(BoundaryType::no_slip);
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  p.initial_pressure = config::ExpressionText{"0.7"};
  p.output.walls = true;
  return p;
}

CoefficientParameters floor_coefficients() {
  CoefficientParameters c;
  c.patches = {"ymin"};
  c.speed = 3;
  c.area = 0.5;
  c.length = 0.25;
  c.drag = Vec3(2, 0, 0);  // need not be of length 1
  c.centre = Vec3(0.3, 0.4, 0);
  return c;
}

std::filesystem::path run(const FluidParameters& p, const std::string& name, int steps = 3) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("couplet-" + name + "-" + std::to_string(parallel::comm_size(MPI_COMM_WORLD)));
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  const mesh::RawMesh raw =
      parallel::comm_rank(MPI_COMM_WORLD) == 0
          ? mesh::make_box(mesh::BoxCells::quadrilaterals, {20, 10, 1}, Vec3::Zero(), Vec3(length, 1, 1))
          : mesh::RawMesh{};
  FluidParticipant<2> fluid(mesh::distribute(MPI_COMM_WORLD, raw), p, FluidContext{"fluid", folder},
                            MotionLink{});
  fluid.initialise();
  for (int i = 0; i < steps; ++i) {
    fluid.begin_step({0.01 * i, 0.01, coupling::Scheme::standalone, i});
    fluid.solve({});
    fluid.accept_step();
    fluid.write_monitors(0.01 * (i + 1));
  }
  MPI_Barrier(MPI_COMM_WORLD);
  return folder;
}

TEST(WallOutput, coefficients_are_forces_and_moments_over_dynamic_pressure_and_area) {
  FluidParameters p = couette();
  p.output.coefficients["floor"] = floor_coefficients();
  p.output.coefficients["turned"] = floor_coefficients();
  p.output.coefficients["turned"].axis = Vec3(0, 0, -2);
  p.output.coefficients["turned"].lift = Vec3(0, -1, 0);
  const auto [header, rows] = support::Csv(run(p, "coefficients") / "coefficients.csv");
  EXPECT_EQ(header,
            "time [s],floor drag [-],floor lift [-],floor moment [-],turned drag [-],turned lift [-],turned "
            "moment [-]");
  ASSERT_EQ(rows.size(), 3u);
  const double qa = 0.5 * rho * 9 * 0.5;
  const double drag = mu * length, lift = -pressure * length;
  const double moment = 0.4 * drag - pressure * (length * length / 2 - 0.3 * length);
  for (const auto& row : rows) {
    EXPECT_NEAR(row[1], drag / qa, 1e-10);
    EXPECT_NEAR(row[2], lift / qa, 1e-10);
    EXPECT_NEAR(row[3], moment / (qa * 0.25), 1e-10);
    EXPECT_NEAR(row[4], row[1], 1e-14);
    EXPECT_NEAR(row[5], -row[2], 1e-14);
    EXPECT_NEAR(row[6], -row[3], 1e-14);
  }
}

TEST(WallOutput, shear_and_wall_units_of_a_laminar_run) {
  const auto [header, rows] = support::Csv(run(couette(), "walls") / "walls.csv");
  EXPECT_THAT(header, ::testing::HasSubstr("ymin mean shear [Pa],ymin largest shear [Pa],ymin mean y+ [-]"));
  ASSERT_EQ(rows.size(), 3u);
  // du/dy = 1: tau = mu; y+ = y (tau/rho)^(1/2) / nu at the first centre, y = 0.05 m
  const double yplus = 0.05 * std::sqrt(mu / rho) / (mu / rho);
  for (const auto& row : rows)
    for (const int wall : {0, 1}) {
      EXPECT_NEAR(row[1 + 4 * wall], mu, 1e-9);
      EXPECT_NEAR(row[2 + 4 * wall], mu, 1e-9);
      EXPECT_NEAR(row[3 + 4 * wall], yplus, 1e-6);
      EXPECT_NEAR(row[4 + 4 * wall], yplus, 1e-6);
    }
}

TEST(WallOutput, is_not_written_unless_asked_for) {
  FluidParameters p = couette();
  p.output.walls = false;
  const auto folder = run(p, "nothing", 1);
  EXPECT_TRUE(std::filesystem::exists(folder / "forces.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "walls.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "coefficients.csv"));
}

TEST(WallOutput, coefficients_of_what_is_no_wall_are_refused_by_name) {
  FluidParameters p = couette();
  p.output.coefficients["floor"] = floor_coefficients();
  p.output.coefficients["floor"].patches = {"xmin"};
  EXPECT_THAT(support::error_of([&] { run(p, "refused", 0); }),
              ::testing::HasSubstr("output.coefficients.floor.patches: 'xmin' is not a wall"));
}

}  // namespace couplet::fluid::test::wall_output_test
