// SPDX-License-Identifier: Apache-2.0
// What the discrete operators do to the kinetic energy, and the orders of the vortex array in a moving frame.
#include <Eigen/Eigenvalues>

#include "fluid_case.hpp"
#include "fluid_solver/momentum/rates.hpp"

namespace couplet::fluid::test::energy_test {
using namespace mesh;

constexpr double pi = std::numbers::pi;

template <int D>
FluidParameters periodic_box(RawMesh& raw, double viscosity) {
  FluidParameters p = fluid_of(1, viscosity, 1e-12);
  p.viscous = ViscousTreatment::explicit_;
  p.time_step = 1;
  all_sides(p, D, boundary(BoundaryType::periodic));
  raw.periodic = {{"xmin", "xmax"}, {"ymin", "ymax"}};
  if (D == 3) raw.periodic.push_back({"zmin", "zmax"});
  return p;
}

template <int D>
RawMesh box(BoxCells cells, int n, int nz = 1) {
  RawMesh raw = make_box(cells, {n, n, nz}, Vec3::Zero(), Vec3(2 * pi, 2 * pi, D == 3 ? 2 * pi * nz / n : 1));
  return raw;
}

/// sum u.R / sum |u||R| of one operator in a state, R the volume-integrated rate.
template <int D>
double share_of_energy(FluidCase<D>& c, const State<D>& s, double nu) {
  const Boundary<D>& b = c.fluid().boundary();
  RateOperator<D> rates(c.mesh(), b, nu);
  Rates<D> r;
  rates.apply(s, false, false, r);
  double work = 0, size = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    work += s.u[i].dot(r.rate[i]);
    size += s.u[i].norm() * r.rate[i].norm();
  }
  return parallel::sum(c.mesh().comm, work) / parallel::sum(c.mesh().comm, size);
}

template <int D>
void check_convection(BoxCells cells, int n, int nz) {
  RawMesh raw = box<D>(cells, n, nz);
  perturb_interior(raw, 0.15, 3);
  FluidParameters p = periodic_box<D>(raw, 0);
  p.initial_velocity = {{"0.6+sin(x)*cos(y)"}, {"0.3-cos(x)*sin(y)"}};
  if (D == 3) p.initial_velocity.push_back({"0.2*cos(x)"});
  FluidCase<D> c(MPI_COMM_WORLD, raw, p);
  for (int i = 0; i < 3; ++i) c.step(0.01);
  const double share = std::abs(share_of_energy(c, c.state(), 0));
  printf("convection: u.C(u)u / |u||Cu| = %.1e\n", share);
  ::testing::Test::RecordProperty("share", std::to_string(share * 1e12) + "e-12");
  EXPECT_LT(share, 1e-12);
}

TEST(Convection, does_no_work_on_perturbed_quadrilaterals) {
  check_convection<2>(BoxCells::quadrilaterals, 32, 1);
}
TEST(Convection, does_no_work_on_perturbed_triangles) { check_convection<2>(BoxCells::triangles, 20, 1); }
TEST(Convection, does_no_work_on_perturbed_hexahedra) { check_convection<3>(BoxCells::hexahedra, 10, 5); }
TEST(Convection, does_no_work_on_perturbed_mixed_cells) { check_convection<3>(BoxCells::mixed, 6, 6); }

TEST(Diffusion, is_symmetric_and_negative_definite) {
  RawMesh raw = make_box(BoxCells::mixed, {4, 4, 3}, Vec3::Zero(), Vec3::Ones());
  perturb_interior(raw, 0.15, 3);
  FluidParameters p = fluid_of(1, 1);
  all_sides(p, 3, boundary(BoundaryType::no_slip));
  FluidCase<3> c(MPI_COMM_SELF, raw, p);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-1, 1);
  State<3> a = c.state(), b = c.state();
  for (auto* s : {&a, &b}) {
    std::fill(s->phi.begin(), s->phi.end(), 0.0);
    for (Vec<3>& u : s->u) u = Vec<3>(value(random), value(random), value(random));
  }
  RateOperator<3> rates(c.mesh(), c.fluid().boundary(), 1);
  Rates<3> la, lb;
  rates.apply(a, false, false, la);
  rates.apply(b, false, false, lb);
  double ab = 0, ba = 0, aa = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i) {
    ab += a.u[i].dot(lb.rate[i]);
    ba += b.u[i].dot(la.rate[i]);
    aa += a.u[i].dot(la.rate[i]);
  }
  EXPECT_NEAR(ab, ba, 1e-12 * std::abs(aa));
  EXPECT_LT(aa, 0);
}

