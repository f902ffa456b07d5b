// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/fluxes.hpp"

#include <cmath>
#include <limits>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

/// This rank's part; the pressure times the area.
template <int D>
void add_faces(const Fluid<D>& fluid, std::span<const double> pressure, const mesh::Patch& patch,
               std::span<double> sums) {
  const mesh::Mesh& mesh = fluid.mesh();
  const State<D>& s = fluid.state();
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const Index b = f - mesh.n_interior;
    const double flux = s.mesh_flux.empty() ? s.phi[f] : s.phi[f] - s.mesh_flux[f];
    const double area = s.placement->area[f].norm();
    const Vec<D> momentum = fluid.parameters().density * flux * s.u_boundary[b] + fluid.pressure_force()[b] +
                            fluid.viscous_force()[b];
    sums[0] += flux;
    sums[1] += area * pressure[b];
    sums[2] += area;
    for (int a = 0; a < D; ++a) sums[3 + a] += momentum[a];
  }
}

}  // namespace

template <int D>
std::vector<PatchFlux<D>> patch_fluxes(const Fluid<D>& fluid) {
  constexpr std::size_t width = 3 + D;
  const mesh::Mesh& mesh = fluid.mesh();
  const auto pressure = fluid.pressure();
  if (!pressure || fluid.pressure_force().empty()) return {};
  std::vector<double> sums(mesh.patches.size() * width, 0);
  for (std::size_t p = 0; p < mesh.patches.size(); ++p)
    add_faces(fluid, pressure->boundary, mesh.patches[p], std::span(sums).subspan(p * width, width));
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  std::vector<PatchFlux<D>> result;
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    const double* of_patch = sums.data() + p * width;
    if (!(of_patch[2] > 0)) continue;
    result.push_back({mesh.patches[p].name, of_patch[0], Eigen::Map<const Vec<D>>(of_patch + 3),
                      of_patch[1] / of_patch[2], of_patch[2]});
  }
  return result;
}

template <int D>
FlowArea flow_area(const PatchFlux<D>& from, const PatchFlux<D>& to, double density) {
  const double mass = -density * from.volume, drop = from.mean_pressure - to.mean_pressure,
               area = mass / std::sqrt(2 * density * std::abs(drop)) * (drop < 0 ? -1 : 1);
  return {mass, drop, drop != 0 ? area : std::numeric_limits<double>::quiet_NaN()};
}

template FlowArea flow_area<2>(const PatchFlux<2>&, const PatchFlux<2>&, double);
template FlowArea flow_area<3>(const PatchFlux<3>&, const PatchFlux<3>&, double);
template std::vector<PatchFlux<2>> patch_fluxes<2>(const Fluid<2>&);
template std::vector<PatchFlux<3>> patch_fluxes<3>(const Fluid<3>&);

}  // namespace couplet::fluid
