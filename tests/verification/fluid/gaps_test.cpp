// SPDX-License-Identifier: Apache-2.0
// A lid that comes down on the floor of a channel until 1 % of the height is left, and goes up again.
#include "fluid_case.hpp"

namespace couplet::fluid::test::gaps_test {

constexpr double height = 0.5, limit = 0.02, dt = 0.04;

/// Part of the way down: 0 to 1 within a second, half a second there, and back.
double closing(double t) {
  const double pi = std::acos(-1.0);
  if (t < 1) return (1 - std::cos(pi * t)) / 2;
  if (t < 1.5) return 1;
  return t < 2.5 ? (1 + std::cos(pi * (t - 1.5))) / 2 : 0;
}

Vec3 pinched(const Vec3& x, double t) {
  const double far = std::clamp((std::abs(x[0] - 3) - 0.25) / 2, 0.0, 1.0);
  return {x[0], x[1] * (1 - 0.99 * closing(t) * (1 + std::cos(std::acos(-1.0) * far)) / 2), x[2]};
}

FluidParameters valve(bool with_gap, double opening = limit) {
  FluidParameters p = fluid_of(1, 0.01, 1e-10);
  p.boundaries["xmin"] = boundary(BoundaryType::outlet, {}, "1");
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.boundaries["ymin"] = boundary(BoundaryType::no_slip);
  p.boundaries["ymax"] = boundary(BoundaryType::body);
  if (with_gap)
    p.gaps["slot"] = {.between = {"ymin", "ymax"}, .opening = opening, .height = {}, .direction = {}};
  return p;
}

struct Valve {
  explicit Valve(const FluidParameters& p)
      : c(MPI_COMM_WORLD,
          mesh::make_box(mesh::BoxCells::quadrilaterals, {60, 6, 1}, Vec3::Zero(), Vec3(6, height, 1)), p,
          [](const Vec3& x, GlobalIndex, double t) { return pinched(x, t); }) {}
  static Vec3 lid(const Vec3& x, double t) {
    Vec3 reference = x;  // x does not move, and the lid's own y is the height
    reference[1] = height;
    return (pinched(reference, t) - pinched(reference, t - dt)) / dt;  // what the mesh sweeps
  }
  void run(double end) {
    while (c.state().time < end - 1e-9) c.step(dt, lid);
  }
  /// Out of the patch [m^3/s].
  double flow(const char* name) const {
    const mesh::Patch& patch = *c.mesh().find_patch(name);
    double out = 0;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) out += c.state().phi[f];
    return parallel::sum(c.mesh().comm, out);
  }
  /// Largest |sum phi| / V of the cells that are not blocked [1/s].
  double divergence() const {
    const State<2>& s = c.state();
    const mesh::Mesh& mesh = c.mesh();
    std::vector<double> sums(mesh.cells.n_local(), 0.0);
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      sums[mesh.owner[f]] += s.phi[f];
      if (f < mesh.n_interior) sums[mesh.neighbour[f]] -= s.phi[f];
    }
    double worst = 0;
    for (Index i = 0; i < mesh.cells.n_owned(); ++i)
      if (!s.blocked || !(*s.blocked)[i]) worst = std::max(worst, std::abs(sums[i]) / s.placement->volume[i]);
    return parallel::max(mesh.comm, worst);
  }
  FluidCase<2> c;
};

TEST(Gaps, a_slot_closes_by_99_percent_and_opens_again) {
  Valve with(valve(true)), without(valve(false));
  with.run(0.48);
  without.run(0.48);
  EXPECT_FALSE(with.c.state().blocked);
  const double apart = std::abs(with.flow("xmin") - without.flow("xmin"));  // ranks: two partitions
  EXPECT_LE(apart, parallel::comm_size(MPI_COMM_WORLD) == 1 ? 0 : 1e-8) << "an open gap does nothing";
  with.run(1.4);
  without.run(1.4);
  EXPECT_TRUE(with.c.state().blocked);
  EXPECT_LT(std::abs(with.flow("xmin")), 1e-3 * std::abs(without.flow("xmin")));
  EXPECT_LT(std::abs(with.flow("xmin")), 1e-8);
  EXPECT_LT(with.divergence(), 1e-6);
  const auto closed = with.c.fluid().statistics().all_sub_steps,
             open = without.c.fluid().statistics().all_sub_steps;
  EXPECT_LT(closed, open) << "cells of the slot still ask for steps of their own";
  with.run(2.6);
  without.run(2.6);
  EXPECT_FALSE(with.c.state().blocked);
  EXPECT_NEAR(with.flow("xmin"), without.flow("xmin"), 0.01 * std::abs(without.flow("xmin")));
  RecordProperty("sub_steps_closed", closed);
  RecordProperty("sub_steps_without", open);
}

