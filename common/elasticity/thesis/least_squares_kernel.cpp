// SPDX-License-Identifier: Apache-2.0
// ElasticKernel with the published least-squares face gradient and its corrections. The published one loops
// over vertices and faces. The corrected one computes gradients of cells; vertices of open boundaries and
// from them gradients of boundary nodes; all vertices; and faces with the middles of their edges.
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/thesis/elastic_corrections.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace least_squares {

template <int D>
class LeastSquaresKernel {
 public:
  LeastSquaresKernel(const mesh::Mesh& mesh, const ElasticOperator& rows, bool is_corrected);

  void apply(std::span<const double> unknowns, std::span<const double> known, std::span<double> result);
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const ElasticKernel::TakeGradient& take, Index first, Index end);
  void point_values(std::span<const double> unknowns, std::span<const double> known,
                    std::span<double> points);

  [[gnu::always_inline]] inline void find_cell_gradients();
  [[gnu::always_inline]] inline void find_boundary_gradients();
  [[gnu::always_inline]] inline void find_vertices(std::span<const Index> points);
  [[gnu::always_inline]] inline void find_plain_vertices();
  [[gnu::always_inline]] inline void collect_forces(std::span<const double> known, std::span<double> result);

 private:
  void prepare(std::span<const double> unknowns, std::span<const double> known);
  void find_gradients(std::span<const double> known);
  void mirror_vertex_gradients();
  double* cell(Index node) { return records_.data() + std::size_t(node) * record<D>; }
  double* vertex(Index point) { return points_.data() + std::size_t(point) * record<D>; }
  [[gnu::always_inline]] inline Surface<D> around(Index f);
  [[gnu::always_inline]] inline Lane<D> inner(Index f, const Rows<D>& grad);
  [[gnu::always_inline]] inline Lane<D> outer(Index f, const Rows<D>& grad);
  [[gnu::always_inline]] inline Lane<D> at_symmetry(Index f, const Rows<D>& grad);
  template <class Take>
  [[gnu::always_inline]] inline void set_record(Index node, const Vec3& place, const Take& row);

  const bool is_corrected_;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  ElasticNodes nodes_;
  ElasticRows boundary_;
  ElasticVertices vertices_;
  std::optional<CellGradients> gradients_;       // this and the following are only used by the corrections
  std::vector<Index> open_points_, open_faces_;  // of traction faces; faces include ghosts
  std::vector<Index> plain_points_;              // interpolated without gradients; all if uncorrected
  std::vector<MirrorVertex> mirrors_;
  FaceLames lame_;
  std::vector<CorrectedFace> faces_;
  Vec3 origin_ = Vec3::Zero();
  // q = u - 1/2 x . G and G of the nodes; u and G of the vertices. Then sum w (u_i + 1/2 r_i . G_i) equals
  // sum w q_i + 1/2 x_V . sum w G_i.
  std::vector<double> records_, points_;
};

template <int D>
LeastSquaresKernel<D>::LeastSquaresKernel(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                          bool is_corrected)
    : is_corrected_(is_corrected),
      mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      nodes_(mesh, rows),
      boundary_(mesh, rows),
      vertices_(mesh, rows),
      plain_points_(is_corrected ? plain_points(mesh, rows, vertices_.free) : vertices_.free),
      lame_(mesh, rows),
      records_(record_space<D>(mesh.cells.n_local() + mesh.boundary.n_local()), 0.0),
      points_(record_space<D>(mesh.points.n_local()), 0.0) {
  const mesh::Geometry& geometry = rows.geometry();
  faces_.reserve(n_faces_with_force(mesh));
  for (Index f = 0; f < n_faces_with_force(mesh); ++f) faces_.push_back(make_face(mesh, geometry, f));
  if (!is_corrected) return;
  gradients_.emplace(mesh, rows);
  mirrors_ = mirror_vertices(mesh, rows, vertices_.free);
  if constexpr (D == 3) {
    const std::vector<std::uint32_t> kinds = edge_kinds(mesh, rows);
    for (std::size_t f = 0; f < kinds.size(); ++f) faces_[f].edges = kinds[f];
  }
  std::vector<std::uint8_t> open(mesh.points.n_local(), 0);
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) {
    if (rows.at(f).fixed || rows.at(f).mirrored) continue;
    open_faces_.push_back(f);
    for (const Index v : mesh.face_points[f]) open[v] = 1;
  }
  for (const Index v : vertices_.free)
    if (open[v]) open_points_.push_back(v);
  // Any origin near the mesh keeps x . G small compared to u. It must be the same on all ranks.
  for (int a = 0; a < D; ++a) {
    double lowest = std::numeric_limits<double>::max();
    for (const Vec3& x : geometry.points) lowest = std::min(lowest, x[a]);
    origin_[a] = parallel::min(mesh.comm, lowest);
  }
}

