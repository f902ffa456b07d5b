// SPDX-License-Identifier: Apache-2.0
// The step on a moving mesh as it is timed beside other programs by benchmarks/fluid: a cylinder that swings
// across a channel flow (Re = 100), the mesh follows by the Laplacian, solved in every step.
#include <ctime>

#include "common/mesh/load.hpp"
#include "fluid_solver/step/fluid.hpp"
#include "mesh_mover/methods.hpp"
#include "tests/support/test.hpp"

namespace couplet::fluid::moving_cylinder_test {

constexpr double amplitude = 0.02, frequency = 2, dt = 5e-4;  // [m], [1/s], [s]
constexpr double omega = 2 * std::numbers::pi * frequency;
constexpr int warm_up = 20, steps = 200;

FluidParameters channel() {
  FluidParameters p;
  p.dimension = 2;
  p.density = 1;
  p.viscosity = 1e-3;
  p.time_step = dt;
  p.initial_velocity = {{"1"}, {"0"}};
  BoundaryParameters inlet, outlet, wall, cylinder;
  inlet.type = BoundaryType::inlet;
  inlet.velocity = {{"6*y*(0.41-y)/0.41^2"}, {"0"}};
  outlet.type = BoundaryType::outlet;
  wall.type = BoundaryType::no_slip;
  cylinder.type = BoundaryType::interface;
  p.boundaries = {{"inlet", inlet}, {"outlet", outlet}, {"walls", wall}, {"cylinder", cylinder}};
  return p;
}

mesh_mover::Parameters motion() {
  mesh_mover::Parameters p;
  p.dimension = 2;
  for (const char* patch : {"inlet", "outlet", "walls"})
    p.boundaries[patch].motion = mesh_mover::BoundaryMotion::fixed;
  p.boundaries["cylinder"].motion = mesh_mover::BoundaryMotion::interface;
  return p;
}

/// One step to t + dt: mesh motion, then the flow.
void step(Fluid<2>& fluid, mesh_mover::Laplacian& laplacian, const mesh::Mesh& mesh,
          const mesh::Geometry& geometry, double t) {
  std::vector<double> prescribed(2 * geometry.points.size(), 0.0);
  for (const Index point : laplacian.interface_points())
    prescribed[2 * point + 1] = amplitude * std::sin(omega * (t + dt));
  const std::vector<double> displacement = laplacian.solve(prescribed);
  std::vector<Vec3> points = geometry.points;
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].head<2>() += Eigen::Map<const Vec<2>>(displacement.data() + 2 * i);
  Vectors<2> w(mesh.boundary.n_owned(), Vec<2>::Zero());
  for (std::size_t b = 0; b < w.size(); ++b)
    if (fluid.boundary().is_interface(static_cast<Index>(b)))
      w[b].y() = amplitude * omega * std::cos(omega * (t + dt));
  fluid.begin_step(t, dt);
  fluid.solve(points, w);
  fluid.accept();
}

double mean_divergence(const Fluid<2>& fluid) {
  const mesh::Mesh& mesh = fluid.mesh();
  const State<2>& s = fluid.state();
  std::vector<double> out(mesh.cells.n_local(), 0.0);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    out[mesh.owner[f]] += s.phi[f];
    if (f < mesh.n_interior) out[mesh.neighbour[f]] -= s.phi[f];
  }
  double sum = 0, volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    sum += std::abs(out[c]);
    volume += s.placement->volume[c];
  }
  return sum / volume;
}

class MovingCylinder : public testing::TestWithParam<double> {};

TEST_P(MovingCylinder, keeps_its_mass_while_it_is_timed) {
  const auto [mesh, geometry] = mesh::load_mesh(MPI_COMM_SELF, COUPLET_CYLINDER, 2, {{"n", 50}});
  FluidParameters parameters = channel();
  parameters.pressure_tolerance = GetParam();
  Fluid<2> fluid(mesh, geometry, parameters, true);
  mesh_mover::Laplacian laplacian(mesh, geometry, motion());
  std::clock_t ticks = 0;
  double divergence = 0;  // mean over the timed steps
  for (int i = 0; i < steps; ++i) {
    const std::clock_t start = std::clock();
    step(fluid, laplacian, mesh, geometry, i * dt);
    if (i < warm_up) continue;
    ticks += std::clock() - start;
    divergence += mean_divergence(fluid) / (steps - warm_up);
  }
  const double seconds = static_cast<double>(ticks) / CLOCKS_PER_SEC;
  RecordProperty("cells", std::to_string(mesh.cells.n_owned()));
  RecordProperty("cells_steps_per_second",
                 std::to_string(double(mesh.cells.n_owned()) * (steps - warm_up) / seconds));
  RecordProperty("mean_divergence", std::to_string(1e9 * divergence));  // [1e-9/s]
  EXPECT_LT(divergence, 1e-2 * GetParam() / dt);
  double largest = 0;
  for (const Index point : laplacian.interface_points())
    largest = std::max(largest, std::abs(fluid.state().points[point].y() - geometry.points[point].y() -
                                         amplitude * std::sin(omega * steps * dt)));
  EXPECT_LT(largest, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Tolerances, MovingCylinder, testing::Values(1e-6, 3e-6, 1e-5));

}  // namespace couplet::fluid::moving_cylinder_test
