// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/barrier/held_points.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh_mover {
namespace {

// Cosine above which normals around a point are those of one curved surface (26 degrees), and the part of a normal
// across what is held already below which it holds nothing new (6 degrees).
constexpr double same_surface = 0.9, new_direction = 0.1;

template <class Action>
void for_faces(const mesh::Patch& patch, const Action& action) {
  for (Index f = patch.first; f < patch.first + patch.count; ++f) action(f);
  for (Index f = patch.ghost_first; f < patch.ghost_first + patch.ghost_count; ++f) action(f);
}

/// Mean normals of the surfaces that the face vectors `areas` around a point belong to.
std::vector<Vec3> surfaces(std::vector<Vec3> areas) {
  std::vector<Vec3> means;
  while (!areas.empty()) {
    const Vec3 first = areas.front().normalized();
    Vec3 mean = Vec3::Zero();
    std::erase_if(areas, [&](const Vec3& a) {
      const bool same = a.normalized().dot(first) > same_surface;
      if (same) mean += a;
      return same;
    });
    means.push_back(mean.normalized());
  }
  return means;
}

/// Projector on what the planes with these face vectors hold.
Tensor3 held_by(std::vector<Vec3> areas) {
  Tensor3 held = Tensor3::Zero();
  for (const Vec3& n : surfaces(std::move(areas))) {
    const Vec3 across = n - held * n;
    if (across.norm() > new_direction) held += across.normalized() * across.normalized().transpose();
  }
  return held;
}

}  // namespace

HeldPoints find_held_points(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                            const Parameters& parameters) {
  const Index n = mesh.points.n_local();
  std::vector<char> is_fixed(n, 0), is_moved(n, 0);
  std::vector<std::vector<std::pair<GlobalIndex, Vec3>>> slides(n);
  for (const mesh::Patch& patch : mesh.patches) {
    const BoundaryMotion motion = parameters.boundaries.at(patch.name).motion;
    if (motion == BoundaryMotion::periodic)
      throw Error(
          "boundaries.{}: method: barrier is not available with periodic patches. Use 'method: pseudo-solid', or "
          "type: slip for both patches.",
          patch.name);
    for_faces(patch, [&](Index f) {
      for (const Index v : mesh.face_points[f]) {
        if (motion == BoundaryMotion::fixed) is_fixed[v] = 1;
        if (is_given(motion)) is_moved[v] = 1;
        if (motion == BoundaryMotion::slip)
          slides[v].emplace_back(mesh.boundary_id[f - mesh.n_interior], geometry.face_area[f]);
      }
    });
  }
  HeldPoints held{std::vector<Tensor3>(n), std::vector<Tensor3>(n)};
  double anything = 0;
  for (Index v = 0; v < n; ++v) {
    // The same order on every rank.
    std::ranges::sort(slides[v], {}, &std::pair<GlobalIndex, Vec3>::first);
    std::vector<Vec3> areas;
    for (const auto& [face, area] : slides[v]) areas.push_back(area);
    Tensor3 across = Tensor3::Identity() - held_by(std::move(areas));
    if (mesh.dim == 2) across(2, 2) = 0;
    if (across.norm() < 1e-6) across.setZero();
    held.free[v] = is_fixed[v] || is_moved[v] ? Tensor3(Tensor3::Zero()) : across;
    held.moved[v] = is_moved[v] && !is_fixed[v] ? across : Tensor3(Tensor3::Zero());
    if (is_fixed[v] || is_moved[v]) anything = 1;
  }
  if (parallel::max(mesh.comm, anything) == 0)
    throw Error("No patch holds the mesh: at least one needs type: fixed, moving or interface.");
  for (std::vector<Tensor3>* tensors : {&held.free, &held.moved})  // a ghost's faces may be on other ranks
    mesh.points.update_ghosts({tensors->data()->data(), tensors->size() * 9}, 9);
  return held;
}

}  // namespace couplet::mesh_mover
