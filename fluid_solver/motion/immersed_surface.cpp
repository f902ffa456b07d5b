// SPDX-License-Identifier: Apache-2.0
// The surface of immersed bodies: what the velocity is beside it, and what acts on it.
#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"
#include "fluid_solver/motion/immersed.hpp"

namespace couplet::fluid {
namespace {

// Share of the rate of shear at which a cell whose centre nears the surface goes over to the line at the surface.
constexpr double of_shear = 0.3;

}  // namespace

template <int D>
void ImmersedBodies<D>::hold(const Placement<D>& at, double dt, Vectors<D>& u) const {
  if (cut_)
    force_by_cuts(at, dt, u);
  else
    force_by_steps(at, u);
}

/// u_N = u_b + (u_b - u_P) |level_N| / |level_P|, the mean over the fluid cells beside N. The quotient is
/// limited to one, where the fluid cell is closer to the surface than N.
template <int D>
void ImmersedBodies<D>::force_by_steps(const Placement<D>& at, Vectors<D>& u) const {
  std::vector<double> weight(body_.size(), 0.0);
  Vectors<D> sum(body_.size(), Vec<D>::Zero());
  for (const Index f : faces_) {
    const bool owner_solid = is_solid(mesh_.owner[f]);
    const Index inside = owner_solid ? mesh_.owner[f] : mesh_.neighbour[f],
                outside = owner_solid ? mesh_.neighbour[f] : mesh_.owner[f];
    const double quotient = std::min(1.0, -depth_[inside] / std::max(depth_[outside], -depth_[inside]));
    sum[inside] += at.conductance[f] * quotient * (velocity_[inside] - u[outside]);
    weight[inside] += at.conductance[f];
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    if (is_solid(c)) u[c] = velocity_[c] + (weight[c] > 0 ? Vec<D>(sum[c] / weight[c]) : Vec<D>::Zero());
  mesh_.cells.update_ghosts(flat<D>(u), D);
}

/// du/ds at the surface, s the distance from it, per local cell that is not all open: least squares over the neighbours P whose
/// centres are farther out, weighted so that one which becomes such a neighbour comes in evenly.
template <int D>
Vectors<D> ImmersedBodies<D>::slopes(const Placement<D>& at, const Vectors<D>& u) const {
  Vectors<D> slope(body_.size(), Vec<D>::Zero());
  std::vector<double> weight(body_.size(), 0.0);
  const auto add = [&](Index c, Index from, double g) {
    const double farther = depth_[from] - std::max(depth_[c], 0.0);
    if (shape_.cells[c] == 1 || farther <= 0) return;
    slope[c] += g * farther * depth_[from] * (u[from] - velocity_[c]);
    weight[c] += g * farther * depth_[from] * depth_[from];
  };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    add(mesh_.owner[f], mesh_.neighbour[f], at.conductance[f]);
    add(mesh_.neighbour[f], mesh_.owner[f], at.conductance[f]);
  }
  for (std::size_t c = 0; c < slope.size(); ++c)
    if (weight[c] > 0) slope[c] /= weight[c];
  mesh_.cells.update_ghosts(flat<D>(slope), D);
  return slope;
}

/// Inside: u_b + s du/ds. A cell that is cut with its centre outside, 0 < s < e, e the extent of the cell, goes over to that line at
/// the rate (nu/e^2 + 0.3 |du/ds|) (e/s - 1), implicitly: evenly from none to at once as its centre nears the surface, whatever the
/// step. A share of the line in each step, by contrast, would be all of it at small steps.
template <int D>
void ImmersedBodies<D>::force_by_cuts(const Placement<D>& at, double dt, Vectors<D>& u) const {
  const auto is_beside = [&](Index c, bool inside) {
    return shape_.cells[c] < 1 && (depth_[c] <= 0) == inside;
  };
  Vectors<D> slope = slopes(at, u);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    if (!is_beside(c, false)) continue;
    const double e = shape_.extent[c], s = depth_[c], rate = nu_ / (e * e) + of_shear * slope[c].norm();
    const double own = s / (s + rate * std::max(0.0, e - s) * dt);
    u[c] = own * u[c] + (1 - own) * (velocity_[c] + s * slope[c]);
  }
  mesh_.cells.update_ghosts(flat<D>(u), D);
  slope = slopes(at, u);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    if (is_beside(c, true)) u[c] = velocity_[c] + depth_[c] * slope[c];
  mesh_.cells.update_ghosts(flat<D>(u), D);
}

