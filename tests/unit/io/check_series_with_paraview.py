#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens the series with ParaView's own XDMF reader and checks times, moved points, cells and fields.
Needs ParaView's Python (Debian: python3-paraview, or any pvpython on PATH or in COUPLET_PVPYTHON); skipped (77) without.
Usage: PROGRAM RANKS FOLDER"""
import os
import shutil
import subprocess
import sys

INSIDE = """
import sys, json
from vtkmodules.vtkIOXdmf2 import vtkXdmfReader
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.util.numpy_support import vtk_to_numpy
import numpy as np

def leaves(data):
    if data.IsA("vtkMultiBlockDataSet"):
        for i in range(data.GetNumberOfBlocks()):
            yield from leaves(data.GetBlock(i))
    else:
        yield data

folder, kinds, wanted = sys.argv[1], json.loads(sys.argv[2]), json.loads(sys.argv[3])
for kind, (n_cells, size) in kinds.items():
    reader = vtkXdmfReader()
    reader.SetFileName(f"{folder}/{kind}.xdmf")
    reader.UpdateInformation()
    times = list(reader.GetOutputInformation(0).Get(reader.GetExecutive().TIME_STEPS()))
    assert times == wanted, f"{kind}: times {times}"
    reference = None
    for time in times:
        reader.UpdateTimeStep(time)
        (grid,) = leaves(reader.GetOutputDataObject(0))
        points = vtk_to_numpy(grid.GetPoints().GetData()).copy()
        if reference is None:
            reference = points
        moved = reference + time * np.outer(reference[:, 1], [1, 0, 0])
        assert np.abs(points - moved).max() < 1e-14, f"{kind}: points not moved at {time}"
        if n_cells:
            assert grid.GetNumberOfCells() == n_cells, grid.GetNumberOfCells()
        sizes = vtkCellSizeFilter()
        sizes.SetInputData(grid)
        sizes.Update()
        name = "Area" if kind in ("quadrilaterals", "triangles") else "Volume"
        each = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray(name))
        assert each.min() > 0, f"{kind}: inverted cells, {each.min()}"
        assert abs(each.sum() - size) < 1e-12, f"{kind}: total size {each.sum()}"
        velocity = vtk_to_numpy(grid.GetCellData().GetArray("velocity [m/s]"))
        pressure = vtk_to_numpy(grid.GetCellData().GetArray("pressure [Pa]"))
        displacement = vtk_to_numpy(grid.GetPointData().GetArray("displacement [m]"))
        assert velocity.shape == (grid.GetNumberOfCells(), 3)
        assert np.abs(pressure - velocity[:, 0] - time).max() < 1e-14
        assert np.abs(displacement[:, 0] - time * reference[:, 1]).max() < 1e-14
    print(f"{kind}: {len(times)} times, {grid.GetNumberOfCells()} cells, {grid.GetNumberOfPoints()} moved points")
"""


def interpreter():
    """A Python that has ParaView's reader, or None."""
    for python in (os.environ.get("COUPLET_PVPYTHON"), shutil.which("pvpython"), sys.executable, "/usr/bin/python3"):
        if python and subprocess.run([python, "-c", "from vtkmodules.vtkIOXdmf2 import vtkXdmfReader"],
                                     capture_output=True).returncode == 0:
            return python
    return None


python = interpreter()
if python is None:
    print("skipped: ParaView's Python was not found (Debian: apt install python3-paraview, or set COUPLET_PVPYTHON).")
    sys.exit(77)

import json

import run_sample

folder = run_sample.run(*sys.argv[1:4])
sys.exit(subprocess.run([python, "-c", INSIDE, str(folder), json.dumps(run_sample.KINDS),
                         json.dumps(run_sample.TIMES)]).returncode)
