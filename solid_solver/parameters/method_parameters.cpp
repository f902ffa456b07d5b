// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/method_parameters.hpp"

#include <string>
#include <vector>

#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

namespace {

void declare_equations(config::Section& s, MethodParameters& m) {
  using Type = MethodParameters::Type;
  using FaceGradient = MethodParameters::FaceGradient;
  s.choice("type", m.type,
           {{"auto", Type::automatic},
            {"block-coupled", Type::block_coupled},
            {"segregated", Type::segregated},
            {"newton-krylov", Type::newton_krylov}})
      .doc(
          "block-coupled: one assembled system of all displacement components. segregated: one scalar "
          "system per component with outer iterations (with kinematics finite-strain: the "
          "updated-Lagrangian method of the thesis). newton-krylov: conjugate gradients for the symmetric gradient, without a "
          "matrix. auto: newton-krylov with the symmetric gradient, else block-coupled");
  s.choice("face-gradient", m.face_gradient,
           {{"auto", FaceGradient::automatic},
            {"thesis", FaceGradient::thesis},
            {"symmetric", FaceGradient::symmetric}})
      .doc(
          "displacement gradient at the faces. symmetric: derived from an energy, free of bending locking and of spurious "
          "growth on any mesh, solved by conjugate gradients. thesis: that of the thesis, which locks in bending with few or "
          "elongated cells; solved by block-coupled or segregated. auto: symmetric, but thesis with 'zero-normal-gradient', "
          "'type: segregated' or 'block-coupled'");
}

void declare_volume_strain(config::Section& s, MethodParameters& m) {
  using Type = MethodParameters::Type;
  using FaceGradient = MethodParameters::FaceGradient;
  using VolumeStrain = MethodParameters::VolumeStrain;
  s.choice("volume-strain", m.volume_strain,
           {{"auto", VolumeStrain::automatic},
            {"faces", VolumeStrain::faces},
            {"cells", VolumeStrain::cells},
            {"shared", VolumeStrain::shared}})
      .doc(
          "where the volume strain is evaluated, for face-gradient symmetric. cells: one per cell, free of volumetric locking "
          "as nu approaches 0.5. faces: one per face. shared: a tenth of the bulk modulus, but at most a third of the shear "
          "modulus, acts on the faces and the rest on the cells, which is best in plane strain and for plates, but too soft "
          "for 3-D bars with few cells across. auto: cells from nu = 0.4, otherwise faces");
  s.check(
      [&m] {
        const bool asked = m.volume_strain == VolumeStrain::cells || m.volume_strain == VolumeStrain::shared;
        const bool other = m.face_gradient == FaceGradient::thesis || m.type == Type::block_coupled ||
                           m.type == Type::segregated;
        return asked && other
                   ? "it requires 'face-gradient: symmetric' with 'type: newton-krylov'; change these, or "
                     "remove it"
                   : "";
      },
      "volume-strain");
}

void declare_linear_solver(config::Section& s, MethodParameters& m) {
  using LinearSolver = MethodParameters::LinearSolver;
  using Preconditioner = MethodParameters::Preconditioner;
  s.choice("linear-solver", m.linear_solver,
           {{"auto", LinearSolver::automatic},
            {"direct", LinearSolver::direct},
            {"bicgstab-ilu", LinearSolver::bicgstab_ilu},
            {"gmres-multigrid", LinearSolver::gmres_multigrid}})
      .doc(
          "linear solver of block-coupled. auto: direct up to 60 000 unknowns (static: 200 000), otherwise "
          "bicgstab-ilu");
  s.choice("preconditioner", m.preconditioner,
           {{"auto", Preconditioner::automatic},
            {"multigrid", Preconditioner::multigrid},
            {"factors", Preconditioner::factors},
            {"mixed", Preconditioner::mixed}})
      .doc(
          "for newton-krylov. multigrid: multigrid of a compact component-wise operator, with the rigid-body modes of "
          "aggregates. factors: factors of the matrix (including the mass), reused for all steps of the same size. mixed: for "
          "one volume strain per cell, with the mean stresses as additional unknowns, so that nu close to 0.5 takes hardly "
          "more iterations than 0.3. auto: factors where the run makes enough steps for them to pay off, and for several "
          "materials and from nu = 0.49 where they are computed in seconds; otherwise mixed from nu = 0.49, otherwise "
          "multigrid. If an iteration that auto chose does not converge, factors replace it if they fit into memory");
}

void declare_iteration(config::Section& s, MethodParameters& m) {
  using Acceleration = MethodParameters::Acceleration;
  using Predictor = MethodParameters::Predictor;
  s.choice(
       "acceleration", m.acceleration,
       {{"none", Acceleration::none}, {"aitken", Acceleration::aitken}, {"anderson", Acceleration::anderson}})
      .doc("convergence acceleration of the outer iterations, for segregated");
  s.choice("predictor", m.predictor, {{"none", Predictor::none}, {"euler", Predictor::euler}})
      .doc(
          "initial guess of a dynamic step: the last displacement, or the last displacement extrapolated with the velocity "
          "(2.73)");
  s.value("relative-tolerance", m.relative_tolerance)
      .range(1e-15, 1e-2)
      .doc(
          "relative residual tolerance; for newton-krylov in steps so small that inertia dominates stiffness, it is relative "
          "to the elastic part");
  s.value("max-iterations", m.max_iterations)
      .range(1, 1e6)
      .doc(
          "maximum number of iterations; beyond it a "
          "step fails");
}

}  // namespace