template <int D>
double kinetic(const FluidCase<D>& c) {
  double energy = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i)
    energy += 0.5 * c.state().placement->volume[i] * c.state().u[i].squaredNorm();
  return parallel::sum(c.mesh().comm, energy);
}

/// An inviscid eddy in thin layers of cells over a rough floor, where the lines between cells miss their faces by more
/// than the height of a cell.
TEST(Projection, adds_no_energy_in_thin_cells_that_miss_each_other) {
  for (int seed = 1; seed <= 5; ++seed) {
    RawMesh raw = make_box(BoxCells::hexahedra, {8, 8, 8}, Vec3::Zero(), Vec3::Ones());
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shift(-0.3 / 8, 0.3 / 8);
    const std::size_t layer = raw.points.size() / 9;
    for (std::size_t k = 0; k < raw.points.size(); ++k) {
      Vec3& x = raw.points[k];
      if (k < layer)
        for (int i = 0; i < 2; ++i)
          if (const double by = shift(random); x[i] > 1e-9 && x[i] < 1 - 1e-9) x[i] += by;
      if (k >= layer) x.head<2>() = raw.points[k % layer].head<2>();
      x.z() = 0.02 * x.z() + 0.05 * std::sin(17 * x.x() + 3 * seed) * std::sin(23 * x.y());
    }
    FluidParameters p = fluid_of(1, 0, 1e-6);
    p.viscous = ViscousTreatment::explicit_;
    all_sides(p, 3, boundary(BoundaryType::slip));
    p.initial_velocity = {{"sin(pi*x)*cos(pi*y)"}, {"-cos(pi*x)*sin(pi*y)"}, {"0"}};
    FluidCase<3> c(MPI_COMM_WORLD, raw, p);
    const double before = kinetic(c);
    ASSERT_NO_THROW(c.run(1, 50)) << seed;
    printf("thin cells, %d: kinetic energy %.3f times\n", seed, kinetic(c) / before);
    EXPECT_LT(kinetic(c), before) << seed;
  }
}

/// Closed box of n cells per side with random widths that differ by up to `ratio`; its inner points move by up to `shift`
/// of the narrower width beside them.
RawMesh random_box(BoxCells cells, int dim, int n, double ratio, double shift, unsigned seed) {
  RawMesh raw = make_box(cells, {n, n, dim == 3 ? n : 1}, Vec3::Zero(), Vec3::Ones());
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(-1, 1);
  std::array<std::vector<double>, 3> place, narrow;
  for (int d = 0; d < dim; ++d) {
    std::vector<double> width(n);
    for (double& w : width) w = std::pow(ratio, 0.5 * part(random));
    place[d].assign(1, 0.0), narrow[d].assign(n + 1, 0.0);
    for (const double w : width) place[d].push_back(place[d].back() + w);
    for (int i = 1; i < n; ++i) narrow[d][i] = std::min(width[i - 1], width[i]);
  }
  for (Vec3& x : raw.points)
    for (int d = 0; d < dim; ++d) {
      const std::size_t i = std::size_t(std::lround(x[d] * n));
      x[d] = place[d][i] + shift * part(random) * narrow[d][i];
    }
  return raw;
}

