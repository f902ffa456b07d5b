// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/face_terms.hpp"

#include <Eigen/Geometry>

namespace couplet::elastic {

void add_term(FaceTermList& terms, const FaceTerm& term) {
  for (FaceTerm& t : terms)
    if (t.block == term.block && t.turn == term.turn) {
      t.b += term.b;
      return;
    }
  terms.push_back(term);
}

/// The hoop strain of a ring comes by the radial displacement; without shear each component has its own derivative.
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
