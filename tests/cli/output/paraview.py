#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""ParaView's own XDMF reader opens what a solver writes: times, points and every field equal what stands in the HDF5 file.
Needs ParaView's Python (Debian: python3-paraview or python3-vtk9, or any in COUPLET_PVPYTHON); skipped (77) without.
Usage: paraview.py PROGRAM FOLDER_OF_CASES NAME"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy

INSIDE = """
import sys
import numpy
from vtkmodules.vtkIOXdmf2 import vtkXdmfReader
from vtkmodules.util.numpy_support import vtk_to_numpy

def leaves(data):
    if data.IsA("vtkMultiBlockDataSet"):
        for i in range(data.GetNumberOfBlocks()):
            yield from leaves(data.GetBlock(i))
    else:
        yield data

reader = vtkXdmfReader()
reader.SetFileName(sys.argv[1])
reader.UpdateInformation()
times = list(reader.GetOutputInformation(0).Get(reader.GetExecutive().TIME_STEPS()))
out = {"times": numpy.array(times)}
for i, time in enumerate(times):
    reader.UpdateTimeStep(time)
    (grid,) = leaves(reader.GetOutputDataObject(0))
    out[f"{i}/coordinates"] = vtk_to_numpy(grid.GetPoints().GetData())
    for place, data in (("cells", grid.GetCellData()), ("points", grid.GetPointData())):
        for k in range(data.GetNumberOfArrays()):
            out[f"{i}/{place}/{data.GetArrayName(k).split(' [')[0]}"] = vtk_to_numpy(data.GetArray(k))
numpy.savez(sys.argv[2], **out)
"""


def interpreter():
    for python in (os.environ.get("COUPLET_PVPYTHON"), shutil.which("pvpython"), sys.executable, "/usr/bin/python3"):
        if python and subprocess.run([python, "-c", "from vtkmodules.vtkIOXdmf2 import vtkXdmfReader"],
                                     capture_output=True).returncode == 0:
            return python
    return None


def compared(python, series, folder, wanted):
    """How many fields of three outputs are the same in ParaView and in the file."""
    subprocess.run([python, "-c", INSIDE, f"{series}.xdmf", str(folder / "read.npz")], check=True)
    read, count = dict(numpy.load(folder / "read.npz")), 0
    with h5py.File(f"{series}.h5") as file:
        steps = sorted(file["steps"])
        numpy.testing.assert_array_equal(read["times"], [float(file["steps"][s].attrs["time"]) for s in steps])
        assert len(steps) == wanted, steps
        for i, step in enumerate(steps):
            group = file["steps"][step]
            points = group["coordinates"] if "coordinates" in group else file["mesh/coordinates"]
            numpy.testing.assert_array_equal(read[f"{i}/coordinates"], points[...])
            for place in ("cells", "points"):
                for field in group.get(place, {}):
                    numpy.testing.assert_array_equal(read[f"{i}/{place}/{field}"], group[place][field][...])
                    count += 1
    return count


program, cases, name = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
python = interpreter()
if python is None:
    print("skipped: ParaView's Python was not found (Debian: apt install python3-paraview, or set COUPLET_PVPYTHON).")
    sys.exit(77)
with tempfile.TemporaryDirectory(prefix="couplet-paraview-") as folder:
    folder = pathlib.Path(folder)
    shutil.copy(cases / "square.msh", folder)
    shutil.copy(cases / f"{name}.yaml", folder / "case.yaml")
    subprocess.run([program, "case.yaml", "--set", "simulation.output.interval=0.5", "--set", f"participants.{name}.output.surfaces=[bottom]"],
                   cwd=folder, check=True, capture_output=True)
    out = folder / "out" / name
    count, on_surface = compared(python, out / name, folder, 3), compared(python, out / "surface-bottom", folder, 2 if name == "fluid" else 3)
    assert count >= 6 and on_surface >= 6, (count, on_surface)
    print(f"{name}: {count} fields as they stand in the file, {on_surface} of a surface")
