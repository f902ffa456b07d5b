// SPDX-License-Identifier: Apache-2.0
// What the boundary faces of an ElasticOperator carry: known forces and values, holding forces, twins.
#include <algorithm>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/vector_at.hpp"

namespace couplet {
Vec3 ElasticOperator::add_forces(std::span<const double> forces, std::span<double> rhs) const {
  const int dim = mesh_->dim;
  Vec3 total = Vec3::Zero();
  for (std::size_t i = 0; i < unknown_faces_.size(); ++i) {
    const Index f = unknown_faces_[i];
    Vec3 force = vector_at(forces, f - mesh_->n_interior, dim);
    if (condition(f) == ElasticCondition::support)
      force -= support(f).known * force;
    else if (condition(f) != ElasticCondition::traction)
      continue;
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
    if (condition(f) == ElasticCondition::traction) continue;
    const Vec3 here = force(f);
    add(mesh_->owner[f],
        condition(f) == ElasticCondition::support ? Vec3(support(f).known * -here) : Vec3(-here));
  }
  for (std::size_t i = 0; i < unknown_faces_.size(); ++i) {
    const Index f = unknown_faces_[i], row = n_owned + static_cast<Index>(i);
    const Vec3 here = force(f);
    switch (condition(f)) {
      case ElasticCondition::support:
        add(row, here - support(f).known * here);
        break;
      case ElasticCondition::zero_gradient:
        break;
      case ElasticCondition::bonded:
        add(row, here + force(mesh_->n_interior + mesh_->twin[f - mesh_->n_interior]));
        break;
      default:
        add(row, here);
    }
  }
}

void ElasticOperator::impose_known(std::span<const double> known, std::span<double> faces) const {
  const int dim = mesh_->dim;
  for (const Index f : known_faces_) {
    const Index b = f - mesh_->n_interior;
    Vec3 value = vector_at(known, known_of_face(f), dim);
    if (condition(f) == ElasticCondition::support) {
      const Vec3 found = vector_at(faces, b, dim);
      value = found + support(f).known * (value - found);
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
  const Vec3 n = geometry_->face_area[face].normalized();
  switch (condition(face)) {
    case ElasticCondition::symmetry:
      return n * n.dot(force);
    case ElasticCondition::support: {
      const ElasticSupport& s = support(face);
      const Vec3 stretch = vector_at(faces, face - mesh_->n_interior, mesh_->dim) -
                           vector_at(known, known_of_face(face), mesh_->dim);
      const Vec3 spring = area(face) * (s.spring * stretch);
      return s.known * force - (spring - s.known * spring);
    }
    case ElasticCondition::prescribed:
    case ElasticCondition::zero_gradient:
      return force;
    default:
      return Vec3::Zero();
  }
}

}  // namespace couplet
