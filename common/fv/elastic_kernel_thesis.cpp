// SPDX-License-Identifier: Apache-2.0
// ElasticKernel with the thesis's face gradient: two passes, vertices then faces.
#include "common/fv/elastic_nodes.hpp"
#include "common/fv/elastic_vertices.hpp"

namespace couplet {
namespace {

using lanes::Lane;
using lanes::load;

/// What the force on one face takes. Since the c_V of (2.56) add up to nothing, grad_t u = sum_i c_i (u_plus
/// - u_minus) with one difference of vertices in 2-D and two in 3-D: the diagonals of a quadrilateral, two
/// sides of a triangle.
template <int D>
struct ThesisFace {
  double n[D];         // out of the owner
  double c[D - 1][D];  // [1/m]
  double kc[D - 1];    // k . c_i [1/m]
  double inverse_dn;   // [1/m]
  double mu, lambda;   // times the area [N]
  Index plus[D - 1], minus[D - 1];
};

template <int D>
ThesisFace<D> make_face(const Mesh& mesh, const FaceGradient& faces, Index f, double mu, double lambda) {
  ThesisFace<D> face;
  const Index first = mesh.face_points.offset[f], count = mesh.face_points.offset[f + 1] - first;
  const Index* point = mesh.face_points.index.data() + first;
  const double area = mesh.reference.face_area[f].norm();
  for (int i = 0; i < D - 1; ++i) {
    const bool diagonals = count == 4;
    const int plus = diagonals ? i : i + 1;
    face.plus[i] = point[plus];
    face.minus[i] = point[diagonals ? i + 2 : 0];
    const Vec3& c = faces.tangential[first + plus];
    for (int a = 0; a < D; ++a) face.c[i][a] = c[a];
    face.kc[i] = faces.skew[f].dot(c);
  }
  for (int a = 0; a < D; ++a) face.n[a] = faces.normal[f][a];
  face.inverse_dn = faces.inverse_dn[f];
  face.mu = mu * area;
  face.lambda = lambda * area;
  return face;
}

//   sigma . S = mu |S| (g + n (n . g) + grad_t(n . u)) + lambda |S| n (n . g + tr grad_t u)
//   g = n . grad u = (u_N - u_P) / (d . n) + k . grad_t u                                        (2.57),
//   (2.77)
template <int D>
[[gnu::always_inline]] inline Lane<D> force_on(const ThesisFace<D>& face, const Lane<D>& across,
                                               const double* points) {
  constexpr int stride = lanes::width<D>;
  const Lane<D> n = load<D>(face.n);
  Lane<D> g = across * face.inverse_dn, turned = {};
  double trace = 0;
  for (int i = 0; i < D - 1; ++i) {
    const Lane<D> along = load<D>(points + std::size_t(face.plus[i]) * stride) -
                          load<D>(points + std::size_t(face.minus[i]) * stride);
    const Lane<D> c = load<D>(face.c[i]);
    g += face.kc[i] * along;
    turned += lanes::dot<D>(n, along) * c;
    trace += lanes::dot<D>(c, along);
  }
  const double normal = lanes::dot<D>(n, g);
  return face.mu * (g + normal * n + turned) + (face.lambda * (normal + trace)) * n;
}

template <int D>
class ThesisKernel final : public ElasticKernel::Implementation {
 public:
  ThesisKernel(const Mesh& mesh, const ElasticOperator& rows, std::span<const double> mu,
               std::span<const double> lambda)
      : mesh_(mesh),
        rows_(rows),
        nodes_(mesh, rows),
        kinds_(mesh, rows),
        vertices_(mesh, rows),
        points_(std::size_t(mesh.points.n_local()) * stride, 0.0) {
    faces_.reserve(mesh.n_flux_faces());
    for (Index f = 0; f < mesh.n_flux_faces(); ++f)
      faces_.push_back(make_face<D>(mesh, rows.faces(), f, mu[mesh.owner[f]], lambda[mesh.owner[f]]));
  }

  void apply(std::span<const double> unknowns, std::span<const double> known,
             std::span<double> result) override;
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      std::span<Tensor3> gradients) override;
  void point_values(std::span<const double> unknowns, std::span<const double> known,
                    std::span<double> points) override;

  [[gnu::always_inline]] inline void interpolate_free();
  [[gnu::always_inline]] inline void collect_forces(std::span<double> result);

 private:
  static constexpr int stride = lanes::width<D>;
  void fill(std::span<const double> unknowns, std::span<const double> known);
  const double* other_side(Index f) const {
    return nodes_[f < mesh_.n_interior ? mesh_.neighbour[f] : mesh_.cells.n_local() + f - mesh_.n_interior];
  }

