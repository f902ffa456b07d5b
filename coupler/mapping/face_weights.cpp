// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/face_weights.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

#include "common/base/point_tree.hpp"
#include "coupler/mapping/sparse_map.hpp"

namespace couplet::coupler {

namespace {

constexpr double same_way = 0.5, not_against = -0.5;

bool alike(const coupling::Interface& s, Index a, Index b, double least_cosine) {
  return s.face_areas[a].dot(s.face_areas[b]) >
         least_cosine * s.face_areas[a].norm() * s.face_areas[b].norm();
}

/// Corner weights of a polygon: integrals of corner functions, linear over the triangles about the mean
/// corner, over its area.
std::vector<double> fan_weights(const std::vector<Vec3>& at) {
  const std::size_t n = at.size();
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : at) centre += p / double(n);
  std::vector<double> weights(n, 0.);
  double total = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    const double area = 0.5 * (at[i] - centre).cross(at[j] - centre).norm();
    weights[i] += area / 3, weights[j] += area / 3;
    total += area;
  }
  if (!(total > 0)) return std::vector<double>(n, 1 / double(n));
  for (double& w : weights) w = w / total + 1 / (3 * double(n));
  return weights;
}

/// Smallest change of the weights that moves the mean of the corners to `centre`, in the directions that
/// these span.
void meet(const Vec3& centre, const std::vector<Vec3>& at, std::vector<double>& weights) {
  const std::size_t n = at.size();
  Vec3 off = centre, mean = Vec3::Zero();
  for (std::size_t i = 0; i < n; ++i) off -= weights[i] * at[i], mean += at[i] / double(n);
  std::vector<Vec3> rest;  // of the corners' offsets, without the directions found
  double size = 0;
  rest.reserve(n);
  for (const Vec3& p : at) rest.push_back(p - mean), size = std::max(size, rest.back().squaredNorm());
  size = std::sqrt(size);
  if (!(off.norm() > 1e-14 * size)) return;
  // Orthonormal directions by Gram-Schmidt with pivoting, and the corners' coordinates along them, over their
  // length.
  std::vector<Vec3> along(n, Vec3::Zero());
  Vec3 goal = Vec3::Zero();
  Eigen::Matrix3d direction = Eigen::Matrix3d::Zero();
  int rank = 0;
  for (; rank < 3; ++rank) {
    const auto longest = std::ranges::max_element(rest, {}, [](const Vec3& d) { return d.squaredNorm(); });
    if (!(longest->norm() > 1e-9 * size)) break;
    const Vec3 d = (*longest - direction * (direction.transpose() * *longest)).normalized();
    direction.col(rank) = d;
    double square = 0;
    for (std::size_t i = 0; i < n; ++i) {
      along[i][rank] = d.dot(rest[i]);
      rest[i] -= along[i][rank] * d, square += along[i][rank] * along[i][rank];
    }
    const double scale = 1 / std::sqrt(square);
    for (Vec3& a : along) a[rank] *= scale;
    goal[rank] = d.dot(off) * scale;
  }
  // Without the round-off of the mean, which would change the sum of the weights on a nearly flat face.
  Vec3 level = Vec3::Zero();
  for (const Vec3& a : along) level += a / double(n);
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (Vec3& a : along) a -= level, products += a * a.transpose();
  for (int k = rank; k < 3; ++k) products(k, k) = 1;
  const Vec3 factor = products.inverse() * goal;
  for (const Vec3& a : along)
    if (!(std::abs(factor.dot(a)) <= 1)) return;  // not a center of this face
  for (std::size_t i = 0; i < n; ++i) weights[i] += factor.dot(along[i]);
}

}  // namespace

Slopes::Slopes(const coupling::Interface& surface) : surface_(surface), known_(surface.face_centres.size()) {
  faces_of_.resize(surface.vertices.size());
  for (Index f = 0; f < Index(known_.size()); ++f)
    for (const Index v : corners(surface, f)) faces_of_[std::size_t(v)].push_back(f);
}

std::vector<Index> Slopes::touching(Index face, std::size_t shared, double least_cosine) const {
  std::vector<Index> all, result;
  all.reserve(16), result.reserve(8);
  for (const Index v : corners(surface_, face))
    all.insert(all.end(), faces_of_[std::size_t(v)].begin(), faces_of_[std::size_t(v)].end());
  std::ranges::sort(all);
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i;
    while (end < all.size() && all[end] == all[i]) ++end;
    if (all[i] != face && end - i >= shared && alike(surface_, face, all[i], least_cosine))
      result.push_back(all[i]);
    i = end;
  }
  return result;
}

