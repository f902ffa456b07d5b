// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/output.hpp"

#include <algorithm>

#include "fluid_solver/output/derived.hpp"

namespace couplet::fluid {

/// Per owned boundary face; vectors of D values each.
template <int D>
struct FluidSurfaces<D>::Faces {
  std::vector<double> traction, shear, yplus;
};

template <int D>
FluidSurfaces<D>::FluidSurfaces(const Fluid<D>& fluid)
    : fluid_(fluid),
      series_(fluid.mesh(), fluid.points_at_rest(), fluid.parameters().output.surfaces, "output.surfaces") {}

// Forces equal those of forces.csv, and so does their sum.
template <int D>
typename FluidSurfaces<D>::Faces FluidSurfaces<D>::faces() const {
  const mesh::Mesh& mesh = fluid_.mesh();
  const std::size_t n = mesh.boundary.n_owned();
  const auto units = wall_units(fluid_);
  Faces faces{std::vector<double>(n * D), std::vector<double>(n * D), std::vector<double>(n)};
  for (std::size_t b = 0; b < n; ++b) {
    const Vec<D>& area = fluid_.state().placement->area[mesh.n_interior + static_cast<Index>(b)];
    const double size = area.norm();
    const Vec<D> normal = area / size, &friction = fluid_.viscous_force()[b];
    Eigen::Map<Vec<D>>(faces.traction.data() + b * D) = (fluid_.pressure_force()[b] + friction) / size;
    Eigen::Map<Vec<D>>(faces.shear.data() + b * D) = (friction - friction.dot(normal) * normal) / size;
    faces.yplus[b] = units[b][1];
  }
  return faces;
}

/// Per boundary face; empty if no coefficients use this patch, else those of the first by name.
template <int D>
std::vector<double> FluidSurfaces<D>::pressure_coefficient(const mesh::Patch& patch,
                                                           std::span<const double> pressure) const {
  for (const auto& [name, c] : fluid_.parameters().output.coefficients) {
    if (std::ranges::find(c.patches, patch.name) == c.patches.end()) continue;
    const double q = 0.5 * fluid_.parameters().density * c.speed * c.speed;
    std::vector<double> result(pressure.begin(), pressure.end());
    for (double& value : result) value = (value - c.pressure) / q;
    return result;
  }
  return {};
}

template <int D>
void FluidSurfaces<D>::write(double time, const FluidContext& context) {
  const auto pressure = fluid_.pressure();
  if (!pressure || fluid_.pressure_force().empty()) return;
  if (!is_open_) series_.open(context.output_folder, fluid_.moving(), context.restart_time);
  is_open_ = true;
  const Faces all = faces();
  using Place = io::OutputField::Place;
  for (std::size_t i = 0; i < series_.patches().size(); ++i) {
    const mesh::Patch& patch = *series_.patches()[i];
    std::vector<io::OutputField> fields{{"pressure", "Pa", Place::cells, 1, pressure->boundary},
                                        {"traction", "Pa", Place::cells, D, all.traction},
                                        {"wall-shear", "Pa", Place::cells, D, all.shear}};
    if (is_wall(fluid_.parameters().boundaries.at(patch.name)))
      fields.push_back({"y-plus", "-", Place::cells, 1, all.yplus});
    const std::vector<double> cp = pressure_coefficient(patch, pressure->boundary);
    if (!cp.empty()) fields.push_back({"pressure-coefficient", "-", Place::cells, 1, cp});
    series_.write(i, time, fluid_.moving() ? fluid_.state().points : fluid_.points_at_rest(), fields);
  }
}

template class FluidSurfaces<2>;
template class FluidSurfaces<3>;

}  // namespace couplet::fluid
