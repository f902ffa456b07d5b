// SPDX-License-Identifier: Apache-2.0
// ElasticKernel with the thesis's face gradient: two passes, vertices then faces.
#include <algorithm>
#include <array>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/elastic_rows.hpp"
#include "common/elasticity/elastic_vertices.hpp"
#include "common/elasticity/lanes.hpp"

namespace couplet::elastic {
namespace thesis {
namespace {

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

template <int D>
class ThesisKernel final : public ElasticKernel::Implementation {
 public:
  ThesisKernel(const mesh::Mesh& mesh, const ElasticOperator& rows)
      : mesh_(mesh),
        geometry_(rows.geometry()),
        rows_(rows),
        nodes_(mesh, rows),
        boundary_(mesh, rows),
        vertices_(mesh, rows),
        lame_(mesh, rows),
        points_(std::size_t(mesh.points.n_local()) * record<D>, 0.0) {
    faces_.reserve(n_faces_with_force(mesh));
    for (Index f = 0; f < n_faces_with_force(mesh); ++f) faces_.push_back(make_face<D>(mesh, geometry_, f));
    if constexpr (D == 3)
      for (Index v = 0; v < mesh.points.n_local(); ++v)
        std::copy_n(geometry_.points[v].data(), 3,
                    points_.begin() + std::ptrdiff_t(v) * record<3> + lanes::width<3>);
    if (D == 3 && n_faces_with_force(mesh) <= most_kept) keep_vectors();
  }

  void apply(std::span<const double> unknowns, std::span<const double> known,
             std::span<double> result) override;
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const ElasticKernel::TakeGradient& take, Index first, Index end) override;
  void point_values(std::span<const double> unknowns, std::span<const double> known,
                    std::span<double> points) override;

  [[gnu::always_inline]] inline void interpolate_free();
  [[gnu::always_inline]] inline void collect_forces(std::span<const double> known, std::span<double> result);

 private:
  static constexpr int stride = lanes::width<D>;
  void keep_vectors();
  template <class Vectors>
  [[gnu::always_inline]] inline void collect_forces_with(const Vectors& vectors,
                                                         std::span<const double> known,
                                                         std::span<double> result);
  void fill(std::span<const double> unknowns, std::span<const double> known);

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  ElasticNodes<D> nodes_;
  ElasticRows boundary_;
  ElasticVertices vertices_;
  FaceLames lame_;
  std::vector<ThesisFace<D>> faces_;
  std::vector<double> kept_;    // vectors of the faces, kept_size numbers each, if there are few
  std::vector<double> points_;  // records of the vertices
};

template <int D>
inline void ThesisKernel<D>::interpolate_free() {
  const double* nodes = nodes_[0];
  double* points = points_.data();
  for (const Index v : vertices_.free) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    Lane<D> sum = {};
    for (std::size_t i = 0; i < index.size(); ++i)
      sum += weight[i] * load<D>(nodes + std::size_t(index[i]) * stride);
    lanes::store<D>(points + std::size_t(v) * record<D>, sum);
  }
}

template <int D>
void ThesisKernel<D>::keep_vectors() {
  kept_.reserve(faces_.size() * kept_size);
  for (const ThesisFace<D>& face : faces_) {
    const FaceVectors<D> vectors = vectors_of(face, points_.data());
    for (int a = 0; a < D; ++a) kept_.push_back(vectors.n[a]);
    for (int i = 0; i < D - 1; ++i)
      for (int a = 0; a < D; ++a) kept_.push_back(vectors.c[i][a]);
    kept_.push_back(vectors.area);
  }
}

template <int D>
inline void ThesisKernel<D>::collect_forces(std::span<const double> known, std::span<double> result) {
  if constexpr (D == 3) {
    if (!kept_.empty())
      return collect_forces_with(
          [this](Index f) __attribute__((always_inline)) {
            return kept_vectors(kept_.data() + std::size_t(f) * kept_size);
          },
          known, result);
  }
  collect_forces_with(
      [this](Index f) __attribute__((always_inline)) { return vectors_of(faces_[f], points_.data()); }, known,
      result);
}

template <int D>
template <class Vectors>
inline void ThesisKernel<D>::collect_forces_with(const Vectors& vectors, std::span<const double> known,
                                                 std::span<double> result) {
  nodes_.clear_forces();
  const double* points = points_.data();
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Lane<D> force =
        force_on<D>(faces_[f], lame_[f], load<D>(nodes_[n]) - load<D>(nodes_[p]), vectors(f), points);
    lanes::add<D>(nodes_.force(p), -force);
    lanes::add<D>(nodes_.force(n), force);
  }
  const auto across = [&](Index f) __attribute__((always_inline)) {
    return load<D>(nodes_.of_face(f)) - load<D>(nodes_[mesh_.owner[f]]);
  };
  boundary_.add_rows<D>(
      nodes_, known, result.data() + std::size_t(mesh_.cells.n_owned()) * D,
      [&](Index f) __attribute__((always_inline)) {
        return force_on<D>(faces_[f], lame_[f], across(f), vectors(f), points);
      },
      [&](Index f) __attribute__((always_inline)) { return slope_at<D>(faces_[f], across(f), points); });
  nodes_.take_forces(result);
}

