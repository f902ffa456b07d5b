// SPDX-License-Identifier: Apache-2.0
// What the boundary faces of an ElasticOperator carry: known forces and values, holding forces, twins.
#include <algorithm>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/vector_at.hpp"

namespace couplet::elastic {
Vec3 ElasticOperator::add_forces(std::span<const double> forces, std::span<double> rhs) const {
  const int dim = mesh_->dim;
  Vec3 total = Vec3::Zero();
  for (std::size_t i = 0; i < unknown_faces_.size(); ++i) {
    const Index f = unknown_faces_[i];
    Vec3 force = vector_at(forces, f - mesh_->n_interior, dim);
    force -= (at(f).passing * force).eval();
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
    if (!at(f).passing.isZero(0)) add(mesh_->owner[f], at(f).passing * -force(f));
  }
  for (std::size_t i = 0; i < unknown_faces_.size(); ++i) {
    const Index f = unknown_faces_[i], row = n_owned + static_cast<Index>(i);
    const Vec3 here = force(f);
    if (at(f).shared)
      add(row, here + force(mesh_->n_interior + mesh_->twin[f - mesh_->n_interior]));
    else
      add(row, here - at(f).passing * here);
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
  const Vec3 held = row.passing * force;
  if (row.spring.isZero(0)) return held;
  const Vec3 stretch = vector_at(faces, face - mesh_->n_interior, mesh_->dim) -
                       vector_at(known, known_of_face(face), mesh_->dim);
  const Vec3 spring = area(face) * (row.spring * stretch);
  return held - (spring - row.known * spring);
}

}  // namespace couplet::elastic
