// SPDX-License-Identifier: Apache-2.0
// A body of large strain that a partner loads: which scheme integrates it, its order in time with loads that are means over a step, restart.
#include "tests/verification/solid/partner_load.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::partner_load_test {
using namespace coupling;
using time::TimeScheme;
using namespace mesh;

/// Of the end [Pa].
double pull(double t) { return 300 * std::sin(4 * t) * std::sin(4 * t); }
/// Over a step, by Simpson's rule.
double mean_pull(double t, double dt) { return (pull(t) + 4 * pull(t + dt / 2) + pull(t + dt)) / 6; }

void push(Solid& solid, const Interface& interface, double dt) {
  step_under(solid, interface, dt, mean_pull(solid.stepper().state().time, dt));
}

constexpr double end_time = 0.8;

/// Cells at the end time, by n steps; uneven: every second one twice as long.
std::vector<double> moved_by(TimeScheme scheme, int n, bool uneven) {
  const auto solid = sheet(scheme);
  const Interface interface = solid->initialise();
  for (int i = 0; i < n; ++i)
    push(*solid, interface, uneven ? end_time / (1.5 * n) * (1 + i % 2) : end_time / n);
  return solid->stepper().state().cell_u;
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference = std::max(difference, std::abs(a[i] - b[i])), size = std::max(size, std::abs(a[i]));
  return parallel::max(MPI_COMM_WORLD, difference) / parallel::max(MPI_COMM_WORLD, size);
}

TEST(PartnerLoad, is_taken_by_a_scheme_that_damps_the_highest_modes_unless_energy_must_be_kept) {
  SolidParameters p = pushed(TimeScheme::automatic);
  EXPECT_EQ(scheme_of(p).type, TimeScheme::generalised_alpha);
  p.energy_momentum = true;
  EXPECT_EQ(scheme_of(p).type, TimeScheme::trapezoidal);
  p.energy_momentum = false;
  p.kinematics = SolidParameters::Kinematics::small_strain;
  EXPECT_EQ(scheme_of(p).type, TimeScheme::generalised_alpha);
  p.boundaries["xmax"] = boundary(Type::free);
  EXPECT_EQ(scheme_of(p).type, TimeScheme::trapezoidal);
  p.time_scheme.type = TimeScheme::bathe;
  EXPECT_EQ(scheme_of(p).type, TimeScheme::bathe);
}

TEST(PartnerLoad, is_taken_to_second_order_in_time) {
  const std::vector<double> exact = moved_by(TimeScheme::trapezoidal, 1280, false);
  for (const TimeScheme scheme :
       {TimeScheme::automatic, TimeScheme::trapezoidal, TimeScheme::bathe, TimeScheme::three_point})
    for (const bool uneven : {false, true}) {
      const double coarse = apart(exact, moved_by(scheme, 80, uneven)),
                   fine = apart(exact, moved_by(scheme, 320, uneven)), slope = 0.5 * std::log2(coarse / fine);
      fmt::print("{}{}: {:.2e} {:.2e}, slope {:.2f}\n", time::name(scheme), uneven ? ", uneven" : "", coarse,
                 fine, slope);
      EXPECT_GT(slope, 1.85);
      EXPECT_LT(fine, 2e-3);
    }
}

TEST(PartnerLoad, goes_on_bit_for_bit_from_a_checkpoint) {
  const auto run = sheet(TimeScheme::automatic), restarted = sheet(TimeScheme::automatic);
  const Interface interface = run->initialise();
  restarted->initialise();
  for (const double dt : {0.02, 0.01, 0.02}) push(*run, interface, dt);
  support::SavedState(*run).load_into(*restarted);
  for (const double dt : {0.01, 0.02}) push(*run, interface, dt), push(*restarted, interface, dt);
  EXPECT_EQ(run->stepper().state().cell_u, restarted->stepper().state().cell_u);
  EXPECT_EQ(run->fields().point_velocity(), restarted->fields().point_velocity());
}

// Bars that are held and moved at one end: on several ranks only one of them owns what is known.

struct Way {
  const char* name;
  bool is_dynamic, is_large;
  FaceGradient gradient;
  time::TimeScheme scheme = time::TimeScheme::trapezoidal;
  MethodParameters::Type method = MethodParameters::Type::automatic;
};

constexpr std::array ways{
    Way{"static_linear", false, false, FaceGradient::symmetric},
    Way{"static_thesis", false, false, FaceGradient::thesis},
    Way{"static_large", false, true, FaceGradient::symmetric},
    Way{"static_large_segregated", false, true, FaceGradient::thesis, time::TimeScheme::trapezoidal,
        MethodParameters::Type::segregated},
    Way{"dynamic_linear", true, false, FaceGradient::symmetric},
    Way{"dynamic_thesis", true, false, FaceGradient::thesis},
    Way{"dynamic_bathe", true, false, FaceGradient::symmetric, time::TimeScheme::bathe},
    Way{"dynamic_large", true, true, FaceGradient::symmetric},
};

std::ostream& operator<<(std::ostream& out, const Way& way) { return out << way.name; }

class MovedEnd : public ::testing::TestWithParam<Way> {};

SolidParameters moved_bar(const Way& way) {
  SolidParameters p = box_parameters(2);
  p.material = {1000, 1e6, 0.3};
  p.method.face_gradient = way.gradient;
  p.method.type = way.method;
  p.method.relative_tolerance = way.method == MethodParameters::Type::segregated ? 1e-6 : 1e-10;
  if (way.is_large) {
    p.kinematics = SolidParameters::Kinematics::finite_strain;
    p.material.law = "saint-venant-kirchhoff";
  }
  if (way.is_dynamic) {
    p.analysis = SolidParameters::Analysis::dynamic;
    p.time_scheme.type = way.scheme;
  }
  p.output.energies = true;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0.02*t^2", "0.1*t^3"});
  p.boundaries["ymin"] = boundary(Type::traction, {"0", "20*t"});
  return p;
}

/// Displacement integrated over the bar after two steps.
std::array<double, 2> moved(const Way& way, MPI_Comm comm) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {12, 2, 1}, Vec3::Zero(), Vec3(2, 0.3, 0));
  Solid solid(distribute(comm, raw), moved_bar(way), SolidContext{});
  for (int i = 0; i < 2; ++i) step(solid, 0.15);
  const Mesh& mesh = solid.body().mesh();
  const Geometry& geometry = solid.body().geometry();
  const std::vector<double>& u = solid.stepper().state().cell_u;
  std::array<double, 2> result{};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (int a = 0; a < 2; ++a) result[std::size_t(a)] += geometry.volume[c] * u[std::size_t(2 * c + a)];
  for (int a = 0; a < 2; ++a) result[std::size_t(a)] = parallel::sum(comm, result[std::size_t(a)]);
  return result;
}

// A rank with nothing that is known asked itself whether anything moves: the others waited for it for ever.
TEST_P(MovedEnd, is_the_same_on_any_number_of_ranks) {
  const auto whole = moved(GetParam(), MPI_COMM_SELF), parts = moved(GetParam(), MPI_COMM_WORLD);
  EXPECT_GT(std::abs(whole[0]), 1e-5);
  for (std::size_t a = 0; a < 2; ++a) EXPECT_NEAR(parts[a], whole[a], 1e-4 * std::abs(whole[a]));
}

INSTANTIATE_TEST_SUITE_P(Solid, MovedEnd, ::testing::ValuesIn(ways),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace couplet::testing::partner_load_test
