// SPDX-License-Identifier: Apache-2.0
// Large strain in time: rigid rotation, a pressure that turns with its surface, energy and momenta of a free body.
#include "tests/verification/solid/finite_support.hpp"

namespace couplet::testing::finite_motion_test {
using namespace mesh;

// All faces turn by 720 degrees about an oblique place: no stress, whatever the angle.
TEST(FiniteStrain, rigid_rotation_makes_no_stress) {
  SolidParameters p = box_parameters(3);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  const std::string turn = fmt::format("({:.17g}*t)", 4 * std::numbers::pi);
  for (const char* name : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
    p.boundaries[name] =
        boundary(Type::fixed_displacement, {"(cos(" + turn + ")-1)*x - sin(" + turn + ")*(y-3)",
                                            "sin(" + turn + ")*x + (cos(" + turn + ")-1)*(y-3)", "0"});
  for (const BoxCells cells :
       {BoxCells::hexahedra, BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed}) {
    RawMesh raw = make_box(cells, {3, 3, 3}, Vec3::Zero(), Vec3::Ones());
    perturb_interior(raw, 0.2, 5);
    for (const char* law : {"saint-venant-kirchhoff"}) {
      p.material.law = law;
      const auto solid = make_solid(raw, p);
      double most = 0;
      for (int i = 0; i < 12; ++i) {
        step(*solid, 1. / 12);
        for (const Tensor3& s : solid->fields().cell_stress(solid->fields().point_displacement()))
          most = std::max(most, s.cwiseAbs().maxCoeff());
      }
      EXPECT_LT(parallel::max(solid->body().mesh().comm, most), 1e-9 * p.material.youngs_modulus) << law;
    }
  }
}

// A pressure on all of a closed surface that turns and deforms leaves no resultant; on one side it is p times the
// present area.
TEST(FiniteStrain, pressure_follows_the_surface) {
  SolidParameters p = busy(2, MethodParameters::VolumeStrain::faces);
  p.boundaries["ymin"] = boundary(Type::free);
  p.boundaries["ymax"].pressure = {"2e3*t"};
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {40, 4, 1}, Vec3::Zero(), Vec3(10, 1, 0));
  const auto solid = make_solid(raw, p);
  for (int i = 0; i < 5; ++i) step(*solid, 0.2);
  const std::vector<double> u = solid->fields().point_displacement();
  Vec3 ends[2] = {Vec3::Zero(), Vec3::Zero()};
  for (std::size_t v = 0; v < solid->body().geometry().points.size(); ++v)
    for (int k = 0; k < 2; ++k)
      if ((solid->body().geometry().points[v] - Vec3(10 * k, 1, 0)).norm() < 1e-9)
        ends[k] = solid->body().geometry().points[v] + Vec3(u[2 * v], u[2 * v + 1], 0);
  for (Vec3& end : ends)
    for (int a = 0; a < 3; ++a) {
      const double most = parallel::max(MPI_COMM_WORLD, end[a]),
                   least = parallel::min(MPI_COMM_WORLD, end[a]);
      end[a] = std::abs(most) > std::abs(least) ? most : least;
    }
  const Vec3 along = ends[1] - ends[0];
  EXPECT_LT(along[1], -1.5);  // far from where it was
  const auto reactions = solid->fields().reactions(u);
  const Vec3 load = 2e3 * Vec3(along[1], -along[0], 0);
  EXPECT_LT((reactions[0].force + load).norm(), 1e-6 * load.norm());
  EXPECT_LT((solid->fields().total_load() - load).norm(), 1e-9 * load.norm());
}

/// Linear momentum, angular momentum about the origin and energy of a free body that spins and swings.
std::array<double, 7> kept(const Solid& solid) {
  const elastic::ElasticKernel kernel(solid.body().mesh(), solid.body().elastic(),
                                      elastic::FaceGradientScheme::symmetric);
  kernel.set_density(std::vector<double>(solid.body().mesh().cells.n_local(), 1000.));
  const Mesh& mesh = solid.body().mesh();
  const Geometry& geometry = solid.body().geometry();
  std::vector<double> v, momentum(solid.body().elastic().n_unknowns());
  std::vector<Vec3> x;
  const auto add = [&](const Vec3& place, std::size_t i, const std::vector<double>& us,
                       const std::vector<double>& vs) {
    x.push_back(place + Vec3(us[3 * i], us[3 * i + 1], us[3 * i + 2]));
    for (int a = 0; a < 3; ++a) v.push_back(vs[3 * i + std::size_t(a)]);
  };
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    add(geometry.cell_centre[c], std::size_t(c), solid.stepper().state().cell_u,
        solid.stepper().state().cell_v);
  for (const Index f : solid.body().elastic().unknown_faces())
    add(geometry.face_centre[f], std::size_t(f - mesh.n_interior), solid.stepper().state().face_u,
        solid.stepper().state().face_v);
  kernel.apply_with_mass(v, {}, 1, false, momentum);
  std::array<double, 7> result{};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 p(momentum[3 * i], momentum[3 * i + 1], momentum[3 * i + 2]), spin = x[i].cross(p);
    for (std::size_t a = 0; a < 3; ++a) result[a] += p[Index(a)], result[3 + a] += spin[Index(a)];
  }
  for (double& r : result) r = parallel::sum(MPI_COMM_WORLD, r);
  const SolidEnergies e = energies(solid);
  result[6] = e.kinetic + e.strain;
  return result;
}

std::array<double, 3> drifts(BoxCells cells, bool conserving) {
  SolidParameters p = box_parameters(3);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1000, 1e6, 0.45};
  p.material.law = "nearly-incompressible-neo-hookean";
  p.output.energies = true;
  p.energy_momentum = conserving;
  p.method.relative_tolerance = 1e-12;
  for (const char* v : {"-10*(y-0.5) + 8*(x-1)", "10*(x-1) - 5*(y-0.5)", "1 + 2*(z-0.5)"})
    p.initial_velocity.push_back({v});
  const auto solid = make_solid(make_box(cells, {3, 2, 2}, Vec3::Zero(), Vec3(2, 1, 1)), p);
  const auto before = kept(*solid);
  for (int i = 0; i < 40; ++i) step(*solid, 0.01);
  const auto after = kept(*solid);
  double linear = 0, angular = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    linear = std::max(linear, std::abs(after[a] - before[a]));
    angular = std::max(angular, std::abs(after[3 + a] - before[3 + a]));
  }
  return {linear / std::abs(before[2]), angular / std::abs(before[5]), std::abs(after[6] / before[6] - 1)};
}

TEST(FiniteStrain, conserving_stress_keeps_energy_and_momenta) {
  for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra}) {
    const auto [linear, angular, energy] = drifts(cells, true);
    EXPECT_LT(linear, 1e-11);
    EXPECT_LT(angular, 1e-10);
    EXPECT_LT(energy, 1e-9);
  }
  // Its neighbour: the stress in the middle keeps momenta, and energy to second order only.
  const auto [linear, angular, energy] = drifts(BoxCells::hexahedra, false);
  EXPECT_LT(angular, 1e-10);
  EXPECT_GT(energy, 1e-7);
}

}  // namespace couplet::testing::finite_motion_test
