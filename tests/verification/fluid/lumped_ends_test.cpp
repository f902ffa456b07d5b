// SPDX-License-Identifier: Apache-2.0
// Circuits behind outlets, and flow rates at inlets, in a channel with slip walls: its fluid moves as one mass, so that channel and
// circuits obey ordinary differential equations.
#include <Eigen/Eigenvalues>
#include <complex>

#include "fluid_case.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid::test::lumped_ends_test {
using namespace mesh;

constexpr double pi = std::numbers::pi, rho = 1000, length = 1, height = 0.1;
constexpr double inertance = rho * length / height;  // [Pa s^2/m^3]
constexpr double omega = 2 * pi;                     // [1/s]

/// An opening with fluid of this pressure behind it, which it neither loses nor gains as it enters.
BoundaryParameters opening(const std::string& pressure) {
  BoundaryParameters b = boundary(BoundaryType::outlet, {}, pressure);
  b.backflow_stabilisation = false;
  return b;
}

BoundaryParameters with_resistance(double resistance) {
  BoundaryParameters b = opening("0");
  b.circuit.resistance = resistance;
  return b;
}

constexpr WindkesselParameters artery{
    .proximal = 1e5, .distal = 1e6, .compliance = 5e-7, .initial_pressure = 2e3};

BoundaryParameters with_windkessel(const WindkesselParameters& w = artery) {
  BoundaryParameters b = opening("0");
  b.circuit.windkessel = w;
  return b;
}

BoundaryParameters inflow(const std::string& flow) {
  BoundaryParameters b;
  b.type = BoundaryType::inlet;
  b.flow_rate = config::ExpressionText{flow};
  return b;
}

FluidParameters tube(BoundaryParameters left, BoundaryParameters right) {
  FluidParameters p = fluid_of(rho, 0, 1e-12);
  p.boundaries["xmin"] = std::move(left);
  p.boundaries["xmax"] = std::move(right);
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::slip);
  return p;
}

RawMesh cells(int nx = 8, int ny = 2) {
  return make_box(BoxCells::quadrilaterals, {nx, ny, 1}, Vec3::Zero(), Vec3(length, height, 1));
}

/// Makes these cells with the right side divided into `n` patches out0, out1, ... from below.
RawMesh cells_with_outlets(int n) {
  RawMesh raw = cells(8, n);
  const int right = int(std::ranges::find(raw.patches, "xmax") - raw.patches.begin());
  const int first = int(raw.patches.size());
  for (int i = 0; i < n; ++i) raw.patches.push_back(fmt::format("out{}", i));
  for (Index e = 0; e < Index(raw.boundary_patch.size()); ++e) {
    if (raw.boundary_patch[e] != right) continue;
    double y = 0;
    for (const Index v : raw.boundary_points[e]) y += 0.5 * raw.points[v].y();
    raw.boundary_patch[e] = first + int(y / height * n);
  }
  raw.patches.erase(raw.patches.begin() + right);
  for (int& patch : raw.boundary_patch)
    if (patch > right) --patch;
  return raw;
}

/// Flow out of a patch [m^2/s].
double flow_through(const FluidCase<2>& c, const std::string& patch) {
  double flow = 0;
  const Patch& faces = *c.mesh().find_patch(patch);
  for (Index f = faces.first; f < faces.first + faces.count; ++f) flow += c.state().phi[f];
  return parallel::sum(c.mesh().comm, flow);
}

/// Mean pressure of a patch at the middle of the last step [Pa].
double pressure_at(const FluidCase<2>& c, const std::string& patch) {
  double sums[2] = {};
  const Patch& faces = *c.mesh().find_patch(patch);
  for (Index f = faces.first; f < faces.first + faces.count; ++f) {
    const double area = c.state().placement->area[f].norm();
    sums[0] += area * c.state().pressure[0]->boundary[f - c.mesh().n_interior];
    sums[1] += area;
  }
  return parallel::sum(c.mesh().comm, sums[0]) / parallel::sum(c.mesh().comm, sums[1]);
}

