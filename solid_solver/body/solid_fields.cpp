// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/solid_fields.hpp"

namespace couplet::solid {
SolidFields::SolidFields(const SolidBody& body, const SolidState& state, const LastSolve& last)
    : body_(body),
      state_(state),
      last_(last),
      mesh_(body.mesh()),
      geometry_(body.geometry()),
      parameters_(body.parameters()),
      elastic_(body.elastic()) {}

std::vector<double> SolidFields::point_displacement() const {
  return body_.to_points(state_.cell_u, state_.face_u, state_.known);
}

std::vector<double> SolidFields::point_velocity() const {
  return body_.to_points(state_.cell_v, state_.face_v, state_.known_rate);
}

std::vector<double> SolidFields::point_acceleration() const {
  return body_.to_points(state_.acceleration, state_.face_acceleration, known_acceleration());
}

/// Of the prescribed columns at the accepted time: a difference over half of the last step.
std::vector<double> SolidFields::known_acceleration() const {
  std::vector<double> result(state_.known.size(), 0), before(result.size()), now(result.size());
  if (!body_.prescribed().uses_time() || !(state_.dt > 0)) return result;
  const double h = 0.25 * state_.dt;
  body_.prescribed().evaluate(state_.time - h, before);
  body_.prescribed().evaluate(state_.time, now);
  body_.prescribed().evaluate(state_.time + h, result);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = (result[i] - 2 * now[i] + before[i]) / (h * h);
  return result;
}

Displaced SolidFields::displaced(std::span<const double> points) const {
  return {[this] { return body_.unknowns_of(state_.cell_u, state_.face_u); }, state_.known,
          [this, points](Index first, Index count) {
            return body_.face_gradients(first, count, displacement(points));
          },
          [this, points] { return cell_gradient(points); }};
}

std::vector<Tensor3> SolidFields::face_stress(Index first, Index count,
                                              std::span<const double> points) const {
  return body_.equilibrium().face_stress(displaced(points), first, count);
}

std::vector<Tensor3> SolidFields::face_strain(Index first, Index count,
                                              std::span<const double> points) const {
  std::vector<Tensor3> strain = body_.face_gradients(first, count, displacement(points));
  body_.equilibrium().to_strain(strain);
  return strain;
}

std::vector<Tensor3> SolidFields::cell_strain(std::span<const double> points) const {
  std::vector<Tensor3> strain = cell_gradient(points);
  body_.equilibrium().to_strain(strain);
  return strain;
}

std::vector<Tensor3> SolidFields::cell_stress(std::span<const double> points) const {
  return body_.equilibrium().cell_stress(displaced(points));
}

const PointTensors& SolidFields::point_tensors() const {
  if (!point_tensors_) {
    std::vector<bool> is_symmetry;
    for (const mesh::Patch& patch : mesh_.patches) {
      const auto found = parameters_.boundaries.find(patch.name);
      is_symmetry.push_back(found != parameters_.boundaries.end() && found->second.parts.empty() &&
                            is_symmetry_plane(found->second));
    }
    point_tensors_ = std::make_unique<PointTensors>(mesh_, geometry_, is_symmetry, elastic_.vertices());
  }
  return *point_tensors_;
}

/// Of the boundary faces of owned cells, small strain: tractions as the loads have them, no shear at planes of symmetry.
std::vector<SurfaceTraction> SolidFields::known_tractions() const {
  const std::vector<double> forces = loads_now().faces;
  std::vector<SurfaceTraction> result(std::size_t(mesh_.boundary.n_owned()));
  for (std::size_t b = 0; b < result.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b);
    const double area = geometry_.face_area[f].norm();
    SurfaceTraction& known = result[b];
    const elastic::BoundaryRow& row = elastic_.at(f);
    if (row.is_free() && !body_.boundaries().knows_traction(f)) continue;
    if (row.spring.isZero(0)) known.projector = Tensor3::Identity() - row.passing;
    known.symmetry = row.mirrored;
    if (row.mirrored || row.fixed || row.level || row.shared) continue;
    Vec3 force = Vec3::Zero();
    for (int a = 0; a < mesh_.dim; ++a) force[a] = forces[b * std::size_t(mesh_.dim) + std::size_t(a)];
    known.traction = known.projector * force / area;
  }
  return result;
}

DiscreteStress SolidFields::discrete_stress(std::span<const double> points) const {
  DiscreteStress found{cell_stress(points),
                       face_stress(mesh_.n_interior, mesh_.boundary.n_owned(), points),
                       {},
                       {},
                       state_.cell_u,
                       state_.face_u,
                       known_tractions()};
  if (body_.effects().empty()) return found;
  found.other_in_cells.assign(found.cells.size(), Tensor3::Zero());
  found.other_on_faces.assign(found.faces.size(), Tensor3::Zero());
  for (const auto& effect : body_.effects()) {
    effect->add_cell_stress(found.other_in_cells);
    effect->add_face_stress(mesh_.n_interior, found.other_on_faces);
  }
  return found;
}

bool recovers_stress(const SolidBody& body) {
  return body.equilibrium().means().recovers_stress && !is_axisymmetric(body.elastic());
}

std::vector<double> SolidFields::point_stress(std::span<const double> points,
                                              std::span<const std::uint8_t> wanted,
                                              std::vector<double>* left) const {
  if (!recovers_stress(body_)) {
    const std::vector<Tensor3> faces = face_stress(mesh_.n_interior, mesh_.boundary.n_owned(), points);
    return point_tensors().interpolate(cell_stress(points), faces);
  }
  if (!recovery_) recovery_ = std::make_unique<StressRecovery>(mesh_, elastic_);
  const DiscreteStress found = discrete_stress(points);
  std::vector<double> stress = recovery_->at_points(found, wanted);
  if (left) *left = recovery_->left_at_points(found, wanted, stress);
  if (mesh_.dim == 2 && parameters_.plane == SolidParameters::Plane::stress)
    for (std::size_t i = 2; i < stress.size(); i += tensor_size) stress[i] = 0;
  return stress;
}

std::vector<double> SolidFields::point_strain(std::span<const double> points) const {
  return point_tensors().interpolate(cell_strain(points),
                                     face_strain(mesh_.n_interior, mesh_.boundary.n_owned(), points));
}

}  // namespace couplet::solid
