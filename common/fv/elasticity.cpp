// SPDX-License-Identifier: Apache-2.0
#include "common/fv/elasticity.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

std::vector<PatchStencil> stencils_of(std::span<const ElasticCondition> conditions) {
  std::vector<PatchStencil> stencils;
  for (const ElasticCondition condition : conditions)
    stencils.push_back(condition == ElasticCondition::prescribed ? PatchStencil::fixed
                       : condition == ElasticCondition::symmetry ? PatchStencil::symmetry
                                                                 : PatchStencil::open);
  return stencils;
}

/// Flux faces of each owned cell.
Csr faces_of_cells(const Mesh& mesh) {
  const Index n = mesh.cells.n_owned();
  Csr result;
  result.offset.assign(n + 1, 0);
  const auto visit = [&](auto&& take) {
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      if (mesh.owner[f] < n) take(mesh.owner[f], f);
      if (f < mesh.n_interior && mesh.neighbour[f] < n) take(mesh.neighbour[f], f);
    }
  };
  visit([&](Index c, Index) { ++result.offset[c + 1]; });
  for (Index c = 0; c < n; ++c) result.offset[c + 1] += result.offset[c];
  result.index.resize(result.offset.back());
  std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
  visit([&](Index c, Index f) { result.index[next[c]++] = f; });
  return result;
}

}  // namespace

/// One block row under construction: blocks by column, found through marks.
struct ElasticOperator::Row {
  struct Part {
    std::vector<Index> column;
    std::vector<Tensor3> block;
    std::vector<Index> place;  // of each column in `column`, -1: not there
    explicit Part(std::size_t n_columns) : place(n_columns, -1) {}
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
  Part nodes, known;
};

ElasticOperator::ElasticOperator(const Mesh& mesh, std::span<const ElasticCondition> conditions,
                                 const LameConstants& lame)
    : mesh_(&mesh), lame_(lame), vertices_(mesh, stencils_of(conditions)), faces_(mesh) {
  sort_boundary(conditions);
  number_unknowns();
  assemble();
}

void ElasticOperator::sort_boundary(std::span<const ElasticCondition> conditions) {
  const Index n_interior = mesh_->n_interior;
  condition_of_face_.resize(mesh_->boundary.n_local());
  known_of_face_.assign(mesh_->boundary.n_local(), -1);
  known_of_point_.assign(mesh_->points.n_local(), -1);
  for (Index v = 0; v < mesh_->points.n_local(); ++v)
    if (vertices_.is_fixed(v)) {
      known_of_point_[v] = static_cast<Index>(prescribed_points_.size());
      prescribed_points_.push_back(v);
    }
  auto next = static_cast<Index>(prescribed_points_.size());
  for (std::size_t p = 0; p < mesh_->patches.size(); ++p) {
    const Patch& patch = mesh_->patches[p];
    std::fill_n(condition_of_face_.begin() + (patch.first - n_interior), patch.count, conditions[p]);
    std::fill_n(condition_of_face_.begin() + (patch.ghost_first - n_interior), patch.ghost_count,
                conditions[p]);
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      if (conditions[p] == ElasticCondition::traction) traction_faces_.push_back(f);
      if (conditions[p] == ElasticCondition::prescribed) {
        prescribed_faces_.push_back(f);
        known_of_face_[f - n_interior] = next++;
      }
    }
  }
}

void ElasticOperator::number_unknowns() {
  const Index n_owned = mesh_->cells.n_owned(), n_cells = mesh_->cells.n_local();
  const GlobalIndex first = exclusive_scan(mesh_->comm, GlobalIndex(n_owned) + std::ssize(traction_faces_));
  std::vector<GlobalIndex> cells(n_cells, -1), boundary(mesh_->boundary.n_local(), -1);
  for (Index c = 0; c < n_owned; ++c) cells[c] = first + c;
  for (std::size_t i = 0; i < traction_faces_.size(); ++i)
    boundary[traction_faces_[i] - mesh_->n_interior] = first + n_owned + static_cast<GlobalIndex>(i);
  mesh_->cells.update_ghosts(std::span<GlobalIndex>(cells));
  mesh_->boundary.update_ghosts(std::span<GlobalIndex>(boundary));
  number_ = std::move(cells);
  number_.insert(number_.end(), boundary.begin(), boundary.end());
}

void ElasticOperator::assemble() {
  Row row{Row::Part(number_.size()), Row::Part(prescribed_points_.size() + prescribed_faces_.size())};
  const Csr cell_faces = faces_of_cells(*mesh_);
  const Index n_owned = mesh_->cells.n_owned();
  for (Index c = 0; c < n_owned; ++c) {
    for (const Index f : cell_faces[c]) {
      if (f >= mesh_->n_interior && condition(f) == ElasticCondition::traction) continue;
      add_face(f, mesh_->owner[f] == c ? -1.0 : 1.0, row);
    }
    store(c, row);
    row.nodes.clear();
    row.known.clear();
  }
  for (std::size_t i = 0; i < traction_faces_.size(); ++i) {
    add_face(traction_faces_[i], 1.0, row);
    store(n_owned + static_cast<Index>(i), row);
    row.nodes.clear();
    row.known.clear();
  }
}