/// Pressure of a Windkessel for the flow a (1 - cos(omega t)) into it.
double pressure_for_given_flow(const WindkesselParameters& w, double a, double t) {
  const double tau = w.distal * w.compliance, x = omega * tau;
  const auto periodic = [&](double s) {
    return a * w.distal * (1 - (std::cos(omega * s) + x * std::sin(omega * s)) / (1 + x * x));
  };
  const double stored = periodic(t) + (w.initial_pressure - periodic(0)) * std::exp(-t / tau);
  return w.proximal * a * (1 - std::cos(omega * t)) + stored;
}

/// Flow in a channel at rest before t = 0 from a pressure a (1 - cos(omega t)) to a Windkessel:
///   p_in - R_p q - p_d = L dq/dt,   C dp_d/dt = q - p_d/R_d
double flow_for_given_pressure(const WindkesselParameters& w, double a, double t) {
  using Matrix = Eigen::Matrix2cd;
  using Vector = Eigen::Vector2cd;
  const std::complex<double> i(0, 1);
  Matrix m;
  m << -w.proximal / inertance, -1 / inertance, 1 / w.compliance, -1 / (w.distal * w.compliance);
  const Vector force(a / inertance, 0);
  const Vector mean = -m.inverse() * force, swing = -(i * omega * Matrix::Identity() - m).inverse() * force;
  const auto periodic = [&](double s) -> Vector { return mean + (swing * std::exp(i * omega * s)).real(); };
  const Eigen::ComplexEigenSolver<Matrix> modes(m);
  const Vector start = modes.eigenvectors().inverse() * (Vector(0, w.initial_pressure) - periodic(0));
  Vector decay;
  for (int k = 0; k < 2; ++k) decay[k] = std::exp(modes.eigenvalues()[k] * t) * start[k];
  return (periodic(t) + modes.eigenvectors() * decay)[0].real();
}

/// Velocities in a viscous channel after three pulses, with times at rest between them.
Vectors<2> after_pulses(BoundaryParameters outlet) {
  FluidParameters p = fluid_of(rho, 1, 1e-6);
  p.boundaries["xmin"] = inflow("0.001*max(0, sin(2*pi*t))");
  p.boundaries["xmax"] = std::move(outlet);
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  FluidCase<2> c(MPI_COMM_WORLD, cells(20, 10), p);
  for (int k = 0; k < 100; ++k) c.step(0.03);
  return c.state().u;
}

/// Largest difference between these velocities over the largest velocity.
double apart(const Vectors<2>& a, const Vectors<2>& b) {
  double most = 0, difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, a[i].norm());
    difference = std::max(difference, (b[i] - a[i]).norm());
  }
  return difference / most;
}

TEST(OutletPressure, does_not_change_the_flow_by_its_level) {
  EXPECT_LT(apart(after_pulses(opening("0")), after_pulses(opening("5e6"))), 1e-4);
}

// Where the flow is given, a resistance changes only the level of the pressure.
TEST(OutletResistance, does_not_change_a_given_flow) {
  const Vectors<2> without = after_pulses(opening("0"));
  for (const double resistance : {1e6, 1e10, 1e12})
    EXPECT_LT(apart(without, after_pulses(with_resistance(resistance))), 1e-3) << resistance;
}

/// The error is relative to the amplitude.
TEST(LumpedEnds, a_windkessel_behind_a_pulsing_channel_has_the_pressure_of_its_circuit) {
  const double a = 1e-3;
  FluidCase<2> c(MPI_COMM_WORLD, cells(), tube(inflow("1e-3*(1 - cos(2*pi*t))"), with_windkessel()));
  double worst = 0, low = 1e300, high = 0;
  const int steps = 200;
  for (int k = 0; k < 3 * steps; ++k) {
    c.step(1. / steps);
    const double exact = pressure_for_given_flow(artery, a, (k + 0.5) / steps);
    worst = std::max(worst, std::abs(pressure_at(c, "xmax") - exact));
    if (k >= 2 * steps) low = std::min(low, exact), high = std::max(high, exact);
  }
  const double error = worst / (0.5 * (high - low));
  RecordProperty("windkessel_error", fmt::format("{}", error));
  EXPECT_LT(error, 1e-3);
}

