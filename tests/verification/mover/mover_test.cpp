// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/mover.hpp"
#include "common/mesh/load.hpp"
#include "mesh_mover/methods.hpp"
#include "plate_case.hpp"
#include "tests/support/own_folder.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/support/test.hpp"

namespace couplet::mesh_mover::mover_test {
using namespace coupling;
using namespace mesh;

using test::all_patches, test::at_points, test::largest_difference, test::perturbed_box;

TEST(Laplacian, a_rigid_translation_of_the_boundary_translates_every_point) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                               BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed}) {
    const auto [mesh, geometry] = perturbed_box(cells, 5);
    Laplacian laplacian(mesh, geometry, all_patches(mesh, BoundaryMotion::interface));
    const auto shift =
        at_points(mesh, geometry, [&](const Vec3&) { return Vec3(0.3, -0.2, mesh.dim == 3 ? 0.1 : 0.0); });
    EXPECT_LT(largest_difference(mesh.comm, laplacian.solve(shift), shift), 1e-12);
  }
}

// The equation is linear: what a motion linear in the place adds to another one is what it does alone.
TEST(Laplacian, a_linear_motion_of_the_interface_needs_no_further_solve_and_moves_the_mesh_alike) {
  for (const BoxCells cells : {BoxCells::triangles, BoxCells::prisms}) {
    const auto [mesh, geometry] = perturbed_box(cells, 6);
    Parameters p = all_patches(mesh, BoundaryMotion::fixed);
    p.boundaries["xmax"].motion = BoundaryMotion::interface;
    p.boundaries["ymax"].motion = BoundaryMotion::slip;
    Laplacian laplacian(mesh, geometry, p);
    const auto turn = [&](double angle, double shift) {
      return at_points(mesh, geometry, [&](const Vec3& x) {
        return Vec3((std::cos(angle) - 1) * x.x() - std::sin(angle) * x.y() + 0.3 * angle * x.z() + shift,
                    std::sin(angle) * x.x() + (std::cos(angle) - 1) * x.y(), 0.5 * shift);
      });
    };
    const auto bend =
        at_points(mesh, geometry, [](const Vec3& x) { return Vec3(0.1 * x.y() * x.y(), 0, 0); });
    const std::vector<double> rigid = turn(0.1, 0.02);
    std::vector<double> both = rigid;
    for (std::size_t i = 0; i < both.size(); ++i) both[i] += bend[i];
    laplacian.solve(turn(0.05, -0.01));
    const std::vector<double> alone = laplacian.solve(rigid);
    EXPECT_EQ(laplacian.last().iterations, 0);
    std::vector<double> added = laplacian.solve(both);
    EXPECT_GT(laplacian.last().iterations, 0);
    const std::vector<double> bent = laplacian.solve(bend);
    for (std::size_t i = 0; i < added.size(); ++i) added[i] -= bent[i];
    EXPECT_LT(largest_difference(mesh.comm, added, alone), 1e-12);
    EXPECT_GT(largest_difference(mesh.comm, alone, std::vector<double>(alone.size())), 0.02);
  }
}

/// What follows a wall must not leave it by rounding: gaps would open step by step.
TEST(Laplacian, points_of_the_interface_are_where_they_are_sent_to_the_last_bit) {
  for (const BoxCells cells : {BoxCells::triangles, BoxCells::prisms}) {
    const auto [mesh, geometry] = perturbed_box(cells, 4);
    Laplacian laplacian(mesh, geometry, all_patches(mesh, BoundaryMotion::interface));
    const auto sent = at_points(mesh, geometry, [](const Vec3& x) {  // as one body, which needs no solve
      return Vec3(0.01 - 0.1 * x.y(), 0.03 + 0.1 * x.x() - 0.07 * x.z(), 0.02 + 0.07 * x.y());
    });
    const std::vector<double> moved = laplacian.solve(sent);
    for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
      for (const Index v : mesh.face_points[f])
        for (int a = 0; a < mesh.dim; ++a) EXPECT_EQ(moved[v * mesh.dim + a], sent[v * mesh.dim + a]) << a;
  }
}

TEST(Laplacian, a_slipping_wall_lets_points_slide_and_keeps_them_on_its_plane) {
  const auto [mesh, geometry] =
      distribute(MPI_COMM_WORLD, make_box(BoxCells::hexahedra, {6, 5, 4}, Vec3::Zero(), Vec3::Ones()));
  Parameters p = all_patches(mesh, BoundaryMotion::slip);
  p.boundaries["xmin"].motion = BoundaryMotion::fixed;
  p.boundaries["xmax"].motion = BoundaryMotion::interface;
  p.stiffening = 0;
  Laplacian laplacian(mesh, geometry, p);
  const auto pushed =
      at_points(mesh, geometry, [](const Vec3& x) { return Vec3(x.x() > 0.999 ? 0.2 : 0.0, 0, 0); });
  const auto d = laplacian.solve(pushed);
  // On a uniform box the Laplacian stretches linearly; next to the slip walls points come from cell centres
  // in the plane.
  const auto linear = at_points(mesh, geometry, [](const Vec3& x) { return Vec3(0.2 * x.x(), 0, 0); });
  EXPECT_LT(largest_difference(mesh.comm, d, linear), 1e-12);
}

