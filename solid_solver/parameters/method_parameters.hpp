// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/section.hpp"
#include "common/time/time_scheme.hpp"

namespace couplet::solid {

/// Solution method of the equations of a step.
struct MethodParameters {
  enum class Type { automatic, block_coupled, segregated, newton_krylov };
  enum class FaceGradient { automatic, thesis, symmetric };
  enum class LinearSolver { automatic, direct, bicgstab_ilu, gmres_multigrid };
  enum class Preconditioner { automatic, multigrid, factors, mixed };
  enum class Acceleration { none, aitken, anderson };
  enum class Predictor { none, euler };
  enum class VolumeStrain { automatic, faces, cells, shared };
  Type type = Type::automatic;
  FaceGradient face_gradient = FaceGradient::automatic;
  VolumeStrain volume_strain = VolumeStrain::automatic;       // of the symmetric gradient
  LinearSolver linear_solver = LinearSolver::automatic;       // of the block-coupled method
  Preconditioner preconditioner = Preconditioner::automatic;  // of newton-krylov
  Acceleration acceleration = Acceleration::anderson;         // of the segregated method
  Predictor predictor = Predictor::euler;
  int corrections_kept = 12;  // not a key: corrections of newton-krylov's predictor that begin a dynamic step
  double solves = 1;          // not a key: number of solves of the run with one matrix
  double relative_tolerance = 1e-10;
  int max_iterations = 2000;
};

void declare(config::Section& section, MethodParameters& method);

/// Rayleigh damping C = mass M + stiffness K, thesis (2.79).
struct SolidDamping {
  double mass = 0;       // [1/s]
  double stiffness = 0;  // [s]
};

/// Adaptive step size based on the local error.
struct TimeStepControl {
  double tolerance = 0;  // target accuracy of the displacement, rms over the volume [m]
};

void declare(config::Section& section, SolidDamping& damping);
void declare(config::Section& section, TimeStepControl& control);

struct SolidParameters;

/// Stepping between the equilibria of a static run at large strain.
struct LoadStepping {
  enum class Type { load, arc_length };
  Type type = Type::load;
  double first_load_factor = 0.05;  // of the first step
  int iterations = 5;               // target number per step
};

void declare(config::Section& section, LoadStepping& stepping);

}  // namespace couplet::solid
