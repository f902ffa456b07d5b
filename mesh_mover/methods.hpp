// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/solve/elastic_preconditioner.hpp"
#include "common/io/checkpoint.hpp"
#include "common/linalg/krylov.hpp"
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
  /// Of the last solve.
  virtual linalg::SolveStatistics last() const = 0;
  /// What the next solve starts from. Collective.
  virtual void save(io::CheckpointWriter& file) const = 0;
  virtual void load(io::CheckpointReader& file) = 0;
};

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

/// Mesh motion by the equilibrium of an elastic body without loads, thesis (4.10), (4.12): div sigma = 0,
/// E = V^-chi, nu given, by the symmetric operator of common/elasticity (its energy has no negative modes on
/// distorted cells); points by its own vertex values. Patches that slide may lie along any plane.
class PseudoSolid final : public MotionMethod {
 public:
  /// `volumes`: V of (4.12) per local cell; empty: those of the mesh. Throws Error if no patch holds the mesh.
  PseudoSolid(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters,
              std::span<const double> volumes = {});

  std::vector<double> solve(std::span<const double> prescribed) override;
  linalg::SolveStatistics last() const override { return last_; }
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;

 private:
  void make_solver(const linalg::LinearOptions& options);
  /// Displacement of what is held and moved, a known column each; the motion is taken from `prescribed`.
  std::vector<double> known(std::span<const double> prescribed) const;

  const mesh::Mesh& mesh_;
  int dim_;
  linalg::KrylovOptions options_;
  std::vector<char> given_point_, given_face_;  // per local point, boundary face: it moves as prescribed
  std::unique_ptr<elastic::ElasticOperator> rows_;
  std::unique_ptr<elastic::ElasticKernel> kernel_;
  std::unique_ptr<linalg::SparseMatrix> matrix_;  // with factors_
  std::unique_ptr<linalg::LinearSolver> factors_;
  std::unique_ptr<elastic::ElasticPreconditioner> multigrid_;  // or this
  std::unique_ptr<linalg::KrylovSolver> krylov_;
  std::vector<double> unknowns_;  // also the next initial guess
  linalg::SolveStatistics last_;
};

}  // namespace couplet::mesh_mover
