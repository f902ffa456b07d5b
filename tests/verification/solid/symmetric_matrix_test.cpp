// SPDX-License-Identifier: Apache-2.0
// The symmetric operator with the vertices as unknowns of their own: the kernel's rows, their inverse and their inertia.
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/elasticity/finite/stress_stiffness.hpp"
#include "solid_solver/analysis/modal_analysis.hpp"
#include "tests/verification/solid/linear_field.hpp"

namespace couplet::testing::symmetric_matrix_test {
using namespace elastic;
using namespace mesh;
using namespace parallel;

using Volume = MethodParameters::VolumeStrain;

struct Scene {
  const char* name;
  BoxCells cells;
  Volume volume = Volume::automatic;
  bool with_planes = false, with_springs = false, is_orthotropic = false;
};

SolidParameters parameters(const Scene& scene) {
  const int dim = dimension_of(scene.cells);
  SolidParameters p = box_parameters(dim);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.method.face_gradient = FaceGradient::symmetric;
  p.method.volume_strain = scene.volume;
  p.material = {2000, 1e6, 0.3};
  p.boundaries["xmin"] = clamped(dim);
  if (scene.with_planes) p.boundaries["xmin"] = p.boundaries["ymin"] = boundary(Type::symmetry);
  if (scene.with_springs) {
    p.boundaries["xmax"] = sprung("3e5");
  }
  if (scene.is_orthotropic) {
    p.material = {1600, 0, 0};
    p.material.orthotropic.emplace();
    p.material.orthotropic->youngs_moduli = {15e6, 1e6, 0.9e6};
    p.material.orthotropic->poissons_ratios = {0.3, 0.4, 0.25};
    p.material.orthotropic->shear_moduli = {5e5, 3.2e5, 4.5e5};
  }
  return p;
}

class Tied : public ::testing::TestWithParam<Scene> {};

std::vector<double> any_motion(std::size_t n, int rank) {
  std::mt19937 generator(unsigned(7 + rank));
  std::uniform_real_distribution<double> value(-1, 1);
  std::vector<double> u(n);
  for (double& v : u) v = value(generator);
  return u;
}

double gap(MPI_Comm comm, std::span<const double> a, std::span<const double> b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference += (a[i] - b[i]) * (a[i] - b[i]), size += b[i] * b[i];
  return std::sqrt(sum(comm, difference) / sum(comm, size));
}

std::vector<double> densities(const SolidBody& body) {
  std::vector<double> result;
  for (Index c = 0; c < body.mesh().cells.n_owned(); ++c) result.push_back(body.density(c));
  return result;
}

TEST_P(Tied, is_the_kernels_operator_and_its_factors_the_inverse) {
  const auto solid = make_solid(distorted_box(GetParam().cells), parameters(GetParam()));
  const SolidBody& body = solid->body();
  const MPI_Comm comm = body.mesh().comm;
  const std::size_t n = body.elastic().n_unknowns();
  const std::vector<double> u = any_motion(n, comm_rank(comm)), density = densities(body);
  std::vector<double> wanted(n), found(n), back(n);
  constexpr double factor = 300;
  body.kernel().apply_with_mass(u, {}, factor, true, wanted);
  TiedMatrix tied(body.mesh(), body.elastic(), {.mass = factor, .density = density});
  tied.apply(u, found);
  EXPECT_LT(gap(comm, found, wanted), 1e-12);
  tied.factorise();
  tied.solve(wanted, back);
  EXPECT_LT(gap(comm, back, u), 1e-9);
  EXPECT_EQ(tied.negative(), 0);
}

/// The rows of the nodes alone: the preconditioner by factors, which needs one iteration where it is the operator.
TEST_P(Tied, is_the_matrix_of_nodes_with_its_mass) {
  const Scene& scene = GetParam();
  const bool shares = dimension_of(scene.cells) == 3 && scene.cells != BoxCells::hexahedra;
  if (shares) GTEST_SKIP() << "near the operator only";
  const auto solid = make_solid(distorted_box(scene.cells), parameters(scene));
  const SolidBody& body = solid->body();
  const std::size_t n = body.elastic().n_unknowns();
  const std::vector<double> u = any_motion(n, comm_rank(body.mesh().comm));
  std::vector<double> inertia = densities(body), wanted(n), found(n);
  constexpr double factor = 3e6;  // as large as the stiffness
  for (double& m : inertia) m *= factor;
  body.kernel().apply_with_mass(u, {}, factor, true, wanted);
  symmetric_matrix(body.mesh(), body.elastic(), inertia).multiply(u, found);
  EXPECT_LT(gap(body.mesh().comm, found, wanted), 1e-12);
}

TEST_P(Tied, counts_the_eigenvalues_below_a_shift) {
  const auto solid = make_solid(distorted_box(GetParam().cells), parameters(GetParam()));
  const SolidBody& body = solid->body();
  std::vector<double> values;
  for (const auto& v : eigenvalues(body)) values.push_back(v.real());
  double shift = values.size() > 8 ? 0.5 * (values[6] + values[7]) : 0;  // rank 0 has them
  shift = sum(body.mesh().comm, shift);
  const std::vector<double> density = densities(body);
  TiedMatrix tied(body.mesh(), body.elastic(), {.mass = -shift, .density = density});
  tied.factorise();
  EXPECT_EQ(tied.negative(), 7);
}

INSTANTIATE_TEST_SUITE_P(
    Solid, Tied,
    ::testing::Values(Scene{"quadrilaterals", BoxCells::quadrilaterals},
                      Scene{"triangles", BoxCells::triangles}, Scene{"hexahedra", BoxCells::hexahedra},
                      Scene{"tetrahedra", BoxCells::tetrahedra}, Scene{"mixed", BoxCells::mixed},
                      Scene{"tetrahedra_of_cells", BoxCells::tetrahedra, Volume::cells},
                      Scene{"mixed_shared", BoxCells::mixed, Volume::shared},
                      Scene{"tetrahedra_between_planes", BoxCells::tetrahedra, Volume::automatic, true},
                      Scene{"triangles_on_springs", BoxCells::triangles, Volume::automatic, false, true},
                      Scene{"tetrahedra_on_springs", BoxCells::tetrahedra, Volume::automatic, true, true},
                      Scene{"orthotropic_tetrahedra", BoxCells::tetrahedra, Volume::automatic, false, false,
                            true},
                      Scene{"orthotropic_prisms", BoxCells::prisms, Volume::automatic, false, true, true}),
    [](const auto& test) { return test.param.name; });

/// v . K_sigma v of a uniform stress under a linear field u = A x in a free box: volume sigma : A^T A.
TEST(TiedStress, does_the_work_of_the_stress_on_the_square_of_the_gradient) {
  for (const BoxCells cells :
       {BoxCells::quadrilaterals, BoxCells::tetrahedra, BoxCells::hexahedra, BoxCells::mixed}) {
    SCOPED_TRACE(name(cells));
    const int dim = dimension_of(cells);
    SolidParameters p = box_parameters(dim);
    p.analysis = SolidParameters::Analysis::dynamic;
    p.method.face_gradient = FaceGradient::symmetric;
    const auto solid = make_solid(distorted_box(cells), p);
    const SolidBody& body = solid->body();
    const Mesh& mesh = body.mesh();
    const Geometry& geometry = body.geometry();
    Tensor3 stress, gradient;
    stress << 3, -1, 0.5, -1, 2, 0.25, 0.5, 0.25, -4;
    gradient << 0.1, 0.7, -0.3, -0.2, 0.4, 0.6, 0.5, -0.8, 0.9;
    if (dim == 2) gradient.row(2).setZero(), gradient.col(2).setZero();
    std::vector<double> u;
    const auto add = [&](const Vec3& x) {
      const Vec3 v = gradient * x;
      u.insert(u.end(), v.data(), v.data() + dim);
    };
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) add(geometry.cell_centre[c]);
    for (const Index f : body.elastic().unknown_faces()) add(geometry.face_centre[f]);
    const Prestress prestress{std::vector<Tensor3>(std::size_t(mesh.n_flux_faces()), stress), {}};
    TiedMatrix tied(mesh, body.elastic(), {.stiffness = 0, .stress = 1, .prestress = &prestress});
    std::vector<double> force(u.size());
    tied.apply(u, force);
    double work = 0, volume = 0;
    for (std::size_t i = 0; i < u.size(); ++i) work += force[i] * u[i];
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += geometry.volume[c];
    work = sum(mesh.comm, work);
    volume = sum(mesh.comm, volume);
    const double wanted = volume * (stress * gradient.transpose() * gradient).trace();
    EXPECT_NEAR(work, wanted, 2e-3 * std::abs(wanted));  // warped faces fill a cell only nearly
  }
}

