// SPDX-License-Identifier: Apache-2.0
// What the fluid does to its walls.
#include "fluid_solver/step/loads.hpp"

namespace couplet::fluid {

template <int D>
Loads<D>::Loads(StepWork<D>& work) : k_(work) {
  const Boundary<D>& boundary = work.boundary;
  for (std::size_t b = 0; b < boundary.rows().pressure.size(); ++b)
    if (boundary.is_interface(static_cast<Index>(b))) interface_faces_.push_back(static_cast<Index>(b));
}

// The viscous flux of the prediction is kept: each project() corrects that of the guess, not the last one.
template <int D>
void Loads<D>::remember_prediction(double weight) {
  weight_ = weight;
  w_predicted_.resize(interface_faces_.size());
  viscous_predicted_.resize(interface_faces_.size());
  for (std::size_t i = 0; i < interface_faces_.size(); ++i) {
    w_predicted_[i] = k_.w[interface_faces_[i]];
    viscous_predicted_[i] = k_.viscous_flux[interface_faces_[i]];
  }
}

/// Viscous flux of the current wall velocity, F - a mu g (c_t + 4 c_n) with the tangential and the normal part of c = w - w*:
/// left at the guess w* the slip c would come as a force one step late, at a two-step oscillation a mass of -mu g dt. The
/// factor of c_n is found by trial: a wall of a fortieth of its added mass (nu dt/h^2 = 100) diverges with a half and less,
/// zigzags by 0.32 with one, 0.16 with two and 0.08 with four; 0.15 is smooth. c vanishes with the square of the step. The
/// explicit branch takes the flux of level n, which knows its wall velocity.
template <int D>
void Loads<D>::correct_shear() {
  if (weight_ == 0) return;
  for (std::size_t i = 0; i < interface_faces_.size(); ++i) {
    const Index b = interface_faces_[i], f = k_.mesh.n_interior + b;
    const Vec<D> n = k_.step.to->area[f].normalized(), c = k_.w[b] - w_predicted_[i];
    k_.viscous_flux[b] = viscous_predicted_[i] - weight_ * k_.parameters.viscosity *
                                                     k_.step.to->conductance[f] * (c + 3 * c.dot(n) * n);
  }
}

template <int D>
void Loads<D>::set_forces(const State<D>& from) {
  correct_shear();
  pressure_force_.resize(k_.w.size());
  viscous_force_.resize(k_.w.size());
  for (std::size_t b = 0; b < k_.w.size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b);
    double p = k_.p_boundary[b];
    if (k_.frame)
      p += k_.rho * k_.frame->potential(k_.by.time + k_.step.dt / 2, k_.step.to->boundary_centre[b]);
    const Vec<D> n = k_.step.to->area[f].normalized(), normal = k_.viscous_flux[b].dot(n) * n;
    pressure_force_[b] = 0.5 * p * (from.placement->area[f] + k_.step.to->area[f]) + normal;
    viscous_force_[b] = k_.viscous_flux[b] - normal;
  }
}

template class Loads<2>;
template class Loads<3>;

}  // namespace couplet::fluid
