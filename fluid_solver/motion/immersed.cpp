// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/fv/use.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// A cell is clear of a surface if its center is farther away than this many extents.
constexpr double well_clear = 1.01;
// Fraction of the shear rate at which a cell approaches the linear profile at the surface.
constexpr double of_shear = 0.3;

}  // namespace

template <int D>
ImmersedBodies<D>::ImmersedBodies(const mesh::Mesh& mesh, const FluidParameters& parameters)
    : Obstacles<D>(mesh),
      cut_(parameters.bodies.begin()->second.surface == BodySurface::cut),
      nu_(parameters.properties().nu),
      body_(mesh.cells.n_local(), -1),
      depth_(mesh.cells.n_local(), 0.0),
      velocity_(mesh.cells.n_local(), Vec<D>::Zero()) {
  for (const auto& [name, body] : parameters.bodies) {
    names_.push_back(name);
    fv::uses()["bodies." + name].given = "the body, which closes cells or parts of them,";
    level_.emplace_back(body.level, "bodies." + name + ".level");
    speed_.emplace_back();
    if (!body.velocity.empty())
      speed_.back() = fv::make_expressions(body.velocity, D, "bodies." + name + ".velocity");
  }
  if (!cut_) return;
  nearest_.assign(mesh.cells.n_local(), 0);
  shape_.cells.assign(mesh.cells.n_local(), 1.0);
  shape_.faces.assign(mesh.n_flux_faces(), 1.0);
}

template <int D>
void ImmersedBodies<D>::find_levels(double t, const Placement<D>& at) {
  std::vector<Vec3> places(body_.size(), Vec3::Zero());
  for (std::size_t c = 0; c < places.size(); ++c) places[c].template head<D>() = at.centre[c];
  std::fill(body_.begin(), body_.end(), -1);
  std::fill(depth_.begin(), depth_.end(), std::numeric_limits<double>::infinity());
  std::vector<double> level(places.size());
  for (std::size_t i = 0; i < level_.size(); ++i) {
    level_[i].evaluate(places, t, level);
    for (std::size_t c = 0; c < level.size(); ++c) {
      if (level[c] < 0 && level[c] < depth_[c]) body_[c] = static_cast<int>(i);
      if (cut_ && level[c] < depth_[c]) nearest_[c] = static_cast<int>(i);
      depth_[c] = std::min(depth_[c], level[c]);
    }
  }
  faces_.clear();
  for (Index f = 0; f < mesh_.n_interior; ++f)
    if (is_solid(mesh_.owner[f]) != is_solid(mesh_.neighbour[f])) faces_.push_back(f);
}

template <int D>
void ImmersedBodies<D>::find_velocities(double t, const Placement<D>& at) {
  for (std::size_t c = 0; c < body_.size(); ++c) {
    if (cut_ ? shape_.open_depth[c] > well_clear * shape_.extent[c] : body_[c] < 0) continue;
    const std::vector<fv::Expression>& speed = speed_[cut_ ? nearest_[c] : body_[c]];
    Vec3 place = Vec3::Zero();
    place.template head<D>() = at.centre[c];
    velocity_[c].setZero();
    for (std::size_t i = 0; i < speed.size(); ++i) velocity_[c][static_cast<int>(i)] = speed[i](place, t);
  }
}

template <int D>
CutCells<D> ImmersedBodies<D>::shape(double t, const Placement<D>& at, std::span<const Vec3> points) const {
  std::vector<double> lowest(points.size(), std::numeric_limits<double>::infinity()), level(points.size());
  for (const fv::Expression& of_body : level_) {
    of_body.evaluate(points, t, level);
    for (std::size_t v = 0; v < level.size(); ++v) lowest[v] = std::min(lowest[v], level[v]);
  }
  const Level anywhere = [&](const Vec3& x) {
    double least = std::numeric_limits<double>::infinity();
    for (const fv::Expression& of_body : level_) least = std::min(least, of_body(x, t));
    return least;
  };
  return cut<D>(mesh_, at, {points, lowest, depth_, anywhere});
}

