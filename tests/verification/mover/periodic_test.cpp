// SPDX-License-Identifier: Apache-2.0
// Meshes that go on beyond periodic patches.
#include "common/mesh/load.hpp"
#include "common/mesh/periodic_points.hpp"
#include "mesh_mover/methods.hpp"
#include "plate_case.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::mesh_mover::test::periodic_test {
using namespace mesh;
using namespace parallel;

using std::numbers::pi;

/// A unit box whose sides in x (and y, in three dimensions) are joined.
LoadedMesh joined_box(int dim, int n, bool simplices = false) {
  RawMesh raw;
  if (comm_rank(MPI_COMM_WORLD) == 0) {
    const BoxCells in_the_plane = simplices ? BoxCells::triangles : BoxCells::quadrilaterals,
                   in_space = simplices ? BoxCells::tetrahedra : BoxCells::hexahedra;
    raw = make_box(dim == 2 ? in_the_plane : in_space, {n, n, n}, Vec3::Zero(), Vec3::Ones());
    raw.periodic = {{"xmin", "xmax"}};
    if (dim == 3) raw.periodic.push_back({"ymin", "ymax"});
  }
  return distribute(MPI_COMM_WORLD, raw);
}

Parameters floor_moves(int dim) {
  Parameters p;
  p.dimension = dim;
  for (const char* side : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
    p.boundaries[side].motion = BoundaryMotion::fixed;
  for (const char* side : {"xmin", "xmax"}) p.boundaries[side].motion = BoundaryMotion::periodic;
  if (dim == 3)
    for (const char* side : {"ymin", "ymax"}) p.boundaries[side].motion = BoundaryMotion::periodic;
  p.boundaries[dim == 2 ? "ymin" : "zmin"].motion = BoundaryMotion::interface;
  return p;
}

/// Displacement of all points where the floor moves as a wave with its crest at `crest`.
std::vector<double> waved(const Mesh& mesh, const Geometry& geometry, MotionMethod& method, double crest) {
  std::vector<double> floor(std::size_t(mesh.points.n_local()) * mesh.dim, 0.0);
  for (Index v = 0; v < mesh.points.n_local(); ++v) {
    const Vec3& x = geometry.points[v];
    if (x[mesh.dim - 1] > 1e-9) continue;
    double wave = 0.1 * std::cos(2 * pi * (x.x() - crest));
    if (mesh.dim == 3) wave *= std::cos(2 * pi * (x.y() - crest));
    floor[std::size_t(v) * mesh.dim] = 0.5 * wave;
    floor[std::size_t(v) * mesh.dim + mesh.dim - 1] = wave;
  }
  return method.solve(floor);
}

using Place = std::array<int, 3>;

/// By place, counted in cells from `crest` on and around the joined sides.
std::map<Place, Vec3> by_place(const Mesh& mesh, const Geometry& geometry,
                               const std::vector<double>& displacement, int n, double crest) {
  std::vector<double> mine;
  for (Index v = 0; v < mesh.points.n_owned(); ++v) {
    const Vec3& x = geometry.points[v];
    mine.insert(mine.end(), {x[0], x[1], x[2], 0, 0, 0});
    for (int c = 0; c < mesh.dim; ++c)
      mine[mine.size() - 3 + c] = displacement[std::size_t(v) * mesh.dim + c];
  }
  const std::vector<double> all = all_gather(mesh.comm, mine);
  std::map<Place, Vec3> found;
  for (std::size_t i = 0; i < all.size(); i += 6) {
    Place place{};
    for (int c = 0; c < mesh.dim; ++c) {
      const bool joined = c < mesh.dim - 1;
      place[c] = int(std::lround((all[i + c] - (joined ? crest : 0)) * n));
      if (joined) place[c] = (place[c] + n) % n;
    }
    found[place] = Vec3(all[i + 3], all[i + 4], all[i + 5]);
  }
  return found;
}

/// A wave on the floor that begins elsewhere moves the mesh alike elsewhere: no place is a side of the box. Both copies of
/// a point move as one.
void expect_no_side(const Mesh& mesh, const Geometry& geometry, MotionMethod& method, int n,
                    double tolerance) {
  const int dim = mesh.dim;
  const PeriodicPoints periodic(mesh, geometry);
  const std::vector<double> first = waved(mesh, geometry, method, 0),
                            second = waved(mesh, geometry, method, 0.25);
  EXPECT_LT(periodic.largest_gap(first, dim), 1e-12);
  EXPECT_LT(periodic.largest_gap(second, dim), 1e-12);
  const auto a = by_place(mesh, geometry, first, n, 0), b = by_place(mesh, geometry, second, n, 0.25);
  ASSERT_EQ(a.size(), b.size());
  double worst = 0, inside = 0;
  for (const auto& [place, d] : a) {
    worst = std::max(worst, (d - b.at(place)).norm());
    if (place[dim - 1] > 0) inside = std::max(inside, d.norm());
  }
  EXPECT_LT(worst, tolerance) << dim;
  EXPECT_GT(inside, 0.002) << dim;
}

TEST(Periodic, a_wave_on_the_floor_knows_no_side) {
  for (const int dim : {2, 3}) {
    const int n = dim == 2 ? 12 : 4;
    const auto [mesh, geometry] = joined_box(dim, n);
    Laplacian laplacian(mesh, geometry, floor_moves(dim));
    expect_no_side(mesh, geometry, laplacian, n, 1e-10);
  }
}

/// The elastic body, too; three-cornered faces share their strain over the edges of both sides.
TEST(Periodic, a_wave_on_the_floor_of_an_elastic_mesh_knows_no_side) {
  for (const int dim : {2, 3}) {
    const int n = dim == 2 ? 8 : 4;
    const auto [mesh, geometry] = joined_box(dim, n, dim == 3);
    Parameters p = floor_moves(dim);
    p.linear.relative_tolerance = 1e-9;
    const auto solid = make_pseudo_solid(mesh, geometry, p);
    expect_no_side(mesh, geometry, *solid, n, 1e-7);
  }
}

/// Where the floor ends in a patch of its own on one side, its corner there would move and its copy rest.
std::string refusal_of_ends(BoundaryMotion at_one_end) {
  RawMesh raw;
  if (comm_rank(MPI_COMM_WORLD) == 0) {
    raw = make_box(BoxCells::quadrilaterals, {4, 4, 1}, Vec3::Zero(), Vec3::Ones());
    raw.periodic = {{"xmin", "xmax"}};
    raw.patches.push_back("end");
    for (Index b = 0; b < raw.boundary_points.size(); ++b) {
      double highest = 0;
      for (const Index v : raw.boundary_points[b])
        highest = std::max({highest, raw.points[v].x() - 0.25, raw.points[v].y()});
      if (highest < 1e-9) raw.boundary_patch[b] = int(raw.patches.size()) - 1;
    }
  }
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, raw);
  Parameters p = floor_moves(2);
  p.boundaries["end"].motion = at_one_end;
  return support::error_of([&] { const auto solid = make_pseudo_solid(mesh, geometry, p); });
}

