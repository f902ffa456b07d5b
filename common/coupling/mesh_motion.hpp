// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <memory>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::coupling {

/// Source of a fluid's mesh motion. Call each function once per motion, collectively over the fluid's ranks.
class MeshMotionSource {
 public:
  virtual ~MeshMotionSource() = default;
  /// Displacement of every local point relative to the reference points (dim values per point) [m] at t^{n+1}
  /// of the current step. Throws SolveFailure if the mover could not move the mesh.
  virtual std::vector<double> receive() = 0;
  /// Velocity of every local point at the same time [m/s], received with the displacement. Nonzero only on
  /// bodies with motion prescribed by the mover. Empty without such bodies.
  virtual const std::vector<double>& velocity() const = 0;
};

/// Rank-to-rank link between a fluid and a mover that read the same mesh, with equal or different partitions.
/// `peers` is the intercommunicator to the other program. Both ends are made collectively over both
/// programs. They throw Error if number or ids of the points differ.
std::unique_ptr<MeshMotionSource> make_mesh_motion_source(MPI_Comm peers, const mesh::Mesh& mesh,
                                                          std::span<const Vec3> points);

/// Other end of MeshMotionSource, in the mover.
class MeshMotionSink {
 public:
  MeshMotionSink(MPI_Comm peers, const mesh::Mesh& mesh, std::span<const Vec3> points);
  ~MeshMotionSink();
  MeshMotionSink(const MeshMotionSink&) = delete;
  /// Sends dim values for every local point of the mover's mesh, with ghosts up to date. `velocity` is empty
  /// unless the mover prescribes the motion of a body.
  void send(std::span<const double> displacement, std::span<const double> velocity = {});
  /// Tells the fluid not to wait, because the mover failed. The mover reports the reason to the coupler.
  void send_failure();

 private:
  struct Outgoing;
  MPI_Comm peers_;
  int dim_;
  std::vector<Outgoing> to_;
};

}  // namespace couplet::coupling