/// Flow and pressure are both unknown.
TEST(LumpedEnds, a_windkessel_and_the_mass_of_the_channel_swing_together_in_second_order) {
  const double a = 1e4, end = 0.9;
  std::vector<double> errors;
  for (const int steps : {40, 80, 160, 320}) {
    FluidCase<2> c(MPI_COMM_WORLD, cells(), tube(opening("1e4*(1 - cos(2*pi*t))"), with_windkessel()));
    c.run(end, steps);
    errors.push_back(std::abs(flow_through(c, "xmax") - flow_for_given_pressure(artery, a, end)));
  }
  double least = 1e300;
  for (std::size_t k = 1; k < errors.size(); ++k) {
    const double order = std::log2(errors[k - 1] / errors[k]);
    least = std::min(least, order);
    RecordProperty(fmt::format("order_{}", k), fmt::format("{}", order));
  }
  RecordProperty("flow_error", fmt::format("{}", errors.back()));
  EXPECT_GT(least, 1.9);
}

TEST(LumpedEnds, ten_equal_windkessels_are_one_of_their_parallel_circuit) {
  const double a = 1e4;
  WindkesselParameters part = artery;
  part.proximal *= 10, part.distal *= 10, part.compliance /= 10;
  FluidParameters p = tube(opening("1e4*(1 - cos(2*pi*t))"), {});
  p.boundaries.erase("xmax");
  for (int i = 0; i < 10; ++i) p.boundaries[fmt::format("out{}", i)] = with_windkessel(part);
  FluidCase<2> c(MPI_COMM_WORLD, cells_with_outlets(10), p);
  double worst = 0, largest = 0;
  const int steps = 400;
  for (int k = 1; k <= 2 * steps; ++k) {
    c.step(1. / steps);
    const double exact = flow_for_given_pressure(artery, a, double(k) / steps);
    largest = std::max(largest, std::abs(exact));
    for (int i = 0; i < 10; ++i)
      worst = std::max(worst, std::abs(10 * flow_through(c, fmt::format("out{}", i)) - exact));
  }
  RecordProperty("ten_error", fmt::format("{}", worst / largest));
  EXPECT_LT(worst / largest, 1e-3);
}

/// Ten different ones in a steady flow: the flows divide as the resistances ask for.
TEST(LumpedEnds, ten_different_ends_share_a_steady_flow_by_their_resistances) {
  FluidParameters p = tube(inflow("1e-3"), {});
  p.boundaries.erase("xmax");
  double admittance = 0;
  for (int i = 0; i < 10; ++i) {
    const double resistance = 1e8 * (1 + i);
    admittance += 1 / resistance;
    p.boundaries[fmt::format("out{}", i)] =
        i % 2 ? with_resistance(resistance)
              : with_windkessel(
                    {.proximal = 0.1 * resistance, .distal = 0.9 * resistance, .compliance = 1e-10});
  }
  FluidCase<2> c(MPI_COMM_WORLD, cells_with_outlets(10), p);
  c.run(3, 300);
  double worst = 0, total = 0;
  for (int i = 0; i < 10; ++i) {
    const double flow = flow_through(c, fmt::format("out{}", i));
    total += flow;
    worst = std::max(worst, std::abs(flow * admittance * 1e8 * (1 + i) / 1e-3 - 1));
  }
  RecordProperty("share_error", fmt::format("{}", worst));
  EXPECT_LT(worst, 1e-3);
  EXPECT_NEAR(total, 1e-3, 1e-12);
}

