// SPDX-License-Identifier: Apache-2.0
// What acts on the symmetric operator: loads, mass and what supports hold, by the trial functions of its
// strain (SymmetricSpace).
#include <algorithm>
#include <cmath>

#include "common/elasticity/symmetric/symmetric_kernel.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// Where the volume strain is that of the cells it takes no part in the sharing, nor does the pressure that acts on it.
template <int D>
std::vector<double> SymmetricKernel<D>::shared_pressure(std::span<const double> pressure) {
  std::vector<double> result(pressure.begin(), pressure.end());
  if (!edges_ || rows_.volume_by_cells()) return result;
  edges_->clear();
  for (std::size_t i = 0; i < shared_mine_.size(); ++i)
    for (const Index e : edges_->edges_of(i))
      for (int a = 0; a < 3; ++a) edges_->at(e)[a] += shared_[i / 4].part[i % 4] * pressure[shared_mine_[i]];
  edges_->finish_means();
  for (std::size_t i = 0; i < shared_mine_.size(); ++i) {
    double of_edges = 0;
    for (const Index e : edges_->edges_of(i)) of_edges += edges_->at(e)[0] / 3;
    double& here = result[shared_mine_[i]];
    here = (1 - SharedEdges::share) * here + SharedEdges::share * of_edges;
  }
  return result;
}

template <int D>
void SpaceKernel<D>::spread_pressure(std::span<const double> pressure) {
  const mesh::Mesh& mesh = space_.mesh();
  const std::vector<double> shared = shared_pressure(pressure);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;  // another rank's
    const FaceRows face = face_rows(mesh, space_.rows(), f);
    const double scale = shared[f] * face.volume;
    for (const FaceRows::Row& row : face.all()) {
      double* to = space_.force_at(row.place);
      for (int a = 0; a < D; ++a) to[a] += scale * row.b[a];
      if (face.is_ring) to[0] += scale * row.b[2];
    }
  }
}

template <int D>
Vec3 SpaceKernel<D>::add_face_forces(std::span<const double> forces, std::span<double> rhs) {
  space_.clear_forces();
  space_.spread_face_forces(forces);
  space_.add_collected(rhs);
  return space_.acting(forces);
}

template <int D>
void SpaceKernel<D>::add_cell_forces(std::span<const double> forces, std::span<double> rhs) {
  space_.clear_forces();
  space_.spread_cell_forces(forces);
  space_.add_collected(rhs);
}

template <int D>
void SpaceKernel<D>::add_pressure(std::span<const double> pressure, std::span<double> rhs) {
  space_.clear_forces();
  spread_pressure(pressure);
  space_.add_collected(rhs);
}

