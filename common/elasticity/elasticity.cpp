// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/elasticity.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "common/elasticity/vector_at.hpp"
#include "common/fv/vertex_interpolation.hpp"

namespace couplet::elastic {
namespace {

fv::VertexInterpolation::ByFace stencils_of(const ElasticBoundary& boundary, const ElasticBody& body) {
  fv::VertexInterpolation::ByFace stencils{{}, body.material_of_cell};
  for (Index b = 0; b < boundary.size(); ++b)
    stencils.stencil.push_back(boundary[b].fixed      ? fv::PatchStencil::fixed
                               : boundary[b].mirrored ? fv::PatchStencil::symmetry
                                                      : fv::PatchStencil::open);
  return stencils;
}

}  // namespace

/// Block row under construction. Markers find blocks by column.
struct ElasticOperator::BlockRow {
  struct ColumnBlocks {
    std::vector<Index> column;
    std::vector<Tensor3> block;
    std::vector<Index> place;  // of each column in `column`, or -1
    explicit ColumnBlocks(std::size_t n_columns) : place(n_columns, -1) {}
    void add(Index c, const Tensor3& value) {
      if (place[c] < 0) {
        place[c] = static_cast<Index>(column.size());
        column.push_back(c);
        block.push_back(value);
      } else {
        block[place[c]] += value;
      }
    }
    void clear() {
      for (const Index c : column) place[c] = -1;
      column.clear();
      block.clear();
    }
  };
  ColumnBlocks nodes, known;
};

ElasticOperator::ElasticOperator(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                 const ElasticBoundary& boundary, ElasticBody body)
    : mesh_(&mesh),
      geometry_(&geometry),
      boundary_(boundary.on(mesh, geometry)),
      body_(std::move(body)),
      vertices_(mesh, geometry, stencils_of(boundary_, body_)),
      constraints_(mesh, boundary_, vertices_) {
  sort_boundary();
  number_ = fv::number_nodes(mesh, unknown_faces_);
}

ElasticOperator::ElasticOperator(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                 std::span<const BoundaryRow> of_patches, const LameConstants& lame)
    : ElasticOperator(mesh, geometry, boundary_of_patches(mesh, of_patches), {{lame}, {}}) {}

ElasticOperator::FaceWeights ElasticOperator::weights_of(Index face) const {
  FaceWeights here{fv::face_line(*mesh_, *geometry_, face), {}};
  fv::tangential_weights(*mesh_, geometry_->points, face, here.line, here.tangential.data());
  return here;
}

void ElasticOperator::sort_boundary() {
  known_of_face_.assign(mesh_->boundary.n_local(), -1);
  for (Index f = mesh_->n_interior; f < mesh_->n_flux_faces(); ++f) {
    const Index b = f - mesh_->n_interior;
    const BoundaryRow& here = at(f);
    const bool is_second = here.shared && mesh_->boundary_id[mesh_->twin[b]] < mesh_->boundary_id[b];
    if (!here.fixed && !here.mirrored && !is_second) unknown_faces_.push_back(f);
    if (!here.has_value()) continue;
    known_of_face_[b] = static_cast<Index>(n_known());
    known_faces_.push_back(f);
  }
}

void ElasticOperator::assemble() const {
  BlockRow row{BlockRow::ColumnBlocks(number_.size()), BlockRow::ColumnBlocks(n_known())};
  const mesh::Csr cell_faces = fv::flux_faces_of_cells(*mesh_);
  const Index n_owned = mesh_->cells.n_owned();
  for (Index c = 0; c < n_owned; ++c) {
    add_cell(c, cell_faces[c], row);
    store(c, row);
  }
  for (std::size_t i = 0; i < unknown_faces_.size(); ++i) {
    add_unknown_face(unknown_faces_[i], row);
    store(n_owned + static_cast<Index>(i), row);
  }
}

void ElasticOperator::add_cell(Index cell, std::span<const Index> faces, BlockRow& row) const {
  for (const Index f : faces) {
    const double out = (mesh_->owner[f] == cell ? -1 : 1) * area(f);
    if (f < mesh_->n_interior) {
      add_flux(f, out * Tensor3::Identity(), row);
      continue;
    }
    const BoundaryRow& here = at(f);
    if (!here.transmitted.isZero(0)) add_flux(f, out * here.transmitted, row);
    if (here.spring.isZero(0)) continue;
    const Tensor3 held = -out * (Tensor3::Identity() - here.known) * here.spring;
    add_face_node(f, held, row);
    row.known.add(known_of_face(f), -held);
  }
}

void ElasticOperator::add_unknown_face(Index face, BlockRow& row) const {
  const LameConstants lame = lame_at(face);
  const double size = area(face), stiffness = (2 * lame.mu + lame.lambda) * size;
  const FaceWeights here = weights_of(face);
  const BoundaryRow& boundary = at(face);
  if (boundary.level) {
    const Tensor3 across = stiffness * here.line.inverse_dn * Tensor3::Identity();
    row.nodes.add(mesh_->owner[face], -across);
    add_face_node(face, across, row);
    for (Index e = mesh_->face_points.offset[face]; e < mesh_->face_points.offset[face + 1]; ++e)
      add_vertex(mesh_->face_points.index[e],
                 stiffness * here.line.skew.dot(here.tangential[e - mesh_->face_points.offset[face]]) *
                     Tensor3::Identity(),
                 row);
    return;
  }
  const Tensor3 open = Tensor3::Identity() - boundary.known;
  add_flux(face, size * open, row);
  if (boundary.shared) {
    const Index twin = mesh_->n_interior + mesh_->twin[face - mesh_->n_interior];
    add_flux(twin, area(twin) * Tensor3::Identity(), row);
  }
  if (!boundary.has_value()) return;
  const Tensor3 held = size * open * boundary.spring + stiffness * here.line.inverse_dn * boundary.known;
  add_face_node(face, held, row);
  row.known.add(known_of_face(face), -held);
}

void ElasticOperator::set_lame(std::vector<LameConstants> lame) {
  body_.lame = std::move(lame);
  assembled_ = {};
}

LameConstants ElasticOperator::lame_at(Index face) const {
  const LameConstants here = lame(mesh_->owner[face]);
  if (body_.lame.size() == 1 || face >= mesh_->n_interior) return here;
  const LameConstants there = lame(mesh_->neighbour[face]);
  return {0.5 * (here.mu + there.mu), 0.5 * (here.lambda + there.lambda)};
}

// scale . sigma . n, with g = n . grad u and c_V, k as in FaceGradient (2.77):
//   sigma . n = mu (g + n (n . g) + grad_t(n . u)) + lambda n (n . g + tr grad_t u)
//   g = (u_N - u_P) / (d . n) + sum_V (k . c_V) u_V
void ElasticOperator::add_flux(Index face, const Tensor3& scale, BlockRow& row) const {
  const bool on_boundary = face >= mesh_->n_interior;
  const FaceWeights at = weights_of(face);
  const Vec3& n = at.line.normal;
  const Tensor3 nn = n * n.transpose(), identity = Tensor3::Identity();
  const auto [mu, lambda] = lame_at(face);
  const Tensor3 across = scale * (mu * (identity + nn) + lambda * nn) * at.line.inverse_dn;
  row.nodes.add(mesh_->owner[face], -across);
  if (!on_boundary)
    row.nodes.add(mesh_->neighbour[face], across);
  else if (this->at(face).fixed)
    row.known.add(known_of_face(face), across);
  else if (!this->at(face).mirrored)
    add_face_node(face, across, row);
  for (Index e = mesh_->face_points.offset[face]; e < mesh_->face_points.offset[face + 1]; ++e) {
    const Vec3& c = at.tangential[e - mesh_->face_points.offset[face]];
    const double kc = at.line.skew.dot(c);
    add_vertex(
        mesh_->face_points.index[e],
        scale * (mu * (kc * (identity + nn) + c * n.transpose()) + lambda * (kc * nn + n * c.transpose())),
        row);
  }
}

void ElasticOperator::add_vertex(Index point, const Tensor3& block, BlockRow& row) const {
  const Index column = constraints_.column(point);
  if (column >= 0) row.known.add(column, block);
  if (constraints_.is_fixed(point)) return;
  const Tensor3 free =
      constraints_.is_constrained(point) ? Tensor3(block * constraints_.free_part(point)) : block;
  const auto nodes = vertices_.nodes(point);
  const auto weights = vertices_.weights(point);
  for (std::size_t i = 0; i < nodes.size(); ++i) row.nodes.add(nodes[i], weights[i] * free);
}

void ElasticOperator::add_face_node(Index face, const Tensor3& block, BlockRow& row) const {
  row.nodes.add(mesh_->cells.n_local() + face - mesh_->n_interior, block);
}

void ElasticOperator::store(Index unknown_node, BlockRow& row) const {
  const int dim = mesh_->dim;
  const bool is_cell = unknown_node < mesh_->cells.n_owned();
  const GlobalIndex number =
      number_[is_cell ? unknown_node
                      : mesh_->cells.n_local() +
                            (unknown_faces_[unknown_node - mesh_->cells.n_owned()] - mesh_->n_interior)];
  Assembled& to = assembled_;
  for (int a = 0; a < dim; ++a)
    for (std::size_t i = 0; i < row.nodes.column.size(); ++i)
      for (int b = 0; b < dim; ++b) {
        const GlobalIndex column = number_[row.nodes.column[i]];
        if (is_cell && a == b && column == number) to.diagonal.push_back(std::ssize(to.value));
        to.row.push_back(number * dim + a);
        to.column.push_back(column * dim + b);
        to.value.push_back(row.nodes.block[i](a, b));
      }
  for (std::size_t i = 0; i < row.known.column.size(); ++i) {
    to.known_column.push_back(row.known.column[i]);
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) to.known_block.push_back(row.known.block[i](a, b));
  }
  to.known_offset.push_back(std::ssize(to.known_column));
  row.nodes.clear();
  row.known.clear();
}

