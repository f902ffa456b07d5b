// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_space.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

std::vector<double> pyramid_volumes(const mesh::Mesh& mesh, const mesh::Geometry& geometry) {
  std::vector<double> volume(mesh.cells.n_owned(), 0);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const auto [here, there] = pyramids(mesh, geometry, f);
    if (mesh.owner[f] < mesh.cells.n_owned()) volume[mesh.owner[f]] += here;
    if (f < mesh.n_interior && mesh.neighbour[f] < mesh.cells.n_owned()) volume[mesh.neighbour[f]] += there;
  }
  return volume;
}

template <int D>
SymmetricSpace<D>::SymmetricSpace(const mesh::Mesh& mesh, const ElasticOperator& rows)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      nodes_(mesh, rows),
      vertices_(mesh, rows),
      points_(std::size_t(mesh.points.n_local()) * stride, 0.0),
      force_(std::size_t(mesh.cells.n_local() + mesh.boundary.n_local()) * stride, 0.0),
      point_force_(points_.size(), 0.0),
      volume_(pyramid_volumes(mesh, rows.geometry())) {
  const mesh::Geometry& geometry = rows.geometry();
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    if (rows.mirrored(f)) symmetry_.emplace_back(f, geometry.face_area[f].normalized());
  if (!parallel::any(mesh.comm, !mesh.neighbour_shift.empty())) return;
  joined_ = std::make_unique<JoinedVertices>(mesh, rows);
  std::erase_if(vertices_.free, [&](Index v) { return joined_->has(v); });
}

template <int D>
Vec3 SymmetricSpace<D>::vector(const double* at) const {
  Vec3 v = Vec3::Zero();
  for (int a = 0; a < D; ++a) v[a] = at[a];
  return v;
}

template <int D>
inline void SymmetricSpace<D>::interpolate_free() {
  using lanes::Lane;
  const double* nodes = nodes_[0];
  double* points = points_.data();
  for (const Index v : vertices_.free) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    elastic::lanes::Lane<D> sum = {};
    for (std::size_t i = 0; i < index.size(); ++i)
      sum += weight[i] * lanes::load<D>(nodes + std::size_t(index[i]) * stride);
    lanes::store<D>(points + std::size_t(v) * stride, sum);
  }
}

// The weights' transpose.
template <int D>
inline void SymmetricSpace<D>::to_nodes_loop() {
  using lanes::Lane;
  double* force = force_.data();
  for (const Index v : vertices_.free) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    const elastic::lanes::Lane<D> here = lanes::load<D>(point_force_.data() + std::size_t(v) * stride);
    for (std::size_t i = 0; i < index.size(); ++i)
      lanes::add<D>(force + std::size_t(index[i]) * stride, weight[i] * here);
  }
}

namespace {

/// Of a body of revolution what makes the two halves of the force on a pyramid that on a ring, together by its mean radius.
std::array<double, 2> around(const ElasticOperator& rows, Index f, double tip) {
  if (!is_axisymmetric(rows)) return {1, 1};
  const double base = rows.geometry().face_centre[f][0];
  return {circumference(0.5 * (tip + base)), circumference((tip + 5 * base) / 6)};
}

// The loops for several generations of processors; the right one is picked when the program starts.
COUPLET_PROCESSOR_CLONES void vertices_pass(SymmetricSpace<3>& space) { space.interpolate_free(); }
COUPLET_PROCESSOR_CLONES void vertices_pass(SymmetricSpace<2>& space) { space.interpolate_free(); }
COUPLET_PROCESSOR_CLONES void to_nodes_pass(SymmetricSpace<3>& space) { space.to_nodes_loop(); }
COUPLET_PROCESSOR_CLONES void to_nodes_pass(SymmetricSpace<2>& space) { space.to_nodes_loop(); }

}  // namespace

/// All that stands before the faces. At symmetry planes the face's node is the mirror image of its cell.
template <int D>
void SymmetricSpace<D>::fill(std::span<const double> unknowns, std::span<const double> known) {
  nodes_.fill(unknowns, known, true);
  for (const auto& [f, n] : symmetry_) {
    const Vec3 u = vector(nodes_[mesh_.owner[f]]), image = u - 2 * n.dot(u) * n;
    double* at = nodes_.value(node_of_face(f));
    for (int a = 0; a < D; ++a) at[a] = image[a];
  }
  vertices_pass(*this);
  if (joined_) joined_->interpolate<D>(nodes_[0], points_);
  vertices_.constrain<D>(points_, stride, known);
}

