// SPDX-License-Identifier: Apache-2.0
// Quantities of interest of linear static bodies: their errors by the dual problem beside the true ones.
#include "solid_solver/output/quantities.hpp"
#include "solid_solver/body/stress.hpp"
#include "solid_solver/output/quantities.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::quantities_test {
using namespace mesh;

SolidQuantity at(std::vector<double> point, const char* field, const char* component) {
  return {.point = std::move(point), .field = field, .component = component};
}

std::vector<QuantityEstimate> estimates(const Solid& solid) {
  return estimate_quantities(solid.body(), solid.fields(), solid.stepper().state(),
                             *solid.stepper().method());
}

/// What the only step of a run finds.
std::vector<QuantityEstimate> found(MPI_Comm comm, const RawMesh& raw, const SolidParameters& p) {
  Solid solid(distribute(comm, raw), p, SolidContext{});
  step(solid, 1);
  return estimates(solid);
}

/// A clamped sheet 2 x 1 (a bar 4 x 1 x 1), sheared at its end, n cells across.
SolidParameters sheared(int dim) {
  SolidParameters p = box_parameters(dim);
  p.boundaries["xmin"] = clamped(dim);
  std::vector<std::string> load(std::size_t(dim), "0");
  load[1] = "1e6";
  p.boundaries["xmax"] = boundary(Type::traction, load);
  return p;
}

RawMesh sheet(BoxCells cells, int n) { return make_box(cells, {2 * n, n, 1}, Vec3::Zero(), Vec3(2, 1, 0)); }
RawMesh bar(BoxCells cells, int n) { return make_box(cells, {4 * n, n, n}, Vec3::Zero(), Vec3(4, 1, 1)); }

double tip_of(const RawMesh& raw, const SolidParameters& p) {
  return found(MPI_COMM_SELF, raw, p).at(0).value;
}

TEST(Quantities,
     of_a_sheared_sheet_err_by_a_quarter_to_three_times_what_is_estimated_from_eight_cells_across_on) {
  SolidParameters p = sheared(2);
  p.quantities["tip"] = at({2, 1}, "displacement", "y");
  const double truth = tip_of(sheet(BoxCells::quadrilaterals, 64), p);
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles})
    for (const int n : {8, 16}) {
      const QuantityEstimate tip = found(MPI_COMM_WORLD, sheet(cells, n), p).at(0);
      const double wrong = std::abs(tip.value - truth);
      fmt::print("{}, {} across: estimated {:.3g}, true {:.3g} of {:.4g}\n", name(cells), n, tip.error(),
                 wrong, truth);
      EXPECT_GT(tip.error(), wrong / 3);
      EXPECT_LT(tip.error(), wrong * 4);
    }
}

// Bending is met by cancellation, of which the other gradient knows nothing.
TEST(Quantities, of_a_bar_that_bends_in_space_are_better_than_they_are_told) {
  SolidParameters p = sheared(3);
  p.quantities["tip"] = at({4, 1, 1}, "displacement", "y");
  const double truth = tip_of(bar(BoxCells::hexahedra, 8), p);
  const QuantityEstimate tip = found(MPI_COMM_WORLD, bar(BoxCells::hexahedra, 4), p).at(0);
  const double wrong = std::abs(tip.value - truth);
  fmt::print("estimated {:.3g}, true {:.3g} of {:.4g}\n", tip.error(), wrong, truth);
  EXPECT_GT(tip.error(), wrong);
  EXPECT_LT(tip.error(), wrong * 15);
}

// On regular cells the residuals of bending cancel: the dual problem alone, the failing neighbour, sees an eighth of the error.
TEST(Quantities, of_regular_cells_in_bending_err_as_the_whole_body_does) {
  SolidParameters p = sheared(2);
  p.quantities["tip"] = at({5, 0.5}, "displacement", "y");
  const auto beam = [](int n) {
    return make_box(BoxCells::quadrilaterals, {10 * n, 2 * n, 1}, Vec3::Zero(), Vec3(5, 1, 0));
  };
  const double truth = tip_of(beam(16), p);
  Solid solid(distribute(MPI_COMM_WORLD, beam(2)), p, SolidContext{});
  support::observe(solid, 1, 1);
  QuantityEstimate tip = estimates(solid).at(0);
  const double alone = tip.error();
  const auto told = std::ranges::find(diagnostics::findings().rbegin(), diagnostics::findings().rend(),
                                      "quantity-error", &diagnostics::Finding::id);
  ASSERT_NE(told, diagnostics::findings().rend());
  tip.body = told->number * std::abs(tip.value);
  const double wrong = std::abs(tip.value - truth);
  fmt::print("estimated {:.3g}, by the dual problem {:.3g}, true {:.3g} of {:.4g}\n", tip.error(), alone,
             wrong, truth);
  EXPECT_LT(alone, wrong / 3);
  EXPECT_GT(tip.error(), wrong / 2);
  EXPECT_LT(tip.error(), wrong * 2);
}

