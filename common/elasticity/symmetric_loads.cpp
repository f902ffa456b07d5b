// SPDX-License-Identifier: Apache-2.0
// What acts on the symmetric operator: loads, mass and what supports hold, by the trial functions of its
// strain. A cell's row is 1/dim of its balance, so that it carries 1/dim of what acts on its volume and the
// vertices carry the rest; a boundary face carries 1/dim of its traction, its vertices the rest.
#include <algorithm>

#include "common/elasticity/symmetric_kernel.hpp"

namespace couplet {

template <int D>
void SymmetricKernel<D>::spread_over_base(Index f, const Vec3& force_on_base) {
  const bool has_node = f >= mesh_.n_interior && rows_.condition(f) != ElasticCondition::symmetry;
  if (has_node) add(force(node_of_face(f)), force_on_base / D);
  const double part = has_node ? 1 - 1.0 / D : 1;
  const auto shares = point_shares(mesh_, f);
  const auto points = mesh_.face_points[f];
  for (std::size_t i = 0; i < points.size(); ++i)
    add(point_force(points[i]), part * shares[i] * force_on_base);
}

template <int D>
void SymmetricKernel<D>::spread_face_forces(std::span<const double> forces) {
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    Vec3 here = vector(forces.data() + std::size_t(f - mesh_.n_interior) * D);
    if (here.isZero(0)) continue;
    if (rows_.condition(f) == ElasticCondition::support)
      here -= (rows_.support(f).known * here).eval();
    else if (rows_.condition(f) != ElasticCondition::traction)
      continue;
    spread_over_base(f, here);
  }
}

template <int D>
void SymmetricKernel<D>::spread_cell_forces(std::span<const double> forces) {
  const auto add_pyramid = [&](Index f, Index c, double volume) {
    if (c >= mesh_.cells.n_owned()) return;
    const Vec3 here = volume / volume_[c] * vector(forces.data() + std::size_t(c) * D);
    add(force(c), here / D);
    spread_over_base(f, (1 - 1.0 / D) * here);
  };
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const auto [here, there] = pyramids(mesh_, f);
    add_pyramid(f, mesh_.owner[f], here);
    if (f < mesh_.n_interior) add_pyramid(f, mesh_.neighbour[f], there);
  }
}

template <int D>
void SymmetricKernel<D>::spread_pressure(std::span<const double> pressure) {
  std::vector<double> shared(edges_ ? shared_mine_.size() : 0);
  if (edges_) {
    edges_->clear();
    for (std::size_t i = 0; i < shared_mine_.size(); ++i)
      for (const Index e : edges_->edges_of(i))
        for (int a = 0; a < 3; ++a)
          edges_->at(e)[a] += shared_[i / 4].part[i % 4] * pressure[shared_mine_[i]];
    edges_->finish_means();
    for (std::size_t i = 0; i < shared_mine_.size(); ++i) {
      for (const Index e : edges_->edges_of(i)) shared[i] += edges_->at(e)[0] / 3;
      shared[i] = (1 - SharedEdges::share) * pressure[shared_mine_[i]] + SharedEdges::share * shared[i];
    }
  }
  const auto push = [&](Index f, double p) {
    const SymmetricFace<D> face = symmetric_face<D>(mesh_, rows_, f);
    const double scale = p * face.volume * face.inverse;
    double* there = force(f < mesh_.n_interior ? mesh_.neighbour[f] : node_of_face(f));
    double* here = force(mesh_.owner[f]);
    for (int a = 0; a < D; ++a) {
      there[a] += scale * face.area[a];
      here[a] -= scale * face.area[a];
      for (int i = 0; i < D - 1; ++i) {
        point_force(face.plus[i])[a] += scale * face.across[i][a];
        point_force(face.minus[i])[a] -= scale * face.across[i][a];
      }
    }
  };
  for (const Index f : mine_) push(f, pressure[f]);
  for (std::size_t i = 0; i < shared_mine_.size(); ++i) push(shared_mine_[i], shared[i]);
}

template <int D>
void SymmetricKernel<D>::add_collected(std::span<double> rhs) {
  collect();
  std::vector<double> row(rhs.size());
  take_rows({}, {}, row);
  for (std::size_t i = 0; i < row.size(); ++i) rhs[i] += row[i];
}

template <int D>
Vec3 SymmetricKernel<D>::add_face_forces(std::span<const double> forces, std::span<double> rhs) {
  Vec3 total = Vec3::Zero();
  for (const Index f : rows_.unknown_faces()) {
    Vec3 here = vector(forces.data() + std::size_t(f - mesh_.n_interior) * D);
    if (rows_.condition(f) == ElasticCondition::support)
      here -= (rows_.support(f).known * here).eval();
    else if (rows_.condition(f) != ElasticCondition::traction)
      continue;
    total += here;
  }
  clear_forces();
  spread_face_forces(forces);
  add_collected(rhs);
  return total;
}

template <int D>
void SymmetricKernel<D>::add_cell_forces(std::span<const double> forces, std::span<double> rhs) {
  clear_forces();
  spread_cell_forces(forces);
  add_collected(rhs);
}

template <int D>
void SymmetricKernel<D>::add_pressure(std::span<const double> pressure, std::span<double> rhs) {
  clear_forces();
  spread_pressure(pressure);
  add_collected(rhs);
}

