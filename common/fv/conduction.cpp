// SPDX-License-Identifier: Apache-2.0
#include "common/fv/conduction.hpp"

#include <algorithm>
#include <cmath>

#include "common/fv/vertex_interpolation.hpp"

namespace couplet::fv {
namespace {

// On orthogonal faces the tangential correction is round-off, and the stencil reduces to two cells.
constexpr double orthogonal = 1e-12;

VertexInterpolation::ByFace stencils_of(const mesh::Mesh& mesh, std::span<const HeatCondition> conditions) {
  VertexInterpolation::ByFace stencils{{}, mesh.cell_material};
  for (const Index p : mesh.patch_of_boundary())
    stencils.stencil.push_back(conditions[p] == HeatCondition::temperature ? PatchStencil::fixed
                               : conditions[p] == HeatCondition::symmetry  ? PatchStencil::symmetry
                                                                           : PatchStencil::open);
  return stencils;
}

/// Sums coefficients by column, found through markers.
struct ColumnSums {
  std::vector<Index> column, place;
  std::vector<double> value;
  explicit ColumnSums(std::size_t n_columns) : place(n_columns, -1) {}
  void add(Index c, double v) {
    if (place[c] < 0) {
      place[c] = static_cast<Index>(column.size());
      column.push_back(c);
      value.push_back(v);
    } else {
      value[place[c]] += v;
    }
  }
  void move_to(std::vector<Index>& columns, std::vector<double>& values) {
    columns.insert(columns.end(), column.begin(), column.end());
    values.insert(values.end(), value.begin(), value.end());
    for (const Index c : column) place[c] = -1;
    column.clear();
    value.clear();
  }
};

}  // namespace

ConductionOperator::ConductionOperator(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                       std::span<const HeatCondition> conditions)
    : mesh_(&mesh),
      geometry_(&geometry),
      vertices_(mesh, geometry, stencils_of(mesh, conditions)),
      faces_(mesh, geometry) {
  sort_boundary(conditions);
  number_ = number_nodes(mesh, flux_faces_);
  build_stencils();
  build_rows();
}

void ConductionOperator::sort_boundary(std::span<const HeatCondition> conditions) {
  const Index n_interior = mesh_->n_interior;
  condition_of_face_.resize(mesh_->boundary.n_local());
  known_of_face_.assign(mesh_->boundary.n_local(), -1);
  flux_of_face_.assign(mesh_->boundary.n_local(), -1);
  known_of_point_.assign(mesh_->points.n_local(), -1);
  for (Index v = 0; v < mesh_->points.n_local(); ++v)
    if (vertices_.is_fixed(v)) {
      known_of_point_[v] = static_cast<Index>(known_points_.size());
      known_points_.push_back(v);
    }
  auto next = static_cast<Index>(known_points_.size());
  for (std::size_t p = 0; p < mesh_->patches.size(); ++p) {
    const mesh::Patch& patch = mesh_->patches[p];
    std::fill_n(condition_of_face_.begin() + (patch.first - n_interior), patch.count, conditions[p]);
    std::fill_n(condition_of_face_.begin() + (patch.ghost_first - n_interior), patch.ghost_count,
                conditions[p]);
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const bool is_first_side = conditions[p] == HeatCondition::bonded && !is_second_side(f - n_interior);
      if (conditions[p] == HeatCondition::flux || is_first_side) {
        flux_of_face_[f - n_interior] = static_cast<Index>(flux_faces_.size());
        flux_faces_.push_back(f);
      }
      if (conditions[p] == HeatCondition::temperature) {
        known_faces_.push_back(f);
        known_of_face_[f - n_interior] = next++;
      }
    }
  }
}

/// Fluxes in this rank's rows: its own faces and the far sides of its bonded faces.
bool ConductionOperator::needs_stencil(Index face) const {
  if (face < mesh_->n_flux_faces()) return true;
  const Index b = face - mesh_->n_interior;
  return mesh_->twin[b] >= 0 && mesh_->twin[b] < mesh_->boundary.n_owned();
}

