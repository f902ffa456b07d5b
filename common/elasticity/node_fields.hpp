// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/entries.hpp"

namespace couplet::elastic {

/// Node values of an operator as fields on its mesh with `dim` values each, zero if there is no node. Files
/// written from them do not depend on the number of ranks.
struct NodeFields {
  std::vector<double> inner;  ///< unknowns: per owned cell; known columns: per local point
  std::vector<double> faces;  ///< per boundary face of owned cells
};

namespace detail {

inline NodeFields empty_fields(const mesh::Mesh& mesh, Index inner) {
  const auto dim = std::size_t(mesh.dim);
  return {std::vector<double>(std::size_t(inner) * dim, 0.),
          std::vector<double>(std::size_t(mesh.boundary.n_owned()) * dim, 0.)};
}

/// Copies the `dim` values of entry `from` of one array to entry `to` of the other.
inline void copy_entry(const mesh::Mesh& mesh, std::span<const double> values, std::size_t from,
                       std::span<double> others, std::size_t to) {
  const auto dim = std::size_t(mesh.dim);
  std::copy_n(values.begin() + std::ptrdiff_t(from * dim), dim, others.begin() + std::ptrdiff_t(to * dim));
}

}  // namespace detail

inline NodeFields fields_of_unknowns(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                     std::span<const double> unknowns) {
  NodeFields fields = detail::empty_fields(mesh, mesh.cells.n_owned());
  std::copy_n(unknowns.begin(), fields.inner.size(), fields.inner.begin());
  std::size_t node = std::size_t(mesh.cells.n_owned());
  for (const Index f : rows.unknown_faces())
    detail::copy_entry(mesh, unknowns, node++, fields.faces, std::size_t(f - mesh.n_interior));
  return fields;
}

inline std::vector<double> unknowns_of_fields(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                              const NodeFields& fields) {
  std::vector<double> unknowns(fields.inner);
  unknowns.resize(rows.n_unknowns());
  std::size_t node = std::size_t(mesh.cells.n_owned());
  for (const Index f : rows.unknown_faces())
    detail::copy_entry(mesh, fields.faces, std::size_t(f - mesh.n_interior), unknowns, node++);
  return unknowns;
}

/// Saves or loads unknowns as fields `name` and `name`-faces. Collective.
template <class Archive>
void visit_unknowns(Archive& archive, const std::string& name, const mesh::Mesh& mesh,
                    const ElasticOperator& rows, std::vector<double>& unknowns) {
  NodeFields fields = fields_of_unknowns(mesh, rows, unknowns);
  archive.field(mesh::Entries::owned_cells, name, fields.inner, std::size_t(mesh.dim));
  archive.field(mesh::Entries::owned_boundary, name + "-faces", fields.faces, std::size_t(mesh.dim));
  if (archive.reads()) unknowns = unknowns_of_fields(mesh, rows, fields);
}

/// Saves or loads values of the known columns in the same way. Collective.
template <class Archive>
void visit_known(Archive& archive, const std::string& name, const mesh::Mesh& mesh,
                 const ElasticOperator& rows, std::vector<double>& known) {
  NodeFields fields = detail::empty_fields(mesh, mesh.points.n_local());
  const auto each = [&](const auto& copy) {
    std::size_t column = 0;
    for (const Index v : rows.constraints().points()) copy(column++, fields.inner, std::size_t(v));
    for (const Index f : rows.known_faces()) copy(column++, fields.faces, std::size_t(f - mesh.n_interior));
  };
  each([&](std::size_t column, std::vector<double>& field, std::size_t at) {
    detail::copy_entry(mesh, known, column, field, at);
  });
  archive.field(mesh::Entries::points, name, fields.inner, std::size_t(mesh.dim));
  archive.field(mesh::Entries::owned_boundary, name + "-faces", fields.faces, std::size_t(mesh.dim));
  if (archive.reads())
    each([&](std::size_t column, const std::vector<double>& field, std::size_t at) {
      detail::copy_entry(mesh, field, at, known, column);
    });
}

}  // namespace couplet::elastic
