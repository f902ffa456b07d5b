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
    Mutant("Adams-Bashforth ignores the ratio of the steps", "fluid_solver/predictor.cpp",
           "const double e0 = 1 + ratio / 2, e1 = -ratio / 2;", "const double e0 = ratio > 0 ? 1.5 : 1, e1 = ratio > 0 ? -0.5 : 0;",
           "verification_fluid_steps"),
    Mutant("no backflow stabilisation", "fluid_solver/rates.cpp",
           "(backflow ? boundary_.backflow(b) : 1.0)", "(backflow ? 1.0 : 1.0)", "verification_fluid_boundaries"),
    Mutant("four fifths of the mesh stiffening", "mesh_mover/laplacian.cpp",
           "std::pow(volumes[c] / mean, -stiffening)", "std::pow(volumes[c] / mean, -0.8 * stiffening)", "verification_mover"),
    Mutant("the limiter's slope at the inlet", "thermocline/bed_step.cpp",
           "half_slope(2 * (t[0] - inlet), t[1] - t[0])", "half_slope(t[0] - inlet, t[1] - t[0])", "verification_thermocline_bed"),
    Mutant("Wakao's 1.1 is 1.0 where the bed takes it", "thermocline/closures.cpp",
           "n.film_flow = 1.1 * k", "n.film_flow = 1.0 * k", "verification_thermocline_grains"),
    Mutant("Wakao's 1.1 is 1.0 in the formula", "thermocline/closures.cpp",
           "return 2 + 1.1 * std::cbrt", "return 2 + 1.0 * std::cbrt", "verification_thermocline_grains"),
]