/// At s' in the middle of what is open of a cell: u + (s' - s) du/ds.
template <int D>
void ImmersedBodies<D>::carry(const Placement<D>& at, const Vectors<D>& u, std::vector<double>& phi) const {
  if (!cut_) return;
  const Vectors<D> slope = slopes(at, u);
  const auto in_open = [&](Index c) -> Vec<D> {
    if (shape_.cells[c] == 1) return u[c];
    if (depth_[c] <= 0) return velocity_[c] + shape_.open_depth[c] * slope[c];
    return u[c] + (shape_.open_depth[c] - depth_[c]) * slope[c];
  };
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
    if (beside_surface(f)) phi[f] = 0.5 * (in_open(mesh_.owner[f]) + in_open(other(f))).dot(at.area[f]);
}

/// From the fluid cells at the faces of the marked ones.
template <int D>
void ImmersedBodies<D>::add_forces_of_steps(const Placement<D>& at, const std::vector<double>& p,
                                            const Vectors<D>& u, double viscosity, Sums& sums) const {
  for (const Index f : faces_) {
    const bool owner_solid = is_solid(mesh_.owner[f]);
    const Index inside = owner_solid ? mesh_.owner[f] : mesh_.neighbour[f],
                outside = owner_solid ? mesh_.neighbour[f] : mesh_.owner[f];
    if (outside >= mesh_.cells.n_owned()) continue;  // that rank counts it
    const Vec<D> pressure = (owner_solid ? -1 : 1) * p[outside] * at.area[f],
                 friction = viscosity * at.conductance[f] * (u[outside] - u[inside]);
    double* sum = sums.data() + std::size_t(body_[inside]) * 2 * D;
    for (int c = 0; c < D; ++c) {
      sum[c] += pressure[c];
      sum[D + c] += friction[c];
    }
  }
}

/// On the part of the surface in each cell: the pressure carried there by its gradient, and mu du/ds along it.
template <int D>
void ImmersedBodies<D>::add_forces_of_cuts(const Placement<D>& at, const PressureLevel<D>& level,
                                           const Vectors<D>& u, double viscosity, Sums& sums) const {
  const Vectors<D> slope = slopes(at, u);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double area = shape_.wall[c].norm();
    if (is_closed(c) || area == 0) continue;
    const Vec<D> normal = shape_.wall[c] / area;
    const double there = level.p[c] + depth_[c] * level.gradient[c].dot(normal);
    Vec<D> shear = shape_.cells[c] < 1 ? slope[c] : Vec<D>((u[c] - velocity_[c]) / depth_[c]);
    shear -= shear.dot(normal) * normal;
    double* sum = sums.data() + std::size_t(nearest_[c]) * 2 * D;
    for (int i = 0; i < D; ++i) {
      sum[i] += there * shape_.wall[c][i];
      sum[D + i] += viscosity * area * shear[i];
    }
  }
}

template <int D>
std::vector<std::pair<Vec<D>, Vec<D>>> ImmersedBodies<D>::forces(const Placement<D>& at,
                                                                 const PressureLevel<D>& level,
                                                                 const Vectors<D>& u,
                                                                 double viscosity) const {
  Sums sums(names_.size() * 2 * D, 0.0);
  if (cut_)
    add_forces_of_cuts(at, level, u, viscosity, sums);
  else
    add_forces_of_steps(at, level.p, u, viscosity, sums);
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
  std::vector<std::pair<Vec<D>, Vec<D>>> result(names_.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    for (int c = 0; c < D; ++c) {
      result[i].first[c] = sums[i * 2 * D + c];
      result[i].second[c] = sums[i * 2 * D + D + c];
    }
  return result;
}

template void ImmersedBodies<2>::hold(const Placement<2>&, double, Vectors<2>&) const;
template void ImmersedBodies<2>::carry(const Placement<2>&, const Vectors<2>&, std::vector<double>&) const;
template std::vector<std::pair<Vec<2>, Vec<2>>> ImmersedBodies<2>::forces(const Placement<2>&,
                                                                          const PressureLevel<2>&,
                                                                          const Vectors<2>&, double) const;
template void ImmersedBodies<3>::hold(const Placement<3>&, double, Vectors<3>&) const;
template void ImmersedBodies<3>::carry(const Placement<3>&, const Vectors<3>&, std::vector<double>&) const;
template std::vector<std::pair<Vec<3>, Vec<3>>> ImmersedBodies<3>::forces(const Placement<3>&,
                                                                          const PressureLevel<3>&,
                                                                          const Vectors<3>&, double) const;

}  // namespace couplet::fluid