Slope Slopes::least_squares(Index face, const std::vector<Index>& neighbours, bool& spans) const {
  const Vec3 normal = surface_.face_areas[face].normalized();
  const auto n = Eigen::Index(neighbours.size());
  Eigen::Matrix3Xd way(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 d = surface_.face_centres[neighbours[std::size_t(i)]] - surface_.face_centres[face];
    way.col(i) = d - normal * normal.dot(d);
  }
  // Weights 1/distance^2 balance near and far neighbors in graded meshes.
  Eigen::RowVectorXd weight(n);
  for (Eigen::Index i = 0; i < n; ++i) weight[i] = 1 / std::max(way.col(i).squaredNorm(), 1e-300);
  const Eigen::Matrix3Xd weighted = way.array().rowwise() * weight.array();
  Eigen::Matrix<double, 3, 2> plane;
  plane.col(0) = normal.unitOrthogonal(), plane.col(1) = normal.cross(plane.col(0));
  const Eigen::Matrix2d strength = plane.transpose() * (way * weighted.transpose()) * plane;
  const double mean = strength.trace() / 2, high = mean + std::hypot(strength(0, 0) - mean, strength(0, 1));
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  int directions = 0;
  if (2 * mean - high > 1e-3 * high) {
    inverse = plane * strength.inverse() * plane.transpose();
    directions = 2;
  } else if (high > 0) {
    // The eigenvector of the larger value, from the longer column of A - low I.
    const Eigen::Matrix2d rest = strength - (2 * mean - high) * Eigen::Matrix2d::Identity();
    const Vec3 along = plane * rest.col(rest(0, 0) > rest(1, 1) ? 0 : 1).normalized();
    inverse = along * along.transpose() / high;
    directions = 1;
  }
  spans = directions >= surface_.dim - 1;
  Slope slope{neighbours, Eigen::Matrix3Xd(3, n + 1)};
  slope.weights.leftCols(n) = inverse * weighted;
  slope.weights.col(n) = -slope.weights.leftCols(n).rowwise().sum();
  slope.around.push_back(face);
  return slope;
}

const Slope& Slopes::at(Index face) {
  Slope& slope = known_[std::size_t(face)];
  if (!slope.around.empty()) return slope;
  bool spans = false;
  slope = least_squares(face, touching(face, std::size_t(surface_.dim - 1), same_way), spans);
  if (!spans) slope = least_squares(face, touching(face, 1, same_way), spans);
  if (!spans) slope = least_squares(face, touching(face, 1, not_against), spans);
  return slope;
}

std::span<const Index> corners(const coupling::Interface& surface, Index face) {
  return {surface.face_vertices.data() + surface.face_offset[face],
          std::size_t(surface.face_offset[face + 1] - surface.face_offset[face])};
}

double reach(const coupling::Interface& surface, Index face) {
  double most = 0;
  for (const Index v : corners(surface, face))
    most = std::max(most, (surface.vertices[v] - surface.face_centres[face]).norm());
  return most;
}

std::vector<double> corner_weights(const coupling::Interface& surface, Index face) {
  const auto vertex = corners(surface, face);
  std::vector<Vec3> at;
  at.reserve(vertex.size());
  for (const Index v : vertex) at.push_back(surface.vertices[v]);
  std::vector<double> weights =
      at.size() > 3 ? fan_weights(at) : std::vector<double>(at.size(), 1 / double(at.size()));
  meet(surface.face_centres[face], at, weights);
  return weights;
}

std::vector<Transfer::Entry> vertices_to_faces(MPI_Comm comm, const coupling::Interface& part) {
  const Surroundings all(comm, part);
  const PointSet faces = all.faces();
  std::vector<Transfer::Entry> entries;
  if (!all.has_corners()) {
    add_interpolation(comm, all.vertices(), faces.points, faces.positions, part.dim == 2 ? 2 : 4, entries);
    return entries;
  }
  const SurfacePart mine = all.with(faces.positions);
  entries.reserve(mine.surface.face_vertices.size());
  for (Index f = 0; f < Index(mine.faces.size()); ++f) {
    const std::vector<double> weights = corner_weights(mine.surface, f);
    const auto vertex = corners(mine.surface, f);
    for (std::size_t i = 0; i < weights.size(); ++i)
      entries.push_back({mine.faces[std::size_t(f)], mine.vertices[std::size_t(vertex[i])], weights[i]});
  }
  return entries;
}

