// SPDX-License-Identifier: Apache-2.0
// Layers that the mesh does not resolve, and turbulence models.
#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/output/derived.hpp"

namespace couplet::fluid {

namespace {

// Ducts become turbulent at 2300 based on the mean speed; the maximum of plane laminar flow is 3/2 of it.
constexpr double laminar_below = 3450;

/// Largest y+ at walls; 0 without walls.
template <int D>
double largest_yplus(const FluidView<D>& view) {
  double largest = 0;
  for (const mesh::Patch& patch : view.mesh.patches)
    if (is_wall(view.parameters().boundaries.at(patch.name)))
      largest = std::max(largest, summarise_wall(view.fluid, patch).largest_yplus);
  return largest;
}

/// 4 times volume over wall area [m]; NaN without walls. Collective.
template <int D>
double hydraulic_diameter(const Fluid<D>& fluid) {
  const mesh::Mesh& mesh = fluid.mesh();
  const Placement<D>& at = *fluid.state().placement;
  std::array<double, 2> sums{};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) sums[0] += at.volume[c];
  for (const mesh::Patch& patch : mesh.patches)
    if (is_wall(fluid.parameters().boundaries.at(patch.name)))
      for (Index f = patch.first; f < patch.first + patch.count; ++f) sums[1] += at.area[f].norm();
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  return sums[1] > 0 ? 4 * sums[0] / sums[1] : std::numeric_limits<double>::quiet_NaN();
}

struct Shear {
  double reynolds;   // largest of a cell
  double viscosity;  // smallest of a cell [m^2/s]
};

/// Largest Reynolds number of the shear within a cell, S h^2/nu. S is the smaller of the rates of strain and of rotation, because a
/// stagnating flow does not rotate and a turning one is not strained. h is the size of the cell along which the velocity varies. Collective.
template <int D>
Shear largest_shear(const FluidView<D>& view) {
  const mesh::Mesh& mesh = view.mesh;
  const State<D>& s = view.fluid.state();
  const Placement<D>& at = *s.placement;
  std::vector<Tensor<D>> gradient;
  velocity_gradient<D>(mesh, at, s.u, s.u_boundary, gradient);
  Vectors<D> across(std::size_t(mesh.cells.n_local()),
                    Vec<D>::Zero());  // area of a cell across each axis, twice
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    across[mesh.owner[f]] += at.area[f].cwiseAbs();
    if (f < mesh.n_interior) across[mesh.neighbour[f]] += at.area[f].cwiseAbs();
  }
  const auto [rho, mu, nu, sound] = view.properties();
  const auto& law = view.parameters().viscosity_law;
  const std::vector<double> viscosity =
      law ? viscosity_in_cells<D>(view.parameters(), s, gradient) : std::vector<double>();
  double largest = 0, smallest = law ? std::numeric_limits<double>::infinity() : nu;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double local = law ? viscosity[c] / rho : nu;
    smallest = std::min(smallest, local);
    const Tensor<D>& g = gradient[c];  // du_i/dx_j
    const double strain = (g + g.transpose()).norm(), rotation = (g - g.transpose()).norm(), size = g.norm();
    if (!(size > 0)) continue;
    const Vec<D> extent = 2 * at.volume[c] * across[c].cwiseInverse();
    const double change = (g * extent.asDiagonal()).norm() / size;
    largest = std::max(largest, std::min(strain, rotation) / std::sqrt(2.) * change * change / local);
  }
  return {parallel::max(mesh.comm, largest), parallel::min(mesh.comm, smallest)};
}

