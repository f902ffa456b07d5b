// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/body_start.hpp"

#include <algorithm>

#include "common/io/probes/place_search.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/motion/turning_walls.hpp"

namespace couplet::fluid {
template <int D>
double set_body_start(const mesh::Mesh& mesh, std::span<const Vec3> points, const Boundary<D>& boundary,
                      const fv::MotionParameters& motion, double time, Vectors<D>& w, Vectors<D>& turn) {
  const fv::PrescribedMotion prescribed(motion, D);
  const double length = io::mesh_size(mesh, points);
  double largest = 0;
  for (const mesh::Patch* patch : boundary.body_patches()) {
    std::vector<Vec3> corners;
    for (Index f = patch->first; f < patch->first + patch->count; ++f)
      for (const Index v : mesh.face_points[f]) corners.push_back(points[v]);
    const std::vector<Vec3> velocities = prescribed.starting_velocities(corners, time, length);
    if (!turn.empty()) set_turn<D>(mesh, *patch, points, velocities, turn);
    auto next = velocities.begin();
    for (Index f = patch->first; f < patch->first + patch->count; ++f) {
      const auto n = mesh.face_points[f].size();
      Vec3 sum = Vec3::Zero();
      for (std::size_t i = 0; i < n; ++i) sum += *next++;
      w[f - mesh.n_interior] = (sum / double(n)).template head<D>();
      largest = std::max(largest, w[f - mesh.n_interior].norm());
    }
  }
  return parallel::max(mesh.comm, largest);
}

template double set_body_start<2>(const mesh::Mesh&, std::span<const Vec3>, const Boundary<2>&,
                                  const fv::MotionParameters&, double, Vectors<2>&, Vectors<2>&);
template double set_body_start<3>(const mesh::Mesh&, std::span<const Vec3>, const Boundary<3>&,
                                  const fv::MotionParameters&, double, Vectors<3>&, Vectors<3>&);

}  // namespace couplet::fluid
