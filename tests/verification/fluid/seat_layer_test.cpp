// SPDX-License-Identifier: Apache-2.0
// Layers of cells that a moving mesh carries through a seat: from blocked to fluid and back.
#include "fluid_case.hpp"
#include "participant_case.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::fluid::test::seat_layer_test {

constexpr double h = 0.05, inflow = 0.08, width = 1.2;  // cell [m], [m^2/s], of the seat [m]

/// Out of a tube of width 0.4 below the seat y = 0, under a lid, to both sides; cells Reynolds number 4 in the tube.
FluidParameters orifice(BodySurface surface) {
  FluidParameters p = fluid_of(1, 0.004, 1e-13);
  p.boundaries["ymin"] = boundary(BoundaryType::inlet, {"0", "abs(x) < 0.2 ? 0.3*(1-(x/0.2)^2) : 0"});
  p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.bodies["seat"].level.text = "max(y, 0.2-abs(x))";
  p.bodies["seat"].surface = surface;
  return p;
}

mesh::RawMesh layers(double lid) {
  return mesh::make_box(mesh::BoxCells::quadrilaterals, {32, int(std::lround((0.4 + lid) / h)), 1},
                        Vec3(-0.8, -0.4, 0), Vec3(0.8, lid, 1));
}

/// Two cells up and down again beside the seat, nothing at bottom and lid; the pressure of the flow stays what it is.
struct Layers {
  Layers(BodySurface surface, double lid_height, MPI_Comm comm = MPI_COMM_WORLD)
      : lid(lid_height), c(comm, layers(lid), orifice(surface), [this](const Vec3& x, GlobalIndex, double t) {
          const double s = x[1] < 0 ? x[1] / 0.4 : x[1] / lid;
          return Vec3(x[0], x[1] + lift(t) * (1 - s * s) * (1 - s * s), 0);
        }) {}
  double lift(double t) const { return t < begin ? 0 : h * (1 - std::cos(speed / h * (t - begin))); }
  double end() const { return 2 * std::numbers::pi * h / speed; }

  double flux_sum() const {
    double out = 0;
    for (Index f = c.mesh().n_interior; f < c.mesh().n_flux_faces(); ++f) out += c.state().phi[f];
    return parallel::sum(c.mesh().comm, out);
  }
  /// In the tube at its inlet.
  double pressure() const {
    const mesh::Patch& patch = *c.mesh().find_patch("ymin");
    double sums = 0, n = 0;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Index o = c.mesh().owner[f];
      if (std::abs(c.state().placement->centre[o][0]) > 0.2) continue;
      sums += c.state().pressure[0]->p[o];
      n += 1;
    }
    return parallel::sum(c.mesh().comm, sums) / parallel::sum(c.mesh().comm, n);
  }
  double lifting_force() {
    const State<2>& s = c.state();
    const auto [pressure, friction] = c.fluid().bodies()->forces(*s.placement, *s.pressure[0], s.u, 0.004)[0];
    return pressure[1] + friction[1];
  }

  double lid, begin = 3, speed = 0.05;
  FluidCase<2> c;
};

/// Largest deviations from the flow on the mesh at rest, largest changes from step to step; shares of the pressure, of that times
/// the seat.
struct Spikes {
  double pressure = 0, step = 0, force = 0, force_step = 0, mass = 0;
};
Spikes pass(BodySurface surface, double lid, double cells_per_step) {
  Layers l(surface, lid);
  l.c.run(l.begin, 300);
  const double p0 = l.pressure(), f0 = l.lifting_force(), dt = cells_per_step * h / l.speed;
  Spikes s;
  double p = p0, f = f0;
  for (int i = 0; i < int(l.end() / dt); ++i) {
    l.c.step(dt);
    const double p_before = std::exchange(p, l.pressure()), f_before = std::exchange(f, l.lifting_force());
    s.pressure = std::max(s.pressure, std::abs(p - p0) / p0);
    s.step = std::max(s.step, std::abs(p - p_before) / p0);
    s.force = std::max(s.force, std::abs(f - f0) / (p0 * width));
    s.force_step = std::max(s.force_step, std::abs(f - f_before) / (p0 * width));
    s.mass = std::max(s.mass, std::abs(l.flux_sum()) / inflow);
  }
  printf("%s, lid %g, %g of a cell per step: pressure %.4f (per step %.4f), force %.4f (%.4f), mass %.1e\n",
         surface == BodySurface::cut ? "cut" : "steps", lid, cells_per_step, s.pressure, s.step, s.force,
         s.force_step, s.mass);
  return s;
}