/// True if the flow has no third dimension in which vortices stretch: most cells reach from one boundary to the
/// opposite one, or across periodic patches to themselves. Collective.
template <int D>
bool is_plane(const FluidView<D>& view) {
  if (D == 2) return true;
  constexpr double opposite = -0.9;  // cosine of two outward normals
  const mesh::Mesh& mesh = view.mesh;
  const Index owned = mesh.cells.n_owned();
  std::vector<char> spans(owned, 0);
  for (Index f = 0; f < mesh.n_interior; ++f)
    if (mesh.owner[f] < owned && mesh.cell_id[mesh.owner[f]] == mesh.cell_id[mesh.neighbour[f]])
      spans[mesh.owner[f]] = 1;
  std::vector<std::pair<Index, Index>> faces;  // by cell
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) faces.emplace_back(mesh.owner[f], f);
  std::ranges::sort(faces);
  const Vectors<D>& area = view.fluid.state().placement->area;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = i + 1; j < faces.size() && faces[j].first == faces[i].first; ++j) {
      const Vec<D>&a = area[faces[i].second], &b = area[faces[j].second];
      if (a.dot(b) < opposite * a.norm() * b.norm()) spans[faces[i].first] = 1;
    }
  const auto deep = parallel::sum(mesh.comm, double(std::ranges::count(spans, char(1))));
  return 2 * deep > double(mesh.cells.n_global());
}

/// Largest eddy viscosity over the molecular one.
template <int D>
double eddy_viscosity(const FluidView<D>& view) {
  double largest = 0;
  for (const double eddy : view.fluid.state().eddy) largest = std::max(largest, eddy);
  return parallel::max(view.mesh.comm, largest) * view.properties().rho / view.properties().mu;
}

}  // namespace

// Free layers are as thin as at their origin. A mesh that resolves the wall layers (y+ up to 1) also resolves
// those shed from them. Flow that remains laminar near walls needs no turbulence model; other mesh errors are in the estimated error.
diagnostics::EffectFinding unresolved_layers(int dimension, double shear, double yplus, double reynolds) {
  const double limit = yplus > 0 && yplus <= 1 ? 250 : 50;
  diagnostics::EffectFinding e{
      .effect = "turbulence model",
      .number = shear,
      .limit = limit,
      .what = fmt::format("max Reynolds number of the shear within a cell = {:.3g}, max y+ = {:.3g}", shear,
                          yplus),
      .advice =
          dimension == 2
              ? "steep layers may be thinner than the mesh: refine it; if the flow is turbulent, use 'turbulence', "
                "'dimension: 3' and many cells in each direction"
              : "steep layers may be thinner than the mesh: refine it, or add 'turbulence' if the flow is turbulent"};
  if (shear > limit && reynolds < laminar_below) {
    e.number = reynolds, e.limit = laminar_below, e.share = 0;
    e.what = fmt::format(
        "Reynolds number (max speed; hydraulic diameter or layers since the start) = {:.3g}: laminar; {}",
        reynolds, e.what);
  } else {
    // The thickness of the layer scales with the inverse root of the number, which gives the share that a coarse mesh misses.
    e.share = shear > limit ? 1 - std::sqrt(limit / shear) : 0;
  }
  return e;
}

// Energy passes to smaller eddies by vortex stretching, which is absent in 2-D and on a mesh one cell deep. There the models only add
// friction, and layers thicken with the square root of the viscosity.
diagnostics::EffectFinding eddies(int dimension, double eddy_viscosity) {
  diagnostics::EffectFinding e{
      .effect = dimension == 3 ? "turbulence model" : "eddy viscosity in two dimensions",
      .number = eddy_viscosity,
      .limit = 0.01,
      .what = fmt::format("max eddy viscosity = {:.2g} times the molecular viscosity", eddy_viscosity),
      .left_out = false};
  if (dimension == 3 || eddy_viscosity <= e.limit) {
    e.is_spare = true;
    e.saves = 0.3;  // of a step, at least (32 x 32 squares to 8 x 8 x 8 cubes)
    return e;
  }
  e.advice =
      "vortices in two dimensions do not stretch, so the model represents no turbulence: omit 'turbulence', or use 'dimension: "
      "3' and many cells in each direction";
  e.share = 1 - 1 / std::sqrt(1 + eddy_viscosity);
  return e;
}

diagnostics::EffectFinding varying_viscosity(double variation, double mean) {
  return {.effect = "viscosity law",
          .number = variation,
          .limit = 0.01,
          .what = fmt::format(
              "standard deviation of the viscosity, by dissipated power = {:.2g} of its mean {:.4g} Pa s",
              variation, mean),
          .left_out = false,
          .is_spare = true,
          .saves = 0.3};
}

