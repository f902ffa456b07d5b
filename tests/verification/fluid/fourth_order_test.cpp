// SPDX-License-Identifier: Apache-2.0
// Fourth order along lines of cells: what it does to energy and momentum, and its order on equal and on stretched cells.
#include "fluid_case.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "participant_case.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::fluid::test::fourth_order_test {
using namespace mesh;

constexpr double pi = std::numbers::pi;

template <int D>
FluidParameters periodic(RawMesh& raw, double viscosity, FaceValues order) {
  FluidParameters p = fluid_of(1, viscosity, 1e-9);
  p.viscous = ViscousTreatment::explicit_;
  p.time_step = 1;
  p.face_values = order;
  all_sides(p, D, boundary(BoundaryType::periodic));
  raw.periodic = {{"xmin", "xmax"}, {"ymin", "ymax"}};
  if (D == 3) raw.periodic.push_back({"zmin", "zmax"});
  return p;
}

/// Square or cube of edge 2 pi, its cells from 1 - stretch to 1 + stretch of the mean.
template <int D>
RawMesh box(int n, double stretch) {
  const BoxCells cells = D == 2 ? BoxCells::quadrilaterals : BoxCells::hexahedra;
  RawMesh raw =
      make_box(cells, {n, n, D == 3 ? n : 1}, Vec3::Zero(), Vec3(2 * pi, 2 * pi, D == 3 ? 2 * pi : 1));
  for (Vec3& x : raw.points)
    for (int d = 0; d < D; ++d) x[d] += stretch * std::sin(x[d]);
  return raw;
}

struct Errors {
  double u, p;
};

/// Vortices that are advected, viscosity 0.05, at t = 0.5; steps so short that the error is that in space.
Errors travelling(int n, double stretch, FaceValues order) {
  const double nu = 0.05, end = 0.5, dt = 0.016 / n;
  RawMesh raw = box<2>(n, stretch);
  FluidParameters p = periodic<2>(raw, nu, order);
  p.initial_velocity = {{"0.6+sin(x)*cos(y)"}, {"0.3-cos(x)*sin(y)"}};
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  c.run(end, static_cast<int>(std::lround(end / dt)));
  const auto place = [](const Vec3& x, double t) { return Vec3(x.x() - 0.6 * t, x.y() - 0.3 * t, 0); };
  const double u = c.velocity_error([&](const Vec3& x) {
    const Vec3 y = place(x, end);
    const double f = std::exp(-2 * nu * end);
    return Vec3(0.6 + f * std::sin(y.x()) * std::cos(y.y()), 0.3 - f * std::cos(y.x()) * std::sin(y.y()), 0);
  });
  const double middle = end - dt / 2;
  return {u, c.pressure_error([&](const Vec3& x) {
            const Vec3 y = place(x, middle);
            return 0.25 * std::exp(-4 * nu * middle) * (std::cos(2 * y.x()) + std::cos(2 * y.y()));
          })};
}

void check_order(double stretch, double least_slope, double least_gain) {
  Errors second[3], fourth[3];
  for (int i = 0; i < 3; ++i) {
    second[i] = travelling(16 << i, stretch, FaceValues::second_order);
    fourth[i] = travelling(16 << i, stretch, FaceValues::fourth_order);
  }
  const auto slope = [](double coarse, double fine) { return std::log2(coarse / fine); };
  printf("stretch %.2f: u second %.2e %.2e %.2e (%.2f), fourth %.2e %.2e %.2e (%.2f)\n", stretch, second[0].u,
         second[1].u, second[2].u, slope(second[1].u, second[2].u), fourth[0].u, fourth[1].u, fourth[2].u,
         slope(fourth[1].u, fourth[2].u));
  printf("stretch %.2f: p second %.2e %.2e %.2e (%.2f), fourth %.2e %.2e %.2e (%.2f)\n", stretch, second[0].p,
         second[1].p, second[2].p, slope(second[1].p, second[2].p), fourth[0].p, fourth[1].p, fourth[2].p,
         slope(fourth[1].p, fourth[2].p));
  const std::string name = stretch > 0 ? "_stretched" : "";
  ::testing::Test::RecordProperty("velocity_slope" + name, std::to_string(slope(fourth[1].u, fourth[2].u)));
  ::testing::Test::RecordProperty("pressure_slope" + name, std::to_string(slope(fourth[1].p, fourth[2].p)));
  ::testing::Test::RecordProperty("gain" + name, std::to_string(second[2].u / fourth[2].u));
  EXPECT_GE(slope(fourth[1].u, fourth[2].u), least_slope);
  EXPECT_GE(slope(fourth[1].p, fourth[2].p), least_slope);
  EXPECT_GE(second[2].u / fourth[2].u, least_gain);
}

