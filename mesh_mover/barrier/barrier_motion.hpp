// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "mesh_mover/barrier/barrier_system.hpp"
#include "mesh_mover/motion_method.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Mesh motion that cannot fold: the points minimise the distortion of the cells from their reference shapes,
///   sum_s V_s (V/mean V)^-chi (|F|^2 + |F^-1|^2 - 2 D),
/// over the simplices s of the cells, which is infinite where one turns flat. Newton's method with the Hessian without
/// its negative part [teran2005, smith2019] from the last solve's mesh; each step is cut where a simplex would lose
/// nine tenths of its volume. What remains of the boundary's way is part of each step, so that the boundary moves as
/// far at once as the cells at it let it; where it has arrived, the energy falls from step to step.
class BarrierMotion final : public MotionMethod {
 public:
  /// `volumes`: V per local cell; empty: those of the mesh. Throws Error if no patch holds the mesh.
  BarrierMotion(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters,
                std::span<const double> volumes = {});

  std::vector<double> solve(std::span<const double> prescribed) override;
  linalg::SolveStatistics last() const override { return last_; }
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;

 private:
  /// The remaining way of held directions; its largest component over all ranks. Collective.
  double remaining(std::span<const double> prescribed, std::span<const double> u,
                   std::vector<double>& way) const;
  /// One Newton step of `u`, with the way or without; the share of it that was taken.
  double advance(std::vector<double>& u, const std::vector<double>& way, bool moves);
  /// direction_ and slope_ at `u`; false if this Hessian gives none that lowers the energy.
  bool find_direction(const std::vector<double>& u, const std::vector<double>& way,
                      BarrierSystem::Hessian hessian);
  double line_search(std::vector<double>& u, double limit, double most, double slope);
  void arrive(std::span<const double> prescribed, std::vector<double>& u) const;

  const mesh::Mesh& mesh_;
  int dim_;
  Simplices simplices_;
  HeldPoints held_;
  BarrierSystem system_;
  std::unique_ptr<linalg::LinearSolver> solver_;
  std::vector<double> displacement_;  // dim per local point: of the last solve, which the next starts from
  std::vector<double> residual_, direction_, trial_;
  double slope_ = 0, energy_ = 0;
  int built_ = 0;                    // preconditioners so far
  std::vector<double> factored_at_;  // displacement whose Hessian the preconditioner is of
  BarrierSystem::Hessian factored_ = BarrierSystem::Hessian::exact;
  linalg::SolveStatistics last_;
};

}  // namespace couplet::mesh_mover