/// Any stress, and pressure that follows, on faces: with and without a matrix.
TEST_P(Tied, has_the_stress_stiffness_of_the_faces_loops) {
  const auto solid = make_solid(distorted_box(GetParam().cells), parameters(GetParam()));
  const SolidBody& body = solid->body();
  const Mesh& mesh = body.mesh();
  const Geometry& geometry = body.geometry();
  Prestress prestress;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Vec3& x = geometry.face_centre[f];
    Tensor3 s;
    s << std::sin(x[0]), x[1], x[2], x[1], 2 - x[0], 0.3, x[2], 0.3, std::cos(x[1]);
    if (mesh.dim == 2) s.row(2).setZero(), s.col(2).setZero();
    prestress.stress.push_back(s);
  }
  std::vector<double> pressure;
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    pressure.push_back(body.elastic().at(f).is_free() ? geometry.face_centre[f][0] : 0);
  prestress.loads = pressure_stiffness(mesh, geometry, pressure);
  const std::size_t n = body.elastic().n_unknowns();
  const std::vector<double> u = any_motion(n, comm_rank(mesh.comm));
  std::vector<double> wanted(n), found(n);
  StressStiffness(mesh, body.elastic(), prestress).apply(u, wanted);
  TiedMatrix(mesh, body.elastic(), {.stiffness = 0, .stress = 1, .prestress = &prestress}).apply(u, found);
  EXPECT_LT(gap(mesh.comm, found, wanted), 1e-12);
}

}  // namespace couplet::testing::symmetric_matrix_test
