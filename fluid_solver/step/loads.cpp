// SPDX-License-Identifier: Apache-2.0
// What the fluid does to its walls.
#include "fluid_solver/step/loads.hpp"

#include <Eigen/LU>

namespace couplet::fluid {
namespace {

constexpr double least_span = 1e-3;

}  // namespace

template <int D>
Loads<D>::Loads(StepWork<D>& work) : k_(work) {
  const Mesh& mesh = work.mesh;
  const Boundary<D>& boundary = work.boundary;
  for (std::size_t b = 0; b < boundary.kind().size(); ++b)
    if (boundary.is_interface(static_cast<Index>(b))) interface_faces_.push_back(static_cast<Index>(b));
  slot_.assign(mesh.cells.n_local(), -1);
  for (std::size_t b = 0; b < boundary.kind().size(); ++b) {
    const Index p = mesh.owner[mesh.n_interior + static_cast<Index>(b)];
    if (boundary.kind()[b] != FaceKind::velocity || slot_[p] >= 0) continue;
    slot_[p] = static_cast<Index>(fits_.size());
    fits_.push_back({});
  }
  for (Index f = 0; f < mesh.n_interior; ++f)
    if (slot_[mesh.owner[f]] >= 0 || slot_[mesh.neighbour[f]] >= 0) near_walls_.push_back(f);
}

// The viscous force of the prediction is kept: each project() corrects that of the guess, not the last one.
template <int D>
void Loads<D>::remember_prediction(bool implicit) {
  shear_weight_ = implicit ? 0.5 : 0.0;
  w_predicted_.resize(interface_faces_.size());
  shear_predicted_.resize(interface_faces_.size());
  for (std::size_t i = 0; i < interface_faces_.size(); ++i) {
    w_predicted_[i] = k_.w[interface_faces_[i]];
    shear_predicted_[i] = k_.viscous_force[interface_faces_[i]];
  }
}

/// Shear of the current wall velocity, F - theta mu g [c - (c.n) n], c = w - w*: left at the guess w* the
/// slip c would come as a force one step late, at a two-step oscillation a mass of -mu g dt. The explicit
/// branch takes the shear of level n, which knows its wall velocity.
template <int D>
void Loads<D>::correct_shear() {
  if (shear_weight_ == 0) return;
  for (std::size_t i = 0; i < interface_faces_.size(); ++i) {
    const Index b = interface_faces_[i], f = k_.mesh.n_interior + b;
    const Vec<D> n = k_.step.to->area[f].normalized(), c = k_.w[b] - w_predicted_[i];
    k_.viscous_force[b] = shear_predicted_[i] - shear_weight_ * k_.parameters.viscosity *
                                                    k_.step.to->conductance[f] * (c - c.dot(n) * n);
  }
}

/// Pressure on the walls for the load: linear from the cell, p_P + G.(x_b - x_P), with G by least squares
/// over the neighbours, so that it does not know the wall value. The wall value of the scheme itself is first
/// order in the part of the normal gradient that the acceleration does not explain. Cells whose neighbours do
/// not span the space keep that one.
template <int D>
void Loads<D>::extrapolate_to_walls() {
  const Placement<D>& now = *k_.step.to;
  for (Fit& fit : fits_) fit = {};
  const auto add = [&](Index cell, Index neighbour, const Vec<D>& shift) {
    if (slot_[cell] < 0) return;
    Fit& fit = fits_[slot_[cell]];
    const Vec<D> d = now.centre[neighbour] - now.centre[cell] + shift;
    const double weight = 1 / d.squaredNorm();
    fit.matrix += weight * d * d.transpose();
    fit.side += weight * (k_.p[neighbour] - k_.p[cell]) * d;
  };
  for (const Index f : near_walls_) {
    const Vec<D> shift = k_.mesh.shift(f).template head<D>();
    add(k_.mesh.owner[f], k_.mesh.neighbour[f], shift);
    add(k_.mesh.neighbour[f], k_.mesh.owner[f], -shift);
  }
  for (Fit& fit : fits_) {
    fit.usable = fit.matrix.determinant() > least_span;  // weights make the entries of order one
    if (fit.usable) fit.side = (fit.matrix.inverse() * fit.side).eval();
  }
  p_wall_ = k_.p_boundary;
  for (std::size_t b = 0; b < k_.w.size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b), p = k_.mesh.owner[f];
    if (k_.boundary.kind()[b] != FaceKind::velocity || !fits_[slot_[p]].usable) continue;
    p_wall_[b] =
        k_.p[p] + fits_[slot_[p]].side.dot(now.boundary_centre[b].template head<D>() - now.centre[p]);
  }
}

template <int D>
void Loads<D>::set_forces(const State<D>& from) {
  extrapolate_to_walls();
  for (std::size_t b = 0; k_.frame && b < p_wall_.size(); ++b)
    p_wall_[b] += k_.rho * k_.frame->potential(k_.by.time + k_.step.dt / 2, k_.step.to->boundary_centre[b]);
  pressure_force_.resize(k_.w.size());
  for (std::size_t b = 0; b < k_.w.size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b);
    pressure_force_[b] = 0.5 * p_wall_[b] * (from.placement->area[f] + k_.step.to->area[f]);
  }
}

template class Loads<2>;
template class Loads<3>;

}  // namespace couplet::fluid
