// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/io/fields/surface_series.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_context.hpp"
#include "solid_solver/body/solid_fields.hpp"

namespace couplet::solid {

/// surface-<patch>.h5 of the patches in `output.surfaces`: displacement and stress at the points, traction of the faces, and
/// what effects know there (temperature, heat flux).
class SolidSurfaces {
 public:
  /// All by reference. Throws Error for a name that is no patch. Collective.
  SolidSurfaces(const SolidFields& derived, const SolidBody& body, const SolidContext& context);
  /// `points`: displacement of all local points; `places`: where they are. Collective.
  void write(double time, std::span<const double> points, std::span<const Vec3> places);

 private:
  const SolidFields& derived_;
  const SolidBody& body_;
  const SolidContext& context_;
  io::SurfaceSeries series_;
  std::vector<std::uint8_t> wanted_;  // points with stress
  bool is_open_ = false;
};

}  // namespace couplet::solid