TEST(SeatLayer, passes_without_spikes_and_keeps_the_mass_at_any_step) {
  for (const double lid : {0.5, 0.3})
    for (const double share : {1.0, 0.1, 0.01}) {
      const Spikes s = pass(BodySurface::cut, lid, share);
      const std::string name =
          "lid_" + std::to_string(int(10 * lid)) + "_percent_of_a_cell_" + std::to_string(int(100 * share));
      RecordProperty(name + "_pressure", std::to_string(s.pressure));
      RecordProperty(name + "_step", std::to_string(s.step));
      RecordProperty(name + "_force", std::to_string(s.force));
      RecordProperty(name + "_force_step", std::to_string(s.force_step));
      RecordProperty(name + "_mass", std::to_string(s.mass * 1e12) + "e-12");
      EXPECT_LT(s.pressure, 0.05) << lid << " " << share;
      EXPECT_LT(s.force, 0.1) << lid << " " << share;
      EXPECT_LT(s.force_step, 0.08) << lid << " " << share;
      EXPECT_LT(s.mass, 1e-12) << lid << " " << share;
    }
}

/// The failing neighbour: cells blocked at once, by their centres, keep the mass too, but each is a shock, the larger the smaller
/// the step.
TEST(SeatLayer, blocked_at_once_shocks_the_pressure_more_in_smaller_steps) {
  const Spikes coarse = pass(BodySurface::steps, 0.5, 0.1), fine = pass(BodySurface::steps, 0.5, 0.01);
  RecordProperty("at_once_tenth_pressure", std::to_string(coarse.pressure));
  RecordProperty("at_once_hundredth_pressure", std::to_string(fine.pressure));
  EXPECT_LT(fine.mass, 1e-12);
  EXPECT_GT(coarse.pressure, 0.1);
  EXPECT_GT(fine.pressure, 1);
  EXPECT_GT(fine.pressure, 5 * coarse.pressure);
}

/// Fluid at rest under a uniform pressure: the seat and its layers are not felt.
template <int D>
void rest(const mesh::RawMesh& raw, const std::string& level) {
  FluidParameters p = orifice(BodySurface::automatic);
  all_sides(p, D, boundary(BoundaryType::no_slip));
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "3");
  p.bodies["seat"].level.text = level;
  FluidCase<D> c(MPI_COMM_WORLD, raw, p, [](const Vec3& x, GlobalIndex, double t) {
    const double s = (x[1] - 0.5) / 0.5;
    return Vec3(x[0], x[1] + 0.12 * std::sin(t) * (1 - s * s), x[2]);
  });
  c.run(1, 20);
  EXPECT_TRUE(c.fluid().bodies()->cuts());
  double fastest = 0, off = 0;
  GlobalIndex cut = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    fastest = std::max(fastest, c.state().u[i].norm());
    if (c.fluid().bodies()->is_closed(i)) continue;
    cut += c.fluid().bodies()->is_solid(i);
    off = std::max(off, std::abs(c.state().pressure[0]->p[i] - 3));
  }
  EXPECT_GT(parallel::sum(c.mesh().comm, cut), 0);
  EXPECT_LT(parallel::max(c.mesh().comm, fastest), 1e-11);
  EXPECT_LT(parallel::max(c.mesh().comm, off), 1e-10);
}

TEST(SeatLayer, leaves_a_fluid_at_rest_under_its_pressure) {
  const Vec3 one(1, 1, 1);
  rest<2>(mesh::make_box(mesh::BoxCells::quadrilaterals, {8, 11, 1}, Vec3::Zero(), one),
          "max(y-0.41, 0.3-x)");
  rest<2>(mesh::make_box(mesh::BoxCells::triangles, {8, 11, 1}, Vec3::Zero(), one), "max(y-0.41, 0.3-x)");
  rest<3>(mesh::make_box(mesh::BoxCells::hexahedra, {5, 7, 5}, Vec3::Zero(), one),
          "max(y-0.41, 0.3-x-0.1*z)");
  rest<3>(mesh::make_box(mesh::BoxCells::tetrahedra, {4, 6, 4}, Vec3::Zero(), one), "max(y-0.41, 0.3-x)");
}

