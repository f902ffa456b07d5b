// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_space.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

std::vector<double> pyramid_volumes(const mesh::Mesh& mesh, const mesh::Geometry& geometry) {
  std::vector<double> volume(mesh.cells.n_owned(), 0);
  visit_pyramids(mesh, geometry, [&](Index c, Index, double pyramid) { volume[c] += pyramid; });
  return volume;
}

SymmetricSpace::SymmetricSpace(const mesh::Mesh& mesh, const ElasticOperator& rows)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      n_nodes_(n_node_places(mesh)),
      nodes_(mesh, rows, mesh.points.n_local()),
      vertices_(mesh, rows),
      force_(nodes_.all().size(), 0.0),
      volume_(pyramid_volumes(mesh, rows.geometry())) {
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    if (rows.mirrored(f)) symmetry_.emplace_back(f, geometry_.face_area[f].normalized());
  if (!parallel::any(mesh.comm, !mesh.neighbour_shift.empty())) return;
  joined_ = std::make_unique<JoinedVertices>(mesh, rows);
  std::erase_if(vertices_.free, [&](Index v) { return joined_->has(v); });
}

inline void SymmetricSpace::interpolate_free() {
  const double* nodes = nodes_[0];
  double* points = nodes_.value(n_nodes_);
  for (const Index v : vertices_.free) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    lanes::Lane<3> sum = {};
    for (std::size_t i = 0; i < index.size(); ++i)
      sum += weight[i] * lanes::load<3>(nodes + std::size_t(index[i]) * stride);
    lanes::store<3>(points + std::size_t(v) * stride, sum);
  }
}

// Applies the transpose of the interpolation weights.
inline void SymmetricSpace::to_nodes_loop() {
  double* force = force_.data();
  const double* point_force = force + std::size_t(n_nodes_) * stride;
  for (const Index v : vertices_.free) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    const lanes::Lane<3> here = lanes::load<3>(point_force + std::size_t(v) * stride);
    for (std::size_t i = 0; i < index.size(); ++i)
      lanes::add<3>(force + std::size_t(index[i]) * stride, weight[i] * here);
  }
}

namespace {

// Loops compiled for several generations of processors, selected at program start.
COUPLET_PROCESSOR_CLONES void vertices_pass(SymmetricSpace& space) { space.interpolate_free(); }
COUPLET_PROCESSOR_CLONES void to_nodes_pass(SymmetricSpace& space) { space.to_nodes_loop(); }

/// Circumferences at the mean radii of both halves of a pyramid, or 1 without rotational symmetry.
std::array<double, 2> around(const ElasticOperator& rows, Index f, double tip) {
  if (!is_axisymmetric(rows)) return {1, 1};
  const double base = rows.geometry().face_centre[f][0];
  return {circumference(0.5 * (tip + base)), circumference((tip + 5 * base) / 6)};
}

Vec3 mirrored(const Vec3& v, const Vec3& n) { return v - 2 * n.dot(v) * n; }

}  // namespace

/// Sets all values that precede the loop over faces.
template <int D>
void SymmetricSpace::fill_nodes(std::span<const double> unknowns, std::span<const double> known) {
  nodes_.fill<D>(unknowns, known, true);
  for (const auto& [f, n] : symmetry_)
    Place(nodes_.value(node_of_face(f))) = mirrored(value(mesh_.owner[f]), n);
  vertices_pass(*this);
  const std::span<double> points = nodes_.all().subspan(n_nodes() * stride);
  if (joined_) joined_->interpolate(nodes_[0], points);
  vertices_.constrain<D>(points, stride, known);
}

void SymmetricSpace::fill(std::span<const double> unknowns, std::span<const double> known) {
  mesh_.dim == 2 ? fill_nodes<2>(unknowns, known) : fill_nodes<3>(unknowns, known);
}

void SymmetricSpace::point_values(std::span<double> points) const {
  const auto take = [&](Index v) {
    std::copy_n(nodes_[place_of_point(v)], mesh_.dim, points.data() + std::size_t(v) * mesh_.dim);
  };
  vertices_.visit(take);
  if (!joined_) return;
  for (const Index v : joined_->all()) take(v);
}