// Loops over cells and vertices for values and gradients.

/// Sets the gradient rows and q of a node at `place`.
template <int D>
template <class Take>
inline void LeastSquaresKernel<D>::set_record(Index node, const Vec3& place, const Take& row) {
  Lane<D> q = load<D>(nodes_[node]);
  Rows<D> gradient;
  for (int i = 0; i < D; ++i) {
    gradient.row[i] = row(i);
    q -= 0.5 * (place[i] - origin_[i]) * gradient.row[i];
  }
  store_record<D>(cell(node), q, gradient);
}

template <int D>
inline void LeastSquaresKernel<D>::find_cell_gradients() {
  const Index* offset = gradients_->offset.data();
  const Index* node = gradients_->node.data();
  const float* weight = gradients_->weight.data();
  const Vec3* centre = geometry_.cell_centre.data();
  const Index n_cells = mesh_.cells.n_local();
  const Vec3* outside = geometry_.face_centre.data() + mesh_.n_interior;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const Lane<D> here = load<D>(nodes_[c]);
    Rows<D> sum;
    for (Index i = offset[c]; i < offset[c + 1]; ++i) {
      const Lane<D> difference = weight[i] * (load<D>(nodes_[node[i]]) - here);
      const Vec3& there = node[i] < n_cells ? centre[node[i]] : outside[node[i] - n_cells];
      for (int a = 0; a < D; ++a) sum.row[a] += (there[a] - centre[c][a]) * difference;
    }
    const auto& m = gradients_->inverse[c];
    Rows<D> g;
    if constexpr (D == 2) {
      g.row[0] = m[0] * sum.row[0] + m[1] * sum.row[1];
      g.row[1] = m[1] * sum.row[0] + m[3] * sum.row[1];
    } else {
      g.row[0] = m[0] * sum.row[0] + m[1] * sum.row[1] + m[2] * sum.row[2];
      g.row[1] = m[1] * sum.row[0] + m[3] * sum.row[1] + m[4] * sum.row[2];
      g.row[2] = m[2] * sum.row[0] + m[4] * sum.row[1] + m[5] * sum.row[2];
    }
    set_record(
        c, centre[c], [&](int a) __attribute__((always_inline)) { return g.row[a]; });
  }
  for (const auto& mirror : gradients_->mirrors) {
    double* here = cell(mirror.cell);
    const Lane<D> u = load<D>(nodes_[mirror.cell]);
    double normal = 0, reach = 0;
    for (int a = 0; a < D; ++a) {
      normal += mirror.normal[a] * u[a];
      reach += mirror.weight[a] * (geometry_.cell_centre[mirror.cell][a] - origin_[a]);
    }
    for (int b = 0; b < D; ++b) {
      const double difference = -2 * normal * mirror.normal[b];
      here[b] -= 0.5 * reach * difference;
      for (int a = 0; a < D; ++a) here[(a + 1) * D + b] += mirror.weight[a] * difference;
    }
  }
}

template <int D>
inline void LeastSquaresKernel<D>::find_vertices(std::span<const Index> points) {
  for (const Index v : points) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    Lane<D> u = {};
    Rows<D> g;
    for (std::size_t i = 0; i < index.size(); ++i) {
      const double* node = cell(index[i]);
      const double w = weight[i];
      u += w * load<D>(node);
      for (int a = 0; a < D; ++a) g.row[a] += w * row_of<D>(node, a);
    }
    const Vec3& x = geometry_.points[v];
    for (int a = 0; a < D; ++a) u += 0.5 * (x[a] - origin_[a]) * g.row[a];
    store_record<D>(vertex(v), u, g);
  }
}