TEST(SeatLayer, is_the_same_on_any_ranks) {
  Layers all(BodySurface::automatic, 0.3), one(BodySurface::automatic, 0.3, MPI_COMM_SELF);
  for (Layers* l : {&all, &one}) {
    l->begin = 0.5;
    l->c.run(1.7, 60);
  }
  EXPECT_NEAR(all.pressure(), one.pressure(), 1e-9 * one.pressure());
  EXPECT_NEAR(all.lifting_force(), one.lifting_force(), 1e-9 * std::abs(one.pressure()));
}

TEST(SeatLayer, goes_on_from_a_checkpoint_bit_for_bit) {
  FluidParameters p = orifice(BodySurface::automatic);
  p.pressure_tolerance = 1e-4;
  p.motion.emplace();
  p.motion->displacement = {{"0"}, {"0.5*t*(1-(y < 0 ? y/0.4 : y/0.3)^2)^2"}};
  const auto make = [&] {
    auto run = std::make_unique<FluidParticipant<2>>(mesh::distribute(MPI_COMM_WORLD, layers(0.3)), p,
                                                     FluidContext{}, MotionLink{});
    run->initialise();
    return run;
  };
  const auto first = make(), second = make();
  take_steps(*first, 0, 6, 0.01);
  support::SavedState(*first).load_into(*second);
  for (auto* run : {first.get(), second.get()}) take_steps(*run, 6, 12, 0.01);
  EXPECT_EQ(first->fluid().state().phi, second->fluid().state().phi);
  EXPECT_EQ(first->fluid().state().pressure[0]->p, second->fluid().state().pressure[0]->p);
  EXPECT_EQ(first->fluid().state().memory, second->fluid().state().memory);
  double fastest = 0;
  for (const Vec<2>& u : first->fluid().state().u) fastest = std::max(fastest, u.norm());
  EXPECT_GT(parallel::max(MPI_COMM_WORLD, fastest), 0.1);
}

TEST(SeatLayer, is_refused_where_it_cannot_serve) {
  const auto refused = [](FluidParameters p, const std::string& why) {
    EXPECT_THAT(
        [&] {
          FluidCase<2>(MPI_COMM_SELF, layers(0.3), p, [](const Vec3& x, GlobalIndex, double) { return x; });
        },
        ::testing::ThrowsMessage<Error>(::testing::HasSubstr(why)));
  };
  FluidParameters p = orifice(BodySurface::cut);
  p.bodies["second"].level.text = "x+0.7";
  p.bodies["second"].surface = BodySurface::steps;
  refused(p, "the same kind of surface");
}

/// Of a linear level l in a simplex of n corners: sum of l_i^(n-1)/prod_j (l_i - l_j) over the corners above zero is the share, with
/// l_i^n/n the integral.
TEST(OpenPart, is_exact_for_linear_levels) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const std::size_t n : {2, 3, 4})
    for (int trial = 0; trial < 200; ++trial) {
      const Vec3 slope(any(random), any(random), any(random));
      const double at_zero = 0.5 * any(random);
      const Level level = [&](const Vec3& x) { return at_zero + slope.dot(x); };
      std::vector<LevelCorner> corners(n);
      for (LevelCorner& c : corners) {
        c.place = Vec3(any(random), any(random), any(random));
        c.level = level(c.place);
      }
      double share = 0, moment = 0;
      for (std::size_t i = 0; i < n; ++i) {
        if (corners[i].level <= 0) continue;
        double part = 1;
        for (std::size_t j = 0; j < n; ++j)
          if (j != i) part *= corners[i].level / (corners[i].level - corners[j].level);
        share += part;
        moment += part * corners[i].level / double(n);
      }
      const OpenPart open = open_part(corners, level, 0);
      EXPECT_NEAR(open.share, share, 1e-9) << n;
      EXPECT_NEAR(open.moment, moment, 1e-9) << n;
    }
}

}  // namespace couplet::fluid::test::seat_layer_test
