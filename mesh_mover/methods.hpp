// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/mesh/mesh.hpp"
#include "common/mesh/periodic_points.hpp"
#include "mesh_mover/parameters.hpp"
#include "mesh_mover/patches.hpp"

namespace couplet::mesh_mover {

/// From the displacement of what moves to that of every point, on the mesh that it was made with.
class MotionMethod {
 public:
  virtual ~MotionMethod() = default;
  /// `prescribed`: dim values per local point, ghosts current, read on patches whose displacement is given.
  /// Result: dim values per local point [m], ghosts up to date. Throws SolveFailure. Collective.
  virtual std::vector<double> solve(std::span<const double> prescribed) = 0;
  /// Statistics of the last solve.
  virtual linalg::SolveStatistics last() const = 0;
  /// State that the next solve starts from. Collective.
  virtual void save(io::CheckpointWriter& file) const = 0;
  virtual void load(io::CheckpointReader& file) = 0;
};

/// Stiffness (V / mean V)^-chi of thesis (4.12) per local cell, V the `volumes`. Collective.
std::vector<double> stiffness_of(const mesh::Mesh& mesh, std::span<const double> volumes, double stiffening);

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
  void set_coefficients(const std::vector<double>& stiffness);
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

// The other methods. `volumes`: V of (4.12) per local cell, empty for those of the mesh. All throw Error if no patch holds the
// mesh, or if a body has no room to rotate. Collective.
std::unique_ptr<MotionMethod> make_pseudo_solid(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                                const Parameters& parameters,
                                                std::span<const double> volumes = {});
std::unique_ptr<MotionMethod> make_rotations(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                             const Parameters& parameters,
                                             std::span<const double> volumes = {});
std::unique_ptr<MotionMethod> make_barrier(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           const Parameters& parameters,
                                           std::span<const double> volumes = {});

}  // namespace couplet::mesh_mover
