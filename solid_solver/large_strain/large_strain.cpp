// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/large_strain/large_strain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/fv/face_gradient.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

// Of a stiffness, in a residual that is nothing but rounding.
constexpr double last_digits = 2e-15;

}  // namespace

double rounding_of_forces(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  const mesh::Geometry& geometry = rows.geometry();
  double square = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const elastic::LameConstants lame = rows.lame(mesh.owner[f]);
    const double force = (2 * lame.mu + lame.lambda) * geometry.face_area[f].norm();
    square += 2 * force * force;
  }
  return last_digits * std::sqrt(parallel::sum(mesh.comm, square));
}

double rounding_of_motion(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  const mesh::Geometry& geometry = rows.geometry();
  double square = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const elastic::LameConstants lame = rows.lame(mesh.owner[f]);
    const fv::FaceLine line = fv::face_line(mesh, geometry, f);
    const double stiffness = (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn;
    square += 2 * stiffness * stiffness;
  }
  return std::numeric_limits<double>::epsilon() * std::sqrt(parallel::sum(mesh.comm, square));
}

std::string worst_cell(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double ratio, Index face) {
  struct Place {
    double ratio, x[3];
  };
  Place here{ratio, {0, 0, 0}};
  if (face >= 0)
    for (int a = 0; a < 3; ++a) here.x[a] = geometry.cell_centre[mesh.owner[face]][a];
  const std::vector<Place> all = parallel::all_gather(mesh.comm, std::vector<Place>{here});
  const Place& w = *std::ranges::min_element(all, {}, &Place::ratio);
  if (!(w.ratio < 1)) return "No cell is compressed.";
  return fmt::format("The worst cell is at ({:.4g}, {:.4g}, {:.4g}) m (undeformed), where det F = {:.3g}.",
                     w.x[0], w.x[1], w.x[2], w.ratio);
}

}  // namespace couplet::solid
