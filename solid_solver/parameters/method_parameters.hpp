// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/section.hpp"

namespace couplet::solid {

/// How the equations of a step are solved.
struct MethodParameters {
  enum class Type { automatic, block_coupled, segregated, newton_krylov };
  enum class FaceGradient { automatic, thesis, corrected, symmetric };
  enum class LinearSolver { automatic, direct, bicgstab_ilu, gmres_multigrid };
  enum class Preconditioner { automatic, multigrid, factors, mixed };
  enum class Acceleration { none, aitken, anderson };
  enum class Predictor { none, euler, adams };
  enum class VolumeStrain { automatic, faces, cells, shared };
  Type type = Type::automatic;
  FaceGradient face_gradient = FaceGradient::automatic;
  VolumeStrain volume_strain = VolumeStrain::automatic;       // of the symmetric gradient
  LinearSolver linear_solver = LinearSolver::automatic;       // of the block-coupled method
  Preconditioner preconditioner = Preconditioner::automatic;  // of newton-krylov
  Acceleration acceleration = Acceleration::anderson;         // of the segregated method
  int aitken_interval = 5;
  int anderson_history = 10;
  Predictor predictor = Predictor::euler;
  int corrections_kept = 12;
  double solves = 1;  // no key: with one matrix, as many as the run will make
  double relative_tolerance = 1e-10;
  int max_iterations = 2000;
};

void declare(config::Section& section, MethodParameters& method);

}  // namespace couplet::solid