template <int D>
bool SymmetricKernel<D>::set_density(std::span<const double> of_cells) {
  std::vector<double> mass(std::size_t(mesh_.cells.n_owned()) * D, 0);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    mass[std::size_t(c) * D] = of_cells[c] * mesh_.reference.volume[c];
  clear_forces();
  spread_cell_forces(mass);
  node_mass_.resize(force_.size() / stride);
  point_mass_.resize(point_force_.size() / stride);
  for (std::size_t i = 0; i < node_mass_.size(); ++i) node_mass_[i] = force_[i * stride];
  for (std::size_t i = 0; i < point_mass_.size(); ++i) point_mass_[i] = point_force_[i * stride];
  return true;
}

template <int D>
void SymmetricKernel<D>::add_mass_forces(double factor) {
  const double *nodes = nodes_[0], *points = points_.data();
  for (std::size_t i = 0; i < node_mass_.size(); ++i)
    for (int a = 0; a < D; ++a) force_[i * stride + a] += factor * node_mass_[i] * nodes[i * stride + a];
  for (std::size_t i = 0; i < point_mass_.size(); ++i)
    for (int a = 0; a < D; ++a)
      point_force_[i * stride + a] += factor * point_mass_[i] * points[i * stride + a];
}

template <int D>
void SymmetricKernel<D>::apply_with_mass(std::span<const double> unknowns, std::span<const double> known,
                                         double mass_factor, bool with_stiffness, std::span<double> result) {
  fill(unknowns, known);
  clear_forces();
  if (with_stiffness) {
    internal_forces();
    add_springs(known);
  }
  add_mass_forces(mass_factor);
  collect();
  take_rows(with_stiffness ? unknowns : std::span<const double>(), known, result);
}

/// The forces of u on all nodes and points, times what v moves them.
template <int D>
double SymmetricKernel<D>::product(ElasticPart part, const ElasticField& u, const ElasticField& v) {
  fill(u.unknowns, u.known);
  clear_forces();
  if (part == ElasticPart::stiffness) internal_forces();
  if (part == ElasticPart::springs) add_springs(u.known);
  if (part == ElasticPart::mass) add_mass_forces(1);
  fill(v.unknowns, v.known);
  double sum = 0;
  const double* nodes = nodes_[0];
  for (std::size_t i = 0; i < force_.size(); i += stride)
    for (int a = 0; a < D; ++a) sum += force_[i + a] * nodes[i + a];
  for (std::size_t i = 0; i < point_force_.size(); i += stride)
    for (int a = 0; a < D; ++a) sum += point_force_[i + a] * points_[i + a];
  return sum;
}

/// dE/du of all that is held, less the loads there: by the sources of what is known at points, the faces' own
/// nodes and the mirror images at symmetry planes.
template <int D>
std::vector<Vec3> SymmetricKernel<D>::holding_forces(std::span<const double> unknowns,
                                                     std::span<const double> known,
                                                     const ElasticLoads& loads) {
  clear_forces();
  if (!loads.faces.empty()) spread_face_forces(loads.faces);
  if (!loads.cells.empty()) spread_cell_forces(loads.cells);
  if (!loads.pressure.empty()) spread_pressure(loads.pressure);
  for (double& f : force_) f = -f;
  for (double& f : point_force_) f = -f;
  fill(unknowns, known);
  internal_forces();
  add_springs(known);  // at a vertex that a support shares the support takes their part along what it knows
  std::vector<Vec3> result(mesh_.patches.size(), Vec3::Zero());
  const std::vector<Index> patch_of = mesh_.patch_of_boundary();
  std::vector<std::vector<std::pair<Index, Vec3>>> planes(mesh_.points.n_local());
  for (Index f = mesh_.n_interior; f < mesh_.n_faces(); ++f) {
    if (rows_.condition(f) != ElasticCondition::symmetry) continue;
    const Vec3 n = mesh_.reference.face_area[f].normalized();
    for (const Index v : mesh_.face_points[f]) {
      const auto same = [&](const auto& plane) { return std::abs(plane.second.dot(n)) > 0.9994; };
      if (std::ranges::none_of(planes[v], same)) planes[v].emplace_back(patch_of[f - mesh_.n_interior], n);
    }
  }
  const VertexConstraints& constraints = rows_.constraints();
  for (const Index v : vertices_.constrained) {
    const Vec3 whole = vector(point_force(v));
    Vec3 held = whole - constraints.free_part(v) * whole;
    if (const Index column = constraints.column(v); column >= 0)
      for (const auto& [face, share] : constraints.sources(column)) {
        const Vec3 here = share.transpose() * whole;
        result[patch_of[face]] += here;
        held -= here;
      }
    for (const auto& [patch, n] : planes[v]) {
      result[patch] += n.dot(held) * n;
      held -= n.dot(held) * n;
    }
  }
  // What the free part of the points' forces leaves at nodes that are held.
  points_to_nodes();
  for (Index b = 0; b < mesh_.boundary.n_local(); ++b) {
    const Index f = mesh_.n_interior + b;
    const Vec3 here = vector(force(mesh_.cells.n_local() + b));
    switch (rows_.condition(f)) {
      case ElasticCondition::prescribed:
        result[patch_of[b]] += here;
        break;
      case ElasticCondition::support:
        result[patch_of[b]] += rows_.support(f).known * here;
        break;
      case ElasticCondition::symmetry: {
        const Vec3 n = mesh_.reference.face_area[f].normalized();
        result[patch_of[b]] += 2 * n.dot(here) * n;
        break;
      }
      default:
        break;
    }
  }
  for (const Index f : rows_.known_faces())
    if (rows_.condition(f) == ElasticCondition::support)
      visit_spring(f, known,
                   [&](double*, const Vec3& pull) { result[patch_of[f - mesh_.n_interior]] -= pull; });
  return result;
}

template class SymmetricKernel<2>;
template class SymmetricKernel<3>;

}  // namespace couplet
