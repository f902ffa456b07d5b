// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/moving_patches.hpp"

#include <algorithm>
#include <utility>

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

}  // namespace couplet::mesh_mover
