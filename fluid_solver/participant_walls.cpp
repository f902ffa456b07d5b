// SPDX-License-Identifier: Apache-2.0
// Data of walls moved by other programs or a prescribed motion.
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/motion/rotation.hpp"
#include "fluid_solver/participant.hpp"

namespace couplet::fluid {
namespace {

/// Datum of the interface; empty if not given, as at the start.
std::vector<double> datum(const coupling::Exchange& in, const char* name) {
  const auto given = in.find(name);
  return given == in.end() ? std::vector<double>{} : given->second;
}

}  // namespace

/// One value per corner of each face of the patch, at the end of the step. Call after receive_points().
template <int D>
std::vector<Vec3> FluidParticipant<D>::body_velocities(const mesh::Patch& patch) const {
  if (!prescribed_) {
    std::vector<Vec3> corners;
    const std::vector<double>& given = motion_->velocity();
    if (given.empty())
      throw Error("boundaries.{}: the mesh mover does not move this body: set 'type: moving' there.",
                  patch.name);
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      for (const Index v : mesh_.face_points[f]) {
        corners.push_back(Vec3::Zero());
        corners.back().template head<D>() = Eigen::Map<const Vec<D>>(given.data() + std::size_t(v) * D);
      }
    return corners;
  }
  return prescribed_->velocities(face_corners(mesh_, patch, fluid_->points_at_rest()), step_.time + step_.dt,
                                 step_.dt);
}

/// Velocity w of all moving walls, at a face the mean of its vertices, and their turn (see turn_of()). Both
/// are empty if no wall moves. Call after receive_points().
template <int D>
std::pair<Vectors<D>, Vectors<D>> FluidParticipant<D>::wall_motion(const coupling::Exchange& in) const {
  const bool coupled = interface_ && step_.scheme != coupling::Scheme::standalone;
  if (!coupled && !moves_bodies()) return {};
  Vectors<D> w(mesh_.boundary.n_owned(), Vec<D>::Zero()), turn = w;
  const std::vector<Vec3>& points = points_.empty() ? fluid_->points_at_rest() : points_;
  for (const mesh::Patch* patch : fluid_->boundary().body_patches()) {
    const std::vector<Vec3> velocities = body_velocities(*patch);
    set_face_means<D>(mesh_, *patch, velocities, w);
    set_turn<D>(mesh_, *patch, points, velocities, turn);
  }
  if (!coupled) return {w, turn};
  const std::vector<double> at_points = interface_->scatter_vertices(datum(in, "velocity"), D);
  const std::vector<Index>& faces = interface_->faces();
  std::vector<Vec3> corners, velocities;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    Vec<D>& mean = w[faces[i] - mesh_.n_interior];
    corners.clear();
    velocities.clear();
    for (const Index v : mesh_.face_points[faces[i]]) corners.push_back(points[v]);
    for (const Index v : interface_vertices_[static_cast<Index>(i)]) {
      velocities.push_back(Vec3::Zero());
      velocities.back().template head<D>() = Eigen::Map<const Vec<D>>(at_points.data() + std::size_t(v) * D);
      mean += velocities.back().template head<D>();
    }
    mean /= static_cast<double>(velocities.size());
    turn[faces[i] - mesh_.n_interior] = turn_of<D>(corners, velocities);
  }
  return {w, turn};
}

/// Pressure to which the structure has responded, per boundary face [Pa]; empty at the start.
template <int D>
std::vector<double> FluidParticipant<D>::wall_load(const coupling::Exchange& in) const {
  std::vector<double> load(mesh_.boundary.n_owned(), 0.);
  const std::vector<double> at_faces = interface_->scatter_faces(datum(in, "own-wall-force"), 1);
  const std::vector<Index>& faces = interface_->faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    load[faces[i] - mesh_.n_interior] = at_faces[i] / interface_area_[i];
  return load;
}

/// Takes the masses for `impedance: structure`.
template <int D>
void FluidParticipant<D>::take_wall_mass(const coupling::Exchange& in) {
  const std::vector<double> masses = interface_->scatter_faces(datum(in, "surface-density"), 1);
  std::vector<Index> faces = interface_->faces();
  for (Index& f : faces) f -= mesh_.n_interior;
  fluid_->set_wall_mass(faces, masses);
}

/// Largest mean displacement of an interface face over the height of its cell. Collective.
template <int D>
double FluidParticipant<D>::wall_displacement(const coupling::Exchange& in) const {
  const std::vector<double> at_points = interface_->scatter_vertices(datum(in, "displacement"), D);
  const std::vector<Index>& faces = interface_->faces();
  double largest = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto vertices = interface_vertices_[static_cast<Index>(i)];
    Vec<D> mean = Vec<D>::Zero();
    for (const Index v : vertices) mean += Eigen::Map<const Vec<D>>(at_points.data() + std::size_t(v) * D);
    mean /= static_cast<double>(vertices.size());
    largest = std::max(largest, mean.norm() / cell_height_[i]);
  }
  return parallel::max(mesh_.comm, largest);
}

template std::vector<Vec3> FluidParticipant<2>::body_velocities(const mesh::Patch&) const;
template std::vector<Vec3> FluidParticipant<3>::body_velocities(const mesh::Patch&) const;
template std::pair<Vectors<2>, Vectors<2>> FluidParticipant<2>::wall_motion(const coupling::Exchange&) const;
template std::pair<Vectors<3>, Vectors<3>> FluidParticipant<3>::wall_motion(const coupling::Exchange&) const;
template std::vector<double> FluidParticipant<2>::wall_load(const coupling::Exchange&) const;
template std::vector<double> FluidParticipant<3>::wall_load(const coupling::Exchange&) const;
template void FluidParticipant<2>::take_wall_mass(const coupling::Exchange&);
template void FluidParticipant<3>::take_wall_mass(const coupling::Exchange&);
template double FluidParticipant<2>::wall_displacement(const coupling::Exchange&) const;
template double FluidParticipant<3>::wall_displacement(const coupling::Exchange&) const;

}  // namespace couplet::fluid
