// SPDX-License-Identifier: Apache-2.0
// Values at points and gradients at faces of a field that is given in cells and on the boundary.
#include <algorithm>

#include "solid_solver/body/solid_body.hpp"

namespace couplet::solid {
namespace {

template <int D>
void interpolate(const elastic::ElasticOperator& elastic, std::span<const Index> points,
                 std::span<const double> cells, std::span<const double> faces, std::span<const double> known,
                 std::span<double> values) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const elastic::VertexConstraints& constraints = elastic.constraints();
    Vec<D> value = Vec<D>::Zero();
    if (!constraints.is_fixed(points[i])) {
      value = elastic.vertices().template scalar_at<D>(points[i], cells, faces);
      if (constraints.is_constrained(points[i]))
        value = constraints.free_part(points[i]).template topLeftCorner<D, D>() * value;
    }
    if (const Index column = constraints.column(points[i]); column >= 0)
      value += Eigen::Map<const Vec<D>>(known.data() + std::size_t(column) * D);
    for (int a = 0; a < D; ++a) values[i * D + a] = value[a];
  }
}

}  // namespace

std::vector<double> SolidBody::at_points(std::span<const Index> points, std::span<const double> cells,
                                         std::span<const double> faces, std::span<const double> known) const {
  std::vector<double> values(points.size() * mesh_.dim);
  if (mesh_.dim == 2)
    interpolate<2>(elastic_, points, cells, faces, known, values);
  else
    interpolate<3>(elastic_, points, cells, faces, known, values);
  return values;
}

std::vector<double> SolidBody::to_points(std::span<const double> cells, std::span<const double> faces,
                                         std::span<const double> known) const {
  std::vector<double> values;
  if (kernel_.scheme() == elastic::FaceGradientScheme::thesis) {
    std::vector<Index> all(mesh_.points.n_local());
    for (Index v = 0; v < mesh_.points.n_local(); ++v) all[v] = v;
    values = at_points(all, cells, faces, known);
  } else {
    values.assign(std::size_t(mesh_.points.n_local()) * mesh_.dim, 0);
    kernel_.point_values(unknowns_of(cells, faces), known, values);
  }
  mesh_.points.update_ghosts(values, mesh_.dim);
  return values;
}

std::vector<double> SolidBody::unknowns_of(std::span<const double> cells,
                                           std::span<const double> faces) const {
  const std::size_t dim = mesh_.dim, n_cells = mesh_.cells.n_owned() * dim;
  std::vector<double> unknowns(cells.begin(), cells.begin() + std::ptrdiff_t(n_cells));
  for (const Index f : elastic_.unknown_faces()) {
    const auto first = faces.begin() + std::ptrdiff_t((f - mesh_.n_interior) * dim);
    unknowns.insert(unknowns.end(), first, first + std::ptrdiff_t(dim));
  }
  return unknowns;
}

/// What of a point's value is not free, and the known faces.
std::vector<double> SolidBody::known_of(const BodyField& field) const {
  const int dim = mesh_.dim;
  const elastic::VertexConstraints& constraints = elastic_.constraints();
  std::vector<double> known(elastic_.n_known() * dim, 0);
  const auto at = [dim](std::span<const double> values, Index i) {
    Vec3 u = Vec3::Zero();
    for (int a = 0; a < dim; ++a) u[a] = values[std::size_t(i) * dim + a];
    return u;
  };
  for (const Index v : constraints.points()) {
    const Vec3 u = at(field.points, v), held = u - constraints.free_part(v) * u;
    for (int a = 0; a < dim; ++a) known[std::size_t(constraints.column(v)) * dim + a] = held[a];
  }
  for (const Index f : elastic_.known_faces()) {
    const Vec3 u = at(field.faces, f - mesh_.n_interior);
    for (int a = 0; a < dim; ++a) known[std::size_t(elastic_.known_of_face(f)) * dim + a] = u[a];
  }
  return known;
}

void SolidBody::visit_gradients(const BodyField& field,
                                const elastic::ElasticKernel::TakeGradient& take) const {
  kernel_.face_gradients(unknowns_of(field.cells, field.faces), known_of(field), take, 0,
                         mesh_.n_flux_faces());
}

std::vector<Tensor3> SolidBody::face_gradients(Index first, Index count, const BodyField& field) const {
  std::vector<Tensor3> gradients(count);
  const auto take = [&](Index f, const Tensor3& gradient) { gradients[f - first] = gradient; };
  kernel_.face_gradients(unknowns_of(field.cells, field.faces), known_of(field), take, first, first + count);
  return gradients;
}

}  // namespace couplet::solid
