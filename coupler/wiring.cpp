// SPDX-License-Identifier: Apache-2.0
#include "coupler/wiring.hpp"

#include <algorithm>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "coupler/map_projection.hpp"

namespace couplet {
namespace {

using Place = Interface::Place;

const Interface::Datum* find(const std::vector<Interface::Datum>& list, const std::string& name) {
  for (const auto& datum : list)
    if (datum.name == name) return &datum;
  return nullptr;
}

/// All that `to` takes must come from `from`, in the same unit and at the given kind of place.
void check_link(const Side& from, const Side& to, Place place) {
  std::vector<std::string> given;
  for (const auto& datum : from.interface.gives) given.push_back(datum.name);
  for (const auto& taken : to.interface.takes) {
    const Interface::Datum* source = find(from.interface.gives, taken.name);
    if (source == nullptr)
      throw Error("'{}' takes '{}', which '{}' does not give. It gives: {}.", to.name, taken.name, from.name,
                  given.empty() ? "nothing" : join(given));
    if (source->unit != taken.unit)
      throw Error("'{}' takes '{}' in {}, but '{}' gives it in {}.", to.name, taken.name, taken.unit,
                  from.name, source->unit);
    if (source->place != place || taken.place != place)
      throw Error("'{}' takes and '{}' gives '{}' at different places: {} are needed.", to.name, from.name,
                  taken.name, place == Place::vertices ? "vertices" : "faces");
  }
}

PointSet vertices(const Side& side) {
  return {"vertices of '" + side.name + "'", side.interface.vertices, {}, &side.interface};
}

PointSet faces(const Side& side) {
  PointSet set{"faces of '" + side.name + "'", side.interface.face_centres, {}, &side.interface};
  for (const Vec3& area : side.interface.face_areas) set.sizes.push_back(area.norm());
  return set;
}

Balance balance(const Interface& interface, const std::vector<Interface::Datum>& data,
                const SparseMap& to_faces, const Exchange& values, const std::vector<double>& increment) {
  Balance result;
  const int dim = interface.dim;
  const std::vector<double> moved = to_faces.apply(increment, dim);
  for (const auto& datum : data) {
    const auto found = values.find(datum.name);
    if (found == values.end() || datum.place != Place::faces || datum.unit != "N") continue;
    for (std::size_t f = 0; f < interface.face_centres.size(); ++f)
      for (int c = 0; c < dim; ++c) {
        const double force = found->second[f * dim + c];
        result.force[c] += force;
        result.work += force * moved[f * dim + c];
      }
  }
  return result;
}

}  // namespace

Wiring::Wiring(const Side& fluid, const Side& structure, const std::optional<Side>& mesh,
               const MappingParameters& mapping)
    : fluid_(fluid), structure_(structure), mesh_(mesh), dim_(structure.interface.dim) {
  for (const Side* side : {&fluid_, &structure_, mesh_ ? &*mesh_ : &fluid_})
    check_corners(side->interface, side->name);
  for (const Side* side : {&fluid_, mesh_ ? &*mesh_ : &fluid_})
    if (side->interface.dim != dim_)
      throw Error("'{}' has {} dimensions and '{}' has {}: both must have the same.", side->name,
                  side->interface.dim, structure.name, dim_);
  for (const char* motion : {"displacement", "velocity"}) {
    const Interface::Datum* datum = find(structure.interface.gives, motion);
    if (datum == nullptr || datum->place != Place::vertices)
      throw Error("The structure '{}' does not give '{}' at vertices, which is part of the coupling unknown.",
                  structure.name, motion);
  }
  check_link(structure_, fluid_, Place::vertices);
  check_link(fluid_, structure_, Place::faces);
  to_fluid_.emplace(Mapping::Kind::consistent, vertices(structure_), vertices(fluid_), mapping);
  to_structure_.emplace(Mapping::Kind::conservative, faces(fluid_), faces(structure_), mapping);
  notes_ = {"motion: " + to_fluid_->summary(), "load: " + to_structure_->summary()};
  if (mesh_) {
    check_link(structure_, *mesh_, Place::vertices);
    to_mesh_.emplace(Mapping::Kind::consistent, vertices(structure_), vertices(*mesh_), mapping);
    notes_.push_back("mesh: " + to_mesh_->summary());
  }
  for (const auto& datum : fluid_.interface.gives)
    if (find(structure_.interface.takes, datum.name) == nullptr)
      notes_.push_back(fmt::format("note: nobody takes '{}' of '{}'", datum.name, fluid_.name));
  fluid_faces_ = vertices_to_faces(fluid_.interface);
  structure_faces_ = vertices_to_faces(structure_.interface);
}

Exchange Wiring::motion(const InterfaceState& x, const Side& to, const Mapping& mapping) const {
  Exchange data;
  for (const auto& datum : to.interface.takes)
    data[datum.name] = mapping.apply(datum.name == "velocity" ? x.velocity : x.displacement, dim_);
  return data;
}

Exchange Wiring::to_structure(const Exchange& from_fluid) const {
  Exchange data;
  for (const auto& datum : structure_.interface.takes) {
    const auto found = from_fluid.find(datum.name);
    if (found == from_fluid.end() ||
        found->second.size() != fluid_.interface.face_centres.size() * std::size_t(dim_))
      throw Error("'{}' did not give '{}' for each of its {} faces, as it had announced.", fluid_.name,
                  datum.name, fluid_.interface.face_centres.size());
    data[datum.name] = to_structure_->apply(found->second, dim_);
  }
  return data;
}

InterfaceState Wiring::from_structure(Exchange data) const {
  InterfaceState state{std::move(data["displacement"]), std::move(data["velocity"])};
  if (state.displacement.size() != n_unknowns() || state.velocity.size() != n_unknowns())
    throw Error(
        "'{}' did not give 'displacement' and 'velocity' for each of its {} vertices, as it had announced.",
        structure_.name, structure_.interface.vertices.size());
  return state;
}

Balance Wiring::fluid_balance(const Exchange& data, const std::vector<double>& increment) const {
  return balance(fluid_.interface, structure_.interface.takes, fluid_faces_, data, increment);
}

Balance Wiring::structure_balance(const Exchange& data, const std::vector<double>& increment) const {
  return balance(structure_.interface, structure_.interface.takes, structure_faces_, data, increment);
}

}  // namespace couplet
