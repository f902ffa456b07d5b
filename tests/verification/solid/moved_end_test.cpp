// SPDX-License-Identifier: Apache-2.0
// Bars that are held and moved at one end: on several ranks only one of them owns what is known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ostream>
#include <string>

#include "common/parallel/collective.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::moved_end_test {
using namespace mesh;
namespace {

struct Way {
  const char* name;
  bool is_dynamic, is_large;
  FaceGradient gradient;
  time::TimeScheme scheme = time::TimeScheme::trapezoidal;
  MethodParameters::Type method = MethodParameters::Type::automatic;
};

constexpr std::array ways{
    Way{"static_linear", false, false, FaceGradient::symmetric},
    Way{"static_corrected", false, false, FaceGradient::corrected},
    Way{"static_large", false, true, FaceGradient::symmetric},
    Way{"static_large_segregated", false, true, FaceGradient::thesis, time::TimeScheme::trapezoidal,
        MethodParameters::Type::segregated},
    Way{"dynamic_linear", true, false, FaceGradient::symmetric},
    Way{"dynamic_corrected", true, false, FaceGradient::corrected},
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

}  // namespace
}  // namespace couplet::testing::moved_end_test