template <int D>
typename ImmersedBodies<D>::Changed ImmersedBodies<D>::mark_cells(double t, const Placement<D>& at,
                                                                  std::span<const Vec3> points) {
  if (!cut_) {
    const std::vector<int> before = body_;
    find_levels(t, at);
    find_velocities(t, at);
    return parallel::any(mesh_.comm, before != body_) ? Changed::cells : Changed::nothing;
  }
  find_levels(t, at);
  const CutCells<D> before = std::exchange(shape_, shape(t, at, points));
  find_velocities(t, at);
  bool others = false;
  for (std::size_t c = 0; c < before.cells.size(); ++c)
    others |= (before.cells[c] == 0) != (shape_.cells[c] == 0);
  if (parallel::any(mesh_.comm, others)) return Changed::cells;
  return parallel::any(mesh_.comm, before.faces != shape_.faces) ? Changed::shares : Changed::nothing;
}

/// Notes which bodies close at least a part of a cell.
template <int D>
void ImmersedBodies<D>::note_use() const {
  std::vector<double> closes(names_.size(), 0);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const int body = !cut_ ? body_[c] : shape_.cells[c] < 1 ? nearest_[c] : -1;
    if (body >= 0) closes[std::size_t(body)] = 1;
  }
  for (std::size_t i = 0; i < names_.size(); ++i) fv::uses()["bodies." + names_[i]].note(closes[i]);
}

template <int D>
typename ImmersedBodies<D>::Changed ImmersedBodies<D>::mark(double t,
                                                            const std::shared_ptr<const Placement<D>>& at,
                                                            const std::vector<Vec3>& points) {
  const Changed changed = mark_cells(t, *at, points);
  note_use();
  if (changed == Changed::nothing && around_of_ == at) return changed;
  this->close([&](Index c) { return cut_ ? shape_.cells[c] == 0 : is_solid(c); });
  auto around = std::make_shared<Placement<D>>(*at);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const double share = open(f);
    if (share == 1) continue;
    around->conductance[f] *= share;
    if (!around->oblique.empty()) around->oblique[f] *= share;
  }
  around_ = std::move(around);
  around_of_ = at;
  return changed;
}

template <int D>
void ImmersedBodies<D>::block(const FluidStep<D>& step, std::vector<double>& phi) const {
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
    if (const double share = open(f); share < 1) phi[f] = share * phi[f] + carried(f, *step.to);
}

template <int D>
void ImmersedBodies<D>::block(const FluidStep<D>& step, const std::vector<Index>& boundary_faces,
                              std::vector<double>& phi) const {
  for (const Index b : boundary_faces) {
    const Index f = mesh_.n_interior + b;
    if (const double share = open(f); share < 1) phi[f] = share * phi[f] + carried(f, *step.to);
  }
}

/// Sets the memory of the flux through the whole face with the velocity of its open part. A closed face
/// stores zero, so a newly opened one starts without a flux.
template <int D>
void ImmersedBodies<D>::correct_memory(State<D>& s) const {
  if (!cut_) {
    for (Index f = 0; f < mesh_.n_interior; ++f)
      if (open(f) == 0) s.memory[f] = 0;
    return;
  }
  const Placement<D>& at = *around_of_;
  std::vector<double> mean(mesh_.n_flux_faces());
  carry(at, s.u, mean);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    if (!beside_surface(f)) continue;
    const double share = open(f);
    s.memory[f] = (share > 0 ? (s.phi[f] - carried(f, at)) / share : s.phi[f]) - mean[f];
  }
}

template <int D>
void ImmersedBodies<D>::before(std::vector<double>& b, std::vector<double>& p) const {
  this->clear(b);
  this->clear(p);
}

