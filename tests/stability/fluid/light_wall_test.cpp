// SPDX-License-Identifier: Apache-2.0
// A light wall on a viscous fluid in the semi-implicit loop, one mode of it, so that every pass is solved
// exactly: what is left is the scheme.
#include "../../verification/fluid/fluid_case.hpp"
#include "fluid_solver/step/fluid.hpp"
#include "tests/support/test.hpp"

namespace couplet::fluid::test::light_wall_test {

constexpr double wave = 2 * std::numbers::pi, dt = 0.01;

/// m da/dt = F(a) + push for the velocity a sin(2 pi x) normal to the floor of a box with an open lid.
class LightWall {
 public:
  LightWall(double mass, double viscosity, bool renew)
      : mass_(mass), renew_(renew), case_(MPI_COMM_WORLD, mesh(), parameters(viscosity)) {}

  void step(double push) {
    Fluid<2>& fluid = case_.fluid();
    fluid.begin_step(case_.state().time, dt);
    const double guess = 2 * now_ - before_;
    fluid.prepare({}, velocity(guess));
    double a = solve(guess, push);
    if (renew_) {
      fluid.solve_pressure(velocity(a));
      unseen_ = fluid.unseen_share(velocity(a))[0];
      fluid.prepare({}, velocity(a));
      a = solve(a, push);
    }
    fluid.solve_pressure(velocity(a));
    fluid.accept();
    before_ = now_;
    now_ = a;
  }
  double velocity() const { return now_; }
  double unseen() const { return unseen_; }

 private:
  static mesh::RawMesh mesh() {
    return mesh::make_box(mesh::BoxCells::quadrilaterals, {32, 24, 1}, Vec3::Zero(), Vec3(1, 0.75, 1));
  }
  static FluidParameters parameters(double viscosity) {
    FluidParameters p = fluid_of(1, viscosity, 1e-12);
    p.viscous = ViscousTreatment::implicit;
    p.time_step = dt;
    p.boundaries["ymin"] = boundary(BoundaryType::interface);
    p.boundaries["ymax"] = boundary(BoundaryType::outlet);
    p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::slip);
    return p;
  }
  Vectors<2> velocity(double a) const {
    return case_.wall([a](const Vec3& x, double) { return Vec3(0, a * std::sin(wave * x.x()), 0); }, 0);
  }
  double force() const {
    double sum = 0;
    const Fluid<2>& fluid = case_.fluid();
    for (std::size_t b = 0; b < fluid.pressure_force().size(); ++b)
      if (fluid.boundary().is_interface(static_cast<Index>(b)))
        sum += (fluid.pressure_force()[b] + fluid.viscous_force()[b]).y() *
               std::sin(wave * case_.state().placement->boundary_centre[b].x());
    return couplet::parallel::sum(MPI_COMM_WORLD, sum);
  }
  /// The force is linear in a within one prediction: two passes say all.
  double solve(double first, double push) {
    Fluid<2>& fluid = case_.fluid();
    fluid.solve_pressure(velocity(first));
    const double f0 = force();
    fluid.solve_pressure(velocity(first + 1));
    const double slope = force() - f0;
    // mass (a - now)/dt = f0 + slope (a - first) + push
    return (mass_ / dt * now_ + f0 - slope * first + push) / (mass_ / dt - slope);
  }

  double mass_;
  bool renew_;
  mutable FluidCase<2> case_;
  double now_ = 0, before_ = 0, unseen_ = 0;
};

/// rms third over rms first difference of the last 8 steps of a wall pushed for 5 steps of 40.
double zigzag(double mass, double viscosity, bool renew) {
  LightWall wall(mass, viscosity, renew);
  std::vector<double> a;
  for (int n = 0; n < 40; ++n) {
    wall.step(n < 5 ? 1 : 0);
    a.push_back(wall.velocity());
  }
  const auto differences = [](std::vector<double> v, int order) {
    for (; order > 0; --order, v.pop_back())
      for (std::size_t i = 0; i + 1 < v.size(); ++i) v[i] = v[i + 1] - v[i];
    double square = 0;
    for (const double d : v) square += d * d;
    return std::sqrt(square / double(v.size()));
  };
  const std::vector<double> last(a.end() - 9, a.end());
  return differences(last, 3) / differences(last, 1);
}

TEST(LightWall, of_a_fortieth_of_the_added_mass_moves_smoothly) {
  for (const double viscosity : {0.1, 1.0, 10.0})
    EXPECT_LT(zigzag(0.002, viscosity, true), 0.15) << viscosity;
}

TEST(LightWall, a_heavy_one_needs_no_renewal) {
  EXPECT_LT(zigzag(20, 1, false), 0.15);
  LightWall heavy(20, 1, true), light(0.002, 1, true);
  for (int n = 0; n < 5; ++n) heavy.step(1), light.step(1);
  EXPECT_LT(heavy.unseen(), 0.01);
  EXPECT_GT(light.unseen(), 10 * heavy.unseen());
}

