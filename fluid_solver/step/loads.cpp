// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/loads.hpp"

namespace couplet::fluid {

/// At an interface the viscous flux is that of the current wall velocity, F - a mu g (c_t + 4 c_n) with the tangential and the normal
/// part of c = w - w*: left at the guess w* the slip c would come as a force one step late, at a two-step oscillation a mass of
/// -mu g dt. The factor of c_n is found by trial: a wall of a fortieth of its added mass (nu dt/h^2 = 100) diverges with a half and less,
/// zigzags by 0.32 with one, 0.16 with two and 0.08 with four; 0.15 is smooth. c vanishes with the square of the step. The
/// explicit branch takes the flux of level n, which knows its wall velocity.
template <int D>
void Loads<D>::set(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction,
                   const Projected<D>& projected, const State<D>& from) {
  const Placement<D>& to = *step.to;
  pressure.resize(projected.w.size());
  viscous.resize(projected.w.size());
  for (std::size_t b = 0; b < projected.w.size(); ++b) {
    const Index f = scene.mesh.n_interior + static_cast<Index>(b);
    const Vec<D> n = to.area[f].normalized();
    Vec<D> flux = prediction.viscous_flux[b];
    if (prediction.weight != 0 && scene.boundary.is_interface(static_cast<Index>(b))) {
      const Vec<D> c = projected.w[b] - prediction.w[b];
      flux -= prediction.weight * scene.fluid.mu * to.conductance[f] * (c + 3 * c.dot(n) * n);
    }
    double p = projected.boundary[b];
    if (scene.frame) p += scene.fluid.rho * scene.frame->potential(step.middle(), to.boundary_centre[b]);
    const Vec<D> normal = flux.dot(n) * n;
    pressure[b] = 0.5 * p * (from.placement->area[f] + to.area[f]) + normal;
    viscous[b] = flux - normal;
  }
}

template struct Loads<2>;
template struct Loads<3>;

}  // namespace couplet::fluid
