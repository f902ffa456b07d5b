// SPDX-License-Identifier: Apache-2.0
// Far motions: elastic body, the guard; a plate in a square and boxes.
#include "common/mesh/load.hpp"
#include "common/mesh/quality.hpp"
#include "mesh_mover/methods.hpp"
#include "mesh_mover/mover.hpp"
#include "plate_case.hpp"

namespace couplet::mesh_mover::test::motion_test {
using namespace mesh;

using std::numbers::pi;

/// Patch test: a body without stiffness gradients takes a linear field over from its boundary, whatever its cells.
TEST(PseudoSolid, carries_a_linear_field_into_the_mesh_exactly) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                               BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed}) {
    const auto [mesh, geometry] = perturbed_box(cells, 4);
    Parameters p = all_patches(mesh, BoundaryMotion::interface);
    p.stiffening = 0;
    p.poisson_ratio = 0.2;
    const auto solid = make_pseudo_solid(mesh, geometry, p);
    const auto linear = at_points(mesh, geometry, [&](const Vec3& x) {
      return Vec3(0.1 * x.x() - 0.2 * x.y() + 0.3, 0.15 * x.x() + 0.05 * x.y(),
                  mesh.dim == 3 ? 0.1 * x.z() : 0);
    });
    EXPECT_LT(largest_difference(mesh.comm, solid->solve(linear), linear), 1e-8) << int(cells);
    EXPECT_GT(solid->last().iterations, 0);
  }
}

/// Pulled between its ends a free side draws in by nu / (1 - nu) of the stretch in the plane, in three dimensions, beside a side
/// that is kept from it, as well.
TEST(PseudoSolid, a_free_side_draws_in_by_poissons_ratio) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra}) {
    const auto [mesh, geometry] = perturbed_box(cells, 4);
    Parameters p = all_patches(mesh, BoundaryMotion::slip);
    p.boundaries["xmin"].motion = p.boundaries["xmax"].motion = BoundaryMotion::interface;
    p.boundaries["ymax"].motion = BoundaryMotion::free;
    p.stiffening = 0;
    p.poisson_ratio = 0.3;
    const auto solid = make_pseudo_solid(mesh, geometry, p);
    const auto pulled = at_points(
        mesh, geometry, [](const Vec3& x) { return Vec3(0.1 * x.x(), -0.3 / 0.7 * 0.1 * x.y(), 0); });
    EXPECT_LT(largest_difference(mesh.comm, solid->solve(pulled), pulled), 1e-8) << int(cells);
  }
}

TEST(PseudoSolid, slides_along_a_plane_of_any_direction) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {8, 6, 1}, Vec3::Zero(), Vec3::Ones());
  const double angle = 0.4;
  const Vec3 along(std::cos(angle), std::sin(angle), 0), across(-std::sin(angle), std::cos(angle), 0);
  for (Vec3& x : raw.points) x = x.x() * along + x.y() * across;
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, raw);
  Parameters p = all_patches(mesh, BoundaryMotion::slip);
  p.boundaries["xmin"].motion = BoundaryMotion::fixed;
  p.boundaries["xmax"].motion = BoundaryMotion::interface;
  const auto solid = make_pseudo_solid(mesh, geometry, p);
  const auto pushed = at_points(mesh, geometry, [&](const Vec3& x) {
    return x.dot(along) > 0.999 ? Vec3(0.2 * along) : Vec3(Vec3::Zero());
  });
  const auto d = solid->solve(pushed);
  // Without Poisson's ratio a uniform body stretches along the push alone.
  const auto stretched =
      at_points(mesh, geometry, [&](const Vec3& x) { return Vec3(0.2 * x.dot(along) * along); });
  EXPECT_LT(largest_difference(mesh.comm, d, stretched), 1e-8);
}

