// SPDX-License-Identifier: Apache-2.0
// Groups of any participants, in one process: two bodies in one fluid, in order and side by side, sub-steps
// of each, restart; against their monolithic solution.
#include <Eigen/Dense>
#include <ctime>

#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "coupler/mapping/surface_checks.hpp"
#include "coupler/output/record.hpp"
#include "tests/coupling/support/local_channel.hpp"
#include "tests/coupling/support/passing.hpp"
#include "tests/coupling/toy/spring.hpp"
#include "tests/support/test.hpp"

namespace couplet::groups_test {
using namespace coupling;
using namespace coupler;
namespace fs = std::filesystem;
using Place = Interface::Place;
using Order = CouplingParameters::Exchange::Order;

/// Walls of one face each at x = 0 and x = 10; each pushes back with its added mass and drags the other
/// along, F_i = F_0 sin(t) - m (dw_i/dt + dw_j/dt / 2) - drag w_i, w by the trapezoidal rule.
class Strait final : public Participant {
 public:
  explicit Strait(double mass, int walls = 2, double drag = 0)
      : mass_(mass), drag_(drag), walls_(walls), now_(2 * walls), next_(now_) {}
  Interface initialise() override {
    Interface i{2,
                {},
                {},
                {},
                {{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}},
                {{"pressure-force", "N", Place::faces}}};
    i.face_offset = {0};
    for (int w = 0; w < walls_; ++w) {
      const double x = 10 * w;
      i.vertices.insert(i.vertices.end(), {{x, 0, 0}, {x + 1, 0, 0}});
      i.face_centres.emplace_back(x + 0.5, 0, 0);
      i.face_areas.emplace_back(0, -1, 0);
      i.face_vertices.insert(i.face_vertices.end(), {2 * w, 2 * w + 1});
      i.face_offset.push_back(2 * (w + 1));
    }
    return i;
  }
  void begin_step(const Step& step) override { step_ = step; }
  Exchange solve(const Exchange& in) override {
    next_ = now_;
    if (in.contains("velocity"))
      for (int w = 0; w < walls_; ++w)
        next_[w] = (in.at("velocity")[4 * w + 1] + in.at("velocity")[4 * w + 3]) / 2;
    std::vector<double> force;
    const double t = step_.time + step_.dt / 2;
    for (int w = 0; w < walls_; ++w) {
      double change = next_[w] - now_[w];
      if (walls_ == 2) change += (next_[1 - w] - now_[1 - w]) / 2;
      force.insert(force.end(),
                   {0, std::sin(t) * (1 + w) - mass_ * change / step_.dt - drag_ * (now_[w] + next_[w]) / 2});
    }
    return {{"pressure-force", force}};
  }
  StepReport accept_step() override {
    now_ = next_;
    return {.dt = step_.dt};
  }
  void save(io::CheckpointWriter& file) const override { file.write("velocity", now_); }
  void load(io::CheckpointReader& file) override { file.read("velocity", now_); }
  void write_output(double, int) override {}
  void write_monitors(double) override {}

 private:
  double mass_, drag_;
  int walls_;
  Step step_;
  std::vector<double> now_, next_;  // mean velocity of each wall
};

/// A spring that stands elsewhere.
class Shifted final : public tests::Passing<toy::Spring> {
 public:
  Shifted(double x, double stiffness)
      : Passing(MPI_COMM_SELF, toy::SpringParameters{2, 0.5, stiffness}), x_(x) {}
  Interface initialise() override {
    Interface i = inner.initialise();
    for (auto* places : {&i.vertices, &i.face_centres})
      for (Vec3& p : *places) p.x() += x_;
    return i;
  }

 private:
  double x_;
};

struct GroupRun {
  CouplingParameters coupling;
  app::SimulationParameters simulation;
  double added_mass = 3, drag = 0;
  int bodies = 2;
  fs::path folder = fs::temp_directory_path() / ("couplet-groups-" + std::to_string(::getpid())), restart;
  std::string problem;
  double iterations = 0;
  std::vector<double> position;

