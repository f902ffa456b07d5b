// SPDX-License-Identifier: Apache-2.0
// Eddy viscosity: where it must vanish, how it goes to walls, and what it takes from the flow.
#include "fluid_case.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/output/derived.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid::test::turbulence_test {
using namespace mesh;

constexpr TurbulenceParameters wale{TurbulenceModel::wale, {}};
constexpr TurbulenceParameters smagorinsky{TurbulenceModel::smagorinsky, {}};

Tensor<3> tensor(std::initializer_list<double> rows) {
  Tensor<3> g;
  auto value = rows.begin();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g(i, j) = *value++;
  return g;
}

TEST(Wale, is_nothing_in_pure_shear_where_smagorinsky_is_not) {
  const Tensor<3> shear = tensor({0, 7, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(eddy_viscosity<3>(wale, shear, 1e-3), 0);
  EXPECT_NEAR(eddy_viscosity<3>(smagorinsky, shear, 1e-3), 0.17 * 0.17 * 1e-2 * 7, 1e-12);
}

TEST(Wale, has_the_value_of_its_formula_in_rotation_with_strain) {
  // g = diag(1, -1, 0) + rotation 2 about z: g g = diag(1, 1, 0) - 4 diag(1, 1, 0), Sd = -3 (diag(1, 1, 0) -
  // 2/3 I).
  const Tensor<3> g = tensor({1, -2, 0, 2, -1, 0, 0, 0, 0});
  const double ss = 2, dd = 9 * (2.0 / 9 + 4.0 / 9);
  const double wanted = std::pow(0.325, 2) * std::pow(dd, 1.5) / (std::pow(ss, 2.5) + std::pow(dd, 1.25));
  EXPECT_NEAR(eddy_viscosity<3>(wale, g, 1), wanted, 1e-14);
  EXPECT_EQ(eddy_viscosity<3>(wale, Tensor<3>::Zero(), 1), 0);
}

/// Near a wall u ~ y, w ~ y and v ~ y^2: on a mesh with that field, and the wall's own boundary values, the
/// eddy viscosity of the discrete gradients.
TEST(Wale, goes_to_walls_as_the_third_power_of_the_distance) {
  const int n = 40;
  RawMesh raw = make_box(BoxCells::hexahedra, {12, n, 12}, Vec3::Zero(), Vec3(1, 1, 1));
  for (Vec3& x : raw.points) x.y() = 0.1 * x.y();
  FluidParameters p = fluid_of(1, 1e-3);
  all_sides(p, 3, boundary(BoundaryType::no_slip));
  const auto field = [](const Vec3& x) {
    const double a = 6 * x.x(), b = 5 * x.z(), y = x.y();
    return Vec3(y * (2 + std::sin(a) * std::cos(b)), y * y * std::cos(a + b),
                y * (1 + std::cos(a) * std::sin(b)));
  };
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  const auto at = make_placement<3>(mesh, geometry);
  Vectors<3> u, u_boundary;
  for (const Vec3& x : at->centre) u.push_back(field(x));
  for (const Vec3& x : at->boundary_centre) u_boundary.push_back(field(x));
  std::vector<Tensor<3>> gradient;
  std::vector<double> eddy;
  velocity_gradient<3>(mesh, *at, u, u_boundary, gradient);
  eddy_viscosity<3>(wale, *at, gradient, eddy);
  std::vector<double> sum(n, 0.0);  // mean over each layer, away from the side walls
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const Vec3& x = at->centre[c];
    if (std::min({x.x(), 1 - x.x(), x.z(), 1 - x.z()}) < 0.15) continue;
    sum[static_cast<int>(x.y() / 0.1 * n)] += eddy[c];
  }
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const int first = 1, last = 8;
  for (int j = first; j < last; ++j) {
    const double x = std::log((j + 0.5) / n), y = std::log(sum[j]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const int m = last - first;
  const double slope = (m * sxy - sx * sy) / (m * sxx - sx * sx);
  printf("WALE at a wall: slope %.2f\n", slope);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_GT(slope, 2.7);
  EXPECT_LT(slope, 3.3);
}

/// A linear shear between walls that carry it stays as it is with WALE, to round-off.
TEST(Wale, leaves_a_couette_flow_alone) {
  FluidParameters p = fluid_of(1, 1e-3);
  p.turbulence = wale;
  p.initial_velocity = {{"3*y"}, {"0"}, {"0"}};
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"3*y", "0", "0"});
  for (const char* side : {"xmin", "xmax", "zmin", "zmax"})
    p.boundaries[side] = boundary(BoundaryType::periodic);
  RawMesh raw = make_box(BoxCells::hexahedra, {6, 6, 4}, Vec3::Zero(), Vec3::Ones());
  raw.periodic = {{"xmin", "xmax"}, {"zmin", "zmax"}};
  FluidCase<3> c(MPI_COMM_WORLD, raw, p);
  c.run(1, 20);
  double largest = 0;
  for (const double eddy : c.state().eddy) largest = std::max(largest, eddy);
  RecordProperty("largest_eddy_viscosity", std::to_string(largest * 1e12) + "e-12");
  EXPECT_LT(parallel::max(MPI_COMM_WORLD, largest), 1e-12);
  EXPECT_LT(c.largest_velocity_error([](const Vec3& x) { return Vec3(3 * x.y(), 0, 0); }), 1e-11);
}

/// Vortices with Smagorinsky's model, in periodic_square().
FluidParameters vortices(double constant) {
  FluidParameters p;
  p.pressure_tolerance = 1e-10;
  p.turbulence = TurbulenceParameters{TurbulenceModel::smagorinsky, constant};
  p.time_step = 1;
  all_sides(p, 2, boundary(BoundaryType::periodic));
  p.initial_velocity = {{"sin(x)*cos(y)"}, {"-cos(x)*sin(y)"}};
  return p;
}

/// Of 2 pi, n cells a side.
RawMesh periodic_square(int n) {
  const double length = 2 * std::numbers::pi;
  RawMesh raw = make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(length, length, 1));
  raw.periodic = {{"xmin", "xmax"}, {"ymin", "ymax"}};
  return raw;
}

