// SPDX-License-Identifier: Apache-2.0
// Mean stresses of cells as unknowns beside the displacements: the answer of factors, in iterations that nu hardly changes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::mixed_form_test {
using namespace mesh;
namespace {

using Preconditioner = MethodParameters::Preconditioner;

SolidParameters nearly_incompressible(int dim, double nu, Preconditioner by) {
  SolidParameters p = box_parameters(dim);
  p.material = {1000, 1e6, nu};
  p.method.face_gradient = FaceGradient::symmetric;
  p.method.volume_strain = MethodParameters::VolumeStrain::cells;
  p.method.preconditioner = by;
  p.method.relative_tolerance = 1e-10;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, std::vector<std::string>(dim, "0"));
  p.boundaries["xmax"] = boundary(Type::traction, dim == 2 ? std::vector<std::string>{"0", "1e3"}
                                                           : std::vector<std::string>{"0", "1e3", "500"});
  return p;
}

RawMesh body(BoxCells cells, int n) {
  const bool is_flat = dimension_of(cells) == 2;
  RawMesh raw = make_box(cells, {2 * n, n, is_flat ? 1 : n}, Vec3::Zero(), Vec3(1, 1, is_flat ? 0 : 1));
  for (Vec3& x : raw.points) x = Vec3(2 * x[0], x[1] * (1 - 0.2 * x[0]) + 0.3 * x[0], x[2]);
  return raw;
}

struct Answer {
  std::vector<double> u;
  int iterations = 0;
};

Answer solved(const RawMesh& raw, const SolidParameters& p, MPI_Comm comm = MPI_COMM_WORLD) {
  Solid solid(distribute(comm, raw), p, SolidContext{});
  step(solid, 0.02);
  if (p.analysis == SolidParameters::Analysis::dynamic) step(solid, 0.02);
  const Mesh& mesh = solid.body().mesh();
  const Geometry& geometry = solid.body().geometry();
  // The same numbers on any count of ranks: moments of the displacements.
  Answer answer;
  const std::vector<double>& u = solid.stepper().state().cell_u;
  for (int a = 0; a < mesh.dim; ++a)
    for (int k = 0; k < 4; ++k) {
      double moment = 0;
      for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
        const Vec3& x = geometry.cell_centre[c];
        const std::array<double, 4> weights{1, x[0], x[1], std::sin(7 * x[0]) * std::cos(5 * x[1])};
        moment += weights[std::size_t(k)] * u[std::size_t(c) * std::size_t(mesh.dim) + std::size_t(a)];
      }
      answer.u.push_back(parallel::sum(mesh.comm, moment));
    }
  answer.iterations = solid.stepper().effort().iterations;
  return answer;
}

double gap(const Answer& a, const Answer& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i) {
    difference = std::max(difference, std::abs(a.u[i] - b.u[i]));
    size = std::max(size, std::abs(b.u[i]));
  }
  return difference / size;
}

constexpr std::array kinds{BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                           BoxCells::mixed};

TEST(MixedForm, gives_what_factors_give) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "on one rank";
  for (const BoxCells cells : kinds) {
    SCOPED_TRACE(int(cells));
    const int dim = dimension_of(cells);
    const RawMesh raw = body(cells, dim == 2 ? 6 : 3);
    EXPECT_LT(gap(solved(raw, nearly_incompressible(dim, 0.4999, Preconditioner::mixed)),
                  solved(raw, nearly_incompressible(dim, 0.4999, Preconditioner::factors))),
              1e-7);
  }
}

// Also where some of the bulk modulus stays with the faces, and in steps in which inertia rules.
TEST(MixedForm, of_shared_volume_strain_and_of_motion) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "on one rank";
  for (const bool moves : {false, true}) {
    std::array<SolidParameters, 2> p{nearly_incompressible(2, 0.4999, Preconditioner::mixed),
                                     nearly_incompressible(2, 0.4999, Preconditioner::factors)};
    for (SolidParameters& q : p) {
      if (moves)
        q.analysis = SolidParameters::Analysis::dynamic;
      else
        q.method.volume_strain = MethodParameters::VolumeStrain::shared;
    }
    const RawMesh raw = body(moves ? BoxCells::triangles : BoxCells::quadrilaterals, 6);
    EXPECT_LT(gap(solved(raw, p[0]), solved(raw, p[1])), 1e-7);
  }
}

// Conjugate gradients without pressures have no end there.
TEST(MixedForm, iterations_hardly_grow_as_nu_goes_to_one_half) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "on one rank";
  const RawMesh raw = body(BoxCells::quadrilaterals, 16);
  const auto iterations = [&](double nu) {
    return solved(raw, nearly_incompressible(2, nu, Preconditioner::mixed)).iterations;
  };
  const int far = iterations(1. / 3), near = iterations(0.4999);
  RecordProperty("far", far);
  RecordProperty("near", near);
  EXPECT_LT(near, 2 * far);
  SolidParameters without = nearly_incompressible(2, 0.4999, Preconditioner::multigrid);
  without.method.max_iterations = 10 * near;
  EXPECT_THROW(solved(raw, without), Error);
}

TEST(MixedForm, ranks_agree) {
  for (const BoxCells cells : {BoxCells::triangles, BoxCells::hexahedra}) {
    SCOPED_TRACE(int(cells));
    const SolidParameters p = nearly_incompressible(dimension_of(cells), 0.4999, Preconditioner::mixed);
    const RawMesh raw = body(cells, cells == BoxCells::triangles ? 4 : 2);
    EXPECT_LT(gap(solved(raw, p), solved(raw, p, MPI_COMM_SELF)), 1e-8);
  }
}

// Two steps, the second from what was saved after the first.
TEST(MixedForm, goes_on_bit_for_bit) {
  SolidParameters p = nearly_incompressible(2, 0.4999, Preconditioner::mixed);
  p.analysis = SolidParameters::Analysis::dynamic;
  const LoadedMesh loaded = distribute(MPI_COMM_WORLD, body(BoxCells::quadrilaterals, 4));
  Solid whole(loaded, p, SolidContext{}), rest(loaded, p, SolidContext{});
  step(whole, 0.02);
  support::SavedState(whole).load_into(rest);
  step(whole, 0.02);
  step(rest, 0.02);
  EXPECT_EQ(whole.stepper().state().cell_u, rest.stepper().state().cell_u);
}

TEST(MixedForm, is_refused_without_mean_stresses_of_cells) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "on one rank";
  SolidParameters p = nearly_incompressible(2, 0.3, Preconditioner::mixed);
  p.method.volume_strain = MethodParameters::VolumeStrain::faces;
  EXPECT_THROW(solved(body(BoxCells::quadrilaterals, 2), p), Error);
  p = nearly_incompressible(2, 0.3, Preconditioner::mixed);
  p.method.face_gradient = FaceGradient::corrected;
  EXPECT_THROW(solved(body(BoxCells::quadrilaterals, 2), p), Error);
}

}  // namespace
}  // namespace couplet::testing::mixed_form_test
