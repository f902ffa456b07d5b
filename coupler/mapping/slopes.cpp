// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/slopes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/base/point_tree.hpp"
#include "coupler/mapping/face_weights.hpp"
#include "coupler/mapping/sparse_map.hpp"

namespace couplet::coupler {
namespace {

constexpr double same_way = 0.5, not_against = -0.5;

bool alike(const coupling::Interface& s, Index a, Index b, double least_cosine) {
  return s.face_areas[a].dot(s.face_areas[b]) >
         least_cosine * s.face_areas[a].norm() * s.face_areas[b].norm();
}

}  // namespace

Slopes::Slopes(const coupling::Interface& surface, MappingParameters::Type type)
    : surface_(surface),
      radial_(type == MappingParameters::Type::rbf || surface.face_offset.empty()),
      known_(surface.face_centres.size()) {
  if (radial_) {
    centres_ = std::make_unique<base::PointTree>(surface.face_centres);
    return;
  }
  faces_of_.resize(surface.vertices.size());
  for (Index f = 0; f < Index(known_.size()); ++f)
    for (const Index v : corners(surface, f)) faces_of_[std::size_t(v)].push_back(f);
}

Slopes::~Slopes() = default;

std::vector<Index> Slopes::touching(Index face, std::size_t shared, double least_cosine) const {
  std::vector<Index> all, result;
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
  // Weights 1 / distance^2: near and far neighbours of graded meshes count alike.
  Eigen::RowVectorXd weight(n);
  for (Eigen::Index i = 0; i < n; ++i) weight[i] = 1 / std::max(way.col(i).squaredNorm(), 1e-300);
  const Eigen::Matrix3Xd weighted = way.array().rowwise() * weight.array();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(Eigen::Matrix3d(way * weighted.transpose()));
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  int directions = 0;
  for (int d = 0; d < 3; ++d) {
    const double strength = solver.eigenvalues()[d];
    if (!(strength > 1e-3 * solver.eigenvalues()[2]) || n == 0) continue;
    inverse += solver.eigenvectors().col(d) * solver.eigenvectors().col(d).transpose() / strength;
    ++directions;
  }
  spans = directions >= surface_.dim - 1;
  Slope slope{neighbours, Eigen::Matrix3Xd(3, n + 1)};
  slope.weights.leftCols(n) = inverse * weighted;
  slope.weights.col(n) = -slope.weights.leftCols(n).rowwise().sum();
  slope.around.push_back(face);
  return slope;
}

Slope Slopes::radial(Index face) const {
  const std::size_t k = looks_at(surface_.dim) / 4;
  const Vec3& centre = surface_.face_centres[face];
  const Vec3 normal = surface_.face_areas[face].normalized();
  Slope slope;
  for (const Index s : centres_->nearest(centre, looks_at(surface_.dim)))
    if (slope.around.size() < k && alike(surface_, face, s, same_way)) slope.around.push_back(s);
  slope.weights = Eigen::Matrix3Xd::Zero(3, Eigen::Index(slope.around.size()));
  if (slope.around.size() < 2) {  // alone on its side
    slope.around = centres_->nearest(centre, std::size_t(surface_.dim) + 1);
    std::erase_if(slope.around, [&](Index s) { return !alike(surface_, face, s, not_against); });
    slope.weights = Eigen::Matrix3Xd::Zero(3, Eigen::Index(slope.around.size()));
  }
  const double area = surface_.face_areas[face].norm(),
               half = 0.5 * (surface_.dim == 2 ? area : std::sqrt(area));
  const Vec3 first = surface_.dim == 2 ? Vec3(-normal.y(), normal.x(), 0) : normal.unitOrthogonal();
  for (const Vec3& along : {first, Vec3(normal.cross(first))}) {
    if (surface_.dim == 2 && std::abs(along.z()) > 0.5) continue;
    const auto low = local_weights(surface_.face_centres, slope.around, centre - half * along),
               high = local_weights(surface_.face_centres, slope.around, centre + half * along);
    for (std::size_t i = 0; i < low.size(); ++i)
      slope.weights.col(Eigen::Index(i)) += along * ((high[i] - low[i]) / (2 * half));
  }
  return slope;
}

const Slope& Slopes::at(Index face) {
  Slope& slope = known_[std::size_t(face)];
  if (!slope.around.empty()) return slope;
  if (radial_) return slope = radial(face);
  bool spans = false;
  slope = least_squares(face, touching(face, std::size_t(surface_.dim - 1), same_way), spans);
  if (!spans) slope = least_squares(face, touching(face, 1, same_way), spans);
  if (!spans) slope = least_squares(face, touching(face, 1, not_against), spans);
  return slope;
}

}  // namespace couplet::coupler