linalg::SparseMatrix ElasticOperator::matrix(std::span<const double> inertia) const {
  if (assembled_.row.empty()) assemble();
  linalg::SparseMatrix matrix(mesh_->comm, static_cast<GlobalIndex>(n_unknowns()), assembled_.row,
                              assembled_.column, mesh_->dim);
  std::vector<double> values = assembled_.value;
  for (std::size_t c = 0; c < inertia.size(); ++c)
    for (int a = 0; a < mesh_->dim; ++a) values[assembled_.diagonal[c * mesh_->dim + a]] += inertia[c];
  matrix.fill(values);
  return matrix;
}

void ElasticOperator::subtract_known(std::span<const double> known, std::span<double> rhs) const {
  if (assembled_.row.empty()) assemble();
  const int dim = mesh_->dim;
  const auto& offset = assembled_.known_offset;
  for (std::size_t r = 0; r + 1 < offset.size(); ++r)
    for (auto i = offset[r]; i < offset[r + 1]; ++i) {
      const double* block = assembled_.known_block.data() + i * dim * dim;
      const double* u = known.data() + std::size_t(assembled_.known_column[i]) * dim;
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) rhs[r * dim + a] -= block[a * dim + b] * u[b];
    }
}

Tensor3 ElasticOperator::stress(Index cell, const Tensor3& gradient) const {
  if (is_anisotropic()) return stress_of(elastic_matrix(cell), gradient);
  const auto [mu, lambda] = lame(cell);
  return mu * (gradient + gradient.transpose()) + lambda * gradient.trace() * Tensor3::Identity();
}