diagnostics::EffectFinding unresolved_walls(double yplus) {
  return {.effect = "resolved walls",
          .number = yplus,
          .limit = 2,
          .what = fmt::format("max y+ = {:.3g}", yplus),
          .advice = "there is no wall function: refine at the walls to y+ of about 1",
          .left_out = false};
}

// A 2-D model does not resolve what is missing without it.
template <int D>
std::optional<diagnostics::Finding> turbulence_model(const FluidView<D>& view) {
  const FluidParameters& p = view.parameters();
  const int dimension = is_plane(view) ? 2 : 3;
  if (p.turbulence && dimension == 3) return diagnostics::finding_of(eddies(3, eddy_viscosity(view)));
  if (!p.viscosity_law && !(p.viscosity > 0)) return {};
  const auto [shear, nu] = largest_shear(view);
  double width = hydraulic_diameter(view.fluid);
  // At the walls of a flow that starts from rest, layers are as thick as friction has reached: below U^2 t/nu = 9e4 (a displacement
  // thickness of 520 nu/U), no disturbance of them grows [Schlichting]. Two of them fill this width.
  if (p.initial_velocity.empty())
    width = std::min(width, 11.5 * std::sqrt(nu * (view.step.time + view.step.dt)));
  const double reynolds = largest_speed(view) * width / nu;
  return diagnostics::finding_of(unresolved_layers(dimension, shear, largest_yplus(view), reynolds));
}

// A viscosity that hardly varies where the flow dissipates energy could be a number.
template <int D>
std::optional<diagnostics::Finding> variation_of_viscosity(const FluidView<D>& view) {
  const auto& law = view.parameters().viscosity_law;
  if (!law) return {};
  const State<D>& s = view.fluid.state();
  std::vector<Tensor<D>> gradient;
  velocity_gradient<D>(view.mesh, *s.placement, s.u, s.u_boundary, gradient);
  const std::vector<double> viscosity = viscosity_in_cells<D>(view.parameters(), s, gradient);
  std::array<double, 3> sums{};  // power, and its sums of the viscosity and its square
  for (Index c = 0; c < view.mesh.cells.n_owned(); ++c) {
    const double mu = viscosity[c],
                 power = mu * s.placement->volume[c] * (gradient[c] + gradient[c].transpose()).squaredNorm();
    sums[0] += power, sums[1] += power * mu, sums[2] += power * mu * mu;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, view.mesh.comm);
  if (!(sums[0] > 0)) return {};
  const double mean = sums[1] / sums[0], square = sums[2] / sums[0] - mean * mean;
  return diagnostics::finding_of(varying_viscosity(std::sqrt(std::max(0., square)) / mean, mean));
}

template <int D>
std::optional<diagnostics::Finding> eddies_in_two_dimensions(const FluidView<D>& view) {
  if (!view.parameters().turbulence || !is_plane(view)) return {};
  return diagnostics::finding_of(eddies(2, eddy_viscosity(view)));
}

template <int D>
std::optional<diagnostics::Finding> resolved_walls(const FluidView<D>& view) {
  if (!view.parameters().turbulence) return {};
  return diagnostics::finding_of(unresolved_walls(largest_yplus(view)));
}

template std::optional<diagnostics::Finding> turbulence_model(const FluidView<2>&);
template std::optional<diagnostics::Finding> turbulence_model(const FluidView<3>&);
template std::optional<diagnostics::Finding> eddies_in_two_dimensions(const FluidView<2>&);
template std::optional<diagnostics::Finding> eddies_in_two_dimensions(const FluidView<3>&);
template std::optional<diagnostics::Finding> variation_of_viscosity(const FluidView<2>&);
template std::optional<diagnostics::Finding> variation_of_viscosity(const FluidView<3>&);
template std::optional<diagnostics::Finding> resolved_walls(const FluidView<2>&);
template std::optional<diagnostics::Finding> resolved_walls(const FluidView<3>&);

}  // namespace couplet::fluid
