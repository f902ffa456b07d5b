// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

#include "common/fv/elastic_nodes.hpp"
#include "common/fv/lanes.hpp"

namespace couplet::corrected {

using lanes::Lane;
using lanes::load;
using lanes::store;

/// grad_t u = sum_i m_i w_i with the values w on the edges around the face (3-D, m_i = L_i n / |S|, sum zero)
/// or at its two end points (2-D).
template <int D>
struct CorrectedFace {
  static constexpr int n_slopes = D == 2 ? 1 : 3;
  double n[D];            // out of the owner
  double m[n_slopes][D];  // [1/m]; w is taken relative to the last edge (the first point)
  double k[D];            // n - d / (d . n)
  double off[D];          // interior: x_f - (x_P + x_N) / 2 [m]; boundary: d / (d . n)
  double inverse_dn;      // [1/m]
  double mu, lambda;      // times the area [N]
  Index around[D == 2 ? 2 : 4];
};

// The gradients of a pyramid, or of two cells of different kind, err too differently for their difference to
// tell the second derivative.
inline bool alike(const Mesh& mesh, Index f) {
  const CellType here = mesh.cell_type[mesh.owner[f]];
  return here == mesh.cell_type[mesh.neighbour[f]] && here != CellType::pyramid;
}

inline void place(const Vec3& from, double* to, int dim) { std::copy_n(from.data(), dim, to); }

template <int D>
CorrectedFace<D> make_face(const Mesh& mesh, const ElasticOperator& rows, Index f) {
  const FaceGradient& faces = rows.faces();
  const LameConstants lame = face_lame(mesh, rows, f);
  CorrectedFace<D> face{};
  const Geometry& g = mesh.reference;
  const auto point = mesh.face_points[f];
  const Vec3& n = faces.normal[f];
  const double area = g.face_area[f].norm();
  if constexpr (D == 2) {
    place(faces.tangential[mesh.face_points.offset[f] + 1], face.m[0], D);
    face.around[0] = point[0];
    face.around[1] = point[1];
  } else {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 edge =
          mesh.reference_points[point[(i + 1) % point.size()]] - mesh.reference_points[point[i]];
      place(edge.cross(n) / area, face.m[i], D);
    }
  }
  place(n, face.n, D);
  place(faces.skew[f], face.k, D);
  if (f < mesh.n_interior && !alike(mesh, f))
    place(Vec3::Zero(), face.off, D);
  else if (f < mesh.n_interior)
    place(g.face_centre[f] - 0.5 * (g.cell_centre[mesh.owner[f]] + g.cell_centre[mesh.neighbour[f]]),
          face.off, D);
  else
    place(n - faces.skew[f], face.off, D);
  face.inverse_dn = faces.inverse_dn[f];
  face.mu = lame.mu * area;
  face.lambda = lame.lambda * area;
  return face;
}

/// Rows i of a gradient: d u / d x_i.
template <int D>
struct Rows {
  Lane<D> row[D] = {};
};

template <int D>
[[gnu::always_inline]] inline Lane<D> contract(const double* v, const double* rows) {
  Lane<D> sum = v[0] * load<D>(rows);
  for (int i = 1; i < D; ++i) sum += v[i] * load<D>(rows + i * lanes::width<D>);
  return sum;
}

/// grad_t u from the values around the face.
template <int D>
[[gnu::always_inline]] inline Rows<D> tangential(const CorrectedFace<D>& face, const double* values,
                                                 int stride) {
  Rows<D> result;
  if constexpr (D == 2) {
    const Lane<D> along = load<D>(values + std::size_t(face.around[1]) * stride) -
                          load<D>(values + std::size_t(face.around[0]) * stride);
    for (int i = 0; i < D; ++i) result.row[i] = face.m[0][i] * along;
  } else {
    const Lane<D> last = load<D>(values + std::size_t(face.around[3]) * stride);
    for (int e = 0; e < 3; ++e) {
      const Lane<D> w = load<D>(values + std::size_t(face.around[e]) * stride) - last;
      for (int i = 0; i < D; ++i) result.row[i] += face.m[e][i] * w;
    }
  }
  return result;
}

/// n . grad u from `along` = d . grad u at the face centre, k . grad_t completing it.
template <int D>
[[gnu::always_inline]] inline Lane<D> normal_derivative(const CorrectedFace<D>& face, const Lane<D>& along,
                                                        const Rows<D>& grad) {
  Lane<D> g = along * face.inverse_dn;
  for (int i = 0; i < D; ++i) g += face.k[i] * grad.row[i];
  return g;
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
