// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/face_integrals.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "coupler/mapping/corner_weights.hpp"
#include "coupler/mapping/map_projection.hpp"
#include "coupler/mapping/overlay.hpp"

namespace couplet::coupler {

using Eigen::MatrixXd;

FaceIntegrals::FaceIntegrals(const coupling::Interface& structure, MappingParameters::Type type)
    : structure_(structure), tree_(structure.face_centres), slopes_(structure, type) {
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

std::vector<Index> FaceIntegrals::candidates(const Vec3& centre, double reach) const {
  std::vector<Index> list = tree_.within(centre, reach + widest_);
  if (list.size() < nearest_faces) {
    const std::vector<Index> near = tree_.nearest(centre, nearest_faces);
    list.insert(list.end(), near.begin(), near.end());
  }
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

void FaceIntegrals::find(const coupling::Interface& surface, Index face, bool dual,
                         std::vector<Part>& parts) {
  parts.clear();
  const Vec3& centre = surface.face_centres[face];
  const double extent = reach(surface, face);
  const std::vector<Cover> covered = covers(surface, face, structure_, candidates(centre, extent));
  const auto vertex = corners(surface, face);
  const auto n = Eigen::Index(vertex.size());
  // Without weight at first: what a curved surface needs beside the dual functions is spread over more faces.
  if (surface.dim == 3 && dual)
    for (const Index s : tree_.within(centre, 2 * extent))
      if (surface.face_areas[face].dot(structure_.face_areas[s]) < 0)
        for (Index i = 0; i < Index(n); ++i) parts.push_back({i, s, {0, 0}});
  Eigen::Matrix3Xd at(3, n);
  for (Eigen::Index i = 0; i < n; ++i) at.col(i) = surface.vertices[vertex[std::size_t(i)]];
  MatrixXd test = MatrixXd::Identity(n, n);
  if (dual) {
    MatrixXd all = MatrixXd::Zero(n, n);
    for (const Cover& part : covered) all += part.products;
    const Eigen::VectorXd sizes = all.rowwise().sum();
    test = sizes.asDiagonal() * all.inverse();
  }
  MatrixXd tested(n, n), more(n, n);
  for (const Cover& part : covered) {
    tested.noalias() = test * part.products, more = tested - part.products;
    const Slope& slope = slopes_.at(part.other);
    const auto way = [&](const MatrixXd& m, Eigen::Index i) {
      return Vec3(at * m.row(i).transpose() - m.row(i).sum() * mean(part.other));
    };
    for (Eigen::Index i = 0; i < n; ++i) {
      parts.push_back({Index(i), part.other, {tested.row(i).sum(), more.row(i).sum()}});
      const Vec3 way_dual = way(tested, i), way_more = way(more, i);
      for (std::size_t k = 0; k < slope.around.size(); ++k) {
        const auto along = slope.weights.col(Eigen::Index(k));
        parts.push_back({Index(i), slope.around[k], {way_dual.dot(along), way_more.dot(along)}});
      }
    }
  }
}

}  // namespace couplet::coupler