void SymmetricSpace::clear_forces() { std::ranges::fill(force_, 0.0); }

void SymmetricSpace::negate_forces() {
  for (double& f : force_) f = -f;
}

/// Multiplies by F_V, which removes the part held by constraints.
void SymmetricSpace::points_to_nodes() {
  for (const Index v : vertices_.constrained) {
    Place f = force(place_of_point(v));
    f = (rows_.constraints().free_part(v) * f).eval();
  }
  to_nodes_pass(*this);
  if (joined_) joined_->to_nodes(std::span(force_).subspan(n_nodes() * stride), force_.data());
}

void SymmetricSpace::collect() {
  points_to_nodes();
  for (const auto& [f, n] : symmetry_) {
    Place image = force(node_of_face(f));
    force(mesh_.owner[f]) += mirrored(image, n);
    image.setZero();
  }
  const std::span<double> nodes = std::span(force_).first(n_nodes() * stride);
  const std::size_t n_cells = std::size_t(mesh_.cells.n_local()) * stride;
  mesh_.cells.add_to_owners(nodes.first(n_cells), stride);
  const std::span<double> faces = nodes.subspan(n_cells);
  mesh_.boundary.add_to_owners(faces, stride);
  if (mesh_.twin.empty()) return;
  std::fill(faces.begin() + std::ptrdiff_t(mesh_.boundary.n_owned()) * stride, faces.end(), 0.0);
  for (Index b = 0; b < mesh_.boundary.n_owned(); ++b) {
    const Index first = mesh_.twin[b];
    if (first < 0 || mesh_.boundary_id[first] > mesh_.boundary_id[b]) continue;
    force(mesh_.cells.n_local() + first) += force(mesh_.cells.n_local() + b);
  }
  mesh_.boundary.add_to_owners(faces, stride);
}

template <int D>
void SymmetricSpace::copy_rows(std::span<double> result) {
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    std::copy_n(force(c).data(), D, result.data() + std::size_t(c) * D);
}

void SymmetricSpace::take_rows(std::span<const double> unknowns, std::span<const double> known,
                               std::span<double> result) {
  const int dim = mesh_.dim;
  dim == 2 ? copy_rows<2>(result) : copy_rows<3>(result);
  const auto& open = rows_.unknown_faces();
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Index f = open[i], row = mesh_.cells.n_owned() + Index(i);
    Vec3 own = force(node_of_face(f));
    if (const BoundaryRow& boundary = rows_.at(f); boundary.held) {
      own -= (boundary.known * own).eval();
      if (!unknowns.empty()) {
        Vec3 jump = vector_at(unknowns, row, dim);
        if (!known.empty()) jump -= vector_at(known, rows_.known_of_face(f), dim);
        const LameConstants lame = rows_.lame(mesh_.owner[f]);
        const fv::FaceLine line = fv::face_line(mesh_, geometry_, f);
        own += (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn * (boundary.known * jump);
      }
    }
    std::copy_n(own.data(), dim, result.data() + std::size_t(row) * dim);
  }
}

template <class Take>
void SymmetricSpace::visit_trace(Index f, const Take& take) const {
  const double of_node = 1.0 / mesh_.dim;
  take(node_of_face(f), of_node);
  const auto shares = point_shares(mesh_, geometry_, f);
  const auto points = mesh_.face_points[f];
  for (std::size_t i = 0; i < points.size(); ++i) take(place_of_point(points[i]), (1 - of_node) * shares[i]);
}

Vec3 SymmetricSpace::face_mean(Index f) const {
  Vec3 mean = Vec3::Zero();
  visit_trace(f, [&](Index place, double share) { mean += share * value(place); });
  return mean;
}

Vec3 SymmetricSpace::pull_of_springs(Index f, std::span<const double> known) const {
  const BoundaryRow& s = rows_.at(f);
  if (s.spring.isZero(0)) return Vec3::Zero();
  const Tensor3 open = Tensor3::Identity() - s.known, spring = open * s.spring * open;
  Vec3 stretch = face_mean(f);
  if (!known.empty()) stretch -= vector_at(known, rows_.known_of_face(f), mesh_.dim);
  return geometry_.face_area[f].norm() * (spring * stretch);
}

