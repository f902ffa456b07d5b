// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/elastic_kernel.hpp"

#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::elastic_kernel_test {
using namespace elastic;
using namespace mesh;

constexpr double mu = 1.1, lambda = 1.7;

struct Case {
  BoxCells cells;
  double perturbation;
};
const std::vector<Case> all_cases = {{BoxCells::quadrilaterals, 0}, {BoxCells::quadrilaterals, 0.2},
                                     {BoxCells::triangles, 0.2},    {BoxCells::hexahedra, 0},
                                     {BoxCells::hexahedra, 0.2},    {BoxCells::tetrahedra, 0.2},
                                     {BoxCells::prisms, 0.2},       {BoxCells::mixed, 0.2}};

/// With `materials`: two zones, left and right of a plane in the middle.
LoadedMesh make_mesh(const Case& c, int n = 4, bool materials = false) {
  RawMesh raw = make_box(c.cells, {n + 1, n, n}, Vec3(0.1, 0.2, 0.3), Vec3(1.1, 1.0, 1.4));
  if (materials) {
    raw.zones = {"left", "right"};
    raw.materials = {{"left"}, {"right"}};
    for (std::size_t i = 0; i < raw.cell_zone.size(); ++i) {
      double x = 0;
      for (const Index p : raw.cell_points[static_cast<Index>(i)]) x += raw.points[p][0];
      raw.cell_zone[i] = x / double(raw.cell_points[static_cast<Index>(i)].size()) > 0.5;
    }
  }
  if (c.perturbation > 0) perturb_interior(raw, c.perturbation, 7);
  return distribute(MPI_COMM_WORLD, raw);
}

/// An operator and its kernel; the first patches get the conditions given, the others are open.
struct Setting {
  Setting(const Case& c, FaceGradientScheme scheme, std::vector<BoundaryRow> first, int n = 4)
      : loaded(make_mesh(c, n)),
        rows(mesh, geometry, padded(first), {mu, lambda}),
        kernel(mesh, rows, scheme) {}
  Setting(const Case& c, FaceGradientScheme scheme, bool materials)
      : loaded(make_mesh(c, 4, materials)),
        rows(mesh, geometry, all_conditions(), {lame(), materials ? mesh.cell_zone : std::vector<int>{}}),
        kernel(mesh, rows, scheme) {}

  /// xmin known, xmax held along an oblique direction and by springs, ymin a plane of symmetry, ymax without
  /// normal gradient, the rest open.
  ElasticBoundary all_conditions() const {
    const Vec3 along = Vec3(2, 1, mesh.dim == 3 ? -1 : 0).normalized();
    const BoundaryRow support =
        support_row(along * along.transpose(), Vec3(0.3, 0.5, mesh.dim == 3 ? 0.2 : 0).asDiagonal());
    return boundary_of_patches(mesh, padded({fixed_row(), support, mirror_row(), level_row()}));
  }
  std::vector<LameConstants> lame() const {
    std::vector<LameConstants> result;
    for (const int zone : mesh.cell_zone) result.push_back({mu * (1 + 2 * zone), lambda});
    return result;
  }
  std::vector<BoundaryRow> padded(std::vector<BoundaryRow> c) const {
    c.resize(mesh.patches.size(), free_row());
    return c;
  }
  std::size_t n_known() const { return rows.n_known() * mesh.dim; }

  /// Unknowns and known values of a field.
  template <class Field>
  void sample(const Field& field, std::vector<double>& unknowns, std::vector<double>& known) const {
    const auto put = [&](const Vec3& x, std::vector<double>& to) {
      const Vec3 u = field(x);
      to.insert(to.end(), u.data(), u.data() + mesh.dim);
    };
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) put(geometry.cell_centre[c], unknowns);
    for (const Index f : rows.unknown_faces()) put(geometry.face_centre[f], unknowns);
    for (const Index v : rows.constraints().points()) put(geometry.points[v], known);
    for (const Index f : rows.known_faces()) put(geometry.face_centre[f], known);
  }

  LoadedMesh loaded;
  const Mesh& mesh = loaded.mesh;
  const Geometry& geometry = loaded.geometry;
  ElasticOperator rows;
  ElasticKernel kernel;
};

