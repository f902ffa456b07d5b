// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/method_parameters.hpp"

#include "common/linalg/residual_projection.hpp"

namespace couplet {

void declare(config::Section& s, MethodParameters& m) {
  using Type = MethodParameters::Type;
  using FaceGradient = MethodParameters::FaceGradient;
  using LinearSolver = MethodParameters::LinearSolver;
  using Preconditioner = MethodParameters::Preconditioner;
  using Acceleration = MethodParameters::Acceleration;
  using Predictor = MethodParameters::Predictor;
  s.choice("type", m.type,
           {{"auto", Type::automatic},
            {"block-coupled", Type::block_coupled},
            {"segregated", Type::segregated},
            {"newton-krylov", Type::newton_krylov}})
      .doc(
          "block-coupled: one assembled system of all displacement components; segregated: one scalar system "
          "a "
          "component and outer iterations (with kinematics finite-strain: the thesis's updated-Lagrangian method); newton-krylov: the operator applied without a matrix; auto: by "
          "size and "
          "scene, the log says what and why");
  s.choice("face-gradient", m.face_gradient,
           {{"auto", FaceGradient::automatic},
            {"thesis", FaceGradient::thesis},
            {"corrected", FaceGradient::corrected},
            {"symmetric", FaceGradient::symmetric}})
      .doc(
          "displacement gradient at the faces; symmetric: from an energy, so that it neither locks in bending nor lets motion "
          "grow on any mesh, by conjugate gradients; thesis: the source's, which locks in bending with few or long cells; "
          "corrected: the thesis's with second-order corrections, which does not, but undamped motion grows sooner with short "
          "steps; auto: symmetric, and thesis with 'zero-normal-gradient', 'type: segregated' or 'block-coupled'");
  using VolumeStrain = MethodParameters::VolumeStrain;
  s.choice("volume-strain", m.volume_strain,
           {{"auto", VolumeStrain::automatic},
            {"faces", VolumeStrain::faces},
            {"cells", VolumeStrain::cells},
            {"shared", VolumeStrain::shared}})
      .doc(
          "of face-gradient symmetric; cells: one a cell, which does not lock as nu goes to 0.5; faces: that of each "
          "face; shared: a tenth of the bulk modulus, at most a third of the shear modulus, on the faces', the rest on the "
          "cells': best in plane strain and for plates, too soft for bars in space with few cells across; auto: cells from "
          "nu = 0.4 up, else faces");
  s.check(
      [&m] {
        const bool asked = m.volume_strain == VolumeStrain::cells || m.volume_strain == VolumeStrain::shared;
        const bool other = m.face_gradient == FaceGradient::thesis ||
                           m.face_gradient == FaceGradient::corrected || m.type == Type::block_coupled ||
                           m.type == Type::segregated;
        return asked && other
                   ? "it is of 'face-gradient: symmetric' with 'type: newton-krylov'; change these, or remove it"
                   : "";
      },
      "volume-strain");
  s.choice("linear-solver", m.linear_solver,
           {{"auto", LinearSolver::automatic},
            {"direct", LinearSolver::direct},
            {"bicgstab-ilu", LinearSolver::bicgstab_ilu},
            {"gmres-multigrid", LinearSolver::gmres_multigrid}})
      .doc("of block-coupled; auto: direct up to 60 000 unknowns (static: 200 000), above that bicgstab-ilu");
  s.choice("preconditioner", m.preconditioner,
           {{"auto", Preconditioner::automatic},
            {"multigrid", Preconditioner::multigrid},
            {"factors", Preconditioner::factors},
            {"mixed", Preconditioner::mixed}})
      .doc(
          "of newton-krylov; multigrid: compact component-wise operator and rigid motions of aggregates; "
          "factors: LU of "
          "the thesis's operator (symmetric: Cholesky of its own), kept for all steps of one size; mixed: of the symmetric "
          "gradient with one volume strain a cell, whose mean stresses become unknowns too, so that nu close to 0.5 costs "
          "hardly more iterations than 0.3; auto: factors of small bodies, else mixed from nu = 0.49 up, else multigrid");
  s.choice(
       "acceleration", m.acceleration,
       {{"none", Acceleration::none}, {"aitken", Acceleration::aitken}, {"anderson", Acceleration::anderson}})
      .doc("of the outer iterations of segregated");
  s.value("aitken-interval", m.aitken_interval)
      .range(2, 100)
      .doc("Aitken's formula after every so many iterations");
  s.value("anderson-history", m.anderson_history)
      .range(1, 30)
      .doc("iterations that Anderson's method combines");
  s.choice("predictor", m.predictor,
           {{"none", Predictor::none}, {"euler", Predictor::euler}, {"adams", Predictor::adams}})
      .doc(
          "first guess of a dynamic step: the last displacement; moved on with the velocity (2.73); with two "
          "velocities (2.74)");
  s.value("corrections-kept", m.corrections_kept)
      .range(0, ResidualProjection::most)
      .doc(
          "of newton-krylov in dynamic analyses: of the corrections that the last so many steps made to the "
          "predictor, the combination that leaves the least residual is added to the guess; 0: none");
  s.value("relative-tolerance", m.relative_tolerance)
      .range(1e-15, 1e-2)
      .doc(
          "residual over right-hand side at which the iteration stops; of symmetric newton-krylov (and of any in 2-D with more than "
          "5000 cells) in steps so small that inertia outweighs stiffness, over its elastic part");
  s.value("max-iterations", m.max_iterations).range(1, 1e6).doc("iterations after which a step has failed");
}

}  // namespace couplet
