// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/moving_patches.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/parallel/collective.hpp"

namespace couplet::mesh_mover {

MovingPatches::MovingPatches(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                             const Parameters& parameters)
    : mesh_(mesh), geometry_(geometry) {
  for (const mesh::Patch& patch : mesh.patches) {
    const Boundary& boundary = parameters.boundaries.at(patch.name);
    if (boundary.motion != BoundaryMotion::moving) continue;
    Moving moving{{}, fv::PrescribedMotion(boundary.prescribed, mesh.dim)};
    for (const auto& [first, count] :
         {std::pair{patch.first, patch.count}, {patch.ghost_first, patch.ghost_count}})
      for (Index f = first; f < first + count; ++f)
        moving.points.insert(moving.points.end(), mesh.face_points[f].begin(), mesh.face_points[f].end());
    std::ranges::sort(moving.points);
    moving.points.erase(std::unique(moving.points.begin(), moving.points.end()), moving.points.end());
    patches_.push_back(std::move(moving));
  }
}

std::vector<Vec3> MovingPatches::at_rest(const Moving& moving) const {
  std::vector<Vec3> reference;
  for (const Index v : moving.points) reference.push_back(geometry_.points[v]);
  return reference;
}

void MovingPatches::displace(double time, std::vector<double>& values) const {
  for (const Moving& moving : patches_) {
    const std::vector<Vec3> reference = at_rest(moving), places = moving.motion.places(reference, time);
    for (std::size_t i = 0; i < places.size(); ++i)
      for (int c = 0; c < mesh_.dim; ++c)
        values[std::size_t(moving.points[i]) * mesh_.dim + c] = places[i][c] - reference[i][c];
  }
}

std::vector<double> MovingPatches::velocities(double time, double dt) const {
  if (patches_.empty()) return {};
  std::vector<double> values(std::size_t(mesh_.points.n_local()) * mesh_.dim, 0.0);
  for (const Moving& moving : patches_) {
    const std::vector<Vec3> velocity = moving.motion.velocities(at_rest(moving), time, dt);
    for (std::size_t i = 0; i < velocity.size(); ++i)
      for (int c = 0; c < mesh_.dim; ++c)
        values[std::size_t(moving.points[i]) * mesh_.dim + c] = velocity[i][c];
  }
  mesh_.points.update_ghosts(values, mesh_.dim);
  return values;
}

namespace {

// Largest error of the fit, over the largest value. No point of the mesh moves by more than its boundary does, so
// this is the largest error too.
constexpr double round_off = 1e-12;
// Extent of the points in a direction, squared and relative to the largest, below which they have none.
constexpr double least_extent = 1e-10;

}  // namespace

AffineFit::AffineFit(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<Index> points)
    : mesh_(mesh), geometry_(geometry), points_(std::move(points)) {
  const auto over_owned = [&](auto&& add) {
    for (const Index v : points_)
      if (v < mesh_.points.n_owned()) add(geometry_.points[v]);
  };
  std::array<double, 4> sums{};
  over_owned([&](const Vec3& x) {
    sums[3] += 1;
    for (int c = 0; c < 3; ++c) sums[c] += x[c];
  });
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 4, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  n_ = std::max(sums[3], 1.0);
  centre_ = Vec3(sums[0], sums[1], sums[2]) / n_;
  Tensor3 spread = Tensor3::Zero();
  over_owned([&](const Vec3& x) { spread += (x - centre_) * (x - centre_).transpose(); });
  MPI_Allreduce(MPI_IN_PLACE, spread.data(), 9, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const Eigen::SelfAdjointEigenSolver<Tensor3> eigen(spread);
  const Vec3 extent = eigen.eigenvalues();
  for (int k = 0; k < 3; ++k)
    if (extent[k] > least_extent * extent[2])
      inverse_ += eigen.eigenvectors().col(k) * eigen.eigenvectors().col(k).transpose() / extent[k];
}

std::optional<AffineFit::Coefficients> AffineFit::operator()(std::span<const double> values,
                                                             int component) const {
  const auto value = [&](Index v) { return values[std::size_t(v) * mesh_.dim + component]; };
  std::array<double, 4> sums{};
  for (const Index v : points_) {
    if (v >= mesh_.points.n_owned()) continue;
    sums[0] += value(v);
    for (int c = 0; c < 3; ++c) sums[c + 1] += value(v) * (geometry_.points[v][c] - centre_[c]);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 4, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const double a = sums[0] / n_;
  const Vec3 b = inverse_ * Vec3(sums[1], sums[2], sums[3]);
  std::array<double, 3> largest{};  // of the values, of what is left, of what a alone leaves
  for (const Index v : points_) {
    largest[0] = std::max(largest[0], std::abs(value(v)));
    const double left = value(v) - a;
    largest[1] = std::max(largest[1], std::abs(left - b.dot(geometry_.points[v] - centre_)));
    largest[2] = std::max(largest[2], std::abs(left));
  }
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), 3, MPI_DOUBLE, MPI_MAX, mesh_.comm);
  if (largest[2] <= round_off * largest[0]) return Coefficients{a, 0, 0, 0};
  if (!(largest[1] <= round_off * largest[0])) return std::nullopt;
  return Coefficients{a, b[0], b[1], b[2]};
}

}  // namespace couplet::mesh_mover