// xmin known, ymin a symmetry plane, the others open: all kinds, and the edges where they meet.
const std::vector<BoundaryRow> all_kinds = {fixed_row(), free_row(), mirror_row()};

/// The kernel beside the assembled matrix and its known columns.
void expect_the_rows_of_the_matrix(const Setting& s) {
  std::mt19937 random(17 + parallel::comm_rank(MPI_COMM_WORLD));
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<double> u(s.rows.n_unknowns()), known;
  for (double& x : u) x = number(random);
  std::vector<double> expected(u.size()), got(u.size());
  s.rows.matrix({}).multiply(u, expected);
  s.kernel.apply(u, {}, got);
  double scale = 1e-300;
  for (const double x : expected) scale = std::max(scale, std::abs(x));
  for (std::size_t i = 0; i < u.size(); ++i) ASSERT_NEAR(got[i], expected[i], 1e-12 * scale);

  // Known values are those of a field, so that what ranks share agrees.
  u.clear();
  s.sample(
      [](const Vec3& x) { return Vec3(std::sin(3 * x[1]), x[0] * x[2] + x[1], std::cos(2 * x[0] + x[1])); },
      u, known);
  std::fill(expected.begin(), expected.end(), 0.0);
  s.rows.subtract_known(known, expected);
  std::vector<double> without(u.size());
  s.kernel.apply(u, {}, without);
  s.kernel.apply(u, known, got);
  for (std::size_t i = 0; i < u.size(); ++i) ASSERT_NEAR(got[i] - without[i], -expected[i], 1e-12 * scale);
}

TEST(ElasticKernel, thesis_rows_are_those_of_the_assembled_matrix) {
  for (const Case& c : all_cases)
    expect_the_rows_of_the_matrix(Setting(c, FaceGradientScheme::thesis, all_kinds));
}

TEST(ElasticKernel, thesis_rows_of_supports_and_springs_are_those_of_the_assembled_matrix) {
  for (const Case& c : all_cases)
    expect_the_rows_of_the_matrix(Setting(c, FaceGradientScheme::thesis, false));
}

TEST(ElasticKernel, thesis_rows_between_materials_are_those_of_the_assembled_matrix) {
  for (const Case& c : all_cases) expect_the_rows_of_the_matrix(Setting(c, FaceGradientScheme::thesis, true));
}

// Two materials with the same constants: a linear field through both, its forces in balance on the faces
// between them.
TEST(ElasticKernel, linear_fields_pass_from_one_material_into_the_next) {
  constexpr FaceGradientScheme scheme = FaceGradientScheme::thesis;
  for (const Case& c : all_cases) {
    const auto [mesh, geometry] = make_mesh(c, 4, true);
    std::vector<BoundaryRow> conditions(mesh.patches.size(), fixed_row());
    const ElasticOperator rows(mesh, geometry, boundary_of_patches(mesh, conditions),
                               {{{mu, lambda}}, mesh.cell_zone});
    const ElasticKernel kernel(mesh, rows, scheme);
    const auto field = [&](const Vec3& x) {
      return Vec3(0.3 * x[0] - x[1], x[2] + 0.5 * x[1], mesh.dim == 3 ? x[0] : 0);
    };
    std::vector<double> u, known;
    const auto put = [&](const Vec3& x, std::vector<double>& to) {
      const Vec3 value = field(x);
      to.insert(to.end(), value.data(), value.data() + mesh.dim);
    };
    for (Index i = 0; i < mesh.cells.n_owned(); ++i) put(geometry.cell_centre[i], u);
    for (const Index f : rows.unknown_faces()) put(geometry.face_centre[f], u);
    for (const Index v : rows.constraints().points()) put(geometry.points[v], known);
    for (const Index f : rows.known_faces()) put(geometry.face_centre[f], known);
    EXPECT_GT(parallel::sum(MPI_COMM_WORLD, GlobalIndex(rows.unknown_faces().size())), 0);
    std::vector<double> force(u.size());
    kernel.apply(u, known, force);
    for (const double x : force) ASSERT_NEAR(x, 0, 1e-11);
  }
}

