// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundaries.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet {
namespace {

using Type = SolidBoundary::Type;

ElasticCondition condition_of(Type type) {
  if (type == Type::fixed_displacement) return ElasticCondition::prescribed;
  if (type == Type::symmetry) return ElasticCondition::symmetry;
  return ElasticCondition::traction;
}

std::vector<std::string> patch_names(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const Patch& patch : mesh.patches) names.push_back(patch.name);
  return names;
}

void check_names(const Mesh& mesh, const SolidParameters& parameters) {
  const std::vector<std::string> patches = patch_names(mesh);
  for (const auto& [name, boundary] : parameters.boundaries)
    if (!mesh.find_patch(name))
      throw Error("boundaries.{}: mesh '{}' has no patch of this name. {} The patches are {}.", name,
                  parameters.mesh, did_you_mean(name, patches, "patches"), join(patches));
  for (const std::string& name : patches)
    if (!parameters.boundaries.contains(name))
      throw Error(
          "boundaries: patch '{}' of mesh '{}' has no entry; each patch needs one (a stress-free patch: "
          "'type: free'). "
          "The patches are {}.",
          name, parameters.mesh, join(patches));
}

}  // namespace

SolidBoundaries::SolidBoundaries(const Mesh& mesh, const SolidParameters& parameters) : mesh_(&mesh) {
  check_names(mesh, parameters);
  for (const Patch& patch : mesh.patches) {
    const SolidBoundary& boundary = parameters.boundaries.at(patch.name);
    OnPatch here{boundary.type, {}, {}};
    const std::string where = "boundaries." + patch.name + ".value";
    if (boundary.type == Type::fixed_displacement || boundary.type == Type::traction)
      here.value = make_expressions(boundary.value, mesh.dim, where);
    if (boundary.type == Type::pressure) here.pressure = Expression(boundary.pressure, where);
    if (boundary.type == Type::interface_) interface_patches_.push_back(patch.name);
    conditions_.push_back(condition_of(boundary.type));
    on_patch_.push_back(std::move(here));
  }
}

bool SolidBoundaries::any_prescribed() const {
  return std::ranges::count(conditions_, ElasticCondition::prescribed) > 0;
}

bool SolidBoundaries::any_symmetry() const {
  return std::ranges::count(conditions_, ElasticCondition::symmetry) > 0;
}

bool SolidBoundaries::forces_use_time() const {
  return std::ranges::any_of(on_patch_, [](const OnPatch& p) {
    return p.type != Type::fixed_displacement &&
           (p.pressure.uses_time() ||
            std::ranges::any_of(p.value, [](const Expression& e) { return e.uses_time(); }));
  });
}

void SolidBoundaries::add_forces(double t, std::span<double> forces) const {
  const int dim = mesh_->dim;
  for (std::size_t p = 0; p < on_patch_.size(); ++p) {
    const OnPatch& here = on_patch_[p];
    if (here.type != Type::traction && here.type != Type::pressure) continue;
    const Patch& patch = mesh_->patches[p];
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Vec3& x = mesh_->reference.face_centre[f];
      const Vec3& area = mesh_->reference.face_area[f];
      double* force = forces.data() + std::size_t(f - mesh_->n_interior) * dim;
      if (here.type == Type::traction) {
        const double size = area.norm();
        for (int c = 0; c < dim; ++c) force[c] += here.value[c](x, t) * size;
      } else {
        const double pressure = here.pressure(x, t);
        for (int c = 0; c < dim; ++c) force[c] -= pressure * area[c];
      }
    }
  }
}

PrescribedDisplacement::PrescribedDisplacement(const Mesh& mesh, const SolidBoundaries& boundaries,
                                               const ElasticOperator& elastic)
    : dim_(mesh.dim), size_(elastic.prescribed_points().size() + elastic.prescribed_faces().size()) {
  std::vector<std::uint8_t> taken(mesh.points.n_local(), 0);
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    if (boundaries.conditions_[p] != ElasticCondition::prescribed) continue;
    const Patch& patch = mesh.patches[p];
    Group group{&boundaries.on_patch_[p].value, {}, {}};
    const auto take_points = [&](Index first, Index count) {
      for (Index f = first; f < first + count; ++f)
        for (const Index v : mesh.face_points[f]) {
          if (taken[v] || elastic.known_of_point(v) < 0) continue;
          taken[v] = 1;
          group.columns.push_back(elastic.known_of_point(v));
          group.places.push_back(mesh.reference_points[v]);
        }
    };
    take_points(patch.first, patch.count);
    take_points(patch.ghost_first, patch.ghost_count);
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      group.columns.push_back(elastic.known_of_face(f));
      group.places.push_back(mesh.reference.face_centre[f]);
    }
    for (const Expression& e : *group.value) {
      is_zero_ = is_zero_ && e.is_zero();
      uses_time_ = uses_time_ || e.uses_time();
    }
    groups_.push_back(std::move(group));
  }
}

void PrescribedDisplacement::evaluate(double t, std::span<double> values) const {
  for (const Group& group : groups_)
    for (std::size_t i = 0; i < group.columns.size(); ++i)
      for (int c = 0; c < dim_; ++c)
        values[std::size_t(group.columns[i]) * dim_ + c] = (*group.value)[c](group.places[i], t);
}

void PrescribedDisplacement::evaluate_rate(double t, double dt, std::span<double> values) const {
  std::ranges::fill(values, 0.0);
  if (!uses_time_) return;
  const double h = 1e-3 * dt;
  std::vector<double> before(values.size());
  evaluate(t - h, before);
  evaluate(t + h, values);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = (values[i] - before[i]) / (2 * h);
}

}  // namespace couplet
