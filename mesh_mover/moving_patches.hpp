// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/fv/prescribed_motion.hpp"
#include "common/mesh/mesh.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Patches of type `moving`, which the case moves.
class MovingPatches {
 public:
  /// By reference.
  MovingPatches(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters);
  bool empty() const { return patches_.empty(); }
  /// Into `values`, dim per local point: the displacement of their points from the mesh as read [m].
  void displace(double time, std::vector<double>& values) const;
  /// dim values per local point, zero elsewhere; empty without such patches. Collective.
  std::vector<double> velocities(double time, double dt) const;

 private:
  struct Moving {
    std::vector<Index> points;  // local
    fv::PrescribedMotion motion;
  };
  std::vector<Vec3> at_rest(const Moving& moving) const;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  std::vector<Moving> patches_;
};

}  // namespace couplet::mesh_mover
