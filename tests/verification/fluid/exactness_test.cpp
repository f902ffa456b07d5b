// SPDX-License-Identifier: Apache-2.0
// Flows that the discrete equations must keep to round-off.
#include "fluid_case.hpp"

namespace couplet::fluid::test::exactness_test {
using namespace mesh;

constexpr double rho = 1.7;

FluidParameters water(int dim, const BoundaryParameters& sides) {
  FluidParameters p = fluid_of(rho, 0.01);
  p.viscous = ViscousTreatment::explicit_;
  all_sides(p, dim, sides);
  return p;
}

/// Every point, also those on the boundary, jumps about its place at random, each step anew: positions are
/// continuous, velocities and accelerations are not.
Vec3 jitter(const Vec3& x, GlobalIndex id, double t, double amount, int dim) {
  if (t == 0) return x;
  std::mt19937_64 random(std::uint64_t(id) * 1000003u + std::uint64_t(std::llround(t * 1e6)));
  std::uniform_real_distribution<double> displacement(-amount, amount);
  Vec3 moved = x;
  for (int c = 0; c < dim; ++c) moved[c] += displacement(random);
  return moved;
}

template <int D>
void check_uniform_flow(BoxCells cells, int n, int steps, ViscousTreatment viscous) {
  const Vec3 flow(1, 0.7, D == 3 ? -0.4 : 0);
  std::vector<std::string> velocity{"1", "0.7"};
  if (D == 3) velocity.push_back("-0.4");
  FluidParameters p = water(D, boundary(BoundaryType::moving_wall, velocity));
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.viscous = viscous;
  for (const std::string& text : velocity) p.initial_velocity.push_back({text});
  p.time_step = 1;
  const double h = 1.0 / n;
  FluidCase<D> c(MPI_COMM_WORLD, make_box(cells, {n, n, n}, Vec3::Zero(), Vec3::Ones()), p,
                 [&](const Vec3& x, GlobalIndex id, double t) { return jitter(x, id, t, 0.15 * h, D); });
  for (int i = 0; i < steps; ++i) c.step(0.05 * h);
  const double error = c.largest_velocity_error([&](const Vec3&) { return flow; });
  printf("uniform flow, %d-D, %d steps: %.2e\n", D, steps, error);
  ::testing::Test::RecordProperty("error", std::to_string(error * 1e12) + "e-12");
  EXPECT_LT(error, 1e-12);
  double moved = 0;
  for (std::size_t i = 0; i < c.state().points.size(); ++i)
    moved = std::max(moved, (c.state().points[i] - c.geometry().points[i]).norm());
  EXPECT_GT(moved, 0.05 * h);
}

TEST(UniformFlow, is_kept_on_a_randomly_moving_accelerating_mesh_over_1000_steps) {
  check_uniform_flow<2>(BoxCells::quadrilaterals, 16, 1000, ViscousTreatment::explicit_);
}
TEST(UniformFlow, is_kept_on_moving_triangles) {
  check_uniform_flow<2>(BoxCells::triangles, 8, 200, ViscousTreatment::explicit_);
}
TEST(UniformFlow, is_kept_with_the_implicit_viscous_term) {
  check_uniform_flow<2>(BoxCells::quadrilaterals, 12, 200, ViscousTreatment::implicit);
}
TEST(UniformFlow, is_kept_on_warped_moving_hexahedra) {
  check_uniform_flow<3>(BoxCells::hexahedra, 6, 100, ViscousTreatment::explicit_);
}
TEST(UniformFlow, is_kept_on_moving_mixed_cells) {
  check_uniform_flow<3>(BoxCells::mixed, 4, 50, ViscousTreatment::explicit_);
}

/// A closed box full of fluid that oscillates as one: u = w(t), p = -rho a.x with a = (w^{n+1} - w^n)/dt.
template <int D>
void check_oscillating_box(int n, int steps, bool moving) {
  const Vec3 direction(1, 0.5, D == 3 ? -0.8 : 0);
  const double omega = 7, amplitude = 0.3, dt = 0.004;
  const auto place = [&](double t) { return Vec3(amplitude * (1 - std::cos(omega * t)) * direction); };
  const auto speed = [&](double t) { return Vec3(amplitude * omega * std::sin(omega * t) * direction); };
  FluidParameters p = water(D, boundary(BoundaryType::interface));
  p.time_step = 1;
  p.pressure_tolerance = 1e-13;
  // Graded, as meshes near walls are.
  RawMesh raw = make_box(D == 2 ? BoxCells::quadrilaterals : BoxCells::hexahedra, {n, n, n}, Vec3::Zero(),
                         Vec3(1, 0.8, 1));
  for (Vec3& x : raw.points) x.x() = 0.6 * x.x() + 0.4 * x.x() * x.x();
  PointMotion motion;
  if (moving) motion = [&](const Vec3& x, GlobalIndex, double t) { return Vec3(x + place(t)); };
  FluidCase<D> c(MPI_COMM_WORLD, raw, p, motion);
  double u_error = 0, p_error = 0;
  for (int i = 0; i < steps; ++i) {
    const double t = c.state().time;
    c.step(dt, [&](const Vec3&, double time) { return speed(time); });
    const Vec3 w = speed(t + dt), a = (w - speed(t)) / dt;
    u_error = std::max(u_error, c.largest_velocity_error([&](const Vec3&) { return w; }));
    p_error = std::max(p_error, c.pressure_error([&](const Vec3& x) { return -rho * a.dot(x); }));
  }
  printf("oscillating box, %d-D, moving mesh %d: u %.2e p %.2e\n", D, int(moving), u_error, p_error);
  ::testing::Test::RecordProperty("velocity_error", std::to_string(u_error * 1e10) + "e-10");
  ::testing::Test::RecordProperty("pressure_error", std::to_string(p_error * 1e10) + "e-10");
  EXPECT_LT(u_error, 1e-10);
  EXPECT_LT(p_error, 1e-10);
}

TEST(OscillatingBox, moves_its_fluid_as_one_body_2d) { check_oscillating_box<2>(12, 250, true); }
TEST(OscillatingBox, moves_its_fluid_as_one_body_3d) { check_oscillating_box<3>(6, 60, true); }

}  // namespace couplet::fluid::test::exactness_test