void SymmetricSpace::add_springs(std::span<const double> known) {
  for (const Index f : rows_.known_faces()) {
    const Vec3 pull = pull_of_springs(f, known);
    if (!pull.isZero(0)) visit_trace(f, [&](Index place, double share) { force(place) += share * pull; });
  }
}

void SymmetricSpace::spread_over_base(Index f, const Vec3& force_on_base) {
  if (f >= mesh_.n_interior && !rows_.mirrored(f))
    return visit_trace(f, [&](Index place, double share) { force(place) += share * force_on_base; });
  const auto shares = point_shares(mesh_, geometry_, f);
  const auto points = mesh_.face_points[f];
  for (std::size_t i = 0; i < points.size(); ++i)
    force(place_of_point(points[i])) += shares[i] * force_on_base;
}

/// Distributes a force around a body of revolution, by the integral of r over the two halves of the face.
void SymmetricSpace::spread_around(Index f, const Vec3& force_on_base) {
  const double middle = geometry_.face_centre[f][0];
  force(node_of_face(f)) += 0.5 * circumference(middle) * force_on_base;
  for (const Index v : mesh_.face_points[f])
    force(place_of_point(v)) += circumference(2 * geometry_.points[v][0] + middle) / 12 * force_on_base;
}

/// Adds the differences from an even force at the corners of a face, and the opposite of their sum at its node.
void SymmetricSpace::spread_within(Index f, std::span<const double> of_corners) {
  const Tensor3 taken = Tensor3::Identity() - rows_.at(f).transmitted;
  const double ring = is_axisymmetric(rows_) ? circumference(geometry_.face_centre[f][0]) : 1;
  const auto points = mesh_.face_points[f];
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 here = ring * (taken * vector_at(of_corners, Index(i), mesh_.dim));
    force(place_of_point(points[i])) += here;
    force(node_of_face(f)) -= here;
  }
}

void SymmetricSpace::spread_face_forces(std::span<const double> forces) {
  const std::size_t n_whole = std::size_t(mesh_.boundary.n_owned()) * std::size_t(mesh_.dim),
                    n_within = std::size_t(mesh_.dim == 2 ? 4 : 12);
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    const Index b = f - mesh_.n_interior;
    Vec3 here = vector_at(forces, b, mesh_.dim);
    if (!here.isZero(0)) here -= (rows_.at(f).transmitted * here).eval();
    if (rows_.mirrored(f)) continue;
    if (forces.size() > n_whole)
      spread_within(f, forces.subspan(n_whole + std::size_t(b) * n_within, n_within));
    if (here.isZero(0)) continue;
    is_axisymmetric(rows_) ? spread_around(f, here) : spread_over_base(f, here);
  }
}

void SymmetricSpace::spread_cell_forces(std::span<const double> forces) {
  const double of_tip = 1.0 / mesh_.dim;
  const auto add_pyramid = [&](Index f, Index c, double volume) {
    if (c >= mesh_.cells.n_owned()) return;
    const Vec3 here = volume / volume_[c] * vector_at(forces, c, mesh_.dim);
    const auto [of_cell, of_base] = around(rows_, f, geometry_.cell_centre[c][0]);
    force(c) += of_cell * of_tip * here;
    spread_over_base(f, of_base * (1 - of_tip) * here);
  };
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const auto [here, there] = pyramids(mesh_, geometry_, f);
    add_pyramid(f, mesh_.owner[f], here);
    if (f < mesh_.n_interior) add_pyramid(f, mesh_.neighbour[f], there);
  }
}

void SymmetricSpace::add_collected(std::span<double> rhs) {
  collect();
  std::vector<double> row(rhs.size());
  take_rows({}, {}, row);
  for (std::size_t i = 0; i < row.size(); ++i) rhs[i] += row[i];
}

void SymmetricSpace::add_mass_forces(double factor) {
  const double* values = nodes_[0];
  for (std::size_t i = 0; i < mass_.size(); ++i)
    lanes::add<3>(force_.data() + i * stride, factor * mass_[i] * lanes::load<3>(values + i * stride));
}

