// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/axisymmetric/axisymmetric_kernel.hpp"

namespace couplet::elastic {

AxisymmetricKernel::AxisymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows)
    : SpaceKernel<2>(mesh, rows), mesh_(mesh), rows_(rows) {
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;  // another rank's
    const AxisymmetricFace from = axisymmetric_face(mesh, rows, f);
    const LameConstants lame = face_lame(mesh, rows, f);
    Face face{{},
              {},
              from.volume * lame.mu,
              from.volume * lame.lambda,
              {mesh.owner[f], space_.node_across(f)},
              from.point,
              from.has_shear ? 1. : 0.};
    for (std::size_t i = 0; i < 4; ++i) {
      face.hoop[i] = from.hoop[i];
      for (std::size_t a = 0; a < 2; ++a) face.b[i][a] = from.b[i][a];
    }
    faces_.push_back(face);
  }
}

std::array<double, 4> AxisymmetricKernel::strain_of(const double (&b)[4][2], const double (&hoop)[4],
                                                    const std::array<const double*, 4>& u) const {
  std::array<double, 4> e{};
  for (std::size_t i = 0; i < 4; ++i) {
    e[0] += b[i][0] * u[i][0];
    e[1] += b[i][1] * u[i][1];
    e[2] += hoop[i] * u[i][0];
    e[3] += b[i][1] * u[i][0] + b[i][0] * u[i][1];
  }
  return e;
}

void AxisymmetricKernel::internal_forces() {
  const double *nodes = space_.nodes(), *points = space_.points();
  double *force = space_.forces(), *point_force = space_.point_forces();
  for (const Face& f : faces_) {
    const std::array<std::size_t, 4> at{std::size_t(f.node[0]) * stride, std::size_t(f.node[1]) * stride,
                                        std::size_t(f.point[0]) * stride, std::size_t(f.point[1]) * stride};
    const std::array<double, 4> e =
        strain_of(f.b, f.hoop, {nodes + at[0], nodes + at[1], points + at[2], points + at[3]});
    const double mean = f.lambda * (e[0] + e[1] + e[2]), shear = f.mu * f.shear * e[3];
    const double radial = mean + 2 * f.mu * e[0], axial = mean + 2 * f.mu * e[1],
                 hoop = mean + 2 * f.mu * e[2];
    for (std::size_t i = 0; i < 4; ++i) {
      double* to = (i < 2 ? force : point_force) + at[i];
      to[0] += radial * f.b[i][0] + shear * f.b[i][1] + hoop * f.hoop[i];
      to[1] += axial * f.b[i][1] + shear * f.b[i][0];
    }
  }
}

void AxisymmetricKernel::spread_pressure(std::span<const double> pressure) {
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    if (mesh_.owner[f] >= mesh_.cells.n_owned()) continue;
    const AxisymmetricFace face = axisymmetric_face(mesh_, rows_, f);
    const double scale = pressure[f] * face.volume;
    for (std::size_t i = 0; i < 4; ++i) {
      const Index node = i == 0 ? mesh_.owner[f] : i == 1 ? space_.node_across(f) : face.point[i - 2];
      double* to = (i < 2 ? space_.forces() : space_.point_forces()) + std::size_t(node) * stride;
      to[0] += scale * (face.b[i][0] + face.hoop[i]);
      to[1] += scale * face.b[i][1];
    }
  }
}

void AxisymmetricKernel::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                        const ElasticKernel::TakeGradient& take, Index first, Index end) {
  space_.fill(unknowns, known);
  for (Index f = first; f < end; ++f) {
    const AxisymmetricFace face = axisymmetric_face(mesh_, rows_, f);
    Tensor3 gradient = Tensor3::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      const Index node = i == 0 ? mesh_.owner[f] : i == 1 ? space_.node_across(f) : face.point[i - 2];
      const double* u = (i < 2 ? space_.nodes() : space_.points()) + std::size_t(node) * stride;
      for (Index j = 0; j < 2; ++j)
        for (Index k = 0; k < 2; ++k)
          if (j == k || face.has_shear) gradient(j, k) += face.b[i][std::size_t(j)] * u[k];
      gradient(2, 2) += face.hoop[i] * u[0];
    }
    // At the surface itself: that of half a cell's middle would be the surface's to first order only.
    if (f >= mesh_.n_interior && face.has_shear)
      gradient(2, 2) =
          space_.nodes()[std::size_t(space_.node_across(f)) * stride] / rows_.geometry().face_centre[f][0];
    take(f, gradient);
  }
}

std::unique_ptr<ElasticKernel::Implementation> make_axisymmetric_kernel(const mesh::Mesh& mesh,
                                                                        const ElasticOperator& rows) {
  return std::make_unique<AxisymmetricKernel>(mesh, rows);
}

}  // namespace couplet::elastic