/// Small cells are stiffer by (V/V')^-chi: a column of cells is a chain of springs.
TEST(PseudoSolid, stiffening_is_the_volume_to_the_power_of_minus_chi) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {24, 1, 1}, Vec3::Zero(), Vec3(1, 0.05, 1));
  for (Vec3& x : raw.points) x.x() = x.x() < 0.5 ? x.x() / 2 : 0.25 + 1.5 * (x.x() - 0.5);  // widths 1:3
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  const auto pushed =
      at_points(mesh, geometry, [](const Vec3& x) { return Vec3(x.x() < 1e-9 ? 0.2 : 0.0, 0, 0); });
  for (const double chi : {1.0, 2.0}) {
    Parameters p = all_patches(mesh, BoundaryMotion::slip);
    p.boundaries["xmin"].motion = BoundaryMotion::interface;
    p.boundaries["xmax"].motion = BoundaryMotion::fixed;
    p.stiffening = chi;
    const auto solid = make_pseudo_solid(mesh, geometry, p);
    const auto d = solid->solve(pushed);
    // Strain e of the small cells, 3^chi e of the large ones: e (0.25 + 0.75 3^chi) = -0.2; the cell pair where they
    // meet smears it.
    const double strain = -0.2 / (0.25 + 0.75 * std::pow(3, chi));
    for (Index v = 0; v < mesh.points.n_local(); ++v) {
      const double x = geometry.points[v].x();
      if (x < 0.2) {
        EXPECT_NEAR(d[2 * v], 0.2 + strain * x, 0.005 * 0.2) << "chi " << chi << " x " << x;
      }
    }
  }
}

TEST(Mover, patches_that_move_a_common_point_apart_are_refused_by_name) {
  const auto error = [](const char* floor, const char* right) {
    Parameters p = plate_in_a_square(Method::laplacian);
    for (const auto& [name, up] : {std::pair{"floor", floor}, std::pair{"right", right}}) {
      p.boundaries[name].motion = BoundaryMotion::moving;
      p.boundaries[name].prescribed.translation = {{"0"}, {up}};
    }
    return support::error_of([&] {
      Mover mover(p, context());
      mover.initialise();
      run(mover, 0, 0.1, 1);
    });
  };
  EXPECT_EQ(error("0.1*t", "t/10"), "");
  const std::string refused = error("0.1*t", "0.2*t");
  for (const char* text :
       {"'floor'", "'right'", " move differently at (", "0.01 m", "0.02 m", "at t = 0.1 s."})
    EXPECT_THAT(refused, ::testing::HasSubstr(text));
}

class EveryMethod : public ::testing::TestWithParam<Method> {};

/// Half a swing and back: the mesh does not depend on the path.
TEST_P(EveryMethod, returns_to_the_reference_mesh_with_the_body) {
  Parameters p = plate_in_a_square(GetParam());
  turn_by(p, "0.35*sin(pi*t)");
  p.boundaries["plate"].prescribed.translation = {{"0"}, {"0.1*sin(pi*t)"}};
  Mover mover(p, context());
  mover.initialise();
  run(mover, 0, 0.5, 5);
  const std::vector<double> out = mover.displacement();
  EXPECT_GT(parallel::max(MPI_COMM_WORLD, *std::ranges::max_element(out)), 0.2);
  run(mover, 0.5, 1, 5);
  const double left =
      largest_difference(MPI_COMM_WORLD, mover.displacement(), std::vector<double>(out.size()));
  EXPECT_LT(left, 1e-10 / 16);  // of the edges
}

/// What is swept by the faces is what the cells gain.
TEST_P(EveryMethod, swept_volumes_are_the_change_of_volume) {
  Parameters p = plate_in_a_square(GetParam());
  turn_by(p, "0.3*t");
  Mover mover(p, context());
  mover.initialise();
  const Mesh& mesh = mover.mesh();
  const Geometry& geometry = mover.geometry();
  const auto placed = [&] {
    std::vector<Vec3> points = geometry.points;
    for (std::size_t v = 0; v < points.size(); ++v)
      for (int c = 0; c < 2; ++c) points[v][c] += mover.displacement()[2 * v + c];
    return points;
  };
  run(mover, 0, 0.5, 2);
  const std::vector<Vec3> from = placed();
  run(mover, 0.5, 1, 2);
  const std::vector<Vec3> to = placed();
  const std::vector<double> swept = swept_volumes(mesh, from, to);
  const Geometry before = compute_geometry(mesh, from), after = compute_geometry(mesh, to);
  std::vector<double> gained(mesh.cells.n_local(), 0.0);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    gained[mesh.owner[f]] += swept[f];
    if (f < mesh.n_interior) gained[mesh.neighbour[f]] -= swept[f];
  }
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    EXPECT_NEAR(gained[c], after.volume[c] - before.volume[c], 1e-14 * 4);  // of the domain
}

INSTANTIATE_TEST_SUITE_P(All, EveryMethod, ::testing::Values(Method::laplacian, Method::pseudo_solid));

