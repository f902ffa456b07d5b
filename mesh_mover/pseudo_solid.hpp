// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/solve/elastic_preconditioner.hpp"
#include "common/linalg/krylov.hpp"
#include "common/mesh/mesh.hpp"
#include "mesh_mover/motion_method.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

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