TEST(ElasticKernel, linear_fields_have_their_exact_constant_stress) {
  constexpr FaceGradientScheme scheme = FaceGradientScheme::thesis;
  for (const Case& c : all_cases) {
    const Setting s(c, scheme, {fixed_row()});
    Tensor3 gradient;
    gradient << 0.3, -0.7, 0.2, 0.5, 0.9, -0.4, 0.1, 0.8, -0.6;  // entry (i, j) = d u_j / d x_i
    if (s.mesh.dim == 2) {
      gradient.row(2).setZero();
      gradient.col(2).setZero();
    }
    std::vector<double> u, known;
    s.sample([&](const Vec3& x) { return Vec3(gradient.transpose() * x + Vec3(0.3, -0.2, 0.1)); }, u, known);
    std::vector<Tensor3> found(s.mesh.n_flux_faces());
    s.kernel.face_gradients(
        u, known, [&](Index f, const Tensor3& g) { found[f] = g; }, 0, s.mesh.n_flux_faces());
    for (const Tensor3& g : found)
      ASSERT_LT((g - gradient).topLeftCorner(s.mesh.dim, s.mesh.dim).norm(), 1e-11);
    std::vector<double> points(std::size_t(s.mesh.points.n_local()) * s.mesh.dim), force(u.size());
    s.kernel.point_values(u, known, points);
    s.kernel.apply(u, known, force);
    const Tensor3 stress = s.rows.stress(0, gradient);
    const std::size_t n_cells = s.mesh.cells.n_owned();
    for (std::size_t i = 0; i < s.rows.unknown_faces().size(); ++i)
      for (int a = 0; a < s.mesh.dim; ++a)
        ASSERT_NEAR(force[(n_cells + i) * s.mesh.dim + a],
                    (stress * s.geometry.face_area[s.rows.unknown_faces()[i]])[a], 1e-11);
  }
}

TEST(ElasticKernel, a_symmetry_plane_keeps_a_symmetric_linear_field_exact) {
  constexpr FaceGradientScheme scheme = FaceGradientScheme::thesis;
  for (const Case& c : all_cases) {
    const Setting s(c, scheme, all_kinds);
    const Vec3 slope(0.3, -0.5, s.mesh.dim == 3 ? 0.7 : 0.0);
    std::vector<double> u, known;
    // Symmetric about y = 0.2, where ymin lies.
    s.sample(
        [&](const Vec3& x) {
          return Vec3(slope[0] * x[0] + 0.4 * x[2], slope[1] * (x[1] - 0.2), slope[2] * x[2]);
        },
        u, known);
    std::vector<Tensor3> found(s.mesh.n_flux_faces());
    s.kernel.face_gradients(
        u, known, [&](Index f, const Tensor3& g) { found[f] = g; }, 0, s.mesh.n_flux_faces());
    Tensor3 exact = slope.asDiagonal();
    if (s.mesh.dim == 3) exact(2, 0) = 0.4;
    for (const Tensor3& g : found) ASSERT_LT((g - exact).topLeftCorner(s.mesh.dim, s.mesh.dim).norm(), 1e-11);
  }
}

// Hence no gradient along the plane has a part across it, whatever the displacement is.
TEST(ElasticKernel, no_vertex_of_a_symmetry_plane_moves_across_it) {
  constexpr FaceGradientScheme scheme = FaceGradientScheme::thesis;
  for (const Case& c : all_cases) {
    const Setting s(c, scheme, all_kinds);
    std::mt19937 random(17 + parallel::comm_rank(MPI_COMM_WORLD));
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<double> u(s.rows.n_unknowns()), points(std::size_t(s.mesh.points.n_local()) * s.mesh.dim, 0);
    for (double& x : u) x = number(random);
    s.kernel.point_values(u, {}, points);
    double along = 0, across = 0;
    for (const Patch& patch : s.mesh.patches)
      for (Index f = patch.first; patch.name == "ymin" && f < patch.first + patch.count; ++f)
        for (const Index v : s.mesh.face_points[f]) {
          along = std::max(along, std::abs(points[v * s.mesh.dim]));
          across = std::max(across, std::abs(points[v * s.mesh.dim + 1]));
        }
    EXPECT_LT(across, 1e-13);
    EXPECT_GT(parallel::max(MPI_COMM_WORLD, along), 0.1);
  }
}

}  // namespace couplet::elastic_kernel_test