// S| n . grad T = |S| [(T_N - T_P) / (d . n) + sum_V (k . c_V) T_V] (2.58), zero on symmetry planes.
void ConductionOperator::build_stencils() {
  ColumnSums nodes(number_.size()), known(n_known());
  offset_.assign(1, 0);
  known_offset_.assign(1, 0);
  const Index n_cells = mesh_->cells.n_local();
  const Index n_faces = mesh_->twin.empty() ? mesh_->n_flux_faces() : mesh_->n_faces();
  for (Index f = 0; f < n_faces; ++f) {
    const bool on_boundary = f >= mesh_->n_interior;
    if (needs_stencil(f) && (!on_boundary || condition(f) != HeatCondition::symmetry)) {
      const double area = geometry_->face_area[f].norm(), across = area * faces_.inverse_dn[f];
      const Index b = f - mesh_->n_interior;
      nodes.add(mesh_->owner[f], -across);
      if (!on_boundary)
        nodes.add(mesh_->neighbour[f], across);
      else if (known_of_face_[b] >= 0)
        known.add(known_of_face_[b], across);
      else
        nodes.add(n_cells + b, across);
      for (Index e = mesh_->face_points.offset[f]; e < mesh_->face_points.offset[f + 1]; ++e) {
        const Index v = mesh_->face_points.index[e];
        const double along = area * faces_.skew[f].dot(faces_.tangential[e]);
        if (std::abs(along) < orthogonal * across) continue;
        if (known_of_point_[v] >= 0) {
          known.add(known_of_point_[v], along);
          continue;
        }
        const auto around = vertices_.nodes(v);
        const auto weights = vertices_.weights(v);
        for (std::size_t i = 0; i < around.size(); ++i) nodes.add(around[i], along * weights[i]);
      }
    }
    nodes.move_to(node_, coefficient_);
    known.move_to(known_column_, known_coefficient_);
    offset_.push_back(std::ssize(node_));
    known_offset_.push_back(std::ssize(known_column_));
  }
}

void ConductionOperator::add_term(const StencilTerm& term, GlobalIndex row) {
  terms_.push_back(term);
  const auto add = [&](GlobalIndex column) {
    row_.push_back(row);
    column_.push_back(column);
  };
  if (term.kind == Kind::conduction)
    for (auto i = offset_[term.index]; i < offset_[term.index + 1]; ++i) add(number_[node_[i]]);
  else if (term.kind == Kind::transfer)
    add(number_[mesh_->cells.n_local() + flux_faces_[term.index] - mesh_->n_interior]);
  else
    add(number_[term.index]);
}

void ConductionOperator::build_rows() {
  const Index n_owned = mesh_->cells.n_owned();
  for (Index f = 0; f < mesh_->n_flux_faces(); ++f) {
    const Index owner = mesh_->owner[f];
    if (f < mesh_->n_interior) {
      if (owner < n_owned) add_term({Kind::conduction, true, -1, f}, number_[owner]);
      const Index neighbour = mesh_->neighbour[f];
      if (neighbour < n_owned) add_term({Kind::conduction, true, 1, f}, number_[neighbour]);
      continue;
    }
    const Index i = flux_of_face_[f - mesh_->n_interior];
    const GlobalIndex own = number_[mesh_->cells.n_local() + f - mesh_->n_interior];
    if (condition(f) != HeatCondition::flux) {
      add_term({Kind::conduction, true, -1, f}, number_[owner]);
      if (i < 0) continue;
      add_term({Kind::conduction, false, 1, f}, own);
      add_term({Kind::conduction, false, 1, twin_of(f)}, own);
      continue;
    }
    add_term({Kind::transfer, true, 1, i}, number_[owner]);
    add_term({Kind::conduction, false, 1, f}, own);
    add_term({Kind::transfer, false, 1, i}, own);
  }
  for (Index c = 0; c < n_owned; ++c) add_term({Kind::capacity, true, 1, c}, number_[c]);
}

linalg::SparseMatrix ConductionOperator::make_matrix() const {
  return {mesh_->comm, static_cast<GlobalIndex>(n_unknowns()), row_, column_};
}

void ConductionOperator::fill(const RowFactors& weights, linalg::SparseMatrix& matrix) const {
  std::vector<double> values;
  values.reserve(row_.size());
  for (const StencilTerm& term : terms_) {
    const double scale = term.sign * (term.in_cell_row ? weights.share : 1);
    if (term.kind == Kind::conduction) {
      const double k = scale * weights.conductivity[term.index];
      for (auto i = offset_[term.index]; i < offset_[term.index + 1]; ++i)
        values.push_back(k * coefficient_[i]);
    } else if (term.kind == Kind::transfer) {
      const double area = geometry_->face_area[flux_faces_[term.index]].norm();
      values.push_back(weights.transfer.empty() ? 0 : scale * weights.transfer[term.index] * area);
    } else {
      values.push_back(weights.capacity.empty() ? 0 : weights.capacity[term.index]);
    }
  }
  matrix.fill(values);
}

