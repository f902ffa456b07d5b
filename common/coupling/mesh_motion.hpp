// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::coupling {

/// Where a fluid gets its moved mesh from. One call a mesh motion, collective over the fluid's ranks.
class MeshMotionSource {
 public:
  virtual ~MeshMotionSource() = default;
  /// Displacement of every local point of the fluid mesh (dim values a point, relative to the reference
  /// points) [m] at t^{n+1} of the step that was begun. Throws SolveFailure if the mover could not move the
  /// mesh.
  virtual std::vector<double> receive() = 0;
  /// Velocity of every local point at the same time [m/s], which came with it: of bodies that the mover moves by
  /// itself, zero elsewhere. Empty without such bodies.
  virtual const std::vector<double>& velocity() const = 0;
};

/// The other end, in the mover.
class MeshMotionSink {
 public:
  virtual ~MeshMotionSink() = default;
  /// `displacement`, `velocity`: dim values for every local point of the mover's mesh, ghosts up to date; no velocity
  /// where the mover moves no body by itself.
  virtual void send(std::span<const double> displacement, std::span<const double> velocity = {}) = 0;
  /// Tells the fluid that there is no motion to wait for (the mover failed; it reports the reason to the
  /// coupler).
  virtual void send_failure() = 0;
};

/// Rank-to-rank link between a fluid and a mover that read the same mesh, on equal or different partitions.
/// `peers` is the intercommunicator to the other program. Both constructors are collective over both programs
/// and throw Error if the meshes differ (number of points or their ids).
std::unique_ptr<MeshMotionSource> make_mesh_motion_source(MPI_Comm peers, const mesh::Mesh& mesh,
                                                          std::span<const Vec3> points);
std::unique_ptr<MeshMotionSink> make_mesh_motion_sink(MPI_Comm peers, const mesh::Mesh& mesh,
                                                      std::span<const Vec3> points);

}  // namespace couplet::coupling