/// (15): the shear follows the wall velocity of the pass by theta mu g of the slip, and comes back with it.
TEST(LightWall, shear_is_that_of_the_velocity_of_the_pass) {
  FluidParameters p = channel(ViscousTreatment::implicit);
  p.time_step = 1;
  FluidCase<2> c(MPI_COMM_WORLD, channel_mesh(), p);
  c.run(0.05, 5);
  Fluid<2>& fluid = c.fluid();
  const auto slide = [&](double u) {
    return c.wall([u](const Vec3&, double) { return Vec3(u, 0.3 * u, 0); }, 0);
  };
  fluid.begin_step(c.state().time, 0.01);
  fluid.prepare({}, slide(0.1));
  fluid.solve_pressure(slide(0.1));
  const Vectors<2> guess = fluid.viscous_force();
  fluid.solve_pressure(slide(0.35));
  for (std::size_t b = 0; b < guess.size(); ++b) {
    if (!fluid.boundary().is_interface(static_cast<Index>(b))) continue;
    const Placement<2>& at = *c.state().placement;
    const Index f = c.mesh().n_interior + static_cast<Index>(b);
    const Vec<2> n = at.area[f].normalized(), slip(0.25, 0.075);
    const double weight = 0.5 + 1. / 16;  // of modified Crank-Nicolson
    const Vec<2> expected = guess[b] - weight * p.viscosity * at.conductance[f] * (slip - slip.dot(n) * n);
    EXPECT_NEAR((fluid.viscous_force()[b] - expected).norm(), 0, 1e-12);
  }
  fluid.solve_pressure(slide(0.1));
  for (std::size_t b = 0; b < guess.size(); ++b) EXPECT_EQ(fluid.viscous_force()[b], guess[b]);
}

// Predictions made anew: a wall whose every pass is solved exactly but for a mass that acts on the guess.

constexpr double load = 1;  // N, beside which what friction misses is judged

/// M (w - w^n) + E (g - w^n) = push, dt = 1 s; a pass leaves the share `added`/M of what is missing.
struct Wall {
  double mass, layer, added = 0.3, now = 0, before = 0;
  int renewals = 0;
  Renewal<2> renewal = {};

  double answer(double guess, double push) const { return now + (push - layer * (guess - now)) / mass; }
  /// `most`: renewals a step.
  void step(double push, int most) {
    double guess = 2 * now - before, w = guess;
    renewal.start({Vec<2>(0, guess)});
    for (int pass = 2; pass <= 40; ++pass) {
      const double goal = answer(guess, push);
      w = goal + added / mass * (w - goal);
      if (renewal.count() == most) continue;
      if (renewal.wanted(MPI_COMM_SELF, {Vec<2>(0, w)}, layer * std::abs(w - guess) / load))
        guess = renewal.guess()[0].y();
    }
    renewals += renewal.count();
    before = now;
    now = w;
  }
};

/// Change of the velocity in the last of 60 steps of a wall pushed in the first three.
double left_over(Wall& wall, int most = 100) {
  for (int n = 0; n < 60; ++n) wall.step(n < 3 ? 0.1 * load : 0, most);
  return std::abs(wall.now - wall.before);
}

TEST(Renewal, holds_a_wall_of_twice_the_mass_that_it_drags_and_fails_for_a_lighter_one) {
  Wall heavier{1, 0.5}, lighter{1, 1.5};
  EXPECT_LT(left_over(heavier), 2e-3);
  EXPECT_GT(heavier.renewals, 4);
  EXPECT_THROW(left_over(lighter), SolveFailure);
}

// The neighbour: friction at the guessed velocity alone, or with one better guess.
TEST(Renewal, such_a_wall_grows_without_it_and_with_one_only) {
  Wall never{1, 1.5}, once{1, 1.5};
  EXPECT_GT(left_over(never, 0), 1e3);
  EXPECT_GT(left_over(once, 1), 1e3);
}

/// Passes hardly change a wall of five times the mass that it drags. On the guess alone it starts with 1.2 of its motion,
/// though only 2 % of the load are missed.
TEST(Renewal, starts_a_heavy_wall_as_its_whole_mass_does) {
  const double push = 0.1 * load, right = push / (100 + 20);
  Wall never{100, 20}, heavy{100, 20};
  never.step(push, 0);
  EXPECT_NEAR(never.now, 1.2 * right, 0.01 * right);
  heavy.step(push, 100);
  EXPECT_NEAR(heavy.now, right, 0.01 * right);
  left_over(heavy);
  EXPECT_LE(heavy.renewals, 6);
}

TEST(Renewal, waits_for_a_better_velocity_than_a_relaxed_pass_has) {
  const auto at = [](double w) { return Vectors<2>{Vec<2>(w, 0)}; };
  Renewal<2> renewal;
  renewal.start(at(0));
  EXPECT_FALSE(renewal.wanted(MPI_COMM_SELF, at(0.8), 0.01)) << "second pass";
  EXPECT_FALSE(Renewal<2>(renewal).wanted(MPI_COMM_SELF, at(1), 1e-4)) << "nothing is missed";
  EXPECT_TRUE(renewal.wanted(MPI_COMM_SELF, at(1), 0.01));
  Renewal<2> shrinking = renewal;
  EXPECT_FALSE(renewal.wanted(MPI_COMM_SELF, at(1.9), 1)) << "the gap of 1 became 0.9";
  EXPECT_TRUE(renewal.wanted(MPI_COMM_SELF, at(1.9), 1));
  EXPECT_TRUE(shrinking.wanted(MPI_COMM_SELF, at(1.5), 1)) << "the gap of 1 became 0.5";
}

TEST(Renewal, fails_where_four_better_predictions_still_miss_too_much_of_the_load) {
  const auto at = [](double w) { return Vectors<2>{Vec<2>(w, 0)}; };
  const auto after_four = [&](double unseen) {
    Renewal<2> renewal;
    renewal.start(at(0));
    for (int pass = 2, k = 1; renewal.count() < 4 && pass < 40; ++pass)
      renewal.wanted(MPI_COMM_SELF, at(k = -k), 0.02);
    EXPECT_EQ(renewal.count(), 4);
    for (int pass = 0; pass < 3; ++pass) EXPECT_FALSE(renewal.wanted(MPI_COMM_SELF, at(1), unseen));
  };
  after_four(0.0005);
  EXPECT_THROW(after_four(0.02), SolveFailure);
}

}  // namespace couplet::fluid::test::light_wall_test
