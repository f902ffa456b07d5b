// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_faces.hpp"

#include <Eigen/Geometry>
#include <numbers>

namespace couplet::elastic {
namespace {

/// Vector from the owner to the neighbor node, which is the owner's mirror image at a symmetry plane.
Vec3 line_across(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f, bool mirrored) {
  const Vec3& here = geometry.cell_centre[mesh.owner[f]];
  if (f < mesh.n_interior) return geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f) - here;
  if (!mirrored) return geometry.face_centre[f] - here;
  const Vec3 n = geometry.face_area[f].normalized();
  return 2 * n.dot(geometry.face_centre[f] - here) * n;
}

Index node_across(const mesh::Mesh& mesh, Index f) {
  return f < mesh.n_interior ? mesh.neighbour[f] : mesh.cells.n_local() + f - mesh.n_interior;
}

double cross(const Vec3& a, const Vec3& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Twice the signed area.
double twice_area(const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a); }

template <int D>
FaceRows rows_of(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  const mesh::Geometry& geometry = rows.geometry();
  const bool mirrored = rows.mirrored(f);
  const Vec3 d = line_across(mesh, geometry, f, mirrored);
  const auto point = mesh.face_points[f];
  const bool diagonals = point.size() == 4;
  Index plus[D - 1], minus[D - 1];
  Vec3 side[D - 1], c[D - 1], area;
  for (int i = 0; i < D - 1; ++i) {
    plus[i] = point[diagonals ? i : i + 1];
    minus[i] = point[diagonals ? i + 2 : 0];
    side[i] = geometry.points[plus[i]] - geometry.points[minus[i]];
  }
  if constexpr (D == 3) {
    area = 0.5 * side[0].cross(side[1]);
    c[0] = 0.5 * side[1].cross(d);
    c[1] = 0.5 * d.cross(side[0]);
  } else {
    const Vec3 normal(side[0][1], -side[0][0], 0);
    const double turn = geometry.face_area[f].dot(normal) > 0 ? 1 : -1;
    area = turn * normal;
    c[0] = turn * Vec3(-d[1], d[0], 0);
  }
  const double whole = area.dot(d), inverse = 1 / whole;
  FaceRows face;
  face.n = 2 * D;
  face.volume = whole / D * (mirrored ? 0.5 : 1);
  const auto set = [&](int i, Index place, const Vec3& from, double sign) {
    face.row[i].place = place;
    face.row[i].b = (sign * inverse) * from;
  };
  const Index first_point = n_node_places(mesh);
  set(0, mesh.owner[f], area, -1);
  set(1, node_across(mesh, f), area, 1);
  for (int i = 0; i < D - 1; ++i) {
    set(2 + 2 * i, first_point + plus[i], c[i], 1);
    set(3 + 2 * i, first_point + minus[i], c[i], -1);
  }
  return face;
}

}  // namespace

FaceRows symmetric_rows(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  return mesh.dim == 2 ? rows_of<2>(mesh, rows, f) : rows_of<3>(mesh, rows, f);
}

double circumference(double radius) { return 2 * std::numbers::pi * radius; }

FaceRows ring_rows(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  const mesh::Geometry& geometry = rows.geometry();
  const auto points = mesh.face_points[f];
  const Index first_point = n_node_places(mesh);
  const bool has_shear = !rows.mirrored(f);
  // Order around the quadrilateral: owner, first point, neighbor node, second point, as array indices.
  const std::array<std::size_t, 4> around{0, 2, 1, 3};
  std::array<Vec3, 4> x, b;
  x[0] = geometry.cell_centre[mesh.owner[f]];
  x[1] = f < mesh.n_interior ? Vec3(geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f))
                             : geometry.face_centre[f];
  x[2] = geometry.points[points[0]], x[3] = geometry.points[points[1]];
  const double here = twice_area(x[0], x[2], x[1]), there = twice_area(x[0], x[1], x[3]),
               whole = here + there, turn = whole > 0 ? 1 : -1;
  const double area = 0.5 * std::abs(whole);
  std::array<double, 4> mean{};  // weights of the value at the centroid
  if (has_shear)
    mean = {1. / 3, 1. / 3, here / (3 * whole), there / (3 * whole)};
  else
    mean = {1. / 3, 0, 1. / 3, 1. / 3};
  double radius = 0;
  for (std::size_t i = 0; i < 4; ++i) radius += mean[i] * x[i][0];
  const double scale = 1 / (radius * area);
  b.fill(Vec3::Zero());
  const auto add_side = [&](std::size_t i, std::size_t j) {
    const Vec3 side = turn * (x[j] - x[i]);
    const double n[2] = {side[1], -side[0]};
    for (Index a = 0; a < 2; ++a) {
      b[i][a] += scale * n[a] * (2 * x[i][0] + x[j][0]) / 6;
      b[j][a] += scale * n[a] * (x[i][0] + 2 * x[j][0]) / 6;
    }
  };
  if (has_shear) {
    for (std::size_t k = 0; k < 4; ++k) add_side(around[k], around[(k + 1) % 4]);
  } else {
    add_side(0, 2), add_side(2, 3), add_side(3, 0);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    b[i][2] = mean[i] / radius;
    b[i][0] -= b[i][2];
  }
  const std::array<Index, 4> place{mesh.owner[f], node_across(mesh, f), first_point + points[0],
                                   first_point + points[1]};
  FaceRows face{
      .row = {}, .n = 4, .volume = circumference(radius) * area, .is_ring = true, .has_shear = has_shear};
  for (std::size_t i = 0; i < 4; ++i) face.row[i] = {place[i], b[i]};
  return face;
}