template <int D>
void ImmersedBodies<D>::after(const Placement<D>& at, std::vector<double>& p) const {
  std::vector<double> weight(p.size(), 0.0), mean(p.size(), 0.0);
  const auto add = [&](Index closed, Index fluid, double g) {
    if (!is_closed(closed) || is_closed(fluid)) return;
    weight[closed] += g;
    mean[closed] += g * p[fluid];
  };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    add(mesh_.owner[f], mesh_.neighbour[f], at.conductance[f]);
    add(mesh_.neighbour[f], mesh_.owner[f], at.conductance[f]);
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    if (weight[c] > 0) p[c] = mean[c] / weight[c];
  mesh_.cells.update_ghosts(p);
}

template <int D>
double ImmersedBodies<D>::carried(Index f, const Placement<D>& at) const {
  const double rest = 1 - open(f);
  if (rest == 0) return 0;
  const Index o = mesh_.owner[f], n = other(f);
  const auto knows = [&](Index c) { return cut_ ? shape_.cells[c] < 1 : is_solid(c); };
  const Vec<D> velocity = cut_ && knows(o) && knows(n) ? Vec<D>(0.5 * (velocity_[o] + velocity_[n]))
                                                       : velocity_[knows(o) ? o : n];
  return rest * velocity.dot(at.area[f]);
}

template <int D>
double ImmersedBodies<D>::leak(const Placement<D>& at, const std::vector<double>& phi) const {
  double total = 0;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index o = mesh_.owner[f], n = mesh_.neighbour[f];
    if (open(f) > 0 || is_closed(o) == is_closed(n)) continue;
    if ((is_closed(o) ? n : o) < mesh_.cells.n_owned()) total += std::abs(phi[f] - carried(f, at));
  }
  return parallel::sum(mesh_.comm, total);
}

template <int D>
void ImmersedBodies<D>::hold(const Placement<D>& at, double dt, Vectors<D>& u) const {
  if (cut_)
    force_by_cuts(at, dt, u);
  else
    force_by_steps(at, u);
}

/// u_N = u_b + (u_b - u_P) |level_N|/|level_P|, averaged over the adjacent fluid cells P. The ratio is at
/// most one if P is closer to the surface.
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

/// du/ds at the surface per partly closed cell, s the distance from it. Least squares over neighbors P with
/// centers farther out, with weights that vary continuously as neighbors are added.
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

/// Inside: u_b + s du/ds. A cut cell of extent e with its center outside, 0 < s < e, approaches that profile
/// at the rate (nu/e^2 + 0.3 |du/ds|)(e/s - 1), implicitly. The effect grows continuously as the center nears
/// the surface and is independent of the step size.
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

/// Value at s', the center of the open part of a cell: u + (s' - s) du/ds.
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

/// Uses fluid cells at the faces of marked cells.
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

/// Forces on the surface in each cell: pressure extrapolated by its gradient, and mu du/ds.
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

template class ImmersedBodies<2>;
template class ImmersedBodies<3>;

FluidParameters with_surfaces(FluidParameters parameters, bool moving) {
  BodySurface all = BodySurface::automatic;
  for (const auto& [name, body] : parameters.bodies) {
    if (body.surface == BodySurface::automatic) continue;
    if (all != BodySurface::automatic && body.surface != all)
      throw Error("bodies.{}.surface: all bodies must have the same kind of surface; choose steps or cut.",
                  name);
    all = body.surface;
  }
  if (all == BodySurface::automatic) all = moving ? BodySurface::cut : BodySurface::steps;
  for (auto& [name, body] : parameters.bodies) body.surface = all;
  return parameters;
}

template <int D>
std::unique_ptr<Obstacles<D>> make_obstacles(const mesh::Mesh& mesh, const FluidParameters& parameters,
                                             std::span<const Vec3> points_at_rest) {
  if (!parameters.gaps.empty()) return std::make_unique<Gaps<D>>(mesh, parameters, points_at_rest);
  if (!parameters.bodies.empty()) return std::make_unique<ImmersedBodies<D>>(mesh, parameters);
  return std::make_unique<Obstacles<D>>(mesh);
}

template decltype(make_obstacles<2>) make_obstacles<2>;
template decltype(make_obstacles<3>) make_obstacles<3>;

}  // namespace couplet::fluid
