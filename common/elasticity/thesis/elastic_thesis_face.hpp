// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/lanes.hpp"

namespace couplet::elastic::thesis {

using lanes::Lane;
using lanes::load;

/// What the force on one face takes. Since the c_V of (2.56) add up to nothing, grad_t u = sum_i c_i (u_plus
/// - u_minus) with one difference of vertices in 2-D and two in 3-D: the diagonals of a quadrilateral, two
/// sides of a triangle. In 3-D the vectors are made from those when they are wanted, unless all of them fit
/// the cache: d_0 x d_1 is twice the face vector.
template <int D>
struct ThesisFace;
template <>
struct ThesisFace<2> {
  double n[2];        // out of the owner
  double c[2];        // [1/m]
  double kc[1];       // k . c_i [1/m]
  double inverse_dn;  // [1/m]
  double area;        // [m]
  Index plus[1], minus[1];
};
template <>
struct ThesisFace<3> {
  double kc[2];           // k . c_i [1/m]
  double inverse_dn;      // [1/m]
  double inverse_double;  // 1 / (2 |S|) [1/m^2]
  Index plus[2], minus[2];
};

template <int D>
struct FaceVectors {
  Lane<D> n, c[D - 1];
  double area;
};

/// Faces, in 3-D, up to which the vectors are kept: 80 bytes each. Beyond, to read them costs more than to
/// make them.
inline constexpr Index most_kept = 40'000;
inline constexpr int kept_size = 10;

/// A vertex: its displacement, in 3-D then its place.
template <int D>
constexpr int record = D == 2 ? lanes::width<D> : 2 * lanes::width<D>;

[[gnu::always_inline]] inline FaceVectors<2> vectors_of(const ThesisFace<2>& face, const double*) {
  return {load<2>(face.n), {load<2>(face.c)}, face.area};
}

[[gnu::always_inline]] inline FaceVectors<3> vectors_of(const ThesisFace<3>& face, const double* points) {
  const double* places = points + lanes::width<3>;
  Lane<3> d[2];
  for (int i = 0; i < 2; ++i)
    d[i] = load<3>(places + std::size_t(face.plus[i]) * record<3>) -
           load<3>(places + std::size_t(face.minus[i]) * record<3>);
  const Lane<3> twice = lanes::cross(d[0], d[1]);
  FaceVectors<3> v;
  v.n = twice * face.inverse_double;
  v.c[0] = lanes::cross(d[1], v.n) * face.inverse_double;
  v.c[1] = lanes::cross(v.n, d[0]) * face.inverse_double;
  v.area = 0.5 * lanes::dot<3>(twice, v.n);
  return v;
}

[[gnu::always_inline]] inline FaceVectors<3> kept_vectors(const double* kept) {
  return {load<3>(kept), {load<3>(kept + 3), load<3>(kept + 6)}, kept[9]};
}

template <int D>
ThesisFace<D> make_face(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  const fv::FaceLine line = fv::face_line(mesh, geometry, f);
  std::array<Vec3, 4> weights;
  fv::tangential_weights(mesh, geometry.points, f, line, weights.data());
  ThesisFace<D> face;
  const auto point = mesh.face_points[f];
  for (int i = 0; i < D - 1; ++i) {
    const bool diagonals = point.size() == 4;
    const int plus = diagonals ? i : i + 1;
    face.plus[i] = point[plus];
    face.minus[i] = point[diagonals ? i + 2 : 0];
    face.kc[i] = line.skew.dot(weights[plus]);
  }
  face.inverse_dn = line.inverse_dn;
  if constexpr (D == 2) {
    for (int a = 0; a < D; ++a) face.n[a] = line.normal[a], face.c[a] = weights[1][a];
    face.area = line.area;
  } else {
    face.inverse_double = 0.5 / line.area;
  }
  return face;
}

template <int D>
[[gnu::always_inline]] inline Lane<D> along(const ThesisFace<D>& face, int i, const double* points) {
  return load<D>(points + std::size_t(face.plus[i]) * record<D>) -
         load<D>(points + std::size_t(face.minus[i]) * record<D>);
}

//   sigma . S = mu |S| (g + n (n . g) + grad_t(n . u)) + lambda |S| n (n . g + tr grad_t u)
//   g = n . grad u = (u_N - u_P) / (d . n) + k . grad_t u                                        (2.57),
//   (2.77)
template <int D>
[[gnu::always_inline]] inline Lane<D> force_on(const ThesisFace<D>& face, const LameConstants& lame,
                                               const Lane<D>& across, const FaceVectors<D>& vectors,
                                               const double* points) {
  const Lane<D>& n = vectors.n;
  Lane<D> g = across * face.inverse_dn, turned = {};
  double trace = 0;
  for (int i = 0; i < D - 1; ++i) {
    const Lane<D> u = along(face, i, points);
    g += face.kc[i] * u;
    turned += lanes::dot<D>(n, u) * vectors.c[i];
    trace += lanes::dot<D>(vectors.c[i], u);
  }
  const double normal = lanes::dot<D>(n, g);
  return vectors.area * (lame.mu * (g + normal * n + turned) + (lame.lambda * (normal + trace)) * n);
}

/// n . grad u, the g above.
template <int D>
[[gnu::always_inline]] inline Lane<D> slope_at(const ThesisFace<D>& face, const Lane<D>& across,
                                               const double* points) {
  Lane<D> g = across * face.inverse_dn;
  for (int i = 0; i < D - 1; ++i) g += face.kc[i] * along(face, i, points);
  return g;
}

}  // namespace couplet::elastic::thesis
