// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/corner_weights.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "coupler/mapping/map_projection.hpp"
#include "coupler/mapping/surroundings.hpp"

namespace couplet::coupler {
namespace {

/// Of a polygon: the integrals of its corners' functions, linear over the triangles about the mean of the corners,
/// over its area.
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

/// The least change of the weights that brings the mean of the corners to `centre`, as far as these span it; Most: of corners, known
/// when this is compiled, so that nothing is allocated, or Eigen::Dynamic.
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
  if (change.cwiseAbs().maxCoeff() > 1) return;  // no centre of this face
  for (Eigen::Index i = 0; i < n; ++i) weights[std::size_t(i)] += change[i];
}

}  // namespace

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
    const std::size_t k = part.dim == 2 ? 2 : 4;
    const Nearby near = nearby(comm, faces.points, {}, k, all.vertices());
    if (!faces.points.empty())
      add_entries(local_interpolation(near.points, faces.points, k), faces.positions, near.positions,
                  entries);
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

}  // namespace couplet::coupler