  GroupRun() {
    spdlog::set_level(spdlog::level::off);
    coupling.scheme = Scheme::implicit;
    coupling.convergence.relative = 1e-12;
    coupling.convergence.absolute = 1e-14;
    coupling.convergence.max_iterations = 400;
    coupling.mapping.type = MappingParameters::Type::nearest;
    coupling.exchange.emplace();
    simulation.end_time = 1;
    simulation.time_step = 0.05;
  }
  ~GroupRun() { fs::remove_all(folder); }
  GroupRun(const GroupRun&) = delete;
  void operator()() {
    fs::create_directories(folder);
    Strait fluid(added_mass, bodies, drag);
    Shifted left(0, 2), right(10, 5);
    std::vector<std::unique_ptr<Channel>> channels;
    channels.push_back(std::make_unique<LocalChannel>("right", right));
    channels.push_back(std::make_unique<LocalChannel>("fluid", fluid));
    channels.push_back(std::make_unique<LocalChannel>("left", left));
    coupling.exchange->participants = {"fluid", "left"};
    if (bodies == 2) coupling.exchange->participants.push_back("right");
    Coupler coupler(MPI_COMM_SELF, coupling, simulation, std::move(channels),
                    {folder, folder / "checkpoints", restart});
    problem = coupler.run();
    iterations = double(coupler.iterations()) / double(std::max<GlobalIndex>(1, coupler.steps()));
    position = {coupler.given_by("left").at("displacement")[1]};
    if (bodies == 2) position.push_back(coupler.given_by("right").at("displacement")[1]);
  }
};

/// (M + A) dv/dt + K y = F sin(t_mid), both walls at once, by the trapezoidal rule; masses 1, springs 4
/// and 10.
std::vector<double> monolithic(double added, double dt, double end) {
  Eigen::Matrix2d mass, k = Eigen::Vector2d(4, 10).asDiagonal();
  mass << 1 + added, added / 2, added / 2, 1 + added;
  Eigen::Vector2d y(0, 0), v(0, 0);
  for (int n = 0; n < std::lround(end / dt); ++n) {
    const Eigen::Vector2d f = std::sin((n + 0.5) * dt) * Eigen::Vector2d(1, 2);
    const Eigen::Vector2d right = mass / dt * v - k * (y + dt / 4 * v) + f;
    const Eigen::Vector2d v_new = (mass / dt + k * dt / 4).inverse() * right;
    y += dt / 2 * (v + v_new);
    v = v_new;
  }
  return {y[0], y[1]};
}

TEST(Groups, two_bodies_in_one_fluid_give_the_monolithic_solution_in_order_and_side_by_side) {
  const std::vector<double> exact = monolithic(3, 0.05, 1);
  for (const Order order : {Order::serial, Order::parallel})
    for (const auto type : {AccelerationParameters::Type::aitken, AccelerationParameters::Type::iqn_ils}) {
      // Side by side one factor for all is not enough.
      if (order == Order::parallel && type == AccelerationParameters::Type::aitken) continue;
      GroupRun run;
      run.coupling.exchange->order = order;
      run.coupling.acceleration.type = type;
      run();
      ASSERT_EQ(run.problem, "");
      for (int i = 0; i < 2; ++i) EXPECT_NEAR(run.position[i], exact[i], 1e-9);
      RecordProperty(
          fmt::format("iterations_{}_{}", order == Order::serial ? "serial" : "parallel", int(type)),
          fmt::format("{:.2f}", run.iterations));
    }
}

/// A run of two halves ends where a whole one does.
void expect_a_restart_to_continue(const auto& setup) {
  GroupRun whole, first, second;
  for (GroupRun* run : {&whole, &first, &second}) setup(*run);
  whole();
  first.folder += "-first";
  first.simulation.end_time = 0.5;
  first();
  second.folder += "-second";
  second.restart = app::find_checkpoint(first.folder / "checkpoints");
  second();
  EXPECT_EQ(second.problem, "");
  EXPECT_EQ(second.position, whole.position);
}

TEST(Groups, restart_continues_bit_for_bit_with_the_accelerators_history) {
  for (const Order order : {Order::serial, Order::parallel}) {
    const auto setup = [&](GroupRun& run) {
      run.coupling.exchange->order = order;
      run.coupling.acceleration.type = AccelerationParameters::Type::iqn_ils;
      run.coupling.convergence.relative = 1e-8;
    };
    expect_a_restart_to_continue(setup);
  }
}

/// Order of the position at t = 1 from three steps of the coupling, by successive differences.
double slope(int fluid_steps, int solid_steps) {
  std::vector<double> y;
  for (const double dt : {0.05, 0.025, 0.0125}) {
    GroupRun run;
    run.bodies = 1;
    run.added_mass = 1;
    run.drag = 1;  // what is felt of the way within a step; the added mass knows only its end
    run.simulation.time_step = dt;
    run.coupling.sub_steps = {{"fluid", double(fluid_steps)}, {"left", double(solid_steps)}};
    run();
    EXPECT_EQ(run.problem, "");
    y.push_back(run.position[0]);
  }
  return std::log2(std::abs(y[0] - y[1]) / std::abs(y[1] - y[2]));
}

TEST(SubSteps, keep_the_second_order) {
  const double linear = slope(7, 4);
  EXPECT_GT(linear, 1.8);
  EXPECT_NEAR(slope(1, 1), 2, 0.1);
  RecordProperty("slope_linear", fmt::format("{:.3f}", linear));
}

TEST(SubSteps, a_restart_between_coupling_steps_is_bit_for_bit) {
  const auto setup = [](GroupRun& run) {
    run.bodies = 1;
    run.added_mass = 1;
    run.coupling.sub_steps = {{"fluid", 3.}, {"left", 2.}};
  };
  expect_a_restart_to_continue(setup);
}

// Set-up of a large interface is linear in its size. Times are recorded, not judged.

const std::vector<Interface::Datum> motion{{"displacement", "m", Place::vertices},
                                           {"velocity", "m/s", Place::vertices}};
const std::vector<Interface::Datum> load{{"pressure-force", "N", Place::faces}};

/// A wavy sheet of n x n quadrilaterals.
Interface sheet(int n, bool fluid) {
  Interface i{3, {}, {}, {}, fluid ? motion : load, fluid ? load : motion};
  const auto at = [n](double a, double b) { return Vec3(a / n, b / n, 0.1 * std::sin(6 * a / n)); };
  for (int a = 0; a <= n; ++a)
    for (int b = 0; b <= n; ++b) i.vertices.push_back(at(a, b));
  i.face_offset = {0};
  for (Index a = 0; a < n; ++a)
    for (Index b = 0; b < n; ++b) {
      i.face_centres.push_back((at(a, b) + at(a + 1, b) + at(a, b + 1) + at(a + 1, b + 1)) / 4);
      i.face_areas.emplace_back(0, 0, 1. / n / n);
      const Index v = a * (n + 1) + b;
      i.face_vertices.insert(i.face_vertices.end(), {v, v + 1, v + n + 2, v + n + 1});
      i.face_offset.push_back(Index(i.face_vertices.size()));
    }
  return i;
}

double setup_seconds(int n, double* exchange = nullptr) {
  const std::vector<Side> sides{{MPI_COMM_SELF, "fluid", sheet(n, true)},
                                {MPI_COMM_SELF, "solid", sheet(n, false)}};
  MappingParameters nearest_map;
  nearest_map.type = MappingParameters::Type::nearest;
  const std::clock_t start = std::clock();
  const Links links(MPI_COMM_SELF, sides, nearest_map);
  check_places(MPI_COMM_SELF, sides, links, nearest_map);
  Mechanics mechanics(MPI_COMM_SELF, sides, links, {"fluid", "solid"});
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  const std::size_t values = 3 * sides[1].interface.vertices.size();
  const std::vector<Exchange> given{
      {}, {{"displacement", std::vector<double>(values, 1.)}, {"velocity", std::vector<double>(values, 1.)}}};
  const std::clock_t exchange_start = std::clock();
  EXPECT_EQ(links.input(0, given).at("velocity"), std::vector<double>(values, 1.));
  if (exchange) *exchange = double(std::clock() - exchange_start) / CLOCKS_PER_SEC / 2;
  return seconds;
}

TEST(Scale, set_up_of_a_large_interface_grows_with_its_size_alone) {
  double exchange = 0;
  const double small = setup_seconds(100), large = setup_seconds(316, &exchange);
  // Ten times the vertices: a quadratic set-up would take a hundred times as long.
  EXPECT_LT(large, 40 * small + 0.1);
  RecordProperty("setup_seconds_1e5", fmt::format("{:.3f}", large));
  RecordProperty("map_milliseconds_1e5", fmt::format("{:.3f}", 1e3 * exchange));
}

}  // namespace couplet::groups_test