// Known forces and values, reaction forces and twins of the boundary faces.

Vec3 ElasticOperator::add_forces(std::span<const double> forces, std::span<double> rhs) const {
  const int dim = mesh_->dim;
  Vec3 total = Vec3::Zero();
  for (std::size_t i = 0; i < unknown_faces_.size(); ++i) {
    const Index f = unknown_faces_[i];
    Vec3 force = vector_at(forces, f - mesh_->n_interior, dim);
    force -= (at(f).transmitted * force).eval();
    total += force;
    for (int a = 0; a < dim; ++a) {
      rhs[std::size_t(mesh_->owner[f]) * dim + a] += force[a];
      rhs[(std::size_t(mesh_->cells.n_owned()) + i) * dim + a] += force[a];
    }
  }
  return total;
}

void ElasticOperator::add_pressure(std::span<const double> pressure, std::span<double> rhs) const {
  const int dim = mesh_->dim;
  const Index n_owned = mesh_->cells.n_owned();
  const auto force = [&](Index f) { return Vec3(pressure[f] * geometry_->face_area[f]); };
  const auto add = [&](Index row, const Vec3& value) {
    for (int a = 0; a < dim; ++a) rhs[std::size_t(row) * dim + a] += value[a];
  };
  for (Index f = 0; f < mesh_->n_interior; ++f) {
    if (mesh_->owner[f] < n_owned) add(mesh_->owner[f], -force(f));
    if (mesh_->neighbour[f] < n_owned) add(mesh_->neighbour[f], force(f));
  }
  for (Index f = mesh_->n_interior; f < mesh_->n_flux_faces(); ++f) {
    if (!at(f).transmitted.isZero(0)) add(mesh_->owner[f], at(f).transmitted * -force(f));
  }
  for (std::size_t i = 0; i < unknown_faces_.size(); ++i) {
    const Index f = unknown_faces_[i], row = n_owned + static_cast<Index>(i);
    const Vec3 here = force(f);
    if (at(f).shared)
      add(row, here + force(mesh_->n_interior + mesh_->twin[f - mesh_->n_interior]));
    else
      add(row, here - at(f).transmitted * here);
  }
}

