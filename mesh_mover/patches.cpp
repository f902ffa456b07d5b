// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/patches.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/point_tree.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh_mover {

namespace {

// Largest relative error of an affine fit. No point moves by more than its boundary, so it bounds the error
// everywhere.
constexpr double round_off = 1e-12;
// Relative difference of displacements that count as equal.
constexpr double same_displacement = 1e-6;

}  // namespace

std::vector<Index> points_of(const mesh::Mesh& mesh, const mesh::Patch& patch) {
  std::vector<Index> points;
  for_faces(patch, [&](Index f) {
    points.insert(points.end(), mesh.face_points[f].begin(), mesh.face_points[f].end());
  });
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

MovingPatches::MovingPatches(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                             const Parameters& parameters)
    : mesh_(mesh), geometry_(geometry) {
  for (const mesh::Patch& patch : mesh.patches) {
    const PatchMotion& boundary = parameters.boundaries.at(patch.name);
    if (boundary.motion == BoundaryMotion::moving)
      patches_.push_back(
          {patch.name, points_of(mesh, patch), fv::PrescribedMotion(boundary.prescribed, mesh.dim)});
  }
}

std::vector<Vec3> MovingPatches::at_rest(const Moving& moving) const {
  std::vector<Vec3> reference;
  for (const Index v : moving.points) reference.push_back(geometry_.points[v]);
  return reference;
}

void MovingPatches::displace(double time, std::vector<double>& values) const {
  std::vector<const Moving*> mover_of(std::size_t(mesh_.points.n_local()), nullptr);
  std::string trouble;
  for (const Moving& moving : patches_) {
    const std::vector<Vec3> reference = at_rest(moving), places = moving.motion.places(reference, time);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Moving*& other = mover_of[std::size_t(moving.points[i])];
      double* const d = &values[std::size_t(moving.points[i]) * std::size_t(mesh_.dim)];
      const Vec3 own = places[i] - reference[i];
      Vec3 before = own;
      if (other != nullptr) std::copy_n(d, mesh_.dim, before.data());
      if ((own - before).norm() >
          same_displacement * std::max(own.norm(), before.norm()) + round_off * places[i].norm())
        trouble = fmt::format(
            "boundaries: '{}' and '{}' move differently at ({:.6g}, {:.6g}, {:.6g}), a common point: by {:.6g} m and {:.6g} m "
            "at t = {:g} s. Give them the same motion there, or let one of them follow ('slip' or 'free').",
            other->name, moving.name, reference[i][0], reference[i][1], reference[i][2], before.norm(),
            own.norm(), time);
      other = &moving;
      std::copy_n(own.data(), mesh_.dim, d);
    }
  }
  parallel::throw_together(mesh_.comm, trouble);
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

// Squared relative extent of the points below which a direction has none.
constexpr double least_extent = 1e-10;

// Largest 1 - |cosine| between a face and the patch's mean normal for a flat patch.
constexpr double flat = 1e-9;

/// True if all faces are parallel. Parts may face each other (two sides of a slice), so that their face
/// vectors cancel. Collective.
bool is_flat(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch) {
  Tensor3 sum = Tensor3::Zero();
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const Vec3& area = geometry.face_area[f];
    sum += area * area.transpose() / area.norm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 9, MPI_DOUBLE, MPI_SUM, mesh.comm);
  // Eigenvector of the largest eigenvalue.
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Tensor3>(sum).eigenvectors().col(2);
  double off = 0;
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    off = std::max(off, 1 - std::abs(geometry.face_area[f].normalized().dot(normal)));
  return parallel::max(mesh.comm, off) <= flat;
}

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
  std::array<double, 3> largest{};  // of the values, of the residual, of that with only a
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

CurvedSlide::CurvedSlide(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters)
    : mesh_(mesh), geometry_(geometry) {
  std::vector<char> held(mesh.points.n_local(), 0);  // by a patch that does not slide
  const auto slides = [&](const mesh::Patch& patch) {
    return parameters.boundaries.at(patch.name).motion == BoundaryMotion::slip;
  };
  for (const mesh::Patch& patch : mesh.patches)
    if (!slides(patch))
      for (const Index v : points_of(mesh, patch)) held[v] = 1;
  for (const mesh::Patch& patch : mesh.patches) {
    if (!slides(patch) || is_flat(mesh, geometry, patch)) continue;
    Curved curved;
    curved.points = points_of(mesh, patch);
    std::erase_if(curved.points, [&](Index v) { return held[v] != 0; });
    std::vector<SurfacePiece> mine;
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      const Vec3 centre = (a + b + c) / 3;
      mine.push_back(
          {a, b, c, centre, std::max({(a - centre).norm(), (b - centre).norm(), (c - centre).norm()})});
    };
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const auto v = mesh.face_points[f];
      const auto x = [&](std::size_t i) -> const Vec3& { return geometry.points[v[i]]; };
      if (v.size() == 2) add(x(0), x(1), x(1));
      for (std::size_t i = 2; i < v.size(); ++i) add(x(0), x(i - 1), x(i));
    }
    std::vector<double> flat_parts;
    for (const SurfacePiece& part : mine)
      for (const Vec3& corner : {part.a, part.b, part.c})
        flat_parts.insert(flat_parts.end(), corner.data(), corner.data() + 3);
    const std::vector<double> all = parallel::all_gather(mesh.comm, flat_parts);
    mine.clear();
    for (std::size_t i = 0; i + 9 <= all.size(); i += 9)
      add(Eigen::Map<const Vec3>(&all[i]), Eigen::Map<const Vec3>(&all[i + 3]),
          Eigen::Map<const Vec3>(&all[i + 6]));
    curved.parts = std::move(mine);
    patches_.push_back(std::move(curved));
  }
}

Vec3 CurvedSlide::nearest(const Curved& patch, const Vec3& x) const {
  Vec3 best = x;
  double least = std::numeric_limits<double>::infinity();
  for (const SurfacePiece& part : patch.parts) {
    const double reach = least + part.radius;
    if ((part.centre - x).squaredNorm() >= reach * reach) continue;
    const auto consider = [&](const auto& nearest) {
      if (nearest.distance >= least) return;
      least = nearest.distance;
      best = nearest.place;
    };
    if (part.b == part.c)
      consider(base::nearest_on_segment(part.a, part.b, x));
    else
      consider(base::nearest_on_triangle(part.a, part.b, part.c, x));
  }
  return best;
}

void CurvedSlide::put_back(std::vector<double>& displacement) const {
  for (const Curved& patch : patches_)
    for (const Index v : patch.points) {
      double* d = displacement.data() + std::size_t(v) * mesh_.dim;
      Vec3 x = geometry_.points[v];
      for (int c = 0; c < mesh_.dim; ++c) x[c] += d[c];
      if (x == geometry_.points[v]) continue;
      const Vec3 moved = nearest(patch, x) - geometry_.points[v];
      for (int c = 0; c < mesh_.dim; ++c) d[c] = moved[c];
    }
  if (!empty()) mesh_.points.update_ghosts(displacement, mesh_.dim);
}

}  // namespace couplet::mesh_mover
