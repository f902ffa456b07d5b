// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "mesh_mover/laplacian.hpp"
#include "mesh_mover/motion_method.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Mesh motion that turns the surroundings of a body with it. Each patch that moves is a body with the centre c
/// (mean of its points) and the best fit R(theta) of its rotation [kabsch1976]; around it
///   x' = c + R(s theta) (x - c) + d(x),   s = 1 for r <= r1,  ln(r2/r) / ln(r2/r1),  0 for r >= r2
/// with r = |x - c|, r1 the radius of the body, r2 that to the nearest point that is held or of another body. A
/// rotation by s(r) alone changes no volume, whatever its angle: the cells between the radii are sheared, evenly in
/// this s. d, by the Laplacian of thesis (4.11), (4.12), is what is left of the motion: the translation and
/// what bends.
///
/// Angles beyond half a turn go on from those of the solve before.
class Rotations final : public MotionMethod {
 public:
  /// Throws Error where a body has no room to turn.
  Rotations(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters,
            std::span<const double> volumes = {});

  std::vector<double> solve(std::span<const double> prescribed) override;
  linalg::SolveStatistics last() const override { return rest_.last(); }
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;

 private:
  struct Body {
    std::string name;
    std::vector<Index> points;    // local
    Vec3 centre = Vec3::Zero();   // [m]
    double inner = 0, outer = 0;  // r1, r2 [m]
    Vec3 theta = Vec3::Zero();    // of the last solve [rad]
  };
  void find_bodies(const Parameters& parameters);
  void find_room(const Parameters& parameters);
  Vec3 best_rotation(const Body& body, std::span<const double> prescribed) const;
  /// Displacement by the rotations alone, dim values a local point.
  std::vector<double> turned() const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  int dim_;
  Laplacian rest_;
  std::vector<Body> bodies_;
};

}  // namespace couplet::mesh_mover
