// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/boundary/inlet_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

constexpr double flat_enough = 1e-3;  // of the size of the patch
constexpr double round_enough = 0.1;  // of the area of the disc

struct Extent {
  Vec3 area = Vec3::Zero(), centre = Vec3::Zero();
  double size = 0, radius = 0;  // sum of |S|; largest distance of a point from the centre
};

Extent extent_of(const mesh::Mesh& mesh, const mesh::Geometry& g, const mesh::Patch& patch) {
  double sums[7] = {};
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const double size = g.face_area[f].norm();
    for (int c = 0; c < 3; ++c) {
      sums[c] += g.face_area[f][c];
      sums[3 + c] += size * g.face_centre[f][c];
    }
    sums[6] += size;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 7, MPI_DOUBLE, MPI_SUM, mesh.comm);
  Extent e{{sums[0], sums[1], sums[2]}, Vec3(sums[3], sums[4], sums[5]) / sums[6], sums[6], 0};
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    for (const Index p : mesh.face_points[f]) e.radius = std::max(e.radius, (g.points[p] - e.centre).norm());
  e.radius = parallel::max(mesh.comm, e.radius);
  return e;
}

}  // namespace

template <int D>
InletShape<D> inlet_shape(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                          InletProfile profile) {
  const Extent e = extent_of(mesh, geometry, patch);
  if (!(e.area.norm() > (1 - flat_enough) * e.size))
    throw Error("boundaries.{}: the patch is not flat, so 'mean-speed' has no direction. Give a 'velocity'.",
                patch.name);
  if (D == 3 && profile == InletProfile::parabolic &&
      std::abs(e.size / (std::numbers::pi * e.radius * e.radius) - 1) > round_enough)
    throw Error(
        "boundaries.{}: the patch is not round, so a parabolic profile is not defined. Give a 'velocity'.",
        patch.name);
  InletShape<D> shape;
  shape.direction = -e.area.normalized().template head<D>();
  double flow = 0;
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const double r = (geometry.face_centre[f] - e.centre).norm() / e.radius;
    shape.speed.push_back(profile == InletProfile::parabolic ? std::max(0.0, 1 - r * r) : 1.0);
    flow -= shape.speed.back() * shape.direction.dot(geometry.face_area[f].template head<D>());
  }
  const double mean = parallel::sum(mesh.comm, flow) / e.size;
  for (double& speed : shape.speed) speed /= mean;
  return shape;
}

template InletShape<2> inlet_shape<2>(const mesh::Mesh&, const mesh::Geometry&, const mesh::Patch&,
                                      InletProfile);
template InletShape<3> inlet_shape<3>(const mesh::Mesh&, const mesh::Geometry&, const mesh::Patch&,
                                      InletProfile);

}  // namespace couplet::fluid
