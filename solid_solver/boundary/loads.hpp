// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/fv/expression.hpp"
#include "common/fv/use.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/boundary_parameters.hpp"

namespace couplet::solid {

/// Force and moment distributed over faces in proportion to their areas A_i (reference configuration):
///
///     f_i = A_i (F / A + w x (x_i - c)),   J w = M + (p - c) x F,   J = sum A_i (|r_i|^2 I - r_i r_i^T), r_i = x_i - c,
///
/// Here A is the total area, c the centroid and p the point. Then sum f_i = F and sum (x_i - p) x f_i = M to
/// round-off. The faces remain free to deform, as with RBE3 elements. Without a point, it is uniform.
class DistributedForce {
 public:
  /// `faces`: faces of this rank. `load.point` is used if `has_point`. Throws Error for no area. Collective.
  DistributedForce(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<Index> faces,
                   const TotalLoad& load, bool has_point, const std::string& where);

  /// Adds the forces at time t [N], `dim` values per boundary face of owned cells. Throws Error on all ranks
  /// if the faces are collinear and the load has a moment about their line.
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
  // Inverse of J about the axes with inertia, and projection on the other axes; both zero without a point.
  Tensor3 spin_ = Tensor3::Zero(), lost_ = Tensor3::Zero();
};

/// "(0, 0.5)" in 2-D, "(0, 0.5, 1)" in 3-D.
std::string place_of(const Vec3& x, int dim);

/// Component-wise sum over the ranks. Collective.
Vec3 sum_of(MPI_Comm comm, const Vec3& value);
Tensor3 sum_of(MPI_Comm comm, const Tensor3& value);

/// Load of a pin in a hole or a bush around a shaft. The pressure -q . m acts on the half of a cylinder where
/// it is positive; m is the outward normal projected across the axis. For a force F, q satisfies sum A_i m_i
/// m_i^T q = F over that half. The pressure then varies with the cosine of the angle to the force, and its
/// total is F to round-off on any mesh. Its directions stay fixed at large strain (dead load).
class BearingLoad {
 public:
  /// `faces`: faces of this rank. Throws Error with `where` if they do not form a cylinder. Collective.
  BearingLoad(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<Index> faces,
              const TotalLoad& load, std::string where);

  /// Adds the forces at time t [N], `dim` values per boundary face of owned cells. Throws Error for an axial
  /// force and for one that no face can carry. Collective.
  void add_forces(double t, std::span<double> forces) const;

 private:
  void find_axis();
  Vec3 force_at(double t) const;
  struct Push {
    Vec3 half;  ///< the loaded faces have half . m < 0
    Vec3 q;     ///< [Pa]
  };
  Push find_push(const Vec3& force) const;

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  std::string where_;
  std::vector<Index> faces_;
  std::vector<Vec3> across_;  // m, one per face
  std::vector<fv::Expression> force_;
  Vec3 axis_ = Vec3::UnitZ();
  double area_ = 0;
};

/// rho |g| max(0, level - height) of a liquid at rest, averaged over a face of the reference configuration.
/// Exact even where the free surface intersects the face.
class HydrostaticPressure {
 public:
  /// Throws Error with `where`.
  HydrostaticPressure(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const TotalLoad& load,
                      const std::string& where);

  /// Height of the free surface at time t [m].
  double level(double t) const { return level_(Vec3::Zero(), t); }
  /// Pressure at a place below this free surface [Pa].
  double at(const Vec3& x, double level) const;
  /// Mean over a face, moved by `shift`, below this free surface [Pa].
  double mean(Index face, double level, const Vec3& shift) const;

 private:
  double below(Index face, double level, const Vec3& shift) const;

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  fv::Expression level_;
  Vec3 up_ = Vec3::Zero();
  double weight_ = 0;  // rho |g| [N/m^3]
  fv::Use* use_;
};

/// Mean of max(0, d) with d linear between the ends of an edge.
double mean_positive(double d0, double d1);
/// Mean of max(0, d) with d linear on a triangle.
double mean_positive(double d0, double d1, double d2);

/// Faces of this rank that carry a point load: open faces with their center within its radius. Without a
/// radius it is the nearest face of all ranks, which must be open. `open`: flag of each boundary face of owned
/// cells, true if a force on it has an effect. Throws Error with `where`. Collective.
std::vector<Index> faces_of_point_load(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                       const PointLoad& load, std::span<const std::uint8_t> open,
                                       const std::string& where);

/// Patches whose faces move as rigid bodies with small angles: u_i = U + w x (x_i - c) at face centers x_i
/// (RBE2 elements). There is no penalty and no additional unknown: P A P u = P b is solved in the range of P,
/// the orthogonal projection onto such motions. Sums of rigid motions are rigid, so every time scheme
/// preserves them. Vertices are means of nodes as elsewhere: their share of a face's force acts on cells.
class RigidPatches {
 public:
  RigidPatches() = default;
  /// `faces`: faces of owned cells, one list per patch on all ranks. Each face must have an unknown. Collective.
  RigidPatches(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic,
               const std::vector<std::vector<Index>>& faces);

  bool empty() const { return patches_.empty(); }
  /// Applies P to unknowns of ElasticOperator. Collective.
  void project(std::span<double> unknowns) const;

 private:
  struct Patch {
    std::vector<std::size_t> node;   // index of the unknown
    std::vector<Vec3> arm;           // x_i - c
    double share = 0;                // 1 / number of faces of all ranks
    Tensor3 spin = Tensor3::Zero();  // inverse of sum (|r|^2 I - r r^T); zero about a line of faces
  };
  void make(Patch& patch) const;

  const mesh::Mesh* mesh_ = nullptr;
  std::vector<Patch> patches_;
};

}  // namespace couplet::solid