template <int D>
void SpaceKernel<D>::apply_with_mass(std::span<const double> unknowns, std::span<const double> known,
                                     double mass_factor, bool with_stiffness, std::span<double> result) {
  space_.fill(unknowns, known);
  space_.clear_forces();
  if (with_stiffness) {
    internal_forces();
    space_.add_springs(known);
  }
  if (mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(with_stiffness ? unknowns : std::span<const double>(), known, result);
}

/// The forces of u on all nodes and points, times what v moves them.
template <int D>
double SpaceKernel<D>::product(ElasticPart part, const ElasticField& u, const ElasticField& v) {
  space_.fill(u.unknowns, u.known);
  space_.clear_forces();
  if (part == ElasticPart::stiffness) internal_forces();
  if (part == ElasticPart::springs) space_.add_springs(u.known);
  if (part == ElasticPart::mass) space_.add_mass_forces(1);
  space_.fill(v.unknowns, v.known);
  return space_.work();
}

template <int D>
std::vector<Wrench> SpaceKernel<D>::holding_forces(std::span<const double> unknowns,
                                                   std::span<const double> known, const ElasticLoads& loads) {
  space_.clear_forces();
  if (!loads.faces.empty()) space_.spread_face_forces(loads.faces);
  if (!loads.cells.empty()) space_.spread_cell_forces(loads.cells);
  if (!loads.pressure.empty()) spread_pressure(loads.pressure);
  space_.negate_forces();
  space_.fill(unknowns, known);
  internal_forces();
  space_.add_springs(
      known);  // at a vertex that a support shares the support takes their part along what it knows
  return space_.held(known, false);
}

template class SpaceKernel<2>;
template class SpaceKernel<3>;
template std::vector<double> SymmetricKernel<2>::shared_pressure(std::span<const double>);
template std::vector<double> SymmetricKernel<3>::shared_pressure(std::span<const double>);

// What holds a body at its patches: the forces that the trial functions leave where displacements are known.

/// Of an entry of point_force_ or of force_; the face's node at a symmetry plane is the mirror image of the cell's centre.
template <int D>
Vec3 SymmetricSpace<D>::place_of(const double* force, bool moved) const {
  const auto entry = [force](const std::vector<double>& all) { return Index((force - all.data()) / stride); };
  if (force < force_.data() || force >= force_.data() + force_.size()) {
    const Index v = entry(point_force_);
    const Vec3& at = geometry_.points[v];
    return moved ? Vec3(at + vector(points_.data() + std::size_t(v) * stride)) : at;
  }
  const Index node = entry(force_), f = mesh_.n_interior + node - mesh_.cells.n_local();
  const bool is_cell = node < mesh_.cells.n_local();
  Vec3 at = is_cell ? geometry_.cell_centre[node] : geometry_.face_centre[f];
  if (!is_cell && rows_.mirrored(f)) {
    const Vec3 n = geometry_.face_area[f].normalized(), &cell = geometry_.cell_centre[mesh_.owner[f]];
    at = cell - 2 * n.dot(cell - at) * n;
  }
  return moved ? Vec3(at + vector(nodes_[node])) : at;
}

/// At the points, by the sources of what is known there and the symmetry planes. The nodes of a point on a symmetry plane lie
/// to one side of it, so that their images hold the couple that its free force makes with its parts at the nodes.
template <int D>
void SymmetricSpace<D>::held_at_points(std::span<const Index> patch_of, bool moved,
                                       std::vector<Wrench>& result) {
  std::vector<std::vector<std::pair<Index, Vec3>>> planes(mesh_.points.n_local());
  for (Index f = mesh_.n_interior; f < mesh_.n_faces(); ++f) {
    if (!rows_.mirrored(f)) continue;
    const Vec3 n = geometry_.face_area[f].normalized();
    for (const Index v : mesh_.face_points[f]) {
      const auto same = [&](const auto& plane) { return std::abs(plane.second.dot(n)) > 0.9994; };
      if (std::ranges::none_of(planes[v], same)) planes[v].emplace_back(patch_of[f - mesh_.n_interior], n);
    }
  }
  const VertexConstraints& constraints = rows_.constraints();
  for (const Index v : vertices_.constrained) {
    const Vec3 whole = vector(point_force(v)), at = place_of(point_force(v), moved);
    Vec3 held = whole - constraints.free_part(v) * whole;
    if (const Index column = constraints.column(v); column >= 0)
      for (const auto& [face, share] : constraints.sources(column)) {
        const Vec3 here = share.transpose() * whole;
        result[patch_of[face]].add(here, at);
        held -= here;
      }
    for (const auto& [patch, n] : planes[v]) {
      result[patch].add(n.dot(held) * n, at);
      held -= n.dot(held) * n;
    }
    const auto nodes = rows_.vertices().nodes(v);
    if (planes[v].empty() || constraints.is_fixed(v) || nodes.empty()) continue;
    const auto weights = rows_.vertices().weights(v);
    Vec3 lever = at;
    for (std::size_t i = 0; i < nodes.size(); ++i) lever -= weights[i] * place_of(force(nodes[i]), moved);
    result[planes[v].front().first].moment += lever.cross(constraints.free_part(v) * whole);
  }
}

/// dE/du of all that is held: at the points, at the faces' own nodes and at the mirror images of symmetry planes, whose forces go
/// back to the cells mirrored, so that the plane takes the difference.
template <int D>
std::vector<Wrench> SymmetricSpace<D>::held(std::span<const double> known, bool moved) {
  std::vector<Wrench> result(mesh_.patches.size());
  const std::vector<Index> patch_of = mesh_.patch_of_boundary();
  held_at_points(patch_of, moved, result);
  // What the free part of the points' forces leaves at nodes that are held.
  points_to_nodes();
  for (Index b = 0; b < mesh_.boundary.n_local(); ++b) {
    const Index f = mesh_.n_interior + b;
    if (!rows_.at(f).held) continue;
    const double* node = force(mesh_.cells.n_local() + b);
    const Vec3 here = vector(node);
    Wrench& patch = result[patch_of[b]];
    if (!rows_.mirrored(f)) {
      patch.add(rows_.at(f).known * here, place_of(node, moved));
      continue;
    }
    const Vec3 n = geometry_.face_area[f].normalized();
    Vec3 cell = geometry_.cell_centre[mesh_.owner[f]];
    if (moved) cell += vector(nodes_[mesh_.owner[f]]);
    patch.force += 2 * n.dot(here) * n;
    patch.moment += place_of(node, moved).cross(here) - cell.cross(here - 2 * n.dot(here) * n);
  }
  for (const Index f : rows_.known_faces())
    visit_spring(f, known, [&](double* where, const Vec3& pull) {
      result[patch_of[f - mesh_.n_interior]].add(-pull, place_of(where, moved));
    });
  return result;
}

template std::vector<Wrench> SymmetricSpace<2>::held(std::span<const double>, bool);
template std::vector<Wrench> SymmetricSpace<3>::held(std::span<const double>, bool);

}  // namespace couplet::elastic