void ConductionOperator::subtract_known(const RowFactors& weights, std::span<const double> known,
                                        std::span<double> rhs) const {
  const Index n_owned = mesh_->cells.n_owned();
  const auto known_heat = [&](Index f) {
    double heat = 0;
    for (auto i = known_offset_[f]; i < known_offset_[f + 1]; ++i)
      heat += known_coefficient_[i] * known[known_column_[i]];
    return heat == 0 ? 0 : heat * weights.conductivity[f];
  };
  for (Index f = 0; f < mesh_->n_flux_faces(); ++f) {
    const double heat = known_heat(f);
    const Index flux = f < mesh_->n_interior ? -1 : flux_of_face_[f - mesh_->n_interior];
    if (flux >= 0) {
      const bool is_bonded = condition(f) == HeatCondition::bonded;
      rhs[n_owned + flux] -= heat + (is_bonded ? known_heat(twin_of(f)) : 0);
      if (!is_bonded) continue;
    }
    if (heat == 0) continue;
    if (mesh_->owner[f] < n_owned) rhs[mesh_->owner[f]] += weights.share * heat;
    if (f < mesh_->n_interior && mesh_->neighbour[f] < n_owned)
      rhs[mesh_->neighbour[f]] -= weights.share * heat;
  }
}

void ConductionOperator::join_twins(std::span<double> boundary) const {
  for (std::size_t b = 0; b < mesh_->twin.size(); ++b)
    if (mesh_->twin[b] >= 0 && is_second_side(static_cast<Index>(b))) boundary[b] = boundary[mesh_->twin[b]];
}

void ConductionOperator::point_values(std::span<const double> cells, std::span<const double> boundary,
                                      std::span<const double> known, std::span<double> points) const {
  for (Index v = 0; v < mesh_->points.n_local(); ++v)
    points[v] =
        known_of_point_[v] >= 0 ? known[known_of_point_[v]] : vertices_.scalar_at<1>(v, cells, boundary)[0];
  mesh_->points.update_ghosts(points);
}

Vec3 ConductionOperator::tangential_gradient(Index face, std::span<const double> points) const {
  Vec3 gradient = Vec3::Zero();
  for (Index e = mesh_->face_points.offset[face]; e < mesh_->face_points.offset[face + 1]; ++e)
    gradient += faces_.tangential[e] * points[mesh_->face_points.index[e]];
  return gradient;
}

Vec3 ConductionOperator::gradient(Index face, std::span<const double> cells, std::span<const double> boundary,
                                  std::span<const double> points) const {
  const Vec3 along = tangential_gradient(face, points);
  const bool on_boundary = face >= mesh_->n_interior;
  if (on_boundary && condition(face) == HeatCondition::symmetry) return along;
  const double there = on_boundary ? boundary[face - mesh_->n_interior] : cells[mesh_->neighbour[face]];
  const double normal =
      (there - cells[mesh_->owner[face]]) * faces_.inverse_dn[face] + faces_.skew[face].dot(along);
  return normal * faces_.normal[face] + along;
}

// Interpolates on the line between the nodes to the plane of the face, then along the face.
double ConductionOperator::face_value(Index face, std::span<const double> cells,
                                      std::span<const double> boundary,
                                      std::span<const double> points) const {
  const Index owner = mesh_->owner[face];
  const mesh::Geometry& g = *geometry_;
  const Vec3 arm = g.face_centre[face] - g.cell_centre[owner];
  if (face >= mesh_->n_interior) {
    if (condition(face) != HeatCondition::symmetry) return boundary[face - mesh_->n_interior];
    return cells[owner] + arm.dot(tangential_gradient(face, points));
  }
  const Index neighbour = mesh_->neighbour[face];
  const Vec3 d = g.cell_centre[neighbour] - g.cell_centre[owner];
  const double part = arm.dot(faces_.normal[face]) * faces_.inverse_dn[face];
  const Vec3 aside = arm - part * d;
  const double between = cells[owner] + part * (cells[neighbour] - cells[owner]);
  if (aside.squaredNorm() < orthogonal * d.squaredNorm()) return between;
  return between + aside.dot(tangential_gradient(face, points));
}

void ConductionOperator::face_heat(std::span<const double> conductivity, std::span<const double> cells,
                                   std::span<const double> boundary, std::span<const double> points,
                                   std::span<double> heat) const {
  for (Index f = 0; f < mesh_->n_flux_faces(); ++f)
    heat[f] = conductivity[f] * gradient(f, cells, boundary, points).dot(geometry_->face_area[f]);
}

}  // namespace couplet::fv
