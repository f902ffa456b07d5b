// SPDX-License-Identifier: Apache-2.0
// Lid-driven cavity, Re = 100, against Ghia, Ghia, Shin, J. Comput. Phys. 48 (1982) 387, tables I and II.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "common/fv/vertex_interpolation.hpp"
#include "common/io/probes/probe.hpp"
#include "fluid_case.hpp"

namespace couplet::fluid::test::cavity_test {
namespace {

/// First two columns (place, value at Re = 100).
std::vector<std::pair<double, double>> read_table(const std::string& name) {
  std::ifstream file(std::string(COUPLET_TEST_DATA) + "/" + name);
  std::vector<std::pair<double, double>> rows;
  for (std::string line; std::getline(file, line);) {
    double place = 0, value = 0;
    char comma = 0;
    if (std::istringstream(line) >> place >> comma >> value) rows.emplace_back(place, value);
  }
  return rows;
}

/// Largest deviation along a centre line; `component` of u at (0.5, s) or (s, 0.5).
double deviation(const FluidCase<2>& c, const std::string& table, int component) {
  const mesh::Mesh& mesh = c.mesh();
  const mesh::Geometry& geometry = c.geometry();
  const fv::VertexInterpolation interpolation(
      mesh, geometry, std::vector<fv::PatchStencil>(mesh.patches.size(), fv::PatchStencil::open));
  std::vector<double> at_points(mesh.points.n_local() * 2, 0.0);
  for (Index p = 0; p < mesh.points.n_local(); ++p) {
    if (interpolation.nodes(p).empty()) continue;
    const Vec<2> u = interpolation.scalar_at<2>(p, flat<2>(c.state().u), flat<2>(c.state().u_boundary));
    at_points[2 * p] = u[0];
    at_points[2 * p + 1] = u[1];
  }
  double worst = 0;
  const auto rows = read_table(table);
  EXPECT_EQ(rows.size(), 17u);
  for (const auto& [place, value] : rows) {
    if (place == 0 || place == 1) continue;  // on the wall: the boundary value itself
    const io::Probe probe(mesh, geometry.points, "ghia",
                          component == 0 ? Vec3(0.5, place, 0) : Vec3(place, 0.5, 0));
    const double computed = probe.sample(at_points, 2)[component];
    worst = std::max(worst, std::abs(computed - value));
  }
  return worst;
}

TEST(Cavity, agrees_with_ghia_at_reynolds_100_within_one_percent_of_the_lid_speed) {
  FluidParameters p;
  p.density = 1;
  p.viscosity = 0.01;
  p.pressure_tolerance = 1e-5;
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  FluidCase<2> c(MPI_COMM_SELF,
                 mesh::make_box(mesh::BoxCells::quadrilaterals, {64, 64, 1}, Vec3::Zero(), Vec3::Ones()), p);
  c.run(20, 20);
  const double u = deviation(c, "ghia_u_x0.5.csv", 0), v = deviation(c, "ghia_v_y0.5.csv", 1);
  printf("cavity Re 100, 64 x 64: largest deviation u %.4f v %.4f of the lid speed\n", u, v);
  RecordProperty("largest_deviation_u", std::to_string(u));
  RecordProperty("largest_deviation_v", std::to_string(v));
  EXPECT_LT(u, 0.01);
  EXPECT_LT(v, 0.01);
  // The result is steady: nothing drifts.
  const Vectors<2> before = c.state().u;
  c.run(24, 4);
  double drift = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    drift = std::max(drift, (c.state().u[i] - before[i]).norm());
  EXPECT_LT(drift, 2e-4);
}

}  // namespace
}  // namespace couplet::fluid::test::cavity_test