// Interpolates u = sum w u_i, exact for linear fields.
template <int D>
inline void LeastSquaresKernel<D>::find_plain_vertices() {
  for (const Index v : plain_points_) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    Lane<D> u = {};
    for (std::size_t i = 0; i < index.size(); ++i) u += weight[i] * load<D>(nodes_[index[i]]);
    lanes::store_components<D>(vertex(v), u);
  }
}

// Averages the gradient and its mirror image on a symmetry plane: G - NG - GN + 2 NGN with N = n n^T.
template <int D>
void LeastSquaresKernel<D>::mirror_vertex_gradients() {
  for (const MirrorVertex& mirror : mirrors_) {
    double* here = vertex(mirror.point);
    for (const Vec3& normal : mirror.normals) {
      const Vec<D> n = normal.head<D>();
      Tensor<D> g;
      for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) g(a, b) = here[(a + 1) * D + b];
      const Vec<D> right = g * n, left = g.transpose() * n;
      g += n * (2 * n.dot(right) * n - left).transpose() - right * n.transpose();
      for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) here[(a + 1) * D + b] = g(a, b);
    }
  }
}

// The middle value is L^2/8 u'' below the trapezoidal one, the mean L^2/12 u''.
template <int D>
inline Surface<D> LeastSquaresKernel<D>::around(Index f) {
  const CorrectedFace& face = faces_[f];
  const auto corners = mesh_.face_points[f];
  const auto value = [&](int e, const Lane<D>& edge) __attribute__((always_inline)) {
    const double* first = vertex(corners[e]);
    if constexpr (D == 2) {
      return load<D>(first);
    } else {
      constexpr double below[]{0, 1.0 / 8, 1.0 / 12};
      const double* second = vertex(corners[e + 1 < std::ssize(corners) ? e + 1 : 0]);
      Lane<D> here = 0.5 * (load<D>(first) + load<D>(second));
      if (face.edges == 0) return here;
      const Lane<D> part = below[(face.edges >> (2 * e)) & 3U] * edge;
      for (int a = 0; a < D; ++a) here -= part[a] * (row_of<D>(second, a) - row_of<D>(first, a));
      return here;
    }
  };
  return surface<D>(face, corners, geometry_.points.data(), value);
}

template <int D>
inline Lane<D> LeastSquaresKernel<D>::inner(Index f, const Rows<D>& grad) {
  const CorrectedFace& face = faces_[f];
  const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
  const Vec3 &from = geometry_.cell_centre[p], to = geometry_.cell_centre[n] + mesh_.shift(f);
  Lane<D> along = load<D>(nodes_[n]) - load<D>(nodes_[p]);
  if (is_corrected_ && face.curved != 0) {
    const double *here = cell(p), *there = cell(n);
    const Vec3& centre = geometry_.face_centre[f];
    for (int i = 0; i < D; ++i)
      along += (centre[i] - 0.5 * (from[i] + to[i])) * (row_of<D>(there, i) - row_of<D>(here, i));
  }
  return normal_derivative<D>(face, to - from, along, grad);
}

// d . grad u = 2 (u_B - u_P) - d . G_P on the boundary; without corrections u_B - u_P.
template <int D>
inline Lane<D> LeastSquaresKernel<D>::outer(Index f, const Rows<D>& grad) {
  const Index p = mesh_.owner[f];
  const Vec3 d = geometry_.face_centre[f] - geometry_.cell_centre[p];
  const Lane<D> across = load<D>(nodes_.of_face(f)) - load<D>(nodes_[p]);
  if (!is_corrected_) return normal_derivative<D>(faces_[f], d, across, grad);
  return normal_derivative<D>(faces_[f], d, 2 * across - contract<D>(d, cell(p) + D), grad);
}

