// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/mesh/mesh.hpp"
#include "common/mesh/periodic_points.hpp"
#include "mesh_mover/parameters.hpp"
#include "mesh_mover/patches.hpp"

namespace couplet::mesh_mover {

/// Computes the displacement of all points from that of the moving patches, on a fixed reference mesh.
class MotionMethod {
 public:
  virtual ~MotionMethod() = default;
  /// `prescribed`: dim values per local point, ghosts current, read on patches with given displacement.
  /// Returns dim values per local point [m], ghosts current. Throws SolveFailure. Collective.
  virtual std::vector<double> solve(std::span<const double> prescribed) = 0;
  /// Statistics of the last solve.
  virtual linalg::SolveStatistics last() const = 0;
  /// State from which the next solve starts. Collective.
  virtual void visit(io::Archive& archive) = 0;
};

/// Stiffness (V / mean V)^-chi of thesis (4.12) per local cell. Collective.
std::vector<double> stiffness_of(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double stiffening);

/// Laplacian mesh motion, thesis (4.11)-(4.12): div(E grad d) = 0 for the displacement d from the reference
/// mesh, with E = V^-chi of the reference volumes. Each component is solved on cells and interpolated to
/// points by inverse distance.
///
/// The total displacement on the reference mesh, instead of the thesis's increments, makes the motion
/// independent of the path (no drift over cycles) and the matrix constant, so it is factorized once. The flux
/// is only the two-point part of (2.57). It gives an M-matrix, so no point overshoots its neighbors, which
/// suits a mesh better than second order.
///
/// If all moving points move as one rigid body, the displacement is a sum of dim + 1 fields per component.
/// These are solved for once, at the first such motion.
class Laplacian final : public MotionMethod {
 public:
  /// Throws Error if no patch holds the mesh or a slip patch is not normal to an axis.
  Laplacian(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters);

  std::vector<double> solve(std::span<const double> prescribed) override;
  /// Local points on patches with given displacement.
  const std::vector<Index>& interface_points() const { return interface_points_; }
  /// dim values per local cell: initial guess of the next solve.
  const std::vector<double>& cell_displacement() const { return cell_displacement_; }
  linalg::SolveStatistics last() const override { return last_; }
  void visit(io::Archive& archive) override {
    archive.field(mesh::Entries::cells, "cell-displacement", cell_displacement_, std::size_t(dim_));
  }

 private:
  enum class PointKind : char { interior, fixed, interface };
  struct Equation;  // matrix and solver for one set of held patches
  void set_kinds(const Parameters& parameters);
  void share_kinds();
  void set_weights();
  void set_coefficients(const std::vector<double>& stiffness);
  double boundary_value(Index face, int component, std::span<const double> prescribed) const;
  /// Compute one component in cells, at points, or both for values with an AffineFit.
  void solve_cells(int component, std::span<const double> prescribed, std::vector<double>& cells);
  void interpolate(int component, std::span<const double> prescribed, const std::vector<double>& cells,
                   std::vector<double>& points) const;
  void combine(int component, const AffineFit::Coefficients& coefficients, std::vector<double>& points);
  void make_shapes(int component);

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  int dim_;
  mesh::PeriodicPoints periodic_;
  double relative_tolerance_;
  std::vector<std::array<bool, 3>> held_;       // per patch and component: Dirichlet
  std::vector<int> patch_of_;                   // per boundary face
  std::vector<std::array<PointKind, 3>> kind_;  // per local point and component
  std::vector<Index> interface_points_;
  std::vector<double> coefficient_;  // per flux face: E |S| / (d.n)
  mesh::Csr around_;                 // per local point: local cells around it
  std::vector<double> weight_;       // per entry of around_.index
  std::array<std::shared_ptr<Equation>, 3> equation_;
  std::vector<double> cell_displacement_;  // dim per local cell; also the next initial guess
  struct MotionShape {
    std::vector<double> cells, points;  // per local cell and point
  };
  std::array<std::unique_ptr<AffineFit>, 3> fit_;   // of the moved points, per component
  std::array<std::vector<MotionShape>, 3> shapes_;  // per component, empty if not needed so far
  linalg::SolveStatistics last_;
};

// The other methods. Throw Error if no patch holds the mesh. Collective.
std::unique_ptr<MotionMethod> make_pseudo_solid(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                                const Parameters& parameters);
std::unique_ptr<MotionMethod> make_barrier(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           const Parameters& parameters);

}  // namespace couplet::mesh_mover
