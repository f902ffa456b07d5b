// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/surfaces.hpp"

#include "solid_solver/material/stress.hpp"
#include "solid_solver/output/field_list.hpp"

namespace couplet::solid {

using Place = io::OutputField::Place;

SolidSurfaces::SolidSurfaces(const SolidFields& derived, const SolidBody& body, const SolidContext& context)
    : derived_(derived),
      body_(body),
      context_(context),
      series_(body.mesh(), body.geometry().points, body.parameters().output.surfaces, "output.surfaces"),
      wanted_(series_.points()) {}

void SolidSurfaces::write(double time, std::span<const double> points, std::span<const Vec3> places) {
  if (!is_open_)
    series_.open(context_.output_folder, body_.parameters().output.deformed, context_.restart_time);
  is_open_ = true;
  const int dim = body_.mesh().dim;
  const std::vector<double> stress = derived_.point_stress(points, wanted_);
  std::vector<double> equivalent(wanted_.size(), 0);
  for (std::size_t v = 0; v < wanted_.size(); ++v)
    if (wanted_[v])
      equivalent[v] = equivalent_stress(unpack(std::span(stress).subspan(v * tensor_size, tensor_size)));
  FieldList fields;
  fields.list.push_back({"displacement", "m", Place::points, dim, points});
  fields.add("traction", "Pa", Place::cells, dim, derived_.traction(places, stress));
  fields.add_tensor("stress", "Pa", Place::points, dim, stress);
  fields.add("equivalent-stress", "Pa", Place::points, 1, std::move(equivalent));
  for (const auto& effect : body_.effects()) effect->add_surface_fields(fields.list);
  for (std::size_t i = 0; i < series_.patches().size(); ++i) series_.write(i, time, places, fields.list);
}

}  // namespace couplet::solid
