// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>
#include <span>

#include "common/fv/elastic_nodes.hpp"
#include "common/fv/lanes.hpp"

namespace couplet::corrected {

using lanes::Lane;
using lanes::load;
using lanes::store;

/// What a face needs beyond the mesh: its vectors are made from the places of points and cells when they are
/// wanted, which costs less than to keep and read them.
template <int D>
struct CorrectedFace {
  double n[D];                   // out of the owner
  double inverse_dn;             // [1/m]
  double inverse_area;           // [1/m^2]
  double mu, lambda;             // times the area [N]
  Index around[D == 2 ? 2 : 4];  // edges (3-D) or points (2-D) whose values its gradient is made of
  Index curved;                  // whether the cells' gradients tell the second derivative across it
};

// The gradients of a pyramid, or of two cells of different kind, err too differently for their difference to
// tell the second derivative.
inline bool alike(const Mesh& mesh, Index f) {
  const CellType here = mesh.cell_type[mesh.owner[f]];
  return here == mesh.cell_type[mesh.neighbour[f]] && here != CellType::pyramid;
}

template <int D>
CorrectedFace<D> make_face(const Mesh& mesh, const ElasticOperator& rows, Index f) {
  const LameConstants lame = face_lame(mesh, rows, f);
  CorrectedFace<D> face{};
  const FaceLine line = face_line(mesh, mesh.reference, f);
  std::copy_n(line.normal.data(), D, face.n);
  if constexpr (D == 2) std::copy_n(mesh.face_points[f].data(), 2, face.around);
  face.inverse_dn = line.inverse_dn;
  face.inverse_area = 1 / line.area;
  face.mu = lame.mu * line.area;
  face.lambda = lame.lambda * line.area;
  face.curved = f < mesh.n_interior && alike(mesh, f);
  return face;
}

/// Rows i of a gradient: d u / d x_i.
template <int D>
struct Rows {
  Lane<D> row[D] = {};
};

template <int D>
[[gnu::always_inline]] inline Lane<D> contract(const Vec3& v, const double* rows) {
  Lane<D> sum = v[0] * load<D>(rows);
  for (int i = 1; i < D; ++i) sum += v[i] * load<D>(rows + i * lanes::width<D>);
  return sum;
}

/// T x n / |S| of the rows T_i = sum_e L_e,i w_e: the surface Gauss theorem with the edges' L_e.
[[gnu::always_inline]] inline Rows<3> turn(const Rows<3>& t, const CorrectedFace<3>& face) {
  const double n[3] = {face.n[0] * face.inverse_area, face.n[1] * face.inverse_area,
                       face.n[2] * face.inverse_area};
  Rows<3> result;
  result.row[0] = n[2] * t.row[1] - n[1] * t.row[2];
  result.row[1] = n[0] * t.row[2] - n[2] * t.row[0];
  result.row[2] = n[1] * t.row[0] - n[0] * t.row[1];
  return result;
}

/// grad_t u from `value(i)`: on edge i of the face's `corners` (a triangle repeats its first as its fourth,
/// its last edge is then 2), in 2-D at its two points. Edge 3 needs no vector: the edges add up to nothing.
template <int D, class Value>
[[gnu::always_inline]] inline Rows<D> tangential(const CorrectedFace<D>& face, std::span<const Index> corners,
                                                 const Vec3* x, const Value& value) {
  Rows<D> result;
  if constexpr (D == 2) {
    const Lane<D> along = (value(1) - value(0)) * (face.inverse_area * face.inverse_area);
    for (int i = 0; i < D; ++i) result.row[i] = (x[corners[1]][i] - x[corners[0]][i]) * along;
    return result;
  } else {
    const Lane<D> last = value(3);
    for (int e = 0; e < 3; ++e) {
      const Vec3 &from = x[corners[e]], &to = x[corners[e + 1 < std::ssize(corners) ? e + 1 : 0]];
      const Lane<D> w = value(e) - last;
      for (int i = 0; i < D; ++i) result.row[i] += (to[i] - from[i]) * w;
    }
    return turn(result, face);
  }
}

/// n . grad u from `along` = d . grad u at the face centre: with k = n - d / (d . n) and grad_t across n,
/// g = along / (d . n) + k . grad_t u = (along - d . grad_t u) / (d . n).
template <int D>
[[gnu::always_inline]] inline Lane<D> normal_derivative(const CorrectedFace<D>& face, const Vec3& d,
                                                        const Lane<D>& along, const Rows<D>& grad) {
  Lane<D> rest = along;
  for (int i = 0; i < D; ++i) rest -= d[i] * grad.row[i];
  return rest * face.inverse_dn;
}

/// sigma . S for grad u = n g + grad_t u, as in the thesis's kernel.
template <int D>
[[gnu::always_inline]] inline Lane<D> force_on(const CorrectedFace<D>& face, const Lane<D>& g,
                                               const Rows<D>& grad) {
  const Lane<D> n = load<D>(face.n);
  Lane<D> turned = {};
  double trace = 0;
  for (int i = 0; i < D; ++i) {
    turned[i] = lanes::dot<D>(n, grad.row[i]);
    trace += grad.row[i][i];
  }
  const double normal = lanes::dot<D>(n, g);
  return face.mu * (g + normal * n + turned) + (face.lambda * (normal + trace)) * n;
}

}  // namespace couplet::corrected
