# SPDX-License-Identifier: Apache-2.0
"""Couplet from Python: reads the results of a run, starts runs, and takes part in a job as an external program.

    run = couplet.Results("out")                        # after a run
    run.probes("solid")["tip displacement x [m]"]       # columns of probes.csv: numpy arrays
    run.fields("fluid").field(-1, "velocity")           # of the last output: (cells, components)
    run.surface("fluid", "wall").integral("traction")   # of output.surfaces: the force [N]
    run.findings(), run.budget()                        # its warnings; the parts of its error

    run = couplet.run("case.yaml", ranks={"fluid": 2}, changes={"simulation.end-time": "1 s"})

    job = couplet.Client("solid", "my_solver")          # in a program of a job: couplet/participant.py

Names are loaded on first use: a participant needs only mpi4py and numpy."""
from couplet import lazy
from couplet.transports import choose

choose()  # must precede MPI_Init

_PLACES = {
    "participant": ("Client",),
    "series": ("FieldSeries", "Surface", "WIDTH", "extrema", "find_series", "find_surface", "surface_names"),
    "runs": ("Case", "Results", "RunFailed", "Wrong", "read_csv", "run"),
}
__getattr__ = lazy.names(__name__, _PLACES)


def __dir__():
    return sorted([*globals(), *(n for names in _PLACES.values() for n in names)])
