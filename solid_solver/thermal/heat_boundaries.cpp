// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thermal/heat_boundaries.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/fv/face_mean.hpp"

namespace couplet::solid {
namespace {

using Kind = HeatBoundary::Type;

fv::HeatCondition condition_of(Kind type) {
  if (type == Kind::temperature) return fv::HeatCondition::temperature;
  return type == Kind::symmetry ? fv::HeatCondition::symmetry : fv::HeatCondition::flux;
}

}  // namespace

HeatBoundaries::HeatBoundaries(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                               const HeatParameters& parameters,
                               const std::vector<std::string>& symmetry_patches)
    : mesh_(&mesh), geometry_(&geometry) {
  std::vector<std::string> names;
  for (const mesh::Patch& patch : mesh.patches)
    if (!patch.bonded) names.push_back(patch.name);
  for (const auto& [name, boundary] : parameters.boundaries)
    if (!mesh.find_patch(name))
      throw Error("heat.boundaries.{}: the mesh has no patch with this name. {}", name,
                  base::did_you_mean(name, names, "patches"));
  for (const std::string& name : names) {
    OnPatch here;
    const auto found = parameters.boundaries.find(name);
    if (found != parameters.boundaries.end()) {
      const HeatBoundary& b = found->second;
      const std::string where = "heat.boundaries." + name;
      here.type = b.type;
      if (b.type == Kind::interface) interface_patches_.push_back(name);
      if (b.type == Kind::temperature || b.type == Kind::flux)
        here.value = fv::Expression(b.value, where + ".value");
      if (b.type == Kind::convection) {
        here.coefficient = fv::Expression(b.coefficient, where + ".coefficient");
        here.ambient = fv::Expression(b.ambient, where + ".ambient");
      }
    } else if (std::ranges::count(symmetry_patches, name) > 0) {
      here.type = Kind::symmetry;
    }
    conditions_.push_back(condition_of(here.type));
    on_patch_.push_back(std::move(here));
  }
  // The last patch contains the faces between materials.
  if (names.size() == mesh.patches.size()) return;
  conditions_.push_back(fv::HeatCondition::bonded);
  on_patch_.emplace_back();
}

bool HeatBoundaries::gives_temperature() const {
  return std::ranges::count(conditions_, fv::HeatCondition::temperature) > 0;
}

bool HeatBoundaries::any_transfer() const {
  return std::ranges::any_of(on_patch_, [](const OnPatch& p) { return p.type == Kind::convection; });
}

bool HeatBoundaries::transfer_uses_time() const {
  return std::ranges::any_of(on_patch_, [](const OnPatch& p) { return p.coefficient.uses_time(); });
}

void HeatBoundaries::known(const fv::ConductionOperator& conduction, double t,
                           std::span<double> values) const {
  each_known(conduction, values, [&](std::size_t p, const Vec3& x) { return on_patch_[p].value(x, t); });
}

void HeatBoundaries::mark_known(const fv::ConductionOperator& conduction, const std::string& patch,
                                std::span<double> values) const {
  each_known(conduction, values,
             [&](std::size_t p, const Vec3&) { return mesh_->patches[p].name == patch ? 1. : 0.; });
}

template <class Value>
void HeatBoundaries::each_known(const fv::ConductionOperator& conduction, std::span<double> values,
                                const Value& value) const {
  const auto& points = conduction.known_points();
  // A vertex on two such patches takes the value of the first (order of the mesh file).
  std::vector<Index> column(mesh_->points.n_local(), -1);
  for (std::size_t i = 0; i < points.size(); ++i) column[points[i]] = static_cast<Index>(i);
  std::size_t next = points.size();
  for (std::size_t p = 0; p < on_patch_.size(); ++p) {
    if (conditions_[p] != fv::HeatCondition::temperature) continue;
    const mesh::Patch& patch = mesh_->patches[p];
    const auto take_points = [&](Index first, Index count) {
      for (Index f = first; f < first + count; ++f)
        for (const Index v : mesh_->face_points[f]) {
          if (column[v] < 0) continue;
          values[column[v]] = value(p, geometry_->points[v]);
          column[v] = -1;
        }
    };
    take_points(patch.first, patch.count);
    take_points(patch.ghost_first, patch.ghost_count);
  }
  for (std::size_t p = 0; p < on_patch_.size(); ++p) {
    if (conditions_[p] != fv::HeatCondition::temperature) continue;
    const mesh::Patch& patch = mesh_->patches[p];
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      values[next++] = value(p, geometry_->face_centre[f]);
  }
}

void HeatBoundaries::fluxes(double t, std::span<double> heat, std::span<double> transfer) const {
  std::size_t next = 0;
  for (std::size_t p = 0; p < on_patch_.size(); ++p) {
    if (conditions_[p] != fv::HeatCondition::flux) continue;
    const OnPatch& here = on_patch_[p];
    const mesh::Patch& patch = mesh_->patches[p];
    for (Index f = patch.first; f < patch.first + patch.count; ++f, ++next) {
      const double area = geometry_->face_area[f].norm();
      heat[next] = 0;
      if (!transfer.empty()) transfer[next] = 0;
      // A flux is integrated; a film acts at the center, where the scheme has the temperature of the face.
      if (here.type == Kind::flux && here.value.uses_space())
        heat[next] = area * fv::mean_over_face(*mesh_, *geometry_, f, [&](const Vec3& x) {
                              return Vec3(here.value(x, t), 0, 0);
                            }).whole[0];
      else if (here.type == Kind::flux)
        heat[next] = area * here.value(geometry_->face_centre[f], t);
      if (here.type == Kind::convection) {
        const Vec3& x = geometry_->face_centre[f];
        transfer[next] = here.coefficient(x, t);
        heat[next] = area * transfer[next] * here.ambient(x, t);
      }
    }
  }
}

}  // namespace couplet::solid