void ElasticOperator::impose_known(std::span<const double> known, std::span<double> faces) const {
  const int dim = mesh_->dim;
  for (const Index f : known_faces_) {
    const Index b = f - mesh_->n_interior;
    Vec3 value = vector_at(known, known_of_face(f), dim);
    if (!at(f).fixed) {
      const Vec3 found = vector_at(faces, b, dim);
      value = found + at(f).known * (value - found);
    }
    for (int a = 0; a < dim; ++a) faces[std::size_t(b) * dim + a] = value[a];
  }
}

void ElasticOperator::join_twins(std::span<double> faces) const {
  const int dim = mesh_->dim;
  for (std::size_t b = 0; b < mesh_->twin.size(); ++b) {
    const Index first = mesh_->twin[b];
    if (first < 0 || mesh_->boundary_id[first] > mesh_->boundary_id[b]) continue;
    std::copy_n(faces.begin() + std::ptrdiff_t(first) * dim, dim, faces.begin() + std::ptrdiff_t(b) * dim);
  }
}

Vec3 ElasticOperator::holding_force(Index face, const Tensor3& stress, std::span<const double> faces,
                                    std::span<const double> known) const {
  const Vec3 force = stress * geometry_->face_area[face];
  const BoundaryRow& row = at(face);
  if (row.shared) return Vec3::Zero();
  const Vec3 held = row.transmitted * force;
  if (row.spring.isZero(0)) return held;
  const Vec3 stretch = vector_at(faces, face - mesh_->n_interior, mesh_->dim) -
                       vector_at(known, known_of_face(face), mesh_->dim);
  const Vec3 spring = area(face) * (row.spring * stretch);
  return held - (spring - row.known * spring);
}

}  // namespace couplet::elastic
