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
/// these span. `Most`: number of corners at compile time, to avoid allocation, or Eigen::Dynamic.
template <int Most>
void meet(const Vec3& centre, const std::vector<Vec3>& at, std::vector<double>& weights) {
  const auto n = Eigen::Index(at.size());
  Vec3 off = centre, mean = Vec3::Zero();
  double size = 0;
  for (std::size_t i = 0; i < at.size(); ++i) off -= weights[i] * at[i], mean += at[i] / double(n);
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, Most> spread(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    spread.col(i) = at[std::size_t(i)] - mean;
    size = std::max(size, spread.col(i).norm());
  }
  if (!(off.norm() > 1e-14 * size)) return;
  Eigen::CompleteOrthogonalDecomposition<decltype(spread)> factors;
  factors.setThreshold(1e-9);
  factors.compute(spread);
  const Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, Most, 1> change = factors.solve(off);
  if (change.cwiseAbs().maxCoeff() > 1) return;  // not a center of this face
  for (Eigen::Index i = 0; i < n; ++i) weights[std::size_t(i)] += change[i];
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
  // Weights 1/distance^2 balance near and far neighbors in graded meshes.
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
  std::vector<Vec3> at;
  for (const Index v : corners(surface, face)) at.push_back(surface.vertices[v]);
  std::vector<double> weights =
      at.size() > 3 ? fan_weights(at) : std::vector<double>(at.size(), 1 / double(at.size()));
  if (at.size() <= 8)
    meet<8>(surface.face_centres[face], at, weights);
  else
    meet<Eigen::Dynamic>(surface.face_centres[face], at, weights);
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
  for (Index f = 0; f < Index(mine.faces.size()); ++f) {
    const std::vector<double> weights = corner_weights(mine.surface, f);
    const auto vertex = corners(mine.surface, f);
    for (std::size_t i = 0; i < weights.size(); ++i)
      entries.push_back({mine.faces[std::size_t(f)], mine.vertices[std::size_t(vertex[i])], weights[i]});
  }
  return entries;
}

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
  // Adds sources without weight, because corrections for a curved surface are spread over more faces.
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