/// A channel in which the fluid moves at first, or that a pressure of 1 kPa drives: both come to rest.
TEST(LumpedEnds, any_resistance_is_stable_at_any_step_and_an_infinite_one_stops_the_flow) {
  for (const double resistance : {0., 1e6, 1e12, 1e18, 1e300})
    for (const double dt : {1e-6, 1e-3, 1., 1e3})
      for (const bool moves : {false, true}) {
        if (resistance == 0 && dt > 1e-3) continue;  // convection would take millions of sub-steps
        FluidParameters p = tube(opening(moves ? "0" : "1e3"), with_resistance(resistance));
        if (moves) p.initial_velocity = {{"0.01"}, {"0"}};
        FluidCase<2> c(MPI_COMM_WORLD, cells(), p);
        const std::string where = fmt::format("R = {:g}, dt = {:g}, moves: {}", resistance, dt, moves);
        // The channel has L dq/dt + R q = p_in.
        const double tau = inertance / std::max(resistance, 1e-300), start = moves ? 0.01 * height : 0,
                     final = moves ? 0 : 1e3 / std::max(resistance, 1e-300);
        const int steps = 20;
        for (int k = 0; k < steps; ++k) c.step(dt);
        const double flow = flow_through(c, "xmax");
        if (resistance == 0) {
          EXPECT_NEAR(flow, start + (moves ? 0 : 1e3 * steps * dt / inertance), 1e-9 * std::max(1., flow))
              << where;
          continue;
        }
        const double largest = std::max(std::abs(start), std::abs(final));
        const double rounding =
            1e-14 + 1e-11 * 1e3 * dt / inertance;  // 1e-11 of what the pressure would drive
        EXPECT_LE(std::abs(flow), (1 + 1e-6) * largest + rounding) << where;
        if (dt > 30 * tau) {
          EXPECT_NEAR(flow, final, 1e-4 * largest + rounding) << where;
        }
        if (resistance >= 1e12) {
          EXPECT_LT(std::abs(flow), 1e-5 * std::max(start, 1e-3)) << where;
        }
        if (resistance >= 1e12 && !moves) {
          EXPECT_NEAR(pressure_at(c, "xmax"), 1e3, 0.1) << where;
        }
      }
}

/// Beyond 1e9 Pa s/m^2, the rounding of the pressure in the flux through a face is seen: 1e-16 of p dt g/rho.
TEST(LumpedEnds, a_given_flow_through_a_large_resistance_has_its_pressure) {
  for (const double resistance : {1e3, 1e9, 1e15}) {
    FluidCase<2> c(MPI_COMM_WORLD, cells(), tube(inflow("1e-3"), with_resistance(resistance)));
    c.run(1, 10);
    EXPECT_NEAR(pressure_at(c, "xmax") / (1e-3 * resistance), 1, 1e-8 + 1e-20 * resistance) << resistance;
    EXPECT_NEAR(flow_through(c, "xmax"), 1e-3, 1e-13 + 1e-22 * resistance) << resistance;
  }
}

config::ExpressionText quadratic(double factor, double most, int points) {
  std::string text = "table(q, clamp";
  for (int i = -points; i <= points; ++i) {
    const double q = most * i / points;
    text += fmt::format(", {}, {}", q, factor * q * std::abs(q));
  }
  return {text + ")"};
}

/// L dq/dt + k q^2 = p. From rest q = (p/k)^(1/2) tanh(t (p k)^(1/2)/L), and without p it decays as q_0/(1 + k q_0 t/L).
TEST(LumpedEnds, a_table_of_a_quadratic_loss_has_the_flow_of_its_equation_in_second_order) {
  const double p_in = 1e3, k = 1e9, end = 0.01, start = 1e-3;
  const auto flow = [&](bool driven, int steps) {
    BoundaryParameters b = opening("0");
    b.circuit.pressure_drop = quadratic(k, 2e-3, 2000);
    FluidParameters p = tube(opening(driven ? "1e3" : "0"), b);
    if (!driven) p.initial_velocity = {{fmt::format("{}", start / height)}, {"0"}};
    FluidCase<2> c(MPI_COMM_WORLD, cells(), p);
    c.run(end, steps);
    return flow_through(c, "xmax");
  };
  const double exact = std::sqrt(p_in / k) * std::tanh(end * std::sqrt(p_in * k) / inertance);
  const double error = std::abs(flow(true, 80) / exact - 1);
  std::vector<double> errors;
  for (const int steps : {20, 40, 80})
    errors.push_back(std::abs(flow(false, steps) / (start / (1 + k * start * end / inertance)) - 1));
  const double order = std::log2(errors[1] / errors[2]);
  RecordProperty("quadratic_error", fmt::format("{}", error));
  RecordProperty("quadratic_order", fmt::format("{}", order));
  EXPECT_LT(error, 1e-3);
  EXPECT_GT(order, 1.9);
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.9);
}

