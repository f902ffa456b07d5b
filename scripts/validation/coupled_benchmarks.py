# SPDX-License-Identifier: Apache-2.0
"""Bars of the coupled benchmarks: Turek and Hron's flags, tube, flap, cavities, vibration by vortices; restart and ranks of every case."""
from validation.parts.benchmarks import gallery, page
from validation.parts.benchmarks.cavity import CAVITY
from validation.parts.benchmarks.closed import CLOSED
from validation.parts.benchmarks.costs import COSTS
from validation.parts.benchmarks.flags import FLAGS
from validation.parts.benchmarks.large_flap import LARGE_FLAP
from validation.parts.benchmarks.lock_in import LOCK_IN
from validation.parts.benchmarks.studies import STUDY_ROWS
from validation.parts.benchmarks.tube import TUBE_ROWS

SOURCES = ("common/base", "common/parallel", "common/linalg", "common/mesh", "common/fv", "common/elasticity", "coupler",
           "fluid_solver", "solid_solver", "mesh_mover", "client", "configs/turek-hron", "configs/cfd3", "configs/cylinder",
           "configs/cavity-flexible-bottom", "configs/spring-cylinder", "configs/tube-3d", "configs/closed-cavity", "configs/perpendicular-flap",
           "configs/balloon", "configs/two-flaps")
PAGES = [page.write]
BARS = [
    *FLAGS,
    *CAVITY,
    *CLOSED,
    *LOCK_IN,
    *TUBE_ROWS,
    *LARGE_FLAP,
    *gallery.ROWS,
    *COSTS,
    *STUDY_ROWS,
]