TEST(Gaps, what_goes_out_is_what_the_lid_presses_out_of_the_free_cells) {
  static constexpr double small = 0.002;
  Valve v(valve(true));
  v.run(0.92);
  const auto lid = [](const Vec3& x, double t) {
    const Vec3 reference(x[0], height, 0);
    return Vec3((pinched(reference, t) - pinched(reference, t - small)) / small);
  };
  const auto facts = [&] { return v.c.fluid().gaps()->facts()[0]; };
  ASSERT_GT(facts().cells, 0);
  double before = 0, cells = -1;
  while (facts().cells != cells) {  // until the same cells stay blocked in a step
    before = facts().volume;
    cells = facts().cells;
    v.c.step(small, lid);
    ASSERT_LT(v.c.state().time, 0.98);
  }
  const double out = v.flow("xmin") + v.flow("xmax") + v.flow("ymin") + v.flow("ymax");
  EXPECT_NEAR(out, (facts().volume - before) / small, 0.005 * std::abs(out));
  EXPECT_GT(std::abs(out), 1e-3);
}

TEST(Gaps, a_checkpoint_of_a_closed_valve_goes_on_bit_for_bit) {
  Valve v(valve(true));
  v.run(1.2);
  const double t = v.c.state().time;
  Fluid<2> other(v.c.mesh(), v.c.geometry(), v.c.fluid().parameters(), true);
  io::StateInMemory memory;
  {
    io::CheckpointWriter writer(memory);
    v.c.fluid().solvers().save(writer);
    writer.close();
  }
  other.restore(v.c.state());
  io::CheckpointReader reader(memory);
  other.solvers().load(reader);
  const auto points = [&](double at) {
    std::vector<Vec3> moved;
    for (const Vec3& x : v.c.geometry().points) moved.push_back(pinched(x, at));
    return moved;
  };
  for (Fluid<2>* fluid : {&v.c.fluid(), &other}) {
    fluid->begin_step(t, dt);
    fluid->solve(points(t + dt), v.c.wall(Valve::lid, t + dt));
    fluid->accept();
  }
  double apart = 0;
  for (std::size_t c = 0; c < other.state().u.size(); ++c)
    apart = std::max(apart, (other.state().u[c] - v.c.state().u[c]).norm());
  EXPECT_LE(parallel::max(MPI_COMM_WORLD, apart), parallel::comm_size(MPI_COMM_WORLD) == 1 ? 0 : 1e-9);
}

/// Of the free cells left of the slot: mean pressure [Pa], volume [m^3].
std::array<double, 2> upstream(const Valve& v) {
  const State<2>& s = v.c.state();
  double sums[2] = {};
  for (Index i = 0; i < v.c.mesh().cells.n_owned(); ++i) {
    if ((s.blocked && (*s.blocked)[i]) || s.placement->centre[i][0] > 3) continue;
    sums[0] += s.placement->volume[i];
    sums[1] += s.placement->volume[i] * s.pressure[0]->p[i];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, v.c.mesh().comm);
  return {sums[1] / sums[0], sums[0]};
}

TEST(Gaps, the_pressure_before_a_closed_valve_rises_with_what_flows_in) {
  for (const double c : {30., 340.}) {
    FluidParameters p = valve(true);
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"0.1", "0"});
    p.compressibility.emplace();
    p.compressibility->speed_of_sound = c;
    Valve v(p);
    v.run(1.08);
    ASSERT_TRUE(v.c.state().blocked);
    const auto [from, volume] = upstream(v);
    const double begin = v.c.state().pressure[0]->time;
    v.run(1.44);
    const auto [to, same] = upstream(v);
    EXPECT_NEAR(same, volume, 1e-12);
    const double rise = (to - from) / (v.c.state().pressure[0]->time - begin),
                 wanted = c * c * 0.1 * height / volume;
    RecordProperty(fmt::format("rise_error_{:g}", c), fmt::format("{}", rise / wanted - 1));
    EXPECT_NEAR(rise / wanted, 1, 0.01);
    v.run(2.6);
    EXPECT_FALSE(v.c.state().blocked) << "it opens again under that pressure";
  }
}

/// The left end lets fluid in, the slot closes: what flows in then has nowhere to go.
TEST(Gaps, that_cut_an_inlet_off_are_refused_with_the_cause) {
  FluidParameters p = valve(true);
  const auto end_of = [](const FluidParameters& shut) -> std::string {
    Valve v(shut);
    return support::error_of<SolveFailure>([&] { v.run(1.4); });
  };
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"0.01", "0"});
  EXPECT_THAT(end_of(p),
              testing::HasSubstr("the closed gap separates 'xmin' from every outlet, but 0.005 m^3/s are"));
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"0.01*max(0,1-t/0.8)", "0"});
  EXPECT_THAT(end_of(p), testing::HasSubstr("A closed gap has separated 1"))
      << "the lid presses what is shut off";
}

TEST(Gaps, wrong_ones_are_refused_by_name) {
  const auto refusal = [](const FluidParameters& p) -> std::string {
    return support::error_of([&] { Valve v(p); });
  };
  FluidParameters p = valve(true);
  p.gaps["slot"].between[1] = "seat";
  EXPECT_THAT(refusal(p), testing::HasSubstr("gaps.slot.between: the mesh has no patch 'seat'"));
  p.gaps["slot"].between[1] = "xmax";
  EXPECT_THAT(refusal(p), testing::HasSubstr("gaps.slot.between: 'xmax' is not a wall"));
}

}  // namespace couplet::fluid::test::gaps_test
