// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/sparse_map.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/point_tree.hpp"
#include "coupler/mapping/face_weights.hpp"

namespace couplet::coupler {

namespace {

double wendland(double r) {
  const double s = (1 - r) * (1 - r);
  return r < 1 ? s * s * (4 * r + 1) : 0;
}

/// Coordinates relative to the sources' center in units of their reach, along the polynomial's directions:
/// sources first, x last.
Eigen::MatrixXd coordinates(const std::vector<Vec3>& points, std::span<const Index> sources, const Vec3& x) {
  const auto n = Eigen::Index(sources.size());
  Eigen::MatrixXd at(n + 1, 3);
  for (Eigen::Index j = 0; j < n; ++j) at.row(j) = points[sources[j]];
  at.row(n) = x;
  const Eigen::RowVector3d centre = at.topRows(n).colwise().mean();
  at.rowwise() -= centre;
  const Eigen::Matrix3d spread = at.topRows(n).transpose() * at.topRows(n) / double(n);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const double widest = std::sqrt(std::max(0., solver.eigenvalues()[2]));
  if (widest == 0) return Eigen::MatrixXd(n + 1, 0);
  const Eigen::MatrixXd along = at * solver.eigenvectors() / widest;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index d = 2; d >= 0; --d) {
    const double low = along.col(d).head(n).minCoeff(), high = along.col(d).head(n).maxCoeff();
    // A spread of a thousandth counts as a direction (a curved surface) only for an x between the sources.
    const bool thin = high - low < 0.3;
    const double slack = (thin ? 0.5 : 10) * (high - low), here = along(n, d);
    if (high - low > 1e-6 && here > low - slack && here < high + slack) kept.push_back(d);
  }
  Eigen::MatrixXd result(n + 1, Eigen::Index(kept.size()));
  for (std::size_t d = 0; d < kept.size(); ++d) result.col(Eigen::Index(d)) = along.col(kept[d]);
  return result;
}

/// Nearest place on a face, as weights of its corners.
struct OnFace {
  std::vector<double> weights;
  double distance = std::numeric_limits<double>::max();
};

OnFace on_face(const coupling::Interface& surface, Index face, const Vec3& p) {
  const auto vertex = corners(surface, face);
  const auto at = [&](std::size_t i) { return surface.vertices[vertex[i]]; };
  const auto whole = [](const auto& nearest) {
    return OnFace{{nearest.weights.begin(), nearest.weights.end()}, nearest.distance};
  };
  if (vertex.size() == 2) return whole(base::nearest_on_segment(at(0), at(1), p));
  if (vertex.size() == 3) return whole(base::nearest_on_triangle(at(0), at(1), at(2), p));
  const std::size_t n = vertex.size();
  Vec3 centre = Vec3::Zero();
  for (std::size_t i = 0; i < n; ++i) centre += at(i) / double(n);
  OnFace best;
  for (std::size_t i = 0; i < n; ++i) {
    const base::NearestPoint<3> part = base::nearest_on_triangle(at(i), at((i + 1) % n), centre, p);
    if (part.distance >= best.distance) continue;
    best = {std::vector<double>(n, part.weights[2] / double(n)), part.distance};
    best.weights[i] += part.weights[0];
    best.weights[(i + 1) % n] += part.weights[1];
  }
  return best;
}

/// Faces at each vertex.
struct FacesAround {
  std::vector<Index> offset, face;
  explicit FacesAround(const coupling::Interface& surface) : offset(surface.vertices.size() + 1, 0) {
    for (const Index v : surface.face_vertices) ++offset[v + 1];
    for (std::size_t v = 0; v + 1 < offset.size(); ++v) offset[v + 1] += offset[v];
    face.resize(surface.face_vertices.size());
    std::vector<Index> next(offset.begin(), offset.end() - 1);
    for (Index f = 0; f < Index(surface.face_centres.size()); ++f)
      for (const Index v : corners(surface, f)) face[next[v]++] = f;
  }
};

}  // namespace