/// Pieces of very different slopes, at steps of any size: Newton's method alone would go round and round.
TEST(LumpedEnds, tables_with_steep_pieces_find_their_flow_at_any_step) {
  for (const double dt : {1e-4, 1e-1, 1e2})
    for (const double p_in : {-1050., -200., 10., 999., 1001., 1050.}) {
      FluidParameters p = tube(opening(fmt::format("{}", p_in)), {});
      p.boundaries.erase("xmax");
      p.boundaries["xmin"].backflow_stabilisation =
          true;  // else shear that enters may grow, whatever the ends do
      for (int i = 0; i < 2; ++i) {
        BoundaryParameters b = opening("0");
        b.circuit.pressure_drop =
            config::ExpressionText{"table(q, clamp, -1e-3, -1100, -1e-6, -1000, 1e-6, 1000, 1e-3, 1100)"};
        p.boundaries[fmt::format("out{}", i)] = b;
      }
      FluidCase<2> c(MPI_COMM_WORLD, cells_with_outlets(2), p);
      for (int k = 0; k < 20; ++k) c.step(dt);
      const double q = flow_through(c, "out0");
      EXPECT_NEAR(q, flow_through(c, "out1"), 1e-9 * std::max(1., std::abs(q))) << p_in;
      if (std::abs(p_in) < 1000 || dt > 1) {
        const double steep = std::clamp(p_in * 1e-9, -1e-6, 1e-6),
                     exact = steep + (p_in - 1e9 * steep) * 1e-5;
        EXPECT_NEAR(q, exact, 0.02 * std::abs(exact)) << p_in << " " << dt;
      }
    }
}

TEST(FlowRate, of_an_inlet_is_conserved_also_where_its_patch_grows) {
  for (const InletProfile profile : {InletProfile::uniform, InletProfile::parabolic})
    for (const bool grows : {false, true}) {
      FluidParameters p = tube(inflow("0.02*(1 + 0.5*sin(5*t))"), opening("0"));
      p.boundaries["xmin"].profile = profile;
      p.viscosity = 1;
      const auto stretch = [](const Vec3& x, GlobalIndex, double t) {
        return Vec3(x.x(), x.y() * (1 + 0.5 * t), x.z());
      };
      FluidCase<2> c(MPI_COMM_WORLD, cells(8, 6), p, grows ? PointMotion(stretch) : PointMotion());
      for (int k = 1; k <= 10; ++k) {
        c.step(0.02);
        const double wanted = 0.02 * (1 + 0.5 * std::sin(5 * 0.02 * k));
        EXPECT_NEAR(flow_through(c, "xmin"), -wanted, 1e-15);
        // The walls give way to a part of the flow.
        const double given_way = grows ? 0.5 * height * length : 0;
        EXPECT_NEAR(flow_through(c, "xmax"), wanted - given_way, 1e-12);
      }
    }
}

/// L dq/dt + R q = p from rest: q = p/R (1 - exp(-R t/L)), on a mesh whose pressure has no direct solver.
TEST(LumpedEnds, a_resistance_in_three_dimensions_has_the_flow_of_its_equation) {
  const double resistance = 1e6, inertance_3d = rho * length / (height * height), end = 0.2;
  FluidParameters p = tube(opening("1e3"), with_resistance(resistance));
  for (const char* side : {"zmin", "zmax"}) p.boundaries[side] = boundary(BoundaryType::slip);
  const RawMesh raw = make_box(BoxCells::hexahedra, {8, 4, 4}, Vec3::Zero(), Vec3(length, height, height));
  FluidCase<3> c(MPI_COMM_WORLD, raw, p);
  c.run(end, 200);
  const double exact = 1e3 / resistance * (1 - std::exp(-resistance * end / inertance_3d));
  RecordProperty("flow_error_3d", fmt::format("{}", c.state().circuits.flow[0] / exact - 1));
  EXPECT_NEAR(c.state().circuits.flow[0] / exact, 1, 1e-3);
}

TEST(LumpedEnds, sub_steps_are_steps) {
  FluidParameters whole = tube(opening("1e4*(1 - cos(2*pi*t))"), with_windkessel()), parts = whole;
  parts.time_step = 0.005;
  whole.time_step = 0.005;
  FluidCase<2> a(MPI_COMM_WORLD, cells(), whole), b(MPI_COMM_WORLD, cells(), parts);
  a.run(0.2, 40);
  b.run(0.2, 10);
  EXPECT_EQ(b.fluid().statistics().sub_steps, 4);
  EXPECT_NEAR(flow_through(a, "xmax") / flow_through(b, "xmax"), 1, 1e-10);
  EXPECT_NEAR(a.state().circuits.stored[0] / b.state().circuits.stored[0], 1, 1e-10);
}