/// Largest factor by which one projection multiplies the root of the kinetic energy: the norm of its matrix, of which
/// each column is the projection of a unit velocity.
template <int D>
double norm_of_projection(const RawMesh& raw) {
  FluidParameters p = fluid_of(1, 0, 1e-12);
  p.viscous = ViscousTreatment::explicit_;
  p.time_step = 1;
  all_sides(p, D, boundary(BoundaryType::slip));
  FluidCase<D> c(MPI_COMM_SELF, raw, p);
  const Index cells = c.mesh().cells.n_owned();
  Eigen::MatrixXd a(cells * D, cells * D);
  for (Index k = 0; k < cells * D; ++k) {
    State<D> s = c.state();
    const auto root = [&](Index i) { return std::sqrt(s.placement->volume[i]); };
    std::ranges::fill(s.u, Vec<D>::Zero());
    s.u[k / D][k % D] = 1 / root(k / D);
    c.fluid().boundary().close(c.mesh(), *s.placement, s.u, s.w, s.u_boundary);
    c.fluid().solvers().project_initial(s);
    for (Index i = 0; i < cells; ++i) a.template block<D, 1>(i * D, k) = root(i) * s.u[i];
  }
  return std::sqrt(
      (a.transpose() * a).eval().template selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
}

/// With weights of one half the norms were up to 3.3 on boxes of parallel faces and up to 136 on others. What is left on
/// the latter comes from oblique faces and from the correction of gradients, which have no transpose in the flux.
TEST(Projection, hardly_raises_the_energy_of_any_velocity_on_cells_of_any_sizes) {
  const auto check = [](const char* name, auto dimension, BoxCells cells, int n, double ratio, double shift,
                        double bound) {
    double largest = 0;
    for (unsigned seed = 1; seed <= 5; ++seed)
      largest = std::max(
          largest, norm_of_projection<dimension()>(random_box(cells, dimension(), n, ratio, shift, seed)));
    printf("norm of a projection, %s, ratio %g, shift %g: %.4f\n", name, ratio, shift, largest);
    EXPECT_LT(largest, bound) << name << ratio << shift;
  };
  constexpr std::integral_constant<int, 2> plane{};
  constexpr std::integral_constant<int, 3> space{};
  for (const double ratio : {1., 4., 30., 150.}) {
    const double bound = ratio < 10 ? 1.25 : 8;
    check("quadrilaterals", plane, BoxCells::quadrilaterals, 6, ratio, 0, 1.1);
    check("quadrilaterals", plane, BoxCells::quadrilaterals, 6, ratio, 0.2, bound);
    check("triangles", plane, BoxCells::triangles, 5, ratio, 0.2, bound);
    check("hexahedra", space, BoxCells::hexahedra, 3, ratio, 0, 1.1);
    check("prisms", space, BoxCells::prisms, 2, ratio, 0.2, bound);
  }
}

/// Inviscid vortex array in a moving frame over one second: the relative drift of the kinetic energy, and the
/// largest part that convection has in it in a step.
struct Drift {
  double total = 0, convection = 0;
  std::unique_ptr<FluidCase<2>> flow;
};
Drift inviscid_drift(double dt) {
  RawMesh raw = box<2>(BoxCells::quadrilaterals, 64);
  FluidParameters p = periodic_box<2>(raw, 0);
  p.initial_velocity = {{"0.6+sin(x)*cos(y)"}, {"0.3-cos(x)*sin(y)"}};
  Drift drift;
  drift.flow = std::make_unique<FluidCase<2>>(MPI_COMM_WORLD, raw, p);
  FluidCase<2>& c = *drift.flow;
  const double before = kinetic(c);
  RateOperator<2> rates(c.mesh(), c.fluid().boundary(), 0);
  Rates<2> r;
  while (c.state().time < 1 - dt / 2) {
    c.step(dt);
    rates.apply(c.state(), false, false, r);
    double work = 0;
    for (Index k = 0; k < c.mesh().cells.n_owned(); ++k) work += c.state().u[k].dot(r.rate[k]);
    drift.convection =
        std::max(drift.convection, std::abs(dt * parallel::sum(MPI_COMM_WORLD, work)) / before);
  }
  drift.total = std::abs(kinetic(c) / before - 1);
  return drift;
}

/// The pressure takes energy only from what alternates between cells.
TEST(InviscidVortices, lose_nothing_by_convection_and_less_than_the_time_error_in_all) {
  const Drift coarse = inviscid_drift(0.01), fine = inviscid_drift(0.005);
  const double speed = std::sqrt(2 * kinetic(*fine.flow)) / (2 * pi),
               time_error = difference(*coarse.flow, *fine.flow) / 3 / speed;
  printf("inviscid: convection %.1e a step; drift %.2e %.2e; time error %.2e\n", fine.convection,
         coarse.total, fine.total, time_error);
  RecordProperty("drift", std::to_string(fine.total * 1e6) + "e-6");
  RecordProperty("time_error", std::to_string(time_error * 1e6) + "e-6");
  RecordProperty("convection_per_step", std::to_string(fine.convection * 1e12) + "e-12");
  EXPECT_LE(fine.total, time_error);
  EXPECT_LT(fine.convection, 1e-12);
}

struct Errors {
  double u, p;
};

/// Vortex array carried along; viscosity 0.05.
template <int D>
Errors travelling(RawMesh raw, double dt) {
  const double nu = 0.05, end = 0.5;
  FluidParameters p = periodic_box<D>(raw, nu);
  p.pressure_tolerance = 1e-9;
  p.time_step = dt;
  p.initial_velocity = {{"0.6+sin(x)*cos(y)"}, {"0.3-cos(x)*sin(y)"}};
  if (D == 3) p.initial_velocity.push_back({"0"});
  FluidCase<D> c(MPI_COMM_WORLD, raw, p);
  c.run(end, static_cast<int>(std::lround(end / dt)));
  const auto place = [](const Vec3& x, double t) { return Vec3(x.x() - 0.6 * t, x.y() - 0.3 * t, 0); };
  const double u = c.velocity_error([&](const Vec3& x) {
    const Vec3 y = place(x, end);
    const double f = std::exp(-2 * nu * end);
    return Vec3(0.6 + f * std::sin(y.x()) * std::cos(y.y()), 0.3 - f * std::cos(y.x()) * std::sin(y.y()), 0);
  });
  const double middle = end - dt / 2;
  const double pressure = c.pressure_error([&](const Vec3& x) {
    const Vec3 y = place(x, middle);
    return 0.25 * std::exp(-4 * nu * middle) * (std::cos(2 * y.x()) + std::cos(2 * y.y()));
  });
  return {u, pressure};
}

double slope(double coarse, double fine) { return std::log2(coarse / fine); }

TEST(TravellingVortices, are_second_order_in_space_on_quadrilaterals) {
  Errors e[3];
  for (int i = 0; i < 3; ++i)
    e[i] = travelling<2>(box<2>(BoxCells::quadrilaterals, 32 << i), 0.01 / (1 << i));
  const double u = slope(e[1].u, e[2].u), p = slope(e[1].p, e[2].p);
  printf("quadrilaterals: u %.2e %.2e %.2e slope %.3f; p %.2e %.2e %.2e slope %.3f\n", e[0].u, e[1].u, e[2].u,
         u, e[0].p, e[1].p, e[2].p, p);
  RecordProperty("velocity_slope", std::to_string(u));
  RecordProperty("pressure_slope", std::to_string(p));
  EXPECT_GE(u, 1.95);
  EXPECT_GE(p, 1.95);
}

TEST(TravellingVortices, are_second_order_in_space_on_perturbed_prisms) {
  Errors e[3];
  for (int i = 0; i < 3; ++i) {
    RawMesh raw = box<3>(BoxCells::prisms, 12 << i, 3);
    // Columns of prisms: points move in the plane only, all layers alike, the boundary stays.
    const std::size_t layer = raw.points.size() / 4;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> shift(-0.15, 0.15);
    const double h = 2 * pi / (12 << i);
    for (std::size_t k = 0; k < layer; ++k) {
      const double dx = shift(random) * h, dy = shift(random) * h;
      Vec3& x = raw.points[k];
      if (x.x() < 1e-9 || x.y() < 1e-9 || x.x() > 2 * pi - 1e-9 || x.y() > 2 * pi - 1e-9) continue;
      for (int l = 0; l < 4; ++l) raw.points[k + l * layer].head<2>() += Vec<2>(dx, dy);
    }
    e[i] = travelling<3>(raw, 0.01 / (1 << i));
  }
  const double u = slope(e[1].u, e[2].u), p = slope(e[1].p, e[2].p);
  printf("prisms: u %.2e %.2e %.2e slope %.3f; p %.2e %.2e %.2e slope %.3f\n", e[0].u, e[1].u, e[2].u, u,
         e[0].p, e[1].p, e[2].p, p);
  RecordProperty("velocity_slope", std::to_string(u));
  RecordProperty("pressure_slope", std::to_string(p));
  EXPECT_GE(u, 1.8);
}

/// Differences between runs to t = 0.5 s with steps halved three times, the first run taking `steps`.
std::array<double, 3> differences_of_halved_steps(int steps) {
  std::vector<std::unique_ptr<FluidCase<2>>> runs;
  for (int i = 0; i < 4; ++i) {
    RawMesh raw = box<2>(BoxCells::quadrilaterals, 48);
    FluidParameters p = periodic_box<2>(raw, 0.05);
    p.pressure_tolerance = 1e-11;
    p.initial_velocity = {{"0.6+sin(x)*cos(y)"}, {"0.3-cos(x)*sin(y)"}};
    runs.push_back(std::make_unique<FluidCase<2>>(MPI_COMM_WORLD, raw, p));
    runs.back()->run(0.5, steps << i);
  }
  return {difference(*runs[0], *runs[1]), difference(*runs[1], *runs[2]), difference(*runs[2], *runs[3])};
}

TEST(TravellingVortices, are_second_order_in_time) {
  const auto [d0, d1, d2] = differences_of_halved_steps(20);
  printf("time: %.2e %.2e %.2e slopes %.2f %.2f\n", d0, d1, d2, slope(d0, d1), slope(d1, d2));
  RecordProperty("time_slope", std::to_string(slope(d1, d2)));
  EXPECT_GE(slope(d1, d2), 1.9);
}

}  // namespace couplet::fluid::test::energy_test