std::array<double, 4> point_shares(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  std::array<double, 4> shares{};
  const auto point = mesh.face_points[f];
  if (mesh.dim == 2) return {0.5, 0.5};
  double whole = 0;
  for (std::size_t i = 0; i < point.size(); ++i) {
    const std::size_t j = (i + 1) % point.size();
    const Vec3& centre = geometry.face_centre[f];
    const double area = (geometry.points[point[i]] - centre).cross(geometry.points[point[j]] - centre).norm();
    whole += area;
    shares[i] += 0.5 * area;
    shares[j] += 0.5 * area;
  }
  for (double& s : shares) s /= whole;
  return shares;
}

std::array<double, 2> pyramids(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  const Vec3& s = geometry.face_area[f];
  const double here = s.dot(geometry.face_centre[f] - geometry.cell_centre[mesh.owner[f]]) / mesh.dim;
  if (f >= mesh.n_interior) return {here, 0};
  const Vec3 there = geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f);
  return {here, s.dot(there - geometry.face_centre[f]) / mesh.dim};
}

void add_term(FaceTermList& terms, const FaceTerm& term) {
  for (FaceTerm& t : terms)
    if (t.block == term.block && t.turn == term.turn) {
      t.b += term.b;
      return;
    }
  terms.push_back(term);
}

/// Adds a term. In a ring, radial displacement gives hoop strain. Components separate without shear.
void FaceTerms::take(GlobalIndex block, const Vec3& b, const Tensor3& turn) {
  if (block < 0) return;
  if (!ring_) return add_term(terms_, {block, b, turn});
  const auto along = [&](int component, const Tensor3& of) {
    add_term(terms_, {block, b[component] * Vec3::Unit(component), of});
  };
  const auto pick = [&](int to, int from) { return Tensor3(Vec3::Unit(to) * turn.row(from)); };
  if (ring_->has_shear)
    add_term(terms_, {block, Vec3(b[0], b[1], 0), turn});
  else
    along(0, pick(0, 0)), along(1, pick(1, 1));
  along(2, pick(2, 0));
}

void FaceTerms::take_node(Index node, const Vec3& b) {
  const Index f = node - mesh_.cells.n_local() + mesh_.n_interior;
  if (node < mesh_.cells.n_local()) return take(number_.node[node], b, Tensor3::Identity());
  if (!rows_.mirrored(f)) return take(number_.node[node], b, Tensor3::Identity() - rows_.at(f).known);
  if (ring_) return;
  const Vec3 n = rows_.geometry().face_area[f].normalized();
  take(number_.node[mesh_.owner[f]], b, Tensor3::Identity() - 2 * n * n.transpose());
}

void FaceTerms::take_point(Index v, const Vec3& b) {
  if (!number_.point.empty()) return take(number_.point[v], b, Tensor3::Identity());
  const VertexConstraints& constraints = rows_.constraints();
  if (constraints.is_fixed(v)) return;
  const auto nodes = rows_.vertices().nodes(v);
  const auto weights = rows_.vertices().weights(v);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Tensor3 turn = constraints.free_part(v);
    const Index f = nodes[i] - mesh_.cells.n_local() + mesh_.n_interior;
    if (nodes[i] >= mesh_.cells.n_local() && rows_.at(f).held)
      turn = (turn * (Tensor3::Identity() - rows_.at(f).known)).eval();
    take(number_.node[nodes[i]], weights[i] * b, turn);
  }
}

const FaceTermList& FaceTerms::of_face(const FaceRows& face) {
  terms_.clear();
  ring_ = face.is_ring ? &face : nullptr;
  const Index first_point = n_node_places(mesh_);
  for (const FaceRows::Row& row : face.all())
    row.place < first_point ? take_node(row.place, row.b) : take_point(row.place - first_point, row.b);
  ring_ = nullptr;
  return terms_;
}

const FaceTermList& FaceTerms::of_mean(Index f) {
  terms_.clear();
  const double of_node = 1.0 / mesh_.dim;
  take_node(mesh_.cells.n_local() + f - mesh_.n_interior, Vec3(of_node, 0, 0));
  const auto shares = point_shares(mesh_, rows_.geometry(), f);
  const auto points = mesh_.face_points[f];
  for (std::size_t i = 0; i < points.size(); ++i)
    take_point(points[i], Vec3((1 - of_node) * shares[i], 0, 0));
  return terms_;
}

const FaceTermList& FaceTerms::of_point(Index v) {
  terms_.clear();
  take_point(v, Vec3(1, 0, 0));
  return terms_;
}

}  // namespace couplet::elastic