using Eigen::MatrixXd;

FaceIntegrals::FaceIntegrals(const coupling::Interface& structure)
    : structure_(structure),
      tree_(structure.face_centres),
      slopes_(structure),
      place_(structure.face_centres.size(), -1) {
  means_.reserve(structure.face_centres.size());
  for (Index s = 0; s < Index(structure.face_centres.size()); ++s) {
    widest_ = std::max(widest_, reach(structure, s));
    Vec3 mean = Vec3::Zero();
    const std::vector<double> weights = corner_weights(structure, s);
    const auto vertex = corners(structure, s);
    for (std::size_t i = 0; i < weights.size(); ++i) mean += weights[i] * structure.vertices[vertex[i]];
    means_.push_back(mean);
  }
}

DualWeights* FaceIntegrals::weights_of(Index source, std::size_t corners) {
  Index& place = place_[std::size_t(source)];
  if (place < 0) {
    place = Index(sources_.size());
    sources_.push_back(source);
    weights_.resize(weights_.size() + corners, {0, 0});
  }
  return weights_.data() + std::size_t(place) * corners;
}

void FaceIntegrals::find(const coupling::Interface& surface, Index face, bool dual) {
  for (const Index s : sources_) place_[std::size_t(s)] = -1;
  sources_.clear(), weights_.clear();
  const Vec3& centre = surface.face_centres[face];
  const double extent = reach(surface, face);
  // A little more, so that most faces find enough at once.
  std::vector<Index> around = tree_.within(centre, 1.25 * std::max(extent + widest_, 2 * extent));
  if (around.size() < nearest_faces) around = tree_.nearest(centre, nearest_faces);
  std::ranges::sort(around);
  const std::vector<Cover> covered = covers(surface, face, structure_, around);
  const auto vertex = corners(surface, face);
  const std::size_t n = vertex.size();
  // Adds sources without weight, because corrections for a curved surface are spread over more faces.
  if (surface.dim == 3 && dual)
    for (const Index s : around)
      if ((structure_.face_centres[s] - centre).squaredNorm() <= 4 * extent * extent * (1 + 1e-9) &&
          surface.face_areas[face].dot(structure_.face_areas[s]) < 0)
        weights_of(s, n);
  MatrixXd test = MatrixXd::Identity(Index(n), Index(n));
  if (dual) {
    MatrixXd all = MatrixXd::Zero(Index(n), Index(n));
    for (const Cover& part : covered) all += part.products;
    const Eigen::VectorXd sizes = all.rowwise().sum();
    test = sizes.asDiagonal() * all.inverse();
  }
  Eigen::Matrix3Xd at(3, n), way_dual(3, n), way_more(3, n);
  for (std::size_t i = 0; i < n; ++i) at.col(Index(i)) = surface.vertices[vertex[i]] - centre;
  MatrixXd tested(n, n), more(n, n);
  for (const Cover& part : covered) {
    tested.noalias() = test.lazyProduct(part.products);
    const Slope& slope = slopes_.at(part.other);
    // Integrals of the functions and their moments about the source's mean; `more` is the excess over the corner
    // functions.
    more.noalias() = tested - part.products;
    way_dual.noalias() =
        at.lazyProduct(tested.transpose()) - (mean(part.other) - centre) * tested.rowwise().sum().transpose();
    way_more.noalias() =
        at.lazyProduct(more.transpose()) - (mean(part.other) - centre) * more.rowwise().sum().transpose();
    DualWeights* own = weights_of(part.other, n);
    for (Index i = 0; i < Index(n); ++i) own[i].dual += tested.row(i).sum(), own[i].more += more.row(i).sum();
    for (std::size_t k = 0; k < slope.around.size(); ++k) {
      const Vec3 along = slope.weights.col(Index(k));
      DualWeights* weights = weights_of(slope.around[k], n);
      for (Index i = 0; i < Index(n); ++i)
        weights[i].dual += way_dual.col(i).dot(along), weights[i].more += way_more.col(i).dot(along);
    }
  }
}

}  // namespace couplet::coupler
