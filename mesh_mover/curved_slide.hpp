// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/mesh/mesh.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Keeps the points of patches that slide and are not flat on them: a motion along the tangent leaves a curved
/// patch by d^2 / (2 R). Each such point is taken back to the nearest place of the patch as the reference mesh has
/// it (its segments or triangles). Points that another patch holds or moves are left alone.
class CurvedSlide {
 public:
  /// Collective.
  CurvedSlide(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters);
  bool empty() const { return patches_.empty(); }
  /// `displacement`: dim values per local point [m], ghosts current. Gives the same.
  void put_back(std::vector<double>& displacement) const;

 private:
  struct Part {  // a segment or triangle within `radius` of `centre`
    Vec3 a, b, c, centre;
    double radius;
  };
  struct Curved {
    std::vector<Index> points;  // local
    std::vector<Part> parts;    // of all ranks
  };
  Vec3 nearest(const Curved& patch, const Vec3& x) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  std::vector<Curved> patches_;
};

}  // namespace couplet::mesh_mover
