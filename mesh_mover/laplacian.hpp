// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/linalg/linear_solver.hpp"
#include "common/mesh/mesh.hpp"
#include "common/mesh/periodic_points.hpp"
#include "mesh_mover/motion_method.hpp"
#include "mesh_mover/moving_patches.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Laplacian mesh motion, thesis (4.11)-(4.12): div(E grad d) = 0 for the displacement d relative to the
/// reference mesh, E = V^-chi of the reference volumes, one equation a component, on cells; points by
/// inverse-distance interpolation.
///
/// Solving for the total displacement on the reference mesh, where the thesis adds increments on the last
/// one, makes the motion independent of the path (no drift over cycles) and the matrix constant: it is
/// factorised once a run. The flux is the two-point part of (2.57) alone: an M-matrix, so that no point
/// overshoots its surroundings, which serves a mesh better than second order would.
///
/// Where all that moves moves like one rigid body the displacement is a sum of dim + 1 fields a component,
/// solved for once, when the first such motion is met.
class Laplacian final : public MotionMethod {
 public:
  /// `volumes`: V of (4.12) per local cell; empty: those of the mesh. Throws Error if no patch holds the mesh
  /// or a slip patch is not normal to an axis.
  Laplacian(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters,
            std::span<const double> volumes = {});

  std::vector<double> solve(std::span<const double> prescribed) override;
  /// Local points on patches whose displacement is given.
  const std::vector<Index>& interface_points() const { return interface_points_; }
  /// dim per local cell: the initial guess of the next solve, for checkpoints.
  std::vector<double>& cell_displacement() { return cell_displacement_; }
  const std::vector<double>& cell_displacement() const { return cell_displacement_; }
  linalg::SolveStatistics last() const override { return last_; }
  void save(io::CheckpointWriter& file) const override {
    file.write(mesh::Entries::cells, "cell-displacement", cell_displacement_);
  }
  void load(io::CheckpointReader& file) override {
    file.read(mesh::Entries::cells, "cell-displacement", cell_displacement_);
  }

 private:
  enum class PointKind : char { interior, fixed, interface };
  struct Equation;  // matrix and solver of one set of held patches
  void set_kinds(const Parameters& parameters);
  void share_kinds();
  void set_weights();
  void set_coefficients(double stiffening, std::span<const double> volumes);
  double boundary_value(Index face, int component, std::span<const double> prescribed) const;
  /// One component in the cells / at the points / both, for prescribed values that an AffineFit explains.
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
  std::vector<double> weight_;       // with around_.index
  std::array<std::shared_ptr<Equation>, 3> equation_;
  std::vector<double> cell_displacement_;  // dim per local cell; also the next initial guess
  struct Shape {
    std::vector<double> cells, points;  // per local cell and point
  };
  std::array<std::unique_ptr<AffineFit>, 3> fit_;  // of the moved points, per component
  std::array<std::vector<Shape>, 3> shapes_;       // per component, empty: not needed so far
  linalg::SolveStatistics last_;
};

}  // namespace couplet::mesh_mover