// The loops for several generations of processors; the right one is picked when the program starts.
COUPLET_PROCESSOR_CLONES void vertices_pass(ThesisKernel<3>& kernel) { kernel.interpolate_free(); }
COUPLET_PROCESSOR_CLONES void faces_pass(ThesisKernel<3>& kernel, std::span<const double> known,
                                         std::span<double> result) {
  kernel.collect_forces(known, result);
}
COUPLET_PROCESSOR_CLONES void vertices_pass(ThesisKernel<2>& kernel) { kernel.interpolate_free(); }
COUPLET_PROCESSOR_CLONES void faces_pass(ThesisKernel<2>& kernel, std::span<const double> known,
                                         std::span<double> result) {
  kernel.collect_forces(known, result);
}

/// All that stands before the faces.
template <int D>
void ThesisKernel<D>::fill(std::span<const double> unknowns, std::span<const double> known) {
  nodes_.fill(unknowns, known);
  vertices_pass(*this);
  vertices_.constrain<D>(points_, record<D>, known);
}

template <int D>
void ThesisKernel<D>::apply(std::span<const double> unknowns, std::span<const double> known,
                            std::span<double> result) {
  fill(unknowns, known);
  faces_pass(*this, known, result);
}

template <int D>
void ThesisKernel<D>::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                     const ElasticKernel::TakeGradient& take, Index first, Index end) {
  fill(unknowns, known);
  for (Index f = first; f < end; ++f) {
    const ThesisFace<D>& face = faces_[f];
    const bool symmetric = rows_.mirrored(f);
    Lane<D> g = (load<D>(f < mesh_.n_interior ? nodes_[mesh_.neighbour[f]] : nodes_.of_face(f)) -
                 load<D>(nodes_[mesh_.owner[f]])) *
                face.inverse_dn;
    const FaceVectors<D> vectors = vectors_of(face, points_.data());
    Tensor3 gradient = Tensor3::Zero();
    for (int i = 0; i < D - 1; ++i) {
      const Lane<D> u = along(face, i, points_.data());
      g += face.kc[i] * u;
      for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) gradient(a, b) += vectors.c[i][a] * u[b];
    }
    if (symmetric) g = lanes::dot<D>(vectors.n, g) * vectors.n;
    for (int a = 0; a < D; ++a)
      for (int b = 0; b < D; ++b) gradient(a, b) += vectors.n[a] * g[b];
    take(f, gradient);
  }
}

template <int D>
void ThesisKernel<D>::point_values(std::span<const double> unknowns, std::span<const double> known,
                                   std::span<double> points) {
  fill(unknowns, known);
  vertices_.visit([&](Index v) {
    std::copy_n(points_.data() + std::size_t(v) * record<D>, D, points.data() + std::size_t(v) * D);
  });
}

}  // namespace
}  // namespace thesis

std::unique_ptr<ElasticKernel::Implementation> make_thesis_kernel(const mesh::Mesh& mesh,
                                                                  const ElasticOperator& rows) {
  if (mesh.dim == 2) return std::make_unique<thesis::ThesisKernel<2>>(mesh, rows);
  return std::make_unique<thesis::ThesisKernel<3>>(mesh, rows);
}

}  // namespace couplet::elastic