/// One end of each kind, beside a volume in a compressible fluid or on a mesh that moves.
FluidParameters all_kinds() {
  FluidParameters p = tube(inflow("1e-3*sin(9*t)"), {});
  p.viscosity = 1;
  p.boundaries.erase("xmax");
  p.boundaries["out0"] = with_resistance(1e6);
  p.boundaries["out1"] = with_windkessel();
  p.boundaries["out2"] = opening("0");
  p.boundaries["out2"].circuit.pressure_drop = quadratic(1e10, 1e-3, 20);
  return p;
}

Vec3 wobble(const Vec3& x, GlobalIndex, double t) {
  return {x.x(), x.y() * (1 + 0.1 * std::sin(7 * t) * x.x()), x.z()};
}

struct Scene {
  std::string name;
  FluidParameters parameters;
  PointMotion motion;
};
std::vector<Scene> scenes() {
  FluidParameters open = all_kinds(), waves = all_kinds();
  open.boundaries["xmin"] = opening("100*sin(9*t)");
  waves.compressibility.emplace();
  waves.compressibility->speed_of_sound = 100;
  waves.compressibility->upstream_volume = 0.1;
  return {{"given flow", all_kinds(), {}},
          {"given pressure", open, {}},
          {"volume", waves, {}},
          {"moving mesh", all_kinds(), wobble}};
}

/// Pressures, velocities and circuits in a row.
std::vector<double> numbers(const State<2>& s) {
  std::vector<double> all(s.pressure[0]->p);
  all.insert(all.end(), s.phi.begin(), s.phi.end());
  for (const auto& u : s.u) all.insert(all.end(), u.data(), u.data() + 2);
  for (const auto* values :
       {&s.pressure[0]->ends, &s.circuits.flow, &s.circuits.stored, &s.circuits.flow_old})
    all.insert(all.end(), values->begin(), values->end());
  return all;
}

TEST(LumpedEnds, go_on_bit_for_bit_from_a_checkpoint) {
  for (const auto& [name, parameters, motion] : scenes()) {
    FluidCase<2> d(MPI_COMM_WORLD, cells_with_outlets(3), parameters, motion);
    d.run(0.1, 10);
    io::StateInMemory memory;
    {
      io::CheckpointWriter writer(memory);
      write_state(writer, d.state());
      d.fluid().solvers().save(writer);
      writer.close();
    }
    Fluid<2> other(d.mesh(), d.geometry(), d.fluid().parameters(), bool(motion));
    io::CheckpointReader reader(memory);
    other.restore(read_state<2>(reader, d.mesh(), motion ? nullptr : other.state().placement));
    other.solvers().load(reader);
    for (int i = 0; i < 4; ++i)
      for (Fluid<2>* fluid : {&d.fluid(), &other}) {
        fluid->begin_step(fluid->state().time, 0.01);
        fluid->solve(d.points(fluid->state().time + 0.01), {});
        fluid->accept();
      }
    EXPECT_EQ(numbers(d.state()), numbers(other.state())) << name;
  }
}

TEST(LumpedEnds, are_the_same_on_any_number_of_ranks) {
  for (const auto& [name, parameters, motion] : scenes()) {
    FluidCase<2> all(MPI_COMM_WORLD, cells_with_outlets(3), parameters, motion),
        alone(MPI_COMM_SELF, cells_with_outlets(3), parameters, motion);
    all.run(0.2, 20);
    alone.run(0.2, 20);
    for (std::size_t i = 0; i < alone.state().circuits.flow.size(); ++i) {
      EXPECT_NEAR(all.state().circuits.flow[i], alone.state().circuits.flow[i], 1e-12) << name << i;
      EXPECT_NEAR(all.state().pressure[0]->ends[i], alone.state().pressure[0]->ends[i], 1e-5) << name << i;
      EXPECT_NEAR(all.state().circuits.stored[i], alone.state().circuits.stored[i], 1e-6) << name << i;
    }
  }
}

}  // namespace couplet::fluid::test::lumped_ends_test