// Force on the face out of the owner, with g = n . grad u and c_V, k as in FaceGradient (2.77):
//   sigma . n = mu (g + n (n . g) + grad_t(n . u)) + lambda n (n . g + tr grad_t u)
//   g = (u_N - u_P) / (d . n) + sum_V (k . c_V) u_V
void ElasticOperator::add_face(Index face, double sign, Row& row) const {
  const bool on_boundary = face >= mesh_->n_interior;
  const bool symmetric = on_boundary && condition(face) == ElasticCondition::symmetry;
  const Vec3& n = faces_.normal[face];
  const Tensor3 nn = n * n.transpose(), identity = Tensor3::Identity();
  const double mu = lame_.mu, lambda = lame_.lambda;
  Tensor3 scale = sign * mesh_->reference.face_area[face].norm() * identity;
  if (symmetric) scale = scale * nn;  // no shear on a symmetry plane

  const Tensor3 across = scale * (mu * (identity + nn) + lambda * nn) * faces_.inverse_dn[face];
  row.nodes.add(mesh_->owner[face], -across);
  if (!on_boundary) {
    row.nodes.add(mesh_->neighbour[face], across);
  } else if (!symmetric) {
    const Index b = face - mesh_->n_interior;
    if (known_of_face_[b] >= 0)
      row.known.add(known_of_face_[b], across);
    else
      row.nodes.add(mesh_->cells.n_local() + b, across);
  }
  for (Index e = mesh_->face_points.offset[face]; e < mesh_->face_points.offset[face + 1]; ++e) {
    const Index v = mesh_->face_points.index[e];
    const Vec3& c = faces_.tangential[e];
    const double kc = faces_.skew[face].dot(c);
    const Tensor3 block =
        scale * (mu * (kc * (identity + nn) + c * n.transpose()) + lambda * (kc * nn + n * c.transpose()));
    if (known_of_point_[v] >= 0) {
      row.known.add(known_of_point_[v], block);
      continue;
    }
    const Tensor3 projected = vertices_.on_symmetry(v) ? Tensor3(block * vertices_.projector(v)) : block;
    const auto nodes = vertices_.nodes(v);
    const auto weights = vertices_.weights(v);
    for (std::size_t i = 0; i < nodes.size(); ++i) row.nodes.add(nodes[i], weights[i] * projected);
  }
}

void ElasticOperator::store(Index unknown_node, const Row& row) {
  const int dim = mesh_->dim;
  const bool is_cell = unknown_node < mesh_->cells.n_owned();
  const Index node = is_cell
                         ? unknown_node
                         : mesh_->cells.n_local() +
                               (traction_faces_[unknown_node - mesh_->cells.n_owned()] - mesh_->n_interior);
  for (int a = 0; a < dim; ++a)
    for (std::size_t i = 0; i < row.nodes.column.size(); ++i)
      for (int b = 0; b < dim; ++b) {
        if (is_cell && a == b && row.nodes.column[i] == node) diagonal_.push_back(std::ssize(value_));
        row_.push_back(number_[node] * dim + a);
        column_.push_back(number_[row.nodes.column[i]] * dim + b);
        value_.push_back(row.nodes.block[i](a, b));
      }
  for (std::size_t i = 0; i < row.known.column.size(); ++i) {
    known_column_.push_back(row.known.column[i]);
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) known_block_.push_back(row.known.block[i](a, b));
  }
  known_offset_.push_back(std::ssize(known_column_));
}

SparseMatrix ElasticOperator::matrix(std::span<const double> inertia) const {
  SparseMatrix matrix(mesh_->comm, static_cast<GlobalIndex>(n_unknowns()), row_, column_, mesh_->dim);
  std::vector<double> values = value_;
  for (std::size_t c = 0; c < inertia.size(); ++c)
    for (int a = 0; a < mesh_->dim; ++a) values[diagonal_[c * mesh_->dim + a]] += inertia[c];
  matrix.fill(values);
  return matrix;
}

void ElasticOperator::subtract_known(std::span<const double> known, std::span<double> rhs) const {
  const int dim = mesh_->dim;
  for (std::size_t r = 0; r + 1 < known_offset_.size(); ++r)
    for (auto i = known_offset_[r]; i < known_offset_[r + 1]; ++i) {
      const double* block = known_block_.data() + i * dim * dim;
      const double* u = known.data() + std::size_t(known_column_[i]) * dim;
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) rhs[r * dim + a] -= block[a * dim + b] * u[b];
    }
}

Tensor3 ElasticOperator::gradient(Index face, std::span<const double> cells, std::span<const double> boundary,
                                  std::span<const double> points) const {
  const int dim = mesh_->dim;
  const auto at = [dim](std::span<const double> values, Index i) {
    Vec3 u = Vec3::Zero();
    for (int c = 0; c < dim; ++c) u[c] = values[std::size_t(i) * dim + c];
    return u;
  };
  Tensor3 tangential = Tensor3::Zero();
  for (Index e = mesh_->face_points.offset[face]; e < mesh_->face_points.offset[face + 1]; ++e)
    tangential += faces_.tangential[e] * at(points, mesh_->face_points.index[e]).transpose();
  const Vec3& n = faces_.normal[face];
  const Vec3 here = at(cells, mesh_->owner[face]);
  if (face >= mesh_->n_interior && condition(face) == ElasticCondition::symmetry)
    return n * (-n.dot(here) * faces_.inverse_dn[face] * n).transpose() + tangential;
  const Vec3 there =
      face < mesh_->n_interior ? at(cells, mesh_->neighbour[face]) : at(boundary, face - mesh_->n_interior);
  const Vec3 normal = (there - here) * faces_.inverse_dn[face] + tangential.transpose() * faces_.skew[face];
  return n * normal.transpose() + tangential;
}

Tensor3 ElasticOperator::stress(const Tensor3& gradient) const {
  return lame_.mu * (gradient + gradient.transpose()) + lame_.lambda * gradient.trace() * Tensor3::Identity();
}

}  // namespace couplet