TEST(FourthOrder, velocity_and_pressure_are_fourth_order_on_equal_cells) { check_order(0, 3.8, 100); }
TEST(FourthOrder, error_on_stretched_cells_is_a_fraction_of_that_of_second_order) {
  check_order(0.3, 1.9, 4);
}

/// Any velocity, any flux that leaves as much as enters each cell.
template <int D>
void check_conservation(double stretch) {
  RawMesh raw = box<D>(8, stretch);
  FluidParameters p = periodic<D>(raw, 0, FaceValues::fourth_order);
  p.initial_velocity = {{"0.6+sin(x)*cos(y)"}, {"0.3-cos(x)*sin(y)"}};
  if (D == 3) p.initial_velocity.push_back({"0.2*cos(x)"});
  FluidCase<D> c(MPI_COMM_WORLD, raw, p);
  State<D> s = c.state();
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i)
    for (int d = 0; d < D; ++d) s.u[i][d] += std::sin(double(c.mesh().cell_id[i]) * (1.3 + d));
  c.mesh().cells.update_ghosts(flat<D>(s.u), D);
  RateOperator<D> rates(c.mesh(), c.fluid().boundary(), 0);
  rates.set_fourth(c.fluid().fourth());
  Rates<D> r;
  rates.apply(s, false, false, r);
  double sums[2 + D] = {};
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    sums[0] += s.u[i].dot(r.rate[i]);
    sums[1] += s.u[i].norm() * r.rate[i].norm();
    for (int d = 0; d < D; ++d) sums[2 + d] += r.rate[i][d];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2 + D, MPI_DOUBLE, MPI_SUM, c.mesh().comm);
  EXPECT_LT(std::abs(sums[0]), 1e-10 * sums[1]);
  for (int d = 0; d < D; ++d) EXPECT_LT(std::abs(sums[2 + d]), 1e-12 * sums[1]);
}

TEST(FourthOrder, convection_gives_neither_energy_nor_momentum_to_any_velocity) {
  check_conservation<2>(0.4);
  check_conservation<3>(0.4);
}

/// Relative drift of the kinetic energy of vortices without viscosity in one second, Adams and Bashforth.
double drift(double dt, FaceValues order) {
  RawMesh raw = box<2>(32, 0);
  FluidParameters p = periodic<2>(raw, 0, order);
  p.pressure_tolerance = 1e-12;
  p.initial_velocity = {{"0.6+sin(x)*cos(y)"}, {"0.3-cos(x)*sin(y)"}};
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  const auto energy = [&] {
    double sum = 0;
    for (Index i = 0; i < c.mesh().cells.n_owned(); ++i)
      sum += c.state().placement->volume[i] * c.state().u[i].squaredNorm();
    return parallel::sum(c.mesh().comm, sum);
  };
  const double before = energy();
  c.run(1, static_cast<int>(std::lround(1 / dt)));
  return std::abs(energy() / before - 1);
}

