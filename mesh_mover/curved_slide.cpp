// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/curved_slide.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/point_tree.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh_mover {
namespace {

// 1 - |cosine| between a face and the patch's mean normal up to which it is flat.
constexpr double flat = 1e-9;

/// In planes of one direction; parts may face each other (the two sides of a slice), so that their face vectors add up to nothing.
/// Collective.
bool is_flat(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch) {
  Tensor3 sum = Tensor3::Zero();
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const Vec3& area = geometry.face_area[f];
    sum += area * area.transpose() / area.norm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 9, MPI_DOUBLE, MPI_SUM, mesh.comm);
  const Vec3 normal =
      Eigen::SelfAdjointEigenSolver<Tensor3>(sum).eigenvectors().col(2);  // of the largest value
  double off = 0;
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    off = std::max(off, 1 - std::abs(geometry.face_area[f].normalized().dot(normal)));
  return parallel::max(mesh.comm, off) <= flat;
}

}  // namespace

CurvedSlide::CurvedSlide(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters)
    : mesh_(mesh), geometry_(geometry) {
  std::vector<char> held(mesh.points.n_local(), 0);  // by a patch that does not slide
  const auto for_points = [&](const mesh::Patch& patch, const auto& action) {
    for (const auto& [first, count] :
         {std::pair{patch.first, patch.count}, {patch.ghost_first, patch.ghost_count}})
      for (Index f = first; f < first + count; ++f)
        for (const Index v : mesh.face_points[f]) action(v);
  };
  const auto slides = [&](const mesh::Patch& patch) {
    return parameters.boundaries.at(patch.name).motion == BoundaryMotion::slip;
  };
  for (const mesh::Patch& patch : mesh.patches)
    if (!slides(patch)) for_points(patch, [&](Index v) { held[v] = 1; });
  for (const mesh::Patch& patch : mesh.patches) {
    if (!slides(patch) || is_flat(mesh, geometry, patch)) continue;
    Curved curved;
    for_points(patch, [&](Index v) {
      if (!held[v]) curved.points.push_back(v);
    });
    std::ranges::sort(curved.points);
    curved.points.erase(std::unique(curved.points.begin(), curved.points.end()), curved.points.end());
    std::vector<Part> mine;
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
    for (const Part& part : mine)
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
  for (const Part& part : patch.parts) {
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
