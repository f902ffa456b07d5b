// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/mesh/periodic_points.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/step.hpp"

namespace couplet::fluid {

/// Where the mesh is in a coupling step: its points move along straight lines from that of level n to that at the end.
template <int D>
class MeshPath {
 public:
  /// `geometry`: of the mesh at rest, of which the points alone are kept. `moves`: the mesh will. Collective.
  MeshPath(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const FluidParameters& parameters,
           bool moves);

  /// As read, per local point [m].
  const std::vector<Vec3>& points_at_rest() const { return points_at_rest_; }

  bool moves() const { return moves_; }
  /// As a frame that does not turn.
  bool translates() const { return translates_; }
  /// Placement of the mesh at rest; a frame that is only translated keeps its shape, and with it the pressure equation and its factors.
  std::shared_ptr<const Placement<D>> start(const mesh::Geometry& geometry);
  /// Placement of other points; of those at rest if `points` is empty.
  std::shared_ptr<const Placement<D>> at(std::span<const Vec3> points) const;
  /// The sub-step of `dt` on a mesh that ends at the share `s` of the way from `begin` to `end` (empty: it rests
  /// there). `level`: where it starts, at t = `time` of the coupling step. Throws SolveFailure for inverted cells.
  /// Collective.
  SubStep<D> sub_step(const State<D>& level, double dt, double s, std::span<const Vec3> begin,
                      std::span<const Vec3> end, double time) const;
  /// Throws Error where the points at `time` part what is joined. Collective.
  void refuse_torn(std::span<const Vec3> points, double time) const;

 private:
  const mesh::Mesh& mesh_;
  const std::vector<Vec3> points_at_rest_;
  bool moves_, translates_;
  std::optional<mesh::PeriodicPoints> periodic_;  // with patches joined on a mesh that moves
  std::shared_ptr<const Placement<D>> frame_;     // with translates_: the placement at rest
};

}  // namespace couplet::fluid