TEST(Laplacian, no_point_overshoots_the_boundary_values) {
  const auto [mesh, geometry] = perturbed_box(BoxCells::tetrahedra, 6);
  Laplacian laplacian(mesh, geometry, all_patches(mesh, BoundaryMotion::interface));
  const auto given =
      at_points(mesh, geometry, [](const Vec3& x) { return Vec3(x.y() > 0.999 ? 0.1 : 0.0, 0, 0); });
  const auto d = laplacian.solve(given);
  for (std::size_t i = 0; i < d.size(); i += 3) {
    EXPECT_GE(d[i], -1e-14);
    EXPECT_LE(d[i], 0.1 + 1e-14);
  }
}

TEST(Laplacian, cg_and_the_direct_method_move_the_mesh_alike_and_back_to_the_start) {
  const auto [mesh, geometry] = perturbed_box(BoxCells::triangles, 12);
  Parameters p = all_patches(mesh, BoundaryMotion::interface);
  Laplacian direct(mesh, geometry, p);
  p.linear.method = linalg::LinearMethod::cg_multigrid;
  p.linear.relative_tolerance = 1e-12;
  Laplacian iterative(mesh, geometry, p);
  const auto bend = at_points(
      mesh, geometry, [](const Vec3& x) { return Vec3(0.1 * x.y() * x.y(), 0.05 * std::sin(x.x()), 0); });
  const auto rest = at_points(mesh, geometry, [](const Vec3&) { return Vec3(0, 0, 0); });
  EXPECT_LT(largest_difference(mesh.comm, direct.solve(bend), iterative.solve(bend)), 1e-11);
  EXPECT_LT(largest_difference(mesh.comm, direct.solve(rest), rest), 1e-15);
  EXPECT_LT(largest_difference(mesh.comm, iterative.solve(rest), rest), 1e-12);
}

TEST(Laplacian, stiffening_protects_the_small_cells) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {20, 4, 1}, Vec3::Zero(), Vec3::Ones());
  for (Vec3& x : raw.points) x.x() = std::pow(x.x(), 2.5);  // small cells at x = 0
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, raw);
  const auto pushed =
      at_points(mesh, geometry, [](const Vec3& x) { return Vec3(x.x() < 1e-9 ? 0.3 : 0.0, 0, 0); });
  double least[2];
  for (const int chi : {0, 1}) {
    Parameters p = all_patches(mesh, BoundaryMotion::slip);
    p.boundaries["xmin"].motion = BoundaryMotion::interface;
    p.boundaries["xmax"].motion = BoundaryMotion::fixed;
    p.stiffening = chi;
    Laplacian laplacian(mesh, geometry, p);
    const auto d = laplacian.solve(pushed);
    std::vector<Vec3> moved = geometry.points;
    for (std::size_t v = 0; v < moved.size(); ++v) moved[v].x() += d[2 * v];
    const Geometry g = compute_geometry(mesh, moved);
    least[chi] = 1e300;
    Index smallest = 0;
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      if (geometry.volume[c] < geometry.volume[smallest]) smallest = c;
    const double v0 = parallel::min(mesh.comm, geometry.volume[smallest]);
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      if (geometry.volume[c] < 1.001 * v0) least[chi] = g.volume[c] / geometry.volume[c];
    least[chi] = parallel::min(mesh.comm, least[chi]);
  }
  EXPECT_LT(least[0], 0.72);
  EXPECT_GT(least[1], 0.95);
}

/// A row of cells is a chain of springs: (4.12) between two cells is the mean of V^-chi over the distance of
/// their centres, between a cell and a wall that of the cell.
TEST(Laplacian, stiffening_is_the_volume_to_the_power_of_minus_chi) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {12, 1, 1}, Vec3::Zero(), Vec3::Ones());
  for (Vec3& x : raw.points) x.x() = std::pow(x.x(), 2.0);
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  const auto pushed =
      at_points(mesh, geometry, [](const Vec3& x) { return Vec3(x.x() < 1e-9 ? 0.2 : 0.0, 0, 0); });
  for (const double chi : {1.0, 2.0}) {
    Parameters p = all_patches(mesh, BoundaryMotion::slip);
    p.boundaries["xmin"].motion = BoundaryMotion::interface;
    p.boundaries["xmax"].motion = BoundaryMotion::fixed;
    p.stiffening = chi;
    Laplacian laplacian(mesh, geometry, p);
    laplacian.solve(pushed);
    std::vector<double> compliance, edge;
    for (int i = 0; i <= 12; ++i) edge.push_back(std::pow(i / 12.0, 2));
    const auto centre = [&](int i) { return (edge[i] + edge[i + 1]) / 2; };
    const auto stiffness = [&](int i) { return std::pow(edge[i + 1] - edge[i], -chi); };
    compliance.push_back((centre(0) - edge[0]) / stiffness(0));
    for (int i = 1; i < 12; ++i)
      compliance.push_back((centre(i) - centre(i - 1)) / ((stiffness(i) + stiffness(i - 1)) / 2));
    compliance.push_back((edge[12] - centre(11)) / stiffness(11));
    const double all = std::accumulate(compliance.begin(), compliance.end(), 0.0);
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
      double behind = 0;
      for (int i = 0; i < 12 && centre(i) < geometry.cell_centre[c].x() + 1e-9; ++i) behind += compliance[i];
      EXPECT_NEAR(laplacian.cell_displacement()[2 * c], 0.2 * (1 - behind / all), 1e-12) << "chi " << chi;
    }
  }
}

