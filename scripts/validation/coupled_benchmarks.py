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
NOTE = """`--quick` takes all rows but the full FSI3, its second step, the finer runs of Mok's cavity, lock-in, the tube's 3:2 faces and order in time.

Mok's largest height: not met, cause unknown. What the input files of Kratos' example say (inlet, outlet pressure, densities, membrane, plane stress, step, end) agrees with the
case ([README](../../configs/cavity-flexible-bottom/README.md)); its mesh files were not compared. Mesh (0.6 %) and step (0.03 %) do not explain the 10 %. By hand: the membrane's own
period is near the lid's, and its height grows with the cube root of the load, so that 10 % in height are a third in load or damping; published amplitudes differ by half themselves. Its two meshes: the
least height changes by 2.1 % from 32 x 32 to 64 x 64 cells (four cells across the strips, which drive the flow).

Lift of FSI3: not met by 0.35 percentage points. With the trapezoidal rule, the default before, it was 185 N (+20 %): the plate vibrated in its highest modes; generalised-alpha damps them."""
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