TEST(Periodic, ends_that_are_not_held_alike_are_refused) {
  EXPECT_EQ(refusal_of_ends(BoundaryMotion::interface), "");
  EXPECT_THAT(refusal_of_ends(BoundaryMotion::free),
              ::testing::HasSubstr("are supported differently: the adjacent patches"));
}

TEST(Periodic, copies_of_points) {
  const auto [mesh, geometry] = joined_box(3, 3);
  const PeriodicPoints periodic(mesh, geometry);
  std::vector<double> ones(mesh.points.n_local(), 1.0);
  periodic.add_up(ones, 1);
  for (Index v = 0; v < mesh.points.n_local(); ++v) {
    int sides = 0;
    for (const int c : {0, 1}) {
      const double x = geometry.points[v][c];
      sides += x < 1e-9 || x > 1 - 1e-9 ? 1 : 0;
    }
    EXPECT_EQ(ones[v], 1 << sides);
  }
  ones.assign(ones.size(), 0.5);
  EXPECT_EQ(periodic.largest_gap(ones, 1), 0);
  for (Index v = 0; v < mesh.points.n_local(); ++v) ones[v] = geometry.points[v].x();
  EXPECT_NEAR(periodic.largest_gap(ones, 1), 1, 1e-12);
  const LoadedMesh plain =
      distribute(MPI_COMM_SELF, make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3::Zero(), Vec3::Ones()));
  EXPECT_TRUE(PeriodicPoints(plain.mesh, plain.geometry).empty());
}

/// A plate in a square whose left and right sides are joined.
Parameters plate_between_joined_sides(Method method) {
  Parameters p = plate_in_a_square(method);
  p.boundaries["left"] = {BoundaryMotion::periodic, {}, "right"};
  p.boundaries["right"] = {BoundaryMotion::periodic, {}, "left"};
  p.boundaries["plate"].prescribed.translation = {{"0.3*t"}, {"0.2*t"}};
  return p;
}

/// By every method that knows such sides; restarted and on any number of ranks.
TEST(Periodic, sides_move_alike_from_a_checkpoint_too) {
  for (const Method method : {Method::laplacian, Method::pseudo_solid}) {
    Parameters p = plate_between_joined_sides(method);
    p.linear.relative_tolerance = 1e-10;
    Mover mover(p, context());
    mover.initialise();
    run(mover, 0, 0.5, 1);
    const support::SavedState checkpoint(mover);
    run(mover, 0.5, 1, 1);
    const std::vector<double> end = mover.displacement();
    const PeriodicPoints periodic(mover.mesh(), mover.geometry());
    EXPECT_LT(periodic.largest_gap(end, 2), 1e-12);
    double sideways = 0;  // the joined sides go along with the plate
    for (const Index v : periodic.points()) sideways = std::max(sideways, end[2 * std::size_t(v)]);
    EXPECT_GT(max(MPI_COMM_WORLD, sideways), 0.02);
    checkpoint.load_into(mover);
    run(mover, 0.5, 1, 1);
    EXPECT_EQ(mover.displacement(), end);
    Mover reference(p, alone());
    reference.initialise();
    run(reference, 0, 1, 2);
    EXPECT_LT(difference_to(reference, mover, end), method == Method::pseudo_solid ? 1e-7 : 1e-9);
  }
}

std::string refusal(const Parameters& p) {
  return support::error_of([&] {
    Mover mover(p, context());
    run(mover, 0, 1, 1);
  });
}

TEST(Periodic, what_cannot_be_is_refused_by_name) {
  const Parameters good = plate_between_joined_sides(Method::laplacian);
  EXPECT_EQ(refusal(good), "");
  Parameters p = good;
  p.boundaries["left"].partner = "lid";
  EXPECT_THAT(refusal(p), ::testing::HasSubstr("boundaries.left: its partner 'lid' must be another patch"));
  p = good;  // the floor's two ends are one point
  p.boundaries["floor"].motion = BoundaryMotion::moving;
  p.boundaries["floor"].prescribed.displacement = {{"0"}, {"0.01*x*t"}};
  EXPECT_THAT(refusal(p), ::testing::HasSubstr("separates the two sides of periodic patches by 0.0"));
}

}  // namespace couplet::mesh_mover::test::periodic_test
