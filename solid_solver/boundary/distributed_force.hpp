// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/fv/expression.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/load_parameters.hpp"

namespace couplet::solid {

/// A force and a moment shared out over faces by their areas A_i (reference configuration):
///
///     f_i = A_i (F / A + w x (x_i - c)),   J w = M + (p - c) x F,   J = sum A_i (|r_i|^2 I - r_i r_i^T), r_i = x_i - c,
///
/// with A the sum of the areas, c their centre and p the point: sum f_i = F and sum (x_i - p) x f_i = M to round-off. The
/// faces stay free to deform (an RBE3 of finite elements). Without a point the force acts at c: the same traction on all.
class DistributedForce {
 public:
  /// `faces`: this rank's. `load.point` counts if `has_point`. Throws Error, naming `where`, if they have no area. Collective.
  DistributedForce(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<Index> faces,
                   const TotalLoad& load, bool has_point, const std::string& where);

  /// Adds the forces at time t [N], `dim` values a boundary face of owned cells. Throws Error on all ranks where the faces lie
  /// on one line and the load has a moment about it.
  void add_forces(double t, std::span<double> forces) const;

 private:
  Vec3 force(double t) const;
  Vec3 moment_about_centre(double t) const;
  void find_spin();
  void check_taken(const Vec3& moment, const Vec3& force) const;

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  std::string where_;
  std::vector<Index> faces_;
  std::vector<fv::Expression> force_, moment_;
  double area_ = 0;
  Vec3 centre_, arm_ = Vec3::Zero();   // arm_: p - c
  Tensor3 inertia_ = Tensor3::Zero();  // J
  // Inverse of J about the axes that can be turned about, projection on the others; both zero without a point.
  Tensor3 spin_ = Tensor3::Zero(), lost_ = Tensor3::Zero();
};

/// Sum over the ranks, by component. Collective.
Vec3 sum_of(MPI_Comm comm, const Vec3& value);
Tensor3 sum_of(MPI_Comm comm, const Tensor3& value);

}  // namespace couplet::solid