TEST(Laplacian, a_slip_patch_off_the_axes_is_refused_by_name) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 4, 1}, Vec3::Zero(), Vec3::Ones());
  for (Vec3& x : raw.points) x.x() += 0.3 * x.y();
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, raw);
  Parameters p = all_patches(mesh, BoundaryMotion::fixed);
  p.boundaries["xmax"].motion = BoundaryMotion::slip;
  EXPECT_THAT(support::error_of([&] { Laplacian laplacian(mesh, geometry, p); }),
              ::testing::HasSubstr("'xmax'"));
}

Parameters square() {
  Parameters p;
  p.mesh = "square.geo";
  p.dimension = 2;
  p.boundaries["walls"].motion = BoundaryMotion::fixed;
  p.boundaries["moving"].motion = BoundaryMotion::interface;
  return p;
}

app::ParticipantContext context_of_the_test() {
  app::ParticipantContext context;
  context.comm = MPI_COMM_WORLD;
  context.name = "mover";
  context.case_folder = COUPLET_TEST_DATA;
  context.output_folder = support::own_folder();
  return context;
}

/// The middle of the moving side pushed by `x` [m].
Exchange push_middle(const Interface& interface, double x) {
  Exchange push;
  for (const Vec3& vertex : interface.vertices) {
    const bool middle = std::abs(vertex.y() - 0.5) < 0.01;
    push["displacement"].insert(push["displacement"].end(), {middle ? x : 0.0, 0.0});
  }
  return push;
}

TEST(Mover, gives_the_same_mesh_for_the_same_interface_whatever_came_between) {
  Mover mover(square(), context_of_the_test());
  const Interface interface = mover.initialise();
  mover.begin_step({.time = 0, .dt = 0.1, .scheme = Scheme::implicit, .number = 1});
  mover.solve(push_middle(interface, 0.1));
  const std::vector<double> first = mover.displacement();
  EXPECT_GT(parallel::max(MPI_COMM_WORLD, *std::max_element(first.begin(), first.end())), 0.05);
  mover.solve(push_middle(interface, -0.2));
  mover.solve(push_middle(interface, -0.9));  // by the barrier: as far as a guess of the coupling may go
  mover.begin_step({.time = 0, .dt = 0.05, .scheme = Scheme::implicit, .number = 1});
  mover.solve(push_middle(interface, 0.1));
  EXPECT_LT(largest_difference(mover.mesh().comm, mover.displacement(), first), 1e-14);
}

TEST(Mover, is_restored_from_a_checkpoint_bit_for_bit) {
  // In one process the partitioner shares out a second mesh otherwise, which a checkpoint refuses.
  Mover mover(square(), context_of_the_test());
  const Interface interface = mover.initialise();
  const auto step = [&](double push) {
    mover.begin_step({.time = 0, .dt = 0.1, .scheme = Scheme::implicit, .number = 1});
    mover.solve(push_middle(interface, push));
    mover.accept_step();
  };
  step(0.1);
  const support::SavedState checkpoint(mover);
  const auto saved = mover.displacement();
  step(0.2);
  EXPECT_NE(mover.displacement(), saved);
  checkpoint.load_into(mover);
  EXPECT_EQ(mover.displacement(), saved);
}

TEST(Mover, refuses_an_inverted_cell_by_name_and_place) {
  Parameters parameters = square();
  parameters.method = Method::laplacian;
  Mover mover(parameters, context_of_the_test());
  const Interface interface = mover.initialise();
  mover.begin_step({.time = 1.5, .dt = 0.1, .scheme = Scheme::implicit, .number = 3});
  EXPECT_THAT(support::error_of<SolveFailure>([&] { mover.solve(push_middle(interface, -0.9)); }),
              ::testing::AllOf(::testing::HasSubstr("participant 'mover'"), ::testing::HasSubstr("t = 1.5 s"),
                               ::testing::ContainsRegex("inverts cell [0-9]+ at \\(")));
}

}  // namespace couplet::mesh_mover::mover_test
