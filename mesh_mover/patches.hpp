// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/fv/prescribed_motion.hpp"
#include "common/mesh/mesh.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Calls use(face) for the faces of a patch, including ghost faces.
template <class Use>
void for_faces(const mesh::Patch& patch, const Use& use) {
  for (Index f = patch.first; f < patch.first + patch.count; ++f) use(f);
  for (Index f = patch.ghost_first; f < patch.ghost_first + patch.ghost_count; ++f) use(f);
}
/// Local points of these faces, ascending.
std::vector<Index> points_of(const mesh::Mesh& mesh, const mesh::Patch& patch);

/// Patches of type `moving`, with motion prescribed by the case.
class MovingPatches {
 public:
  /// Keeps references.
  MovingPatches(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters);
  bool empty() const { return patches_.empty(); }
  /// Sets the displacement of their points from the mesh as read [m] in `values`, dim per local point. Throws
  /// Error if two patches move a common point differently. Collective.
  void displace(double time, std::vector<double>& values) const;
  /// Velocities, dim values per local point, zero elsewhere; empty without such patches. Collective.
  std::vector<double> velocities(double time, double dt) const;

 private:
  struct Moving {
    std::string name;
    std::vector<Index> points;  // local
    fv::PrescribedMotion motion;
  };
  std::vector<Vec3> at_rest(const Moving& moving) const;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  std::vector<Moving> patches_;
};

/// Least-squares fit of point values by a + b . (x - centre), as for the displacement components of a rigid
/// body, however large its motion.
class AffineFit {
 public:
  static constexpr int most = 4;
  using Coefficients = std::array<double, most>;  // a, b_x, b_y, b_z

  /// `points`: local points including ghosts. Collective.
  AffineFit(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<Index> points);
  /// Fits component `component` of `values` (dim per local point). Empty if the residual exceeds round-off at
  /// some point. Collective.
  std::optional<Coefficients> operator()(std::span<const double> values, int component) const;
  /// Basis function of coefficient k at a point.
  double shape(int k, const Vec3& x) const { return k == 0 ? 1.0 : x[k - 1] - centre_[k - 1]; }
  int count() const { return mesh_.dim + 1; }

 private:
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  std::vector<Index> points_;
  double n_ = 0;
  Vec3 centre_ = Vec3::Zero();
  Tensor3 inverse_ = Tensor3::Zero();  // of sum (x - centre)(x - centre)^T in directions of extent, else 0
};

/// Keeps the points of curved sliding patches on them, because tangential motion leaves a curved patch by
/// d^2/(2 R). Each such point is moved to the nearest place of the patch in the reference mesh (segments or
/// triangles). Points that another patch holds or moves are not changed.
class CurvedSlide {
 public:
  /// Collective.
  CurvedSlide(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters);
  bool empty() const { return patches_.empty(); }
  /// Corrects `displacement`: dim values per local point [m], ghosts current.
  void put_back(std::vector<double>& displacement) const;

 private:
  struct SurfacePiece {  // segment or triangle within `radius` of `centre`
    Vec3 a, b, c, centre;
    double radius;
  };
  struct Curved {
    std::vector<Index> points;        // local
    std::vector<SurfacePiece> parts;  // of all ranks
  };
  Vec3 nearest(const Curved& patch, const Vec3& x) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  std::vector<Curved> patches_;
};

}  // namespace couplet::mesh_mover