TEST(FourthOrder, energy_without_friction_drifts_no_more_than_with_second_order_and_with_the_step_squared) {
  const double second = drift(0.01, FaceValues::second_order), coarse = drift(0.02, FaceValues::fourth_order),
               fine = drift(0.01, FaceValues::fourth_order);
  printf("drift of the energy: second %.2e, fourth %.2e, with steps twice as long %.2e\n", second, fine,
         coarse);
  RecordProperty("drift_second", std::to_string(second * 1e6) + "e-6");
  RecordProperty("drift_fourth", std::to_string(fine * 1e6) + "e-6");
  EXPECT_LT(fine, 2 * second);
  EXPECT_GT(std::log2(coarse / fine), 1.8);
}

TEST(FourthOrder, friction_is_symmetric_and_takes_energy_on_stretched_cells) {
  RawMesh raw = box<2>(8, 0.4);
  FluidCase<2> c(MPI_COMM_WORLD, raw, periodic<2>(raw, 1, FaceValues::fourth_order));
  const auto wave = [&](double k) {
    State<2> s = c.state();
    std::fill(s.phi.begin(), s.phi.end(), 0.);
    for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
      const double id = double(c.mesh().cell_id[i]);
      s.u[i] = {std::sin(k * id), std::cos((k + 1) * id)};
    }
    c.mesh().cells.update_ghosts(flat<2>(s.u), 2);
    return s;
  };
  const State<2> a = wave(1.3), b = wave(2.1);
  RateOperator<2> rates(c.mesh(), c.fluid().boundary(), 1);
  // Without the fluxes of convection's links, which are those of the velocity, not of phi.
  const auto friction = [&](const State<2>& s) {
    Rates<2> with, without;
    RateOperator<2> inviscid(c.mesh(), c.fluid().boundary(), 0);
    inviscid.set_fourth(c.fluid().fourth());
    rates.set_fourth(c.fluid().fourth());
    rates.apply(s, false, false, with);
    inviscid.apply(s, false, false, without);
    for (std::size_t i = 0; i < with.rate.size(); ++i) with.rate[i] -= without.rate[i];
    return with.rate;
  };
  const Vectors<2> la = friction(a), lb = friction(b);
  double sums[4] = {};  // the last: what is told to be lost
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    sums[0] += a.u[i].dot(lb[i]);
    sums[1] += b.u[i].dot(la[i]);
    sums[2] += a.u[i].dot(la[i]);
  }
  sums[3] = c.fluid().fourth()->dissipation(1, a.u);
  for (Index f = 0; f < c.mesh().n_interior; ++f) {
    const Index o = c.mesh().owner[f], n = c.mesh().neighbour[f];
    const int owned = (o < c.mesh().cells.n_owned()) + (n < c.mesh().cells.n_owned());
    sums[3] += 0.5 * owned * a.placement->conductance[f] * (a.u[n] - a.u[o]).squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, c.mesh().comm);
  EXPECT_NEAR(sums[0], sums[1], 1e-12 * std::abs(sums[2]));
  EXPECT_LT(sums[2], 0);
  EXPECT_NEAR(sums[3], -sums[2], 1e-12 * std::abs(sums[2]));
}

/// A box between walls, finer towards them, with a lid.
std::unique_ptr<FluidParticipant<2>> cavity(FaceValues order, MPI_Comm comm = MPI_COMM_WORLD) {
  FluidParameters p = fluid_of(1, 0.01, 1e-10);
  p.mesh = "box";
  p.dimension = 2;
  p.viscous = ViscousTreatment::explicit_;
  p.face_values = order;
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  RawMesh raw;
  if (parallel::comm_rank(comm) == 0) {
    raw = make_box(BoxCells::quadrilaterals, {16, 16, 1}, Vec3::Zero(), Vec3::Ones());
    for (Vec3& x : raw.points)
      for (int d = 0; d < 2; ++d) x[d] -= 0.1 * std::sin(2 * pi * x[d]);
  }
  return std::make_unique<FluidParticipant<2>>(distribute(comm, raw), p, FluidContext{}, MotionLink{});
}

