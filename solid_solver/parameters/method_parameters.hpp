// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/section.hpp"
#include "common/time/time_scheme.hpp"

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

/// Rayleigh damping C = mass M + stiffness K, thesis (2.79).
struct SolidDamping {
  double mass = 0;       // [1/s]
  double stiffness = 0;  // [s]
};

/// Step sizes that follow the local error.
struct TimeStepControl {
  double tolerance = 0;  // wanted accuracy of the displacement, rms over the volume [m]
};

void declare(config::Section& section, SolidDamping& damping);
void declare(config::Section& section, TimeStepControl& control);

struct SolidParameters;

/// How a static run at large strain goes from one equilibrium to the next.
struct LoadStepping {
  enum class Type { load, arc_length };
  Type type = Type::load;
  double first_load_factor = 0.05;  // of the first step
  int iterations = 5;               // that a step should take
  double longest = 10;              // step over the first one
};

void declare(config::Section& section, LoadStepping& stepping);
/// What the arc length cannot have, each told at the key to change.
void check_load_stepping(config::Section& section, SolidParameters& parameters);

}  // namespace couplet::solid
