// SPDX-License-Identifier: Apache-2.0
// ElasticKernel with the thesis's face gradient: two passes, vertices then faces.
#include <algorithm>
#include <array>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/elastic_rows.hpp"
#include "common/elasticity/elastic_vertices.hpp"
#include "common/elasticity/thesis/elastic_thesis_face.hpp"

namespace couplet::elastic {
namespace thesis {
namespace {

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