TEST(FourthOrder, goes_on_from_a_checkpoint_bit_for_bit_and_alike_on_any_number_of_ranks) {
  const auto first = cavity(FaceValues::fourth_order), second = cavity(FaceValues::fourth_order),
             alone = cavity(FaceValues::fourth_order, MPI_COMM_SELF),
             other = cavity(FaceValues::second_order);
  take_steps(*first, 0, 4);
  support::SavedState(*first).load_into(*second);
  take_steps(*first, 4, 8);
  take_steps(*second, 4, 8);
  EXPECT_EQ(first->fluid().state().u, second->fluid().state().u);
  take_steps(*alone, 0, 8);
  take_steps(*other, 0, 8);
  double orders = 0;
  for (Index c = 0; c < first->fluid().mesh().cells.n_owned(); ++c)
    orders = std::max(orders, (first->fluid().state().u[c] - other->fluid().state().u[c]).norm());
  EXPECT_LT(apart(*first, *alone), 1e-8);
  EXPECT_GT(parallel::max(MPI_COMM_WORLD, orders), 1e-4);
}

/// Links end at walls and where faces lie askew: a uniform flow stays uniform whatever lies there.
TEST(FourthOrder, uniform_flow_through_skewed_and_structured_parts_is_exact) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {12, 8, 1}, Vec3::Zero(), Vec3(3, 2, 1));
  for (Vec3& x : raw.points)  // the right half is askew
    if (x.x() > 1.6 && x.x() < 2.9 && x.y() > 0.1 && x.y() < 1.9)
      x.y() += 0.05 * std::sin(3 * x.x() + 5 * x.y());
  FluidParameters p = fluid_of(1, 0.01, 1e-12);
  p.viscous = ViscousTreatment::explicit_;
  p.face_values = FaceValues::fourth_order;
  p.initial_velocity = {{"1"}, {"0"}};
  all_sides(p, 2, boundary(BoundaryType::slip));
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"1", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  EXPECT_GT(c.fluid().fourth()->share(), 0.3);
  EXPECT_LT(c.fluid().fourth()->share(), 0.8);
  c.run(0.5, 10);
  EXPECT_LT(c.largest_velocity_error([](const Vec3&) { return Vec3(1, 0, 0); }), 1e-9);
}

TEST(FourthOrder, is_refused_with_what_it_does_not_know) {
  RawMesh raw = box<2>(8, 0);
  FluidParameters p = periodic<2>(raw, 1, FaceValues::fourth_order);
  const auto with_mover = [&] {
    FluidCase<2>(MPI_COMM_WORLD, raw, p, [](const Vec3& x, GlobalIndex, double) { return x; });
  };
  EXPECT_THAT(with_mover, ::testing::ThrowsMessage<Error>(::testing::HasSubstr("a mesh that moves")));
}

TEST(FourthOrder, auto_takes_it_on_quadrilaterals_at_rest_and_neither_on_triangles_nor_on_moving_meshes) {
  RawMesh raw = box<2>(8, 0);
  const FluidParameters p = periodic<2>(raw, 1, FaceValues::automatic);
  EXPECT_NE(FluidCase<2>(MPI_COMM_WORLD, raw, p).fluid().fourth(), nullptr);
  const auto at_rest = [](const Vec3& x, GlobalIndex, double) { return x; };
  EXPECT_EQ(FluidCase<2>(MPI_COMM_WORLD, raw, p, at_rest).fluid().fourth(), nullptr);
  RawMesh triangles = make_box(BoxCells::triangles, {8, 8, 1}, Vec3::Zero(), Vec3(1, 1, 1));
  const FluidParameters q = periodic<2>(triangles, 1, FaceValues::automatic);
  EXPECT_EQ(FluidCase<2>(MPI_COMM_WORLD, triangles, q).fluid().fourth(), nullptr);
}

}  // namespace couplet::fluid::test::fourth_order_test
