// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/face_stencil.hpp"

namespace couplet::elastic {

void FaceStencil::take(Index node, const Vec3& b, const Tensor3& turn) {
  if (number_[node] < 0) return;  // known
  for (Term& t : terms_)
    if (t.node == node && t.turn == turn) {
      t.b += b;
      return;
    }
  terms_.push_back({node, b, turn});
}

void FaceStencil::take_boundary(Index f, const Vec3& b) {
  take(node_of(f), b, Tensor3::Identity() - rows_.at(f).known);
}

void FaceStencil::take_point(Index v, const Vec3& b) {
  const VertexConstraints& constraints = rows_.constraints();
  if (constraints.is_fixed(v)) return;
  const auto nodes = rows_.vertices().nodes(v);
  const auto weights = rows_.vertices().weights(v);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Tensor3 turn = constraints.free_part(v);
    const Index f = nodes[i] - mesh_.cells.n_local() + mesh_.n_interior;
    if (nodes[i] >= mesh_.cells.n_local() && rows_.at(f).held)
      turn = (turn * (Tensor3::Identity() - rows_.at(f).known)).eval();
    take(nodes[i], weights[i] * b, turn);
  }
}

template <int D>
const std::vector<FaceStencil::Term>& FaceStencil::of(const SymmetricFace<D>& face, Index f) {
  const auto scaled = [&](const std::array<double, D>& from) {
    Vec3 b = Vec3::Zero();
    for (int a = 0; a < D; ++a) b[a] = from[a] * face.inverse;
    return b;
  };
  terms_.clear();
  const Vec3 s = scaled(face.area);
  const Tensor3 identity = Tensor3::Identity();
  take(mesh_.owner[f], -s, identity);
  if (f < mesh_.n_interior) {
    take(mesh_.neighbour[f], s, identity);
  } else if (rows_.mirrored(f)) {
    const Vec3 n = geometry_.face_area[f].normalized();
    take(mesh_.owner[f], s, identity - 2 * n * n.transpose());
  } else {
    take_boundary(f, s);
  }
  for (int i = 0; i < D - 1; ++i) {
    take_point(face.plus[i], scaled(face.across[i]));
    take_point(face.minus[i], -scaled(face.across[i]));
  }
  return terms_;
}

const std::vector<FaceStencil::Term>& FaceStencil::of_revolution(const AxisymmetricFace& face, Index f) {
  const auto of = [&](std::size_t i) { return Vec3(face.b[i][0], face.b[i][1], face.hoop[i]); };
  terms_.clear();
  take(mesh_.owner[f], of(0), Tensor3::Identity());
  if (f < mesh_.n_interior)
    take(mesh_.neighbour[f], of(1), Tensor3::Identity());
  else if (face.has_shear)
    take_boundary(f, of(1));
  for (std::size_t i = 0; i < 2; ++i) take_point(face.point[i], of(i + 2));
  return terms_;
}

template <int D>
const std::vector<FaceStencil::Term>& FaceStencil::of_mean(Index f) {
  terms_.clear();
  take_boundary(f, Vec3(1.0 / D, 0, 0));
  const auto shares = point_shares(mesh_, geometry_, f);
  const auto points = mesh_.face_points[f];
  for (std::size_t i = 0; i < points.size(); ++i)
    take_point(points[i], Vec3((1 - 1.0 / D) * shares[i], 0, 0));
  return terms_;
}

const std::vector<FaceStencil::Term>& FaceStencil::of_point(Index v) {
  terms_.clear();
  take_point(v, Vec3(1, 0, 0));
  return terms_;
}

template const std::vector<FaceStencil::Term>& FaceStencil::of_mean<2>(Index);
template const std::vector<FaceStencil::Term>& FaceStencil::of_mean<3>(Index);
template const std::vector<FaceStencil::Term>& FaceStencil::of<2>(const SymmetricFace<2>&, Index);
template const std::vector<FaceStencil::Term>& FaceStencil::of<3>(const SymmetricFace<3>&, Index);

}  // namespace couplet::elastic
