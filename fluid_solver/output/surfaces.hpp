// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/io/fields/surface_series.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

struct FluidContext;

/// surface-<patch>.h5 of the patches in `output.surfaces`: pressure, traction and wall shear, y+ at walls, Cp where a
/// section `coefficients` names the wall.
template <int D>
class FluidSurfaces {
 public:
  /// Keeps a reference. Throws Error for a name that is no patch. Collective.
  explicit FluidSurfaces(const Fluid<D>& fluid);
  /// Nothing before the first step, which alone gives a load. Collective.
  void write(double time, const FluidContext& context);

 private:
  struct Faces;
  Faces faces() const;
  std::vector<double> pressure_coefficient(const mesh::Patch& patch, std::span<const double> pressure) const;

  const Fluid<D>& fluid_;
  io::SurfaceSeries series_;
  bool is_open_ = false;
};

}  // namespace couplet::fluid