TEST(Quantities, of_linear_fields_have_no_error_on_any_cells) {
  for (const BoxCells cells : all_cells) {
    const int dim = dimension_of(cells);
    SolidParameters p = box_parameters(dim);
    p.boundaries["xmin"] = boundary(Type::symmetry);
    p.boundaries["ymin"] = boundary(Type::symmetry);
    if (dim == 3) p.boundaries["zmin"] = boundary(Type::symmetry);
    p.boundaries["xmax"] = pressed("-1e6");
    p.quantities["corner"] = at({1, 1, double(dim - 2)}, "displacement", "x");
    p.quantities["inside"] = at({0.4, 0.3, 0.2 * (dim - 2)}, "stress", "xx");
    p.quantities["peak"] = at({}, "equivalent-stress", "");
    const auto all = found(MPI_COMM_WORLD, make_box(cells, {3, 3, 3}, Vec3::Zero(), Vec3(1, 1, dim - 2)), p);
    ASSERT_EQ(all.size(), 3u);
    for (const QuantityEstimate& q : all)
      EXPECT_LT(q.error(), 1e-6 * std::abs(q.value)) << name(cells) << " " << q.name;
    EXPECT_NEAR(all[1].value, 1e6, 1);
  }
}

TEST(Quantities, rows_of_a_stress_give_the_stress_of_a_linear_field) {
  for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra}) {
    const Solid solid(distribute(MPI_COMM_WORLD, bar(cells, 2)), sheared(3), SolidContext{});
    const SolidBody& body = solid.body();
    const Vec3 slope(3, -2, 1);  // of the displacement along the bar, which is 0 at its clamped end
    std::vector<double> u;
    const auto add = [&](const Vec3& x) {
      u.insert(u.end(), {slope[0] * x[0], slope[1] * x[0], slope[2] * x[0]});
    };
    for (Index c = 0; c < body.mesh().cells.n_owned(); ++c) add(body.geometry().cell_centre[c]);
    for (const Index f : body.elastic().unknown_faces()) add(body.geometry().face_centre[f]);
    const DualProblem dual(body, u, std::vector<double>(body.prescribed().size() * 3, 0));
    Tensor3 weights, strain = Tensor3::Zero();
    weights << 1, 0.5, 0, 0.5, -2, 0.3, 0, 0.3, 0.7;
    strain.col(0) = 0.5 * slope, strain.row(0) += 0.5 * slope.transpose();
    const Index cell = 0;
    const std::vector<double> rows = dual.of_stress({&cell, 1}, weights);
    double sum = 0;
    for (std::size_t i = 0; i < u.size(); ++i) sum += rows[i] * u[i];
    const Tensor3 stress = body.elastic().stress(cell, strain);
    EXPECT_NEAR(parallel::sum(MPI_COMM_WORLD, sum), weights.cwiseProduct(stress).sum(),
                1e-11 * stress.norm());
  }
}

TEST(Quantities, are_the_same_on_any_ranks) {
  for (const BoxCells cells : {BoxCells::triangles, BoxCells::hexahedra}) {
    const int dim = dimension_of(cells);
    SolidParameters p = sheared(dim);
    p.quantities["tip"] =
        at(dim == 2 ? std::vector<double>{2, 1} : std::vector<double>{4, 1, 1}, "displacement", "y");
    p.quantities["within"] =
        at(dim == 2 ? std::vector<double>{0.9, 0.4} : std::vector<double>{1.9, 0.4, 0.6}, "stress", "xx");
    p.quantities["peak"] = at({}, "equivalent-stress", "");
    const RawMesh raw = dim == 2 ? sheet(cells, 6) : bar(cells, 3);
    const auto here = found(MPI_COMM_WORLD, raw, p), alone = found(MPI_COMM_SELF, raw, p);
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_NEAR(here[i].value, alone[i].value, 1e-6 * std::abs(alone[i].value)) << alone[i].name;
      EXPECT_NEAR(here[i].local, alone[i].local, 1e-4 * alone[i].error()) << alone[i].name;
      EXPECT_NEAR(here[i].dual, alone[i].dual, 1e-4 * alone[i].error()) << alone[i].name;
    }
  }
}

TEST(Quantities, that_nobody_asks_for_are_not_computed) {
  EXPECT_TRUE(found(MPI_COMM_WORLD, sheet(BoxCells::triangles, 4), sheared(2)).empty());
}

}  // namespace couplet::testing::quantities_test
