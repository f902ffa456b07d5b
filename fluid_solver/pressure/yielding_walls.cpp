// SPDX-License-Identifier: Apache-2.0
// The interface as a Robin condition: what the structure would answer to the pressure that the equation finds, w is
// moved by (p_b - p_b^k)/Z off the velocity w^k that the structure gave for p_b^k, Z = m/dt with its mass per area m.
// With p_b = p_P + s - D (w - w^n), D = rho S/(g dt), normal to the wall
//   w = [Z w^k + D w^n + s - p_b^k]/(Z + D) + p_P/(Z + D)
// of which the last part joins the matrix, rho S/(m + rho S/g) a face [badia2008]. Where the iteration stands
// p_b = p_b^k and w = w^k, whatever Z.
#include "fluid_solver/pressure/projection.hpp"

namespace couplet::fluid {

template <int D>
std::vector<double> PressureProjection<D>::admittance() const {
  if (!k_.step.yields && !absorbing_) return {};
  const Placement<D>& at = *k_.step.to;
  std::vector<double> values(k_.w.size(), 0.);
  if (absorbing_) absorbing_->add_admittance(values);
  for (std::size_t b = 0; k_.step.yields && b < k_.boundary.wall_mass().size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b);
    const double area = at.area[f].norm();
    if (k_.boundary.wall_mass()[b] > 0)
      values[b] += k_.rho * area / (k_.boundary.wall_mass()[b] + k_.rho * area / at.conductance[f]);
  }
  return values;
}

/// What is known of w before the pressure is.
template <int D>
void PressureProjection<D>::foresee_walls(const State<D>& from) {
  const Placement<D>& at = *k_.step.to;
  const double dt = k_.step.dt;
  for (std::size_t b = 0; b < k_.boundary.wall_mass().size(); ++b) {
    if (k_.boundary.wall_mass()[b] == 0) continue;
    const Index f = k_.mesh.n_interior + static_cast<Index>(b), p = k_.mesh.owner[f];
    const double area = at.area[f].norm(), g = at.conductance[f];
    const Vec<D> n = at.area[f] / area;
    double source = 0;
    if (!k_.force.empty()) source += k_.rho * k_.force[p].dot(at.area[f]) / g;
    if (!k_.gradient_guess.empty()) source -= k_.gradient_guess[p].dot(at.oblique_of(f)) / g;
    const double z = k_.boundary.wall_mass()[b] / dt, d = k_.rho * area / (g * dt), given = k_.w[b].dot(n);
    const double known = (z * given + d * from.w[b].dot(n) + source - k_.wall_load[b]) / (z + d);
    k_.w[b] += (known - given) * n;
    k_.phi_p[f] = k_.w[b].dot(at.area[f]);
  }
}

template <int D>
void PressureProjection<D>::let_walls_yield() {
  const Placement<D>& at = *k_.step.to;
  const double dt = k_.step.dt;
  for (std::size_t b = 0; b < k_.boundary.wall_mass().size(); ++b) {
    if (k_.boundary.wall_mass()[b] == 0) continue;
    const Index f = k_.mesh.n_interior + static_cast<Index>(b);
    const double area = at.area[f].norm();
    const double resistance = (k_.boundary.wall_mass()[b] + k_.rho * area / at.conductance[f]) / dt;
    k_.w[b] += k_.p[k_.mesh.owner[f]] / resistance * (at.area[f] / area);
    k_.phi_p[f] = k_.w[b].dot(at.area[f]);
  }
}

template std::vector<double> PressureProjection<2>::admittance() const;
template void PressureProjection<2>::foresee_walls(const State<2>&);
template void PressureProjection<2>::let_walls_yield();
template std::vector<double> PressureProjection<3>::admittance() const;
template void PressureProjection<3>::foresee_walls(const State<3>&);
template void PressureProjection<3>::let_walls_yield();

}  // namespace couplet::fluid
