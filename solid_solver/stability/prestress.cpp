// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/stability/prestress.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/mesh/mesh.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

elastic::Prestress prestress_of(const SolidBody& body, const SolidFields& fields, double time) {
  const mesh::Geometry& geometry = body.geometry();
  const mesh::Mesh& mesh = body.mesh();
  return {fields.face_stress(0, mesh.n_flux_faces(), fields.point_displacement()),
          elastic::pressure_stiffness(mesh, geometry, body.boundaries().pressures(time))};
}

double compression(const mesh::Mesh& mesh, const elastic::Prestress& prestress) {
  double least = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    Tensor3 s = prestress.stress[std::size_t(f)];
    if (mesh.dim == 2) s.row(2).setZero(), s.col(2).setZero();
    Eigen::SelfAdjointEigenSolver<Tensor3> solver;
    solver.computeDirect(s, Eigen::EigenvaluesOnly);
    least = std::min(least, solver.eigenvalues()[0]);
  }
  return -parallel::min(mesh.comm, least);
}

std::vector<double> any_start(const SolidBody& body) {
  const mesh::Geometry& geometry = body.geometry();
  const mesh::Mesh& mesh = body.mesh();
  const mesh::Extent box = mesh::extent_of(mesh, geometry);
  const double size = box.diagonal();
  std::vector<double> start;
  const auto add = [&](const Vec3& x) {
    const Vec3 s = (x - box.lower) / size;
    for (int a = 0; a < mesh.dim; ++a) {
      double value = 0;
      for (int k = 1; k <= 4; ++k)
        value += std::sin(k * (2.1 * s[0] + 2.7 * s[1] + 3.3 * s[2]) + 0.7 + 1.9 * a + 0.37 * k) / (k * k);
      start.push_back(value);
    }
  };
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) add(geometry.cell_centre[c]);
  for (const Index f : body.elastic().unknown_faces()) add(geometry.face_centre[f]);
  return start;
}

}  // namespace couplet::solid