template <int D>
void SymmetricSpace<D>::clear_forces() {
  std::ranges::fill(force_, 0.0);
  std::ranges::fill(point_force_, 0.0);
}

/// F_V takes what the constraints hold.
template <int D>
void SymmetricSpace<D>::constrain_point_forces() {
  for (const Index v : vertices_.constrained) {
    Eigen::Map<Vec<D>> f(point_force(v));
    f = (rows_.constraints().free_part(v).template topLeftCorner<D, D>() * f).eval();
  }
}

template <int D>
void SymmetricSpace<D>::points_to_nodes() {
  constrain_point_forces();
  to_nodes_pass(*this);
  if (joined_) joined_->to_nodes<D>(point_force_, force_.data());
}

/// From points and mirror images to the nodes, over the ranks, and both sides of bonded faces into one.
template <int D>
void SymmetricSpace<D>::collect() {
  points_to_nodes();
  for (const auto& [f, n] : symmetry_) {
    double* image = force(node_of_face(f));
    const Vec3 there = vector(image);
    add(force(mesh_.owner[f]), there - 2 * n.dot(there) * n);
    std::fill_n(image, D, 0.0);
  }
  const std::size_t n_cells = std::size_t(mesh_.cells.n_local()) * stride;
  const std::span<double> all(force_);
  mesh_.cells.add_to_owners(all.first(n_cells), stride);
  const std::span<double> faces = all.subspan(n_cells);
  mesh_.boundary.add_to_owners(faces, stride);
  if (mesh_.twin.empty()) return;
  std::fill(faces.begin() + std::ptrdiff_t(mesh_.boundary.n_owned()) * stride, faces.end(), 0.0);
  for (Index b = 0; b < mesh_.boundary.n_owned(); ++b) {
    const Index first = mesh_.twin[b];
    if (first < 0 || mesh_.boundary_id[first] > mesh_.boundary_id[b]) continue;
    for (int a = 0; a < D; ++a) faces[std::size_t(first) * stride + a] += faces[std::size_t(b) * stride + a];
  }
  mesh_.boundary.add_to_owners(faces, stride);
}

/// The rows that ElasticOperator defines. `unknowns` empty: of loads, to which supports add no rows of their
/// own.
template <int D>
void SymmetricSpace<D>::take_rows(std::span<const double> unknowns, std::span<const double> known,
                                  std::span<double> result) {
  const Index n_owned = mesh_.cells.n_owned();
  for (Index c = 0; c < n_owned; ++c) std::copy_n(force(c), D, result.data() + std::size_t(c) * D);
  const auto& open = rows_.unknown_faces();
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Index f = open[i];
    const std::size_t row = (std::size_t(n_owned) + i) * D;
    Vec3 own = vector(force(node_of_face(f)));
    if (const BoundaryRow& boundary = rows_.at(f); boundary.held) {
      own -= (boundary.known * own).eval();
      if (!unknowns.empty()) {
        Vec3 jump = Vec3::Zero();
        for (int a = 0; a < D; ++a)
          jump[a] =
              unknowns[row + a] - (known.empty() ? 0 : known[std::size_t(rows_.known_of_face(f)) * D + a]);
        const LameConstants lame = rows_.lame(mesh_.owner[f]);
        const fv::FaceLine line = fv::face_line(mesh_, geometry_, f);
        own += (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn * (boundary.known * jump);
      }
    }
    for (int a = 0; a < D; ++a) result[row + a] = own[a];
  }
}

template <int D>
void SymmetricSpace<D>::add_springs(std::span<const double> known) {
  for (const Index f : rows_.known_faces())
    visit_spring(f, known, [&](double* at, const Vec3& pull) { add(at, pull); });
}

template <int D>
void SymmetricSpace<D>::spread_over_base(Index f, const Vec3& force_on_base) {
  const bool has_node = f >= mesh_.n_interior && !rows_.mirrored(f);
  if (has_node) add(force(node_of_face(f)), force_on_base / D);
  const double part = has_node ? 1 - 1.0 / D : 1;
  const auto shares = point_shares(mesh_, geometry_, f);
  const auto points = mesh_.face_points[f];
  for (std::size_t i = 0; i < points.size(); ++i)
    add(point_force(points[i]), part * shares[i] * force_on_base);
}

/// Around a body of revolution: as the integral of r over the two halves of the face gives it to its node and points.
template <int D>
void SymmetricSpace<D>::spread_around(Index f, const Vec3& force_on_base) {
  const double middle = geometry_.face_centre[f][0];
  add(force(node_of_face(f)), 0.5 * circumference(middle) * force_on_base);
  for (const Index v : mesh_.face_points[f])
    add(point_force(v), circumference(2 * geometry_.points[v][0] + middle) / 12 * force_on_base);
}