// The mirrored difference is already central.
template <int D>
inline Lane<D> LeastSquaresKernel<D>::at_symmetry(Index f, const Rows<D>& grad) {
  const Index p = mesh_.owner[f];
  const Vec3 d = geometry_.face_centre[f] - geometry_.cell_centre[p];
  return normal_derivative<D>(faces_[f], d, -load<D>(nodes_[p]), grad);
}

template <int D>
inline void LeastSquaresKernel<D>::find_boundary_gradients() {
  for (const Index f : open_faces_) {
    if (f >= mesh_.n_flux_faces()) break;
    const CorrectedFace& face = faces_[f];
    const auto point = mesh_.face_points[f];
    const auto n_points = static_cast<int>(point.size());
    // In 3-D the mean of an edge's end points.
    const Surface<D> here = surface<D>(
        face, point, geometry_.points.data(), [&](int e, const Lane<D>&) __attribute__((always_inline)) {
          const Lane<D> first = load<D>(vertex(point[e]));
          if (D == 2) return first;
          return 0.5 * (first + load<D>(vertex(point[e + 1 < n_points ? e + 1 : 0])));
        });
    const Lane<D> g = outer(f, here.grad);
    set_record(
        mesh_.cells.n_local() + f - mesh_.n_interior,
        geometry_.face_centre[f], [&](int a) __attribute__((always_inline)) {
          return here.grad.row[a] + here.n[a] * g;
        });
  }
}

template <int D>
inline void LeastSquaresKernel<D>::collect_forces(std::span<const double> known, std::span<double> result) {
  nodes_.clear_forces();
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Surface<D> here = around(f);
    const Lane<D> force = force_on<D>(lame_[f], inner(f, here.grad), here);
    lanes::add<D>(nodes_.force(mesh_.owner[f]), -force);
    lanes::add<D>(nodes_.force(mesh_.neighbour[f]), force);
  }
  const auto slope = [&](Index f, const Rows<D>& grad) __attribute__((always_inline)) {
    return rows_.mirrored(f) ? at_symmetry(f, grad) : outer(f, grad);
  };
  boundary_.add_rows<D>(
      nodes_, known, result.data() + std::size_t(mesh_.cells.n_owned()) * D,
      [&](Index f) __attribute__((always_inline)) {
        const Surface<D> here = around(f);
        return force_on<D>(lame_[f], slope(f, here.grad), here);
      },
      [&](Index f) __attribute__((always_inline)) { return slope(f, around(f).grad); });
  nodes_.take_forces<D>(result);
}

namespace {

// Loops compiled for several generations of processors, selected at program start. Halo exchanges separate
// them.
using Fields = std::span<const double>;

COUPLET_PROCESSOR_CLONES void cells_pass(LeastSquaresKernel<3>& kernel) { kernel.find_cell_gradients(); }
COUPLET_PROCESSOR_CLONES void cells_pass(LeastSquaresKernel<2>& kernel) { kernel.find_cell_gradients(); }
COUPLET_PROCESSOR_CLONES void boundary_pass(LeastSquaresKernel<3>& kernel) {
  kernel.find_boundary_gradients();
}
COUPLET_PROCESSOR_CLONES void boundary_pass(LeastSquaresKernel<2>& kernel) {
  kernel.find_boundary_gradients();
}
COUPLET_PROCESSOR_CLONES void vertices_pass(LeastSquaresKernel<3>& kernel, std::span<const Index> points) {
  kernel.find_vertices(points);
}
COUPLET_PROCESSOR_CLONES void vertices_pass(LeastSquaresKernel<2>& kernel, std::span<const Index> points) {
  kernel.find_vertices(points);
}
COUPLET_PROCESSOR_CLONES void plain_pass(LeastSquaresKernel<3>& kernel) { kernel.find_plain_vertices(); }
COUPLET_PROCESSOR_CLONES void plain_pass(LeastSquaresKernel<2>& kernel) { kernel.find_plain_vertices(); }
COUPLET_PROCESSOR_CLONES void faces_pass(LeastSquaresKernel<3>& kernel, Fields known,
                                         std::span<double> result) {
  kernel.collect_forces(known, result);
}
COUPLET_PROCESSOR_CLONES void faces_pass(LeastSquaresKernel<2>& kernel, Fields known,
                                         std::span<double> result) {
  kernel.collect_forces(known, result);
}

}  // namespace