void declare(config::Section& s, MethodParameters& m) {
  declare_equations(s, m);
  declare_volume_strain(s, m);
  declare_linear_solver(s, m);
  declare_iteration(s, m);
}

void declare(config::Section& s, SolidDamping& d) {
  s.value("mass", d.mass)
      .unit("1/s", 1e-9, 1e9)
      .not_negative()
      .doc("Rayleigh coefficient of the mass matrix");
  s.value("stiffness", d.stiffness)
      .unit("s", 1e-15, 1e4)
      .not_negative()
      .doc("Rayleigh coefficient of the stiffness matrix");
}

void declare(config::Section& s, TimeStepControl& c) {
  s.value("tolerance", c.tolerance)
      .unit("m", 1e-15, 1)
      .positive()
      .required()
      .doc("target accuracy of the displacement, rms over the volume; one step may contribute a tenth of it");
}

time::TimeSchemeParameters scheme_of(const SolidParameters& p) {
  time::TimeSchemeParameters scheme = p.time_scheme;
  if (scheme.type != time::TimeScheme::automatic) return scheme;
  const bool keeps_contact = p.contact && p.contact->rule == contact::ContactRule::conserving;
  const bool is_loaded_by_partner =
      !(p.interface_data && p.interface_data->temperature) && any_condition(p, is_interface);
  const bool damps =
      is_loaded_by_partner && !is_updated_lagrangian(p) && !p.energy_momentum && !keeps_contact;
  scheme.type = damps ? time::TimeScheme::generalised_alpha : time::TimeScheme::trapezoidal;
  return scheme;
}

void declare(config::Section& s, LoadStepping& l) {
  using Type = LoadStepping::Type;
  s.choice("type", l.type, {{"load", Type::load}, {"arc-length", Type::arc_length}})
      .doc(
          "load: the steps follow the loads as functions of t. arc-length: a step is a length along the load path, which "
          "passes limit points of load (snap-through) and of displacement; the given loads are those at load factor 1 and must "
          "be constant in time");
  s.value("first-load-factor", l.first_load_factor)
      .range(1e-6, 1)
      .doc("for arc-length: load factor of the first step; sets the length of the later ones");
  s.value("iterations", l.iterations)
      .range(2, 15)
      .doc("for arc-length: target number of Newton iterations per step, to which the length is adapted");
}

}  // namespace couplet::solid