TEST(Guard, measures_of_a_sheared_and_stretched_cell) {
  const auto [mesh, geometry] =
      distribute(MPI_COMM_SELF, make_box(BoxCells::quadrilaterals, {2, 1, 1}, Vec3::Zero(), Vec3(2, 1, 1)));
  Parameters p = all_patches(mesh, BoundaryMotion::fixed);
  const CellMeasures guard(mesh, geometry, p);
  std::vector<Vec3> points = geometry.points;
  for (Vec3& x : points)
    if (x.x() < 0.5) x.x() -= 3;  // the left cell: 4 x 1
  const Geometry moved = compute_geometry(mesh, points);
  const MeshState s = guard.measure(moved);
  EXPECT_DOUBLE_EQ(s.worst[MeshState::volume_ratio].value, 1);
  EXPECT_DOUBLE_EQ(s.worst[MeshState::edge_ratio].value, 4);
  EXPECT_DOUBLE_EQ(s.worst[MeshState::scaled_jacobian].value, 1);
  EXPECT_DOUBLE_EQ(s.worst[MeshState::area_change].value, 2);   // log2(4)
  EXPECT_DOUBLE_EQ(s.worst[MeshState::shape_change].value, 2);  // 4^2 / 4 over 1
  EXPECT_EQ(s.worst[MeshState::edge_ratio].cell, s.worst[MeshState::area_change].cell);
  EXPECT_NEAR(s.worst[MeshState::edge_ratio].place.x(), -1, 1e-12);
  for (Vec3& x : points) x.x() += x.y();  // sheared by 45 degrees
  const MeshState t = guard.measure(compute_geometry(mesh, points));
  EXPECT_NEAR(t.worst[MeshState::scaled_jacobian].value, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(t.worst[MeshState::angle].value, 45, 1e-9);
}

TEST(Guard, ideal_cells_have_a_scaled_jacobian_of_one_and_turned_over_ones_below_zero) {
  for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed,
                               BoxCells::triangles, BoxCells::quadrilaterals}) {
    const auto [mesh, geometry] =
        distribute(MPI_COMM_SELF, make_box(cells, {2, 2, 2}, Vec3::Zero(), Vec3::Ones()));
    const CellMeasures guard(mesh, geometry, all_patches(mesh, BoundaryMotion::fixed));
    const MeshState s = guard.measure(geometry);
    EXPECT_GT(s.worst[MeshState::scaled_jacobian].value, 0.3) << int(cells);
    EXPECT_LE(s.worst[MeshState::scaled_jacobian].value, 1 + 1e-12);
    std::vector<Vec3> mirrored = geometry.points;
    for (Vec3& x : mirrored) x.x() = -x.x();
    const MeshState m = guard.measure(compute_geometry(mesh, mirrored));
    EXPECT_LT(m.worst[MeshState::scaled_jacobian].value, 0) << int(cells);
  }
}

TEST(Guard, each_limit_refuses_with_its_key_and_the_cell_and_lets_a_small_motion_pass) {
  const std::vector<std::pair<std::string, std::function<void(Parameters&)>>> limits{
      {"guard.smallest-scaled-jacobian", [](Parameters& p) { p.guard.smallest_scaled_jacobian = 0.45; }},
      {"guard.largest-angle", [](Parameters& p) { p.guard.largest_angle = 35; }}};
  for (const auto& [key, set] : limits) {
    Parameters p = plate_in_a_square(Method::laplacian);
    set(p);
    p.boundaries["plate"].prescribed.translation = {{"0"}, {"t"}};
    Mover mover(p, context());
    mover.initialise();
    mover.begin_step({0, 1e-4, coupling::Scheme::standalone, 0});
    EXPECT_NO_THROW(mover.solve({})) << key;
    mover.begin_step({0, 0.3, coupling::Scheme::standalone, 0});
    try {
      mover.solve({});
      ADD_FAILURE() << key << " let it pass";
    } catch (const SolveFailure& e) {
      EXPECT_THAT(e.what(), ::testing::AllOf(::testing::HasSubstr(key),
                                             ::testing::ContainsRegex("leaves cell [0-9]+ at \\(")));
    }
  }
}

TEST(MovingPatches, a_translation_that_depends_on_the_place_is_refused_by_key) {
  Parameters p = plate_in_a_square(Method::laplacian);
  p.boundaries["plate"].prescribed.translation = {{"x*t"}, {"0"}};
  EXPECT_THAT(support::error_of([&] { Mover mover(p, context()); }),
              ::testing::HasSubstr("motion.translation: 'x*t' depends on the position"));
}

}  // namespace couplet::mesh_mover::test::motion_test