std::vector<double> local_weights(const std::vector<Vec3>& points, std::span<const Index> sources,
                                  const Vec3& x) {
  const auto n = Eigen::Index(sources.size());
  if (n == 1) return {1.};
  double reach = 0;
  for (const Index i : sources)
    for (const Index j : sources) reach = std::max(reach, (points[i] - points[j]).norm());
  reach *= 1.5;
  if (reach == 0) return std::vector<double>(sources.size(), 1. / double(n));
  const Eigen::MatrixXd at = coordinates(points, sources, x);
  const Eigen::Index m = n + 1 + at.cols();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(m, m);
  Eigen::VectorXd b(m);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      a(i, j) = wendland((points[sources[i]] - points[sources[j]]).norm() / reach);
    b[i] = wendland((points[sources[i]] - x).norm() / reach);
  }
  a.block(0, n, n, 1).setOnes();
  a.block(0, n + 1, n, at.cols()) = at.topRows(n);
  a.bottomLeftCorner(m - n, n) = a.topRightCorner(n, m - n).transpose();
  b[n] = 1;
  b.tail(at.cols()) = at.row(n).transpose();
  Eigen::VectorXd w = a.partialPivLu().solve(b);
  // The smallest weights that fit, for coincident sources or too few of them for the polynomial.
  if (!w.allFinite() || (a * w - b).norm() > 1e-11 * b.norm())
    w = a.completeOrthogonalDecomposition().solve(b);
  return {w.data(), w.data() + n};
}

void add_projection(const coupling::Interface& surface, const std::vector<GlobalIndex>& vertices,
                    const std::vector<Vec3>& targets, const std::vector<GlobalIndex>& rows,
                    std::vector<Transfer::Entry>& entries) {
  const FacesAround around(surface);
  const base::PointTree vertex_tree(surface.vertices), centres(surface.face_centres);
  for (std::size_t row = 0; row < targets.size(); ++row) {
    std::vector<Index> faces = centres.nearest(targets[row], projection_faces);
    for (const Index v : vertex_tree.nearest(targets[row], projection_vertices))
      faces.insert(faces.end(), around.face.begin() + around.offset[v],
                   around.face.begin() + around.offset[v + 1]);
    OnFace best;
    Index chosen = -1;
    for (const Index f : faces) {
      OnFace found = on_face(surface, f, targets[row]);
      if (found.distance < best.distance) best = std::move(found), chosen = f;
    }
    const auto corner = corners(surface, chosen);
    for (std::size_t i = 0; i < corner.size(); ++i)
      entries.push_back({rows[row], vertices[std::size_t(corner[i])], best.weights[i]});
  }
}

double distance_to_face(const coupling::Interface& surface, Index face, const Vec3& place) {
  return on_face(surface, face, place).distance;
}

void add_interpolation(MPI_Comm comm, const PointSet& among, const std::vector<Vec3>& targets,
                       const std::vector<GlobalIndex>& rows, std::size_t k,
                       std::vector<Transfer::Entry>& entries) {
  const PointSet near = nearby(comm, targets, {}, k, among);
  if (targets.empty()) return;
  const base::PointTree tree(near.points);
  for (std::size_t row = 0; row < targets.size(); ++row) {
    const std::vector<Index> sources = tree.nearest(targets[row], k);
    const std::vector<double> weights = local_weights(near.points, sources, targets[row]);
    for (std::size_t i = 0; i < sources.size(); ++i)
      entries.push_back({rows[row], near.positions[std::size_t(sources[i])], weights[i]});
  }
}

void check_corners(const coupling::Interface& surface, const std::string& name, GlobalIndex vertices) {
  if (surface.face_offset.empty() && surface.face_vertices.empty()) return;
  const auto refuse = [&](const std::string& what) {
    throw Error("The face corners of '{}' are invalid: {}.", name, what);
  };
  const std::size_t n = surface.face_centres.size();
  if (surface.face_offset.size() != n + 1)
    refuse(
        fmt::format("{} offsets for {} faces; expected one more than faces", surface.face_offset.size(), n));
  if (surface.face_offset.front() != 0 || surface.face_offset.back() != Index(surface.face_vertices.size()))
    refuse("the offsets do not run from 0 to the number of corners");
  for (std::size_t f = 0; f < n; ++f)
    if (surface.face_offset[f + 1] - surface.face_offset[f] < 2)
      refuse(fmt::format("face {} has fewer than two corners", f));
  for (const Index v : surface.face_vertices)
    if (v < 0 || v >= vertices) refuse(fmt::format("vertex {} is not one of its {}", v, vertices));
}

}  // namespace couplet::coupler