void SymmetricSpace::set_density(std::span<const double> of_cells) {
  std::vector<double> mass(std::size_t(mesh_.cells.n_owned()) * mesh_.dim, 0);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    mass[std::size_t(c) * mesh_.dim] = of_cells[c] * geometry_.volume[c];
  clear_forces();
  spread_cell_forces(mass);
  mass_.resize(force_.size() / stride);
  for (std::size_t i = 0; i < mass_.size(); ++i) mass_[i] = force_[i * stride];
}

Vec3 SymmetricSpace::acting(std::span<const double> forces) const {
  Vec3 total = Vec3::Zero();
  for (const Index f : rows_.unknown_faces()) {
    const Vec3 here = vector_at(forces, f - mesh_.n_interior, mesh_.dim);
    const double ring = is_axisymmetric(rows_) ? circumference(geometry_.face_centre[f][0]) : 1;
    total += ring * (here - rows_.at(f).transmitted * here);
  }
  return total;
}

double SymmetricSpace::work() const {
  double sum = 0;
  const double* values = nodes_[0];
  for (std::size_t i = 0; i < force_.size(); i += stride)
    for (int a = 0; a < 3; ++a) sum += force_[i + a] * values[i + a];
  return sum;
}

// Reactions at patches: the residual forces where displacements are known.

/// Position of a node or point. At a symmetry plane a face's node is the mirror image of the cell center.
Vec3 SymmetricSpace::position(Index place, bool moved) const {
  Vec3 at;
  if (place >= n_nodes_) {
    at = geometry_.points[place - n_nodes_];
  } else if (place < mesh_.cells.n_local()) {
    at = geometry_.cell_centre[place];
  } else {
    const Index f = mesh_.n_interior + place - mesh_.cells.n_local();
    at = geometry_.face_centre[f];
    if (rows_.mirrored(f)) {
      const Vec3 n = geometry_.face_area[f].normalized(), &cell = geometry_.cell_centre[mesh_.owner[f]];
      at = cell - 2 * n.dot(cell - at) * n;
    }
  }
  return moved ? Vec3(at + value(place)) : at;
}

/// Adds reactions at points, by the sources of their known values and the symmetry planes. On a symmetry
/// plane all nodes are on one side, so their images take the couple of the free force and its nodal parts.
void SymmetricSpace::held_at_points(std::span<const Index> patch_of, bool moved,
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
    const Vec3 whole = force(place_of_point(v)), at = position(place_of_point(v), moved);
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
    for (std::size_t i = 0; i < nodes.size(); ++i) lever -= weights[i] * position(nodes[i], moved);
    result[planes[v].front().first].moment += lever.cross(constraints.free_part(v) * whole);
  }
}

/// Sums dE/du of all constraints: at points, at the nodes of faces and at mirror images. Forces on images are
/// mirrored back to the cells, so the plane takes the difference.
std::vector<Wrench> SymmetricSpace::held(std::span<const double> known, bool moved) {
  std::vector<Wrench> result(mesh_.patches.size());
  const std::vector<Index> patch_of = mesh_.patch_of_boundary();
  held_at_points(patch_of, moved, result);
  // Remainder of the point forces at held nodes.
  points_to_nodes();
  for (Index b = 0; b < mesh_.boundary.n_local(); ++b) {
    const Index f = mesh_.n_interior + b, node = mesh_.cells.n_local() + b;
    if (!rows_.at(f).held) continue;
    const Vec3 here = force(node);
    Wrench& patch = result[patch_of[b]];
    if (!rows_.mirrored(f)) {
      patch.add(rows_.at(f).known * here, position(node, moved));
      continue;
    }
    patch.add(here, position(node, moved));
    const Vec3 n = geometry_.face_area[f].normalized();
    patch.add(-mirrored(here, n), position(mesh_.owner[f], moved));
  }
  for (const Index f : rows_.known_faces()) {
    const Vec3 pull = pull_of_springs(f, known);
    if (!pull.isZero(0))
      visit_trace(f, [&](Index place, double share) {
        result[patch_of[f - mesh_.n_interior]].add(-share * pull, position(place, moved));
      });
  }
  return result;
}

}  // namespace couplet::elastic
