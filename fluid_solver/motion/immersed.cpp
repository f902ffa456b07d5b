// SPDX-License-Identifier: Apache-2.0
// Where immersed bodies are, and what they close.
#include "fluid_solver/motion/immersed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// Cells are clear of a surface if it is farther from the centre than so many extents.
constexpr double beside = 1.01;

}  // namespace

template <int D>
ImmersedBodies<D>::ImmersedBodies(const mesh::Mesh& mesh, const FluidParameters& parameters)
    : Obstacles<D>(mesh),
      cut_(parameters.bodies.begin()->second.surface == BodySurface::cut),
      nu_(parameters.kinematic_viscosity()),
      body_(mesh.cells.n_local(), -1),
      depth_(mesh.cells.n_local(), 0.0),
      velocity_(mesh.cells.n_local(), Vec<D>::Zero()) {
  for (const auto& [name, body] : parameters.bodies) {
    names_.push_back(name);
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
    if (cut_ ? shape_.open_depth[c] > beside * shape_.extent[c] : body_[c] < 0) continue;
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

template <int D>
typename ImmersedBodies<D>::Changed ImmersedBodies<D>::mark(double t,
                                                            const std::shared_ptr<const Placement<D>>& at,
                                                            const std::vector<Vec3>& points) {
  const Changed changed = mark_cells(t, *at, points);
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
void ImmersedBodies<D>::block(const Step<D>& step, std::vector<double>& phi) const {
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
    if (const double share = open(f); share < 1) phi[f] = share * phi[f] + carried(f, *step.to);
}

template <int D>
void ImmersedBodies<D>::block(const Step<D>& step, const std::vector<Index>& boundary_faces,
                              std::vector<double>& phi) const {
  for (const Index b : boundary_faces) {
    const Index f = mesh_.n_interior + b;
    if (const double share = open(f); share < 1) phi[f] = share * phi[f] + carried(f, *step.to);
  }
}

/// The memory is that of the flux that the whole face would have with the velocity in its open part. A closed face remembers that
/// nothing passes: what
/// opens next begins without a flux, whatever the velocities beside it.
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

template class ImmersedBodies<2>;
template class ImmersedBodies<3>;

}  // namespace couplet::fluid