/// Computes node records and vertices before the loop over faces.
template <int D>
void LeastSquaresKernel<D>::prepare(std::span<const double> unknowns, std::span<const double> known) {
  nodes_.fill<D>(unknowns, known);
  if (is_corrected_) find_gradients(known);
  plain_pass(*this);
  vertices_.constrain<D>(points_, record<D>, known);
  mirror_vertex_gradients();
}

/// Computes gradients of cells and boundary nodes, and the vertices that use them.
template <int D>
void LeastSquaresKernel<D>::find_gradients(std::span<const double> known) {
  cells_pass(*this);
  const std::span<double> all(records_);
  const std::size_t n_cells = mesh_.cells.n_local();
  mesh_.cells.update_ghosts(all.first(n_cells * record<D>), record<D>);
  // Boundary nodes start with the gradient of their cell. Its error is equal for neighbors with equal cells.
  for (const Index f : open_faces_) {
    const double* owner = cell(mesh_.owner[f]);
    set_record(static_cast<Index>(n_cells) + f - mesh_.n_interior, geometry_.face_centre[f],
               [&](int a) { return row_of<D>(owner, a); });
  }
  vertices_pass(*this, open_points_);
  plain_pass(*this);
  vertices_.constrain<D>(points_, record<D>, known);
  boundary_pass(*this);
  mesh_.boundary.update_ghosts(
      all.subspan(n_cells * record<D>, std::size_t(mesh_.boundary.n_local()) * record<D>), record<D>);
  vertices_pass(*this, vertices_.free);
}

template <int D>
void LeastSquaresKernel<D>::apply(std::span<const double> unknowns, std::span<const double> known,
                                  std::span<double> result) {
  prepare(unknowns, known);
  faces_pass(*this, known, result);
}

template <int D>
void LeastSquaresKernel<D>::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                           const ElasticKernel::TakeGradient& take, Index first, Index end) {
  prepare(unknowns, known);
  for (Index f = first; f < end; ++f) {
    const Surface<D> here = around(f);
    const Rows<D>& grad = here.grad;
    const Lane<D>& n = here.n;
    Lane<D> g;
    if (f < mesh_.n_interior)
      g = inner(f, grad);
    else if (rows_.mirrored(f))
      g = lanes::dot<D>(n, at_symmetry(f, grad)) * n;
    else
      g = outer(f, grad);
    Tensor3 gradient = Tensor3::Zero();
    for (int a = 0; a < D; ++a)
      for (int b = 0; b < D; ++b) gradient(a, b) = grad.row[a][b] + n[a] * g[b];
    take(f, gradient);
  }
}

template <int D>
void LeastSquaresKernel<D>::point_values(std::span<const double> unknowns, std::span<const double> known,
                                         std::span<double> points) {
  prepare(unknowns, known);
  vertices_.visit([&](Index v) { std::copy_n(vertex(v), D, points.data() + std::size_t(v) * D); });
}

namespace {

template <int D>
ElasticKernel::LeastSquares functions(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                      bool is_corrected) {
  const auto kernel = std::make_shared<LeastSquaresKernel<D>>(mesh, rows, is_corrected);
  return {.apply = [=](Fields u, Fields known, std::span<double> result) { kernel->apply(u, known, result); },
          .point_values = [=](Fields u, Fields known,
                              std::span<double> points) { kernel->point_values(u, known, points); },
          .face_gradients = [=](Fields u, Fields known, const ElasticKernel::TakeGradient& take, Index first,
                                Index end) { kernel->face_gradients(u, known, take, first, end); }};
}

}  // namespace
}  // namespace least_squares

ElasticKernel::LeastSquares make_least_squares_kernel(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                                      bool is_corrected) {
  return mesh.dim == 2 ? least_squares::functions<2>(mesh, rows, is_corrected)
                       : least_squares::functions<3>(mesh, rows, is_corrected);
}

}  // namespace couplet::elastic
