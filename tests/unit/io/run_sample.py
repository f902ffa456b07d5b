# SPDX-License-Identifier: Apache-2.0
"""Runs write_sample_series on some ranks into an empty folder."""
import os
import pathlib
import shutil
import subprocess

KINDS = {  # cells of a box of 6 x 4 (x 2), by kind of mesh
    "quadrilaterals": (24, 1.0 * 2),
    "triangles": (48, 2.0),
    "hexahedra": (48, 2.0),
    "tetrahedra": (None, 2.0),
    "prisms": (96, 2.0),
    "mixed": (None, 2.0),
}
TIMES = [0.0, 0.1, 0.2, 0.1 * 3]


def run(program, ranks, folder):
    folder = pathlib.Path(folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    launch = [] if ranks == "1" else ["mpirun", "--oversubscribe", "-n", ranks]
    subprocess.run(launch + [program, str(folder)], check=True, env=os.environ)
    return folder
