// SPDX-License-Identifier: Apache-2.0
// Loads of the symmetric operator are the transposes of what it measures.
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/symmetric/surface_pressure.hpp"
#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::symmetric_loads_test {
using namespace elastic;
using namespace mesh;

constexpr LameConstants lame{1.1, 1.7};

std::vector<double> noise(std::size_t n, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(n);
  std::ranges::generate(values, [&] { return normal(engine); });
  return values;
}

template <int D>
void check(BoxCells cells) {
  RawMesh raw = make_box(cells, {4, 3, 3}, Vec3::Zero(), Vec3(1.1, 1.0, D == 3 ? 1.2 : 0));
  perturb_interior(raw, 0.2, 7);
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  std::vector<BoundaryRow> conditions(mesh.patches.size(), free_row());
  conditions[0] = fixed_row();
  conditions[1] = mirror_row();
  const ElasticOperator rows(mesh, geometry, conditions, lame);
  const ElasticKernel kernel(mesh, rows, FaceGradientScheme::symmetric);
  const std::vector<double> p = noise(std::size_t(mesh.n_faces()), 1), v = noise(rows.n_unknowns(), 2);
  std::vector<double> rhs(rows.n_unknowns(), 0);
  kernel.add_pressure(p, rhs);
  double work = 0, wanted = 0, size = 0;
  for (std::size_t i = 0; i < v.size(); ++i) work += rhs[i] * v[i];
  const auto take = [&](Index f, const Tensor3& gradient) {
    const double part = p[std::size_t(f)] * symmetric_rows(mesh, rows, f).volume * gradient.trace();
    wanted += part, size += std::abs(part);
  };
  kernel.face_gradients(v, {}, take, 0, mesh.n_flux_faces());
  EXPECT_GT(size, 1e-3);
  EXPECT_NEAR(work, wanted, 1e-11 * size);
}

class SymmetricLoads : public ::testing::TestWithParam<BoxCells> {};

// A thermal stress - p I works on the volume strain as the operator has it: on that of its faces, and of three-cornered faces on
// the one that they share with their edges.
TEST_P(SymmetricLoads, thermal_pressure_works_on_the_strain_that_faces_share_with_their_edges) {
  const bool plane = GetParam() == BoxCells::quadrilaterals || GetParam() == BoxCells::triangles;
  plane ? check<2>(GetParam()) : check<3>(GetParam());
}

template <int D>
void check_mass(BoxCells cells) {
  RawMesh raw = make_box(cells, {4, 3, 3}, Vec3::Zero(), Vec3(1.1, 1.0, D == 3 ? 1.2 : 0));
  perturb_interior(raw, 0.2, 7);
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  std::vector<BoundaryRow> conditions(mesh.patches.size(), free_row());
  conditions[0] = fixed_row();
  conditions[1] = mirror_row();
  const ElasticOperator rows(mesh, geometry, conditions, lame);
  const ElasticKernel kernel(mesh, rows, FaceGradientScheme::symmetric);
  ASSERT_TRUE(kernel.set_density(std::vector<double>(std::size_t(mesh.cells.n_local()), 2.5)));
  const std::vector<double> unknowns = noise(rows.n_unknowns(), 2), still(rows.n_unknowns(), 0),
                            known = noise(rows.n_known() * D, 3), held(known.size(), 0);
  const double moving = kernel.product(ElasticPart::mass, {unknowns, held}, {unknowns, held}),
               carried = kernel.product(ElasticPart::mass, {still, known}, {still, known}),
               between = kernel.product(ElasticPart::mass, {unknowns, held}, {still, known});
  EXPECT_GT(moving, 0);
  EXPECT_GT(carried, 0);
  EXPECT_LT(std::abs(between), 1e-14 * std::sqrt(moving * carried));
}

// Nodes and vertices have their mass, and a vertex that a face of known displacement touches follows such faces alone: so the
// inertia of what is known acts on nothing that is not, and the work on it needs no velocity of the rest.
TEST_P(SymmetricLoads, no_mass_belongs_to_known_and_unknown_displacements) {
  const bool plane = GetParam() == BoxCells::quadrilaterals || GetParam() == BoxCells::triangles;
  plane ? check_mass<2>(GetParam()) : check_mass<3>(GetParam());
}

// Areas are of second order in the displacements, so that the difference of two of them is the derivative exactly.
TEST_P(SymmetricLoads, tangent_of_a_follower_pressure_is_the_derivative_of_its_forces) {
  RawMesh raw = make_box(GetParam(), {3, 2, 2}, Vec3::Zero(), Vec3(1.1, 1.0, 1.2));
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  const ElasticOperator rows(mesh, geometry, std::vector<BoundaryRow>(mesh.patches.size(), free_row()), lame);
  SymmetricSpace space(mesh, rows);
  FollowerPressure pressure;
  pressure.set(mesh, geometry, noise(std::size_t(mesh.n_flux_faces() - mesh.n_interior), 1));
  const auto forces = [&](const std::vector<double>& u, const auto& add) {
    space.fill(u, {});
    space.clear_forces();
    add();
    const std::size_t places = space.n_nodes() + std::size_t(mesh.points.n_local());
    return std::vector<double>(space.forces(), space.forces() + places * SymmetricSpace::stride);
  };
  const std::vector<double> u = noise(rows.n_unknowns(), 2), v = noise(rows.n_unknowns(), 3);
  std::vector<double> there = u, back = u;
  for (std::size_t i = 0; i < u.size(); ++i) there[i] += v[i], back[i] -= v[i];
  const auto add = [&] { pressure.add_forces(space); };
  const std::vector<double> plus = forces(there, add), minus = forces(back, add);
  forces(u, add);
  const std::vector<double> tangent = forces(v, [&] { pressure.add_tangent(space); });
  double wrong = 0, size = 0;
  for (std::size_t i = 0; i < tangent.size(); ++i) {
    wrong = std::max(wrong, std::abs((plus[i] - minus[i]) / 2 - tangent[i]));
    size = std::max(size, std::abs(tangent[i]));
  }
  EXPECT_GT(size, 0.1);
  EXPECT_LT(wrong, 1e-12 * size);
}

INSTANTIATE_TEST_SUITE_P(All, SymmetricLoads,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed));

}  // namespace couplet::symmetric_loads_test