  const Mesh& mesh_;
  const ElasticOperator& rows_;
  ElasticNodes<D> nodes_;
  FaceKinds kinds_;
  ElasticVertices vertices_;
  std::vector<ThesisFace<D>> faces_;
  std::vector<double> points_;  // padded displacements of the vertices
};

template <int D>
inline void ThesisKernel<D>::interpolate_free() {
  interpolate_records<D, 1, stride, stride>(rows_.vertices(), vertices_.free, nodes_[0], points_.data());
  for (const Index v : vertices_.on_planes) {
    double* u = points_.data() + std::size_t(v) * stride;
    Eigen::Map<Vec<D>> here(u);
    here = (rows_.vertices().projector(v).template topLeftCorner<D, D>() * here).eval();
  }
}

template <int D>
inline void ThesisKernel<D>::collect_forces(std::span<double> result) {
  nodes_.clear_forces();
  const auto on = [&](Index f) __attribute__((always_inline)) {
    return force_on<D>(faces_[f], load<D>(other_side(f)) - load<D>(nodes_[mesh_.owner[f]]), points_.data());
  };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Lane<D> force = on(f);
    lanes::add<D>(nodes_.force(mesh_.owner[f]), -force);
    lanes::add<D>(nodes_.force(mesh_.neighbour[f]), force);
  }
  for (const Index f : kinds_.prescribed) lanes::add<D>(nodes_.force(mesh_.owner[f]), -on(f));
  for (const Index f : kinds_.symmetry) {
    const Lane<D> n = load<D>(faces_[f].n);
    lanes::add<D>(nodes_.force(mesh_.owner[f]), -lanes::dot<D>(n, on(f)) * n);  // no shear
  }
  double* row = result.data() + std::size_t(mesh_.cells.n_owned()) * D;
  for (const Index f : kinds_.traction) {
    const Lane<D> force = on(f);
    for (int a = 0; a < D; ++a) *row++ = force[a];
  }
  nodes_.take_forces(result);
}

// The loops for several generations of processors; the right one is picked when the program starts.
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void passes(ThesisKernel<3>& kernel,
                                                                                  std::span<double> result) {
  kernel.interpolate_free();
  kernel.collect_forces(result);
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void passes(ThesisKernel<2>& kernel,
                                                                                  std::span<double> result) {
  kernel.interpolate_free();
  kernel.collect_forces(result);
}

template <int D>
void ThesisKernel<D>::fill(std::span<const double> unknowns, std::span<const double> known) {
  nodes_.fill(unknowns, known);
  for (const Index v : vertices_.known)
    for (int a = 0; a < D; ++a)
      points_[std::size_t(v) * stride + a] =
          known.empty() ? 0 : known[std::size_t(rows_.known_of_point(v)) * D + a];
}

template <int D>
void ThesisKernel<D>::apply(std::span<const double> unknowns, std::span<const double> known,
                            std::span<double> result) {
  fill(unknowns, known);
  passes(*this, result);
}

template <int D>
void ThesisKernel<D>::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                     std::span<Tensor3> gradients) {
  fill(unknowns, known);
  interpolate_free();
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const ThesisFace<D>& face = faces_[f];
    const bool symmetric = f >= mesh_.n_interior && rows_.condition(f) == ElasticCondition::symmetry;
    Lane<D> g = (load<D>(other_side(f)) - load<D>(nodes_[mesh_.owner[f]])) * face.inverse_dn;
    Tensor3& gradient = gradients[f];
    gradient.setZero();
    for (int i = 0; i < D - 1; ++i) {
      const Lane<D> along = load<D>(points_.data() + std::size_t(face.plus[i]) * stride) -
                            load<D>(points_.data() + std::size_t(face.minus[i]) * stride);
      g += face.kc[i] * along;
      for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) gradient(a, b) += face.c[i][a] * along[b];
    }
    const Lane<D> n = load<D>(face.n);
    if (symmetric) g = lanes::dot<D>(n, g) * n;
    for (int a = 0; a < D; ++a)
      for (int b = 0; b < D; ++b) gradient(a, b) += face.n[a] * g[b];
  }
}

template <int D>
void ThesisKernel<D>::point_values(std::span<const double> unknowns, std::span<const double> known,
                                   std::span<double> points) {
  fill(unknowns, known);
  interpolate_free();
  const auto take = [&](Index v) {
    for (int a = 0; a < D; ++a) points[std::size_t(v) * D + a] = points_[std::size_t(v) * stride + a];
  };
  for (const Index v : vertices_.free) take(v);
  for (const Index v : vertices_.known) take(v);
}

}  // namespace

std::unique_ptr<ElasticKernel::Implementation> make_thesis_kernel(const Mesh& mesh,
                                                                  const ElasticOperator& rows,
                                                                  std::span<const double> mu,
                                                                  std::span<const double> lambda) {
  if (mesh.dim == 2) return std::make_unique<ThesisKernel<2>>(mesh, rows, mu, lambda);
  return std::make_unique<ThesisKernel<3>>(mesh, rows, mu, lambda);
}

}  // namespace couplet
