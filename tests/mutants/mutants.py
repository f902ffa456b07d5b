# SPDX-License-Identifier: Apache-2.0
"""The mutants: a line of the code, what it is changed to, and the test that must fail then."""
from dataclasses import dataclass


@dataclass
class Mutant:
    name: str
    file: str
    old: str
    new: str
    test: str
    only: str = ""  # the claims of the test that are asked for (a filter of gtest); all by default
    target: str = ""  # what is built for the test, where the two have different names


MUTANTS = [
    Mutant("Adams-Bashforth ignores the ratio of the steps", "fluid_solver/step/stages.cpp",
           "const double e0 = 1 + ratio / 2, e1 = -ratio / 2;", "const double e0 = ratio > 0 ? 1.5 : 1, e1 = ratio > 0 ? -0.5 : 0;",
           "verification_fluid_steps"),
    Mutant("no backflow stabilisation", "fluid_solver/momentum/rates.cpp",
           "(s.phi[f] < 0 ? inflow[b] : 1.0)", "(s.phi[f] < 0 ? 1.0 : 1.0)", "verification_fluid_boundaries"),
    Mutant("four fifths of the mesh stiffening", "mesh_mover/laplacian.cpp",
           "std::pow(volumes[c] / mean, -stiffening)", "std::pow(volumes[c] / mean, -0.8 * stiffening)", "verification_mover"),
    Mutant("the limiter's slope at the inlet", "thermocline/bed/bed_step.cpp",
           "half_slope(2 * (t[0] - inlet), t[1] - t[0])", "half_slope(t[0] - inlet, t[1] - t[0])", "verification_thermocline_bed"),
    Mutant("Wakao's 1.1 is 1.0 where the bed takes it", "thermocline/bed/closures.cpp",
           "n.film_flow = 1.1 * k", "n.film_flow = 1.0 * k", "verification_thermocline_grains"),
    # Guards: each taken away must be missed.
    Mutant("the fluid's energy guard is silent", "fluid_solver/step/fractional_step.cpp",
           "const bool created = judgement_.energy.out_of_bounds", "const bool created = false && judgement_.energy.out_of_bounds",
           "stability_fluid_energy_growth", "EnergyGuard.*"),
    Mutant("an infinite tolerance of the pressure equation", "fluid_solver/pressure/pressure.cpp",
           "if (!std::isfinite(absolute))", "if (absolute < 0)", "stability_fluid_energy_growth", "EnergyGuard.*"),
    Mutant("closed fluids whose interface displaces volume", "fluid_solver/closed_fluid.cpp",
           "if (share <= largest_open_share) return;", "if (share <= 10 * largest_open_share + 10) return;", "contract_fluid", "ClosedFluid.*"),
    Mutant("cells that cross themselves", "common/mesh/quality.cpp", "return other == 2;", "return other == 5;", "unit_mesh", "FindCrossed.*"),
    Mutant("growth of the coupling's iteration", "coupler/diagnostics/iteration.cpp", "if (growing_ < patience && !ran_away) return;",
           "if (growing_ < 1000 * patience && !(ran_away && residual < 0)) return;", "unit_coupler", "*ResidualGrowth*"),
    Mutant("swings from step to step", "coupler/diagnostics/interface_motion.cpp", "if (!(now > 3 * then)", "if (!(now > 3e6 * then)",
           "unit_coupler", "*StepOscillation*"),
    Mutant("interfaces in different places", "coupler/mapping/surface_checks.cpp", "if (off <= allowed) return \"\";", "if (off <= 1e6 * allowed) return \"\";",
           "unit_coupler", "*Places*"),
    Mutant("steps beyond 2^31", "common/coupling/step_plan.cpp", "static_cast<GlobalIndex>(std::ceil(", "static_cast<int>(std::ceil(",
           "unit_coupling", "*more_steps_than_an_int*"),
    Mutant("a flipped bit in a checkpoint", "common/io/checkpoint_set.cpp",
           "if (size == entry->size && digest_of_file(file) == entry->digest)", "if (size == entry->size)", "unit_app"),
    Mutant("a filler that never yields passively", "thermocline/wall/mechanics.cpp", "std::clamp(wanted, active_[i], passive_[i])",
           "std::max(wanted, active_[i])", "stability_thermocline"),
    Mutant("a trapezoidal thermal shock that swings", "solid_solver/diagnostics/heat.cpp", "if (turns_ < patience) return;",
           "if (turns_ < 1000 * patience) return;", "stability_solid_hard_cases", "ThermalShock.*"),
    # Physics that no test held.
    Mutant("quasi-Newton gives up a step's pairs too early", "coupler/acceleration/quasi_newton.cpp",
           "step_ - step_of_.back() > parameters_.reused_steps", "step_ - step_of_.back() >= parameters_.reused_steps",
           "unit_coupler", "QuasiNewton.*"),
    Mutant("quasi-Newton reuses no step", "coupler/acceleration/quasi_newton.cpp",
           "step_ - step_of_.back() > parameters_.reused_steps", "step_ - step_of_.back() > 0 * parameters_.reused_steps",
           "unit_coupler", "QuasiNewton.*"),
    Mutant("the volume level on the area at the end", "coupler/acceleration/volume_level.cpp",
           "found->areas[f] = (found->areas[f] + begin[f]) / 2;", "found->areas[f] = (2 * found->areas[f] + 0 * begin[f]) / 2;",
           "coupling_volume_level", "VolumeArea.*"),
    Mutant("half the loss by mass damping", "solid_solver/motion/ledger.cpp",
           "mass_loss = damping_.mass / dt *", "mass_loss = 0.5 * damping_.mass / dt *",
           "verification_solid_energy", "SolidEnergy.*"),
    Mutant("half the loss by mass damping at large strain", "solid_solver/motion/ledger.cpp",
           "done.loss = damping_.mass / work.stage.dt *", "done.loss = 0.5 * damping_.mass / work.stage.dt *",
           "verification_solid_energy", "SolidEnergy.*"),
    Mutant("half the loss by mass damping, cell by cell", "solid_solver/motion/ledger.cpp",
           "damping_.mass / dt * body_.density(c) *", "0.5 * damping_.mass / dt * body_.density(c) *",
           "verification_solid_energy", "SolidEnergy.*"),
    Mutant("thermal load of three-cornered faces without their edges", "common/elasticity/symmetric/symmetric_kernel.cpp",
           "here += share_[i] * (of_edges - here);",
           "here += 0 * share_[i] * (of_edges - here);", "unit_symmetric_loads"),
    Mutant("half the friction of oblique faces", "fluid_solver/momentum/rates.cpp",
           "const Vec<D> part = nu_ * (mean * at.oblique[f]);", "const Vec<D> part = 0.5 * nu_ * (mean * at.oblique[f]);",
           "verification_fluid_face_loops"),
    Mutant("no friction of oblique faces at walls", "fluid_solver/momentum/rates.cpp",
           "rate[mesh_.owner[f]] += friction * nu_ * (gradient[mesh_.owner[f]] * at.oblique[f]);",
           "rate[mesh_.owner[f]] += 0 * nu_ * (gradient[mesh_.owner[f]] * at.oblique[f]);", "verification_fluid_face_loops"),
    Mutant("the flux is not carried on to the centre of skew faces", "fluid_solver/momentum/rates.cpp",
           "sign * 0.5 * ((gradient", "sign * 0.45 * ((gradient", "verification_fluid_face_loops"),
    Mutant("the load on the area at the end", "fluid_solver/step/fractional_step.cpp",
           "0.5 * p * (from.placement->area[f] + to.area[f])",
           "0.5 * p * (0 * from.placement->area[f] + 2 * to.area[f])", "verification_fluid_face_loops"),
    Mutant("the error constant of the three-point scheme", "common/time/time_scheme.cpp", "return {2, 1. / 3};", "return {2, 1. / 4};",
           "unit_time", "ErrorConstants.*"),
    Mutant("the moments of a load are kept by nine tenths", "coupler/mapping/sparse_map.cpp",
           "b.tail(at.cols()) = at.row(n).transpose();", "b.tail(at.cols()) = 0.9 * at.row(n).transpose();", "unit_maps", "Maps.keep_*"),
    Mutant("the moments of a load are not met at centres of faces", "coupler/mapping/face_weights.cpp",
           "  meet(surface.face_centres[face], at, weights);", "  if (at.empty()) meet(surface.face_centres[face], at, weights);", "unit_maps",
           "CornerWeights.*"),
]