/// What the model's stress takes from the kinetic energy of a vortex array is the power that the budget
/// names.
TEST(Smagorinsky, takes_the_energy_that_the_budget_names) {
  FluidParameters p = vortices(0.6);
  p.density = 2;
  p.viscosity = 0;
  p.viscous = ViscousTreatment::explicit_;
  FluidCase<2> c(MPI_COMM_WORLD, periodic_square(40), p);
  c.run(0.2, 100);
  const EnergyBudget before = energy_budget(c.fluid());
  c.run(0.3, 50);
  const EnergyBudget after = energy_budget(c.fluid());
  const double lost = (before.kinetic - after.kinetic) / 0.1, eddies = 0.5 * (before.eddies + after.eddies),
               pressure = 0.5 * (before.pressure + after.pressure), named = eddies + pressure;
  printf("energy lost %.4f: eddies %.4f pressure %.4f\n", lost, eddies, pressure);
  EXPECT_NEAR(lost, named, 0.02 * named);
  EXPECT_GT(lost, 0.01 * before.kinetic);
}

/// An array of vortices and its quarter between planes of symmetry. Without the normal stress of the eddies on these, the
/// failing neighbor, the quarter keeps a tenth more of its energy.
void compare_with_quarter(ViscousTreatment viscous) {
  FluidParameters p = vortices(0.6);
  p.density = 2;
  p.viscosity = 0.01;
  p.viscous = viscous;
  FluidCase<2> whole(MPI_COMM_WORLD, periodic_square(16), p);
  RawMesh raw = periodic_square(8);
  raw.periodic.clear();
  for (Vec3& x : raw.points) x *= 0.5;
  all_sides(p, 2, boundary(BoundaryType::symmetry));
  FluidCase<2> quarter(MPI_COMM_WORLD, raw, p);
  for (FluidCase<2>* c : {&whole, &quarter}) c->run(1, 50);
  const EnergyBudget all = energy_budget(whole.fluid()), part = energy_budget(quarter.fluid());
  // The pressure on a boundary is not that of a mirrored cell, to second order.
  EXPECT_NEAR(4 * part.kinetic, all.kinetic, 1e-4 * all.kinetic);
  EXPECT_NEAR(4 * part.eddies, all.eddies, 1e-4 * all.eddies);
}

TEST(EddyStress, is_mirrored_by_planes_of_symmetry) { compare_with_quarter(ViscousTreatment::explicit_); }
TEST(EddyStress, is_mirrored_by_planes_of_symmetry_in_implicit_steps) {
  compare_with_quarter(ViscousTreatment::implicit);
}

/// Beside a wall a thin cell borders a thick one. What moves in the thin one alone is slowed down by the stress; with the mean of the
/// cells' gradients in grad u^T at the face, the failing neighbour, it is driven.
TEST(EddyStress, takes_energy_where_a_thin_cell_borders_a_thick_one) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {3, 2, 1}, Vec3::Zero(), Vec3(3, 2, 1));
  for (Vec3& x : raw.points) x.y() = x.y() < 0.5 ? 0 : x.y() < 1.5 ? 0.02 : 1;
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  State<2> s;
  s.placement = make_placement<2>(mesh, geometry);
  const Placement<2>& at = *s.placement;
  s.eddy.assign(at.volume.size(), 1.0);
  for (const Vec<2>& x : at.centre) s.u.push_back(x.y() < 0.02 ? Vec<2>(0, 1) : Vec<2>(0, 0));
  s.u_boundary.assign(at.boundary_centre.size(), Vec<2>::Zero());
  std::vector<Tensor<2>> gradient;
  velocity_gradient<2>(mesh, at, s.u, s.u_boundary, gradient);
  double taken = 0, of_means = 0;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Index p = mesh.owner[f], n = mesh.neighbour[f];
    const Vec<2> change = s.u[n] - s.u[p];
    const Tensor<2> mean = at.weight[f] * gradient[p] + (1 - at.weight[f]) * gradient[n];
    taken += eddy_stress<2>(at, s.eddy, s.u, gradient, f, p, n).dot(change);
    of_means += (at.conductance[f] * change + mean.transpose() * at.area[f]).dot(change);
  }
  printf("taken %.2f, with the mean of the gradients %.2f\n", taken, of_means);
  EXPECT_NEAR(taken, 3 * 2 / 0.5, 0.2);  // three faces of 1 m, 2 nu_t du/dy, 0.5 m between the centres
  EXPECT_LT(of_means, -10);
}

