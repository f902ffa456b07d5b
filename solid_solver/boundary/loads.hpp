// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/fv/expression.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/boundary_parameters.hpp"

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

/// A pin in a hole, or a bush around a shaft: the pressure -q . m pushes on the half of a cylinder where it is positive, m
/// being the normals across the axis, out of the solid. Of a force F, sum A_i m_i m_i^T q = F over that half: a pressure by the
/// cosine of the angle to the force on a cylinder, with F as its total to round-off on any mesh. A dead load: it keeps
/// its directions at large strain.
class BearingLoad {
 public:
  /// `faces`: this rank's. Throws Error, naming `where`, if they are no cylinder. Collective.
  BearingLoad(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<Index> faces,
              const TotalLoad& load, std::string where);

  /// Adds the forces at time t [N], `dim` values a boundary face of owned cells. Throws Error for a force along the axis and
  /// for one that no face can take. Collective.
  void add_forces(double t, std::span<double> forces) const;

 private:
  void find_axis();
  Vec3 force_at(double t) const;
  struct Push {
    Vec3 half;  ///< the loaded faces: half . m < 0
    Vec3 q;     ///< [Pa]
  };
  Push find_push(const Vec3& force) const;

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  std::string where_;
  std::vector<Index> faces_;
  std::vector<Vec3> across_;  // m, one a face
  std::vector<fv::Expression> force_;
  Vec3 axis_ = Vec3::UnitZ();
  double area_ = 0;
};

/// rho |g| max(0, level - height) of a liquid at rest, averaged over a face of the reference configuration: exact where the
/// free surface cuts the face, too.
class HydrostaticPressure {
 public:
  /// Throws Error, naming `where`.
  HydrostaticPressure(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const TotalLoad& load,
                      const std::string& where);

  /// The free surface at time t [m].
  double level(double t) const { return level_(Vec3::Zero(), t); }
  /// Mean over a face under this free surface [Pa].
  double mean(Index face, double level) const;

 private:
  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  fv::Expression level_;
  Vec3 up_ = Vec3::Zero();
  double weight_ = 0;  // rho |g| [N/m^3]
};

/// Mean of max(0, d) for d linear between the ends of an edge.
double mean_positive(double d0, double d1);
/// The same on a triangle.
double mean_positive(double d0, double d1, double d2);

/// The faces of this rank that take a point load: those that are open and have their centre within its radius; without a
/// radius the nearest face of all ranks, which must be open. `open`: per boundary face of owned cells, whether a force on it has
/// an effect. Throws Error, naming `where`. Collective.
std::vector<Index> faces_of_point_load(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                       const PointLoad& load, std::span<const std::uint8_t> open,
                                       const std::string& where);

}  // namespace couplet::solid
