// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/cell_part.hpp"

#include <utility>

#include "common/io/fields/part_points.hpp"

namespace couplet::io {

CellPart make_part(const mesh::Mesh& body, std::span<const Vec3> places,
                   const std::vector<std::uint8_t>& flags) {
  CellPart part;
  mesh::Mesh& mesh = part.mesh;
  mesh.dim = body.dim;
  std::vector<double> uses(body.points.n_local(), 0);
  for (Index c = 0; c < body.cells.n_owned(); ++c) {
    if (!flags[c]) continue;
    part.cells.push_back(c);
    for (const Index v : body.cell_points[c]) uses[v] = 1;
  }
  const std::vector<Index> number = number_points(body, std::move(uses), part.points);
  set_points(mesh, part.places, body, places, part.points, number);
  mesh.cells = parallel::IndexMap(body.comm, static_cast<Index>(part.cells.size()), {}, {});
  std::vector<Index> corners;
  for (const Index c : part.cells) {
    corners.clear();
    for (const Index v : body.cell_points[c]) corners.push_back(number[v]);
    mesh.cell_points.push_row(corners);
    mesh.cell_type.push_back(body.cell_type[c]);
    mesh.cell_id.push_back(body.cell_id[c]);
  }
  return part;
}

std::vector<std::uint8_t> cells_within(const mesh::Mesh& mesh, std::span<const Vec3> places,
                                       const FieldChoice::Box& box) {
  std::vector<std::uint8_t> flags(mesh.cells.n_owned(), 0);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    Vec3 mean = Vec3::Zero();
    for (const Index v : mesh.cell_points[c]) mean += places[v];
    mean /= double(mesh.cell_points[c].size());
    bool within = true;
    for (int d = 0; d < mesh.dim; ++d) within = within && mean[d] >= box.from[d] && mean[d] <= box.to[d];
    flags[c] = within;
  }
  return flags;
}

OutputField part_of(const OutputField& field, const CellPart& part, std::vector<double>& values) {
  const std::size_t n = field.components;
  values.clear();
  for (const Index i : field.place == OutputField::Place::cells ? part.cells : part.points) {
    const auto one = field.values.subspan(std::size_t(i) * n, n);
    values.insert(values.end(), one.begin(), one.end());
  }
  OutputField here = field;
  here.values = values;
  return here;
}

}  // namespace couplet::io