template <int D>
void SymmetricSpace<D>::spread_face_forces(std::span<const double> forces) {
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    Vec3 here = vector(forces.data() + std::size_t(f - mesh_.n_interior) * D);
    if (here.isZero(0)) continue;
    here -= (rows_.at(f).passing * here).eval();
    if (here.isZero(0) || rows_.mirrored(f)) continue;
    is_axisymmetric(rows_) ? spread_around(f, here) : spread_over_base(f, here);
  }
}

template <int D>
void SymmetricSpace<D>::spread_cell_forces(std::span<const double> forces) {
  const auto add_pyramid = [&](Index f, Index c, double volume) {
    if (c >= mesh_.cells.n_owned()) return;
    const Vec3 here = volume / volume_[c] * vector(forces.data() + std::size_t(c) * D);
    const auto [of_cell, of_base] = around(rows_, f, geometry_.cell_centre[c][0]);
    add(force(c), of_cell / D * here);
    spread_over_base(f, of_base * (1 - 1.0 / D) * here);
  };
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const auto [here, there] = pyramids(mesh_, geometry_, f);
    add_pyramid(f, mesh_.owner[f], here);
    if (f < mesh_.n_interior) add_pyramid(f, mesh_.neighbour[f], there);
  }
}

template <int D>
void SymmetricSpace<D>::add_collected(std::span<double> rhs) {
  collect();
  std::vector<double> row(rhs.size());
  take_rows({}, {}, row);
  for (std::size_t i = 0; i < row.size(); ++i) rhs[i] += row[i];
}

template <int D>
void SymmetricSpace<D>::add_mass_forces(double factor) {
  const double *nodes = nodes_[0], *points = points_.data();
  for (std::size_t i = 0; i < node_mass_.size(); ++i)
    for (int a = 0; a < D; ++a) force_[i * stride + a] += factor * node_mass_[i] * nodes[i * stride + a];
  for (std::size_t i = 0; i < point_mass_.size(); ++i)
    for (int a = 0; a < D; ++a)
      point_force_[i * stride + a] += factor * point_mass_[i] * points[i * stride + a];
}

template <int D>
void SymmetricSpace<D>::negate_forces() {
  for (double& f : force_) f = -f;
  for (double& f : point_force_) f = -f;
}

template <int D>
void SymmetricSpace<D>::set_density(std::span<const double> of_cells) {
  std::vector<double> mass(std::size_t(mesh_.cells.n_owned()) * D, 0);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    mass[std::size_t(c) * D] = of_cells[c] * geometry_.volume[c];
  clear_forces();
  spread_cell_forces(mass);
  node_mass_.resize(force_.size() / stride);
  point_mass_.resize(point_force_.size() / stride);
  for (std::size_t i = 0; i < node_mass_.size(); ++i) node_mass_[i] = force_[i * stride];
  for (std::size_t i = 0; i < point_mass_.size(); ++i) point_mass_[i] = point_force_[i * stride];
}

template <int D>
Vec3 SymmetricSpace<D>::acting(std::span<const double> forces) const {
  Vec3 total = Vec3::Zero();
  for (const Index f : rows_.unknown_faces()) {
    const Vec3 here = vector(forces.data() + std::size_t(f - mesh_.n_interior) * D);
    const double ring = is_axisymmetric(rows_) ? circumference(geometry_.face_centre[f][0]) : 1;
    total += ring * (here - rows_.at(f).passing * here);
  }
  return total;
}

template <int D>
double SymmetricSpace<D>::work() const {
  double sum = 0;
  const double* nodes = nodes_[0];
  for (std::size_t i = 0; i < force_.size(); i += stride)
    for (int a = 0; a < D; ++a) sum += force_[i + a] * nodes[i + a];
  for (std::size_t i = 0; i < point_force_.size(); i += stride)
    for (int a = 0; a < D; ++a) sum += point_force_[i + a] * points_[i + a];
  return sum;
}

// Reactions at the patches that hold a body: the forces that the trial functions leave where displacements are known.

/// Place of an entry of point_force_ or force_; the face's node at a symmetry plane is the mirror image of the cell's centre.
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
  // The remainder of the points' forces at nodes that are held.
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

template class SymmetricSpace<2>;
template class SymmetricSpace<3>;

}  // namespace couplet::elastic
