// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/immersed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {

template <int D>
ImmersedBodies<D>::ImmersedBodies(const mesh::Mesh& mesh, const FluidParameters& parameters)
    : mesh_(mesh),
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
}

template <int D>
bool ImmersedBodies<D>::mark(double t, const Placement<D>& at) {
  const std::vector<int> before = body_;
  std::vector<Vec3> places(body_.size(), Vec3::Zero());
  for (std::size_t c = 0; c < places.size(); ++c) places[c].template head<D>() = at.centre[c];
  std::fill(body_.begin(), body_.end(), -1);
  std::fill(depth_.begin(), depth_.end(), std::numeric_limits<double>::infinity());
  std::vector<double> level(places.size());
  for (std::size_t i = 0; i < level_.size(); ++i) {
    level_[i].evaluate(places, t, level);
    for (std::size_t c = 0; c < level.size(); ++c) {
      if (level[c] < 0 && level[c] < depth_[c]) body_[c] = static_cast<int>(i);
      depth_[c] = std::min(depth_[c], level[c]);
    }
  }
  for (std::size_t c = 0; c < body_.size(); ++c) {
    if (body_[c] < 0) continue;
    velocity_[c].setZero();
    for (std::size_t i = 0; i < speed_[body_[c]].size(); ++i)
      velocity_[c][static_cast<int>(i)] = speed_[body_[c]][i](places[c], t);
  }
  faces_.clear();
  for (Index f = 0; f < mesh_.n_interior; ++f)
    if (is_solid(mesh_.owner[f]) != is_solid(mesh_.neighbour[f])) faces_.push_back(f);
  return parallel::any(mesh_.comm, before != body_);
}

template <int D>
double ImmersedBodies<D>::flux(Index f, const Placement<D>& at) const {
  const Index o = mesh_.owner[f];
  return velocity_of(is_solid(o) ? o : mesh_.neighbour[f]).dot(at.area[f]);
}

/// u_N = u_b + (u_b - u_P) |level_N| / |level_P|, the mean over the fluid cells beside N. The quotient is
/// limited to one, where the fluid cell is closer to the surface than N.
template <int D>
void ImmersedBodies<D>::force(const Placement<D>& at, Vectors<D>& u) const {
  std::vector<double> weight(body_.size(), 0.0);
  Vectors<D> sum(body_.size(), Vec<D>::Zero());
  for (const Index f : faces_) {
    const bool owner_solid = is_solid(mesh_.owner[f]);
    const Index inside = owner_solid ? mesh_.owner[f] : mesh_.neighbour[f],
                outside = owner_solid ? mesh_.neighbour[f] : mesh_.owner[f];
    const double quotient = std::min(1.0, -depth_[inside] / std::max(depth_[outside], -depth_[inside]));
    sum[inside] += at.conductance[f] * quotient * (velocity_of(inside) - u[outside]);
    weight[inside] += at.conductance[f];
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    if (is_solid(c)) u[c] = velocity_of(c) + (weight[c] > 0 ? Vec<D>(sum[c] / weight[c]) : Vec<D>::Zero());
  mesh_.cells.update_ghosts(flat<D>(u), D);
}

template <int D>
std::vector<std::pair<Vec<D>, Vec<D>>> ImmersedBodies<D>::forces(const Placement<D>& at,
                                                                 const std::vector<double>& p,
                                                                 const Vectors<D>& u,
                                                                 double viscosity) const {
  std::vector<double> sums(names_.size() * 2 * D, 0.0);
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
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
  std::vector<std::pair<Vec<D>, Vec<D>>> result(names_.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    for (int c = 0; c < D; ++c) {
      result[i].first[c] = sums[i * 2 * D + c];
      result[i].second[c] = sums[i * 2 * D + D + c];
    }
  return result;
}

template <int D>
double ImmersedBodies<D>::leak(const Placement<D>& at, const std::vector<double>& phi) const {
  double total = 0;
  for (const Index f : faces_) {
    const Index fluid = is_solid(mesh_.owner[f]) ? mesh_.neighbour[f] : mesh_.owner[f];
    if (fluid < mesh_.cells.n_owned()) total += std::abs(phi[f] - flux(f, at));
  }
  return parallel::sum(mesh_.comm, total);
}

template class ImmersedBodies<2>;
template class ImmersedBodies<3>;

}  // namespace couplet::fluid