/// A strong eddy viscosity beside an implicit viscous term: steps of a hundred times its explicit limit, second order in time.
TEST(Smagorinsky, does_not_limit_an_implicit_step) {
  FluidParameters p = vortices(3.0);
  p.density = 1;
  p.viscosity = 1e-3;
  p.viscous = ViscousTreatment::implicit;
  p.initial_velocity = {{"sin(x)*cos(y) + 0.1*sin(2*y)"}, {"-cos(x)*sin(y)"}};
  const RawMesh raw = periodic_square(32);
  const auto velocity = [&](int steps) {
    FluidCase<2> c(MPI_COMM_WORLD, raw, p);
    c.run(0.4, steps);
    return c.state().u;
  };
  FluidParameters own = p;
  own.time_step.reset();
  own.viscous = ViscousTreatment::explicit_;
  FluidCase<2> neighbour(MPI_COMM_WORLD, raw, own);
  neighbour.run(0.4, 1);
  const int sub_steps = neighbour.fluid().statistics().sub_steps;
  const Vectors<2> exact = velocity(128);
  const auto error = [&](int steps) {
    const Vectors<2> u = velocity(steps);
    double sum = 0;
    for (std::size_t c = 0; c < u.size(); ++c) sum += (u[c] - exact[c]).squaredNorm();
    return std::sqrt(parallel::sum(MPI_COMM_WORLD, sum));
  };
  const double coarse = error(8), fine = error(16), order = std::log2(coarse / fine);
  printf("explicit: %d sub-steps; implicit: errors %.2e, %.2e of 8 and 16 steps, order %.2f\n", sub_steps,
         coarse, fine, order);
  EXPECT_GT(sub_steps, 80);
  EXPECT_GT(order, 1.8);
  EXPECT_LT(order, 2.6);
}

// Before they begin there are none: 0 would be a velocity.
TEST(Statistics, are_no_numbers_before_they_begin) {
  const auto none = RunningStatistics<2>::nothing_yet(3, 2);
  EXPECT_TRUE(std::isnan(none.velocity_mean()[4][1]));
  EXPECT_TRUE(std::isnan(none.velocity_rms()[0][0]));
  EXPECT_TRUE(std::isnan(none.pressure_rms()[2]));
  EXPECT_TRUE(std::isnan(none.reynolds_shear()[0]));
}

TEST(Statistics, are_those_of_a_known_oscillation) {
  FluidParameters p = fluid_of(1, 0.01);
  RunningStatistics<2> statistics(1, 0);
  State<2> s;
  const int n = 4000;
  double t = 0;
  for (int i = 0; i < n; ++i) {  // steps of two sizes
    const double dt = (i % 2 == 0 ? 0.5 : 1.5) / n;
    t += dt;
    const double a = 2 * std::numbers::pi * 3 * (t - dt / 2);
    s.u = {Vec<2>(1e3 + 2 * std::sin(a), std::sin(a))};
    statistics.add(s, s.pressure[0].get(), dt);
  }
  EXPECT_NEAR(statistics.duration(), 1, 1e-12);
  EXPECT_NEAR(statistics.velocity_mean()[0][0], 1e3, 1e-4);
  EXPECT_NEAR(statistics.velocity_rms()[0][0], std::sqrt(2.0), 1e-4);
  EXPECT_NEAR(statistics.velocity_rms()[0][1], std::sqrt(0.5), 1e-4);
  EXPECT_NEAR(statistics.reynolds_shear()[0], 1, 1e-4);
}

TEST(GradientFields, have_their_values_in_a_rotation_and_in_a_strain) {
  const Tensor3 rotation = tensor({0, -3, 0, 3, 0, 0, 0, 0, 0}),
                strain = tensor({2, 0, 0, 0, -2, 0, 0, 0, 0});
  const auto value = [](const std::string& name, const Tensor3& g) {
    for (const GradientField& field : gradient_fields())
      if (field.name == name) return field.value(g);
    throw std::logic_error(name);
  };
  EXPECT_EQ(value("vorticity", rotation), Vec3(0, 0, 6));
  EXPECT_EQ(value("vorticity", strain), Vec3(0, 0, 0));
  EXPECT_EQ(value("q-criterion", rotation)[0], 9);
  EXPECT_EQ(value("q-criterion", strain)[0], -4);
  EXPECT_EQ(value("shear-rate", rotation)[0], 0);
  EXPECT_DOUBLE_EQ(value("shear-rate", tensor({0, 7, 0, 0, 0, 0, 0, 0, 0}))[0], 7);
}

}  // namespace couplet::fluid::test::turbulence_test
