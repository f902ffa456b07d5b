#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Other programs open what a solver writes: ParaView's XDMF reader, and VTK's and meshio's readers of what `couplet export --to vtk` makes of it.
Times, points and every field equal what stands in the HDF5 file. Needs VTK's Python (Debian: python3-vtk9, which has no XDMF reader, or python3-paraview, or any in
COUPLET_PVPYTHON); skipped (77) without. Usage: paraview.py PROGRAM FOLDER_OF_CASES NAME"""
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import h5py
import numpy

INSIDE = """
import os
import sys
import xml.etree.ElementTree
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy

def leaves(data):
    if data.IsA("vtkMultiBlockDataSet"):
        for i in range(data.GetNumberOfBlocks()):
            yield from leaves(data.GetBlock(i))
    else:
        yield data

def outputs(file):
    if file.endswith(".xdmf"):
        from vtkmodules.vtkIOXdmf2 import vtkXdmfReader
        reader = vtkXdmfReader()
        reader.SetFileName(file)
        reader.UpdateInformation()
        for time in reader.GetOutputInformation(0).Get(reader.GetExecutive().TIME_STEPS()):
            reader.UpdateTimeStep(time)
            (grid,) = leaves(reader.GetOutputDataObject(0))
            yield time, grid
        return
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
    for entry in xml.etree.ElementTree.parse(file).iter("DataSet"):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(os.path.join(os.path.dirname(file), entry.get("file")))
        reader.Update()
        yield float(entry.get("timestep")), reader.GetOutput()

times, out = [], {}
for i, (time, grid) in enumerate(outputs(sys.argv[1])):
    times.append(time)
    out[f"{i}/coordinates"] = vtk_to_numpy(grid.GetPoints().GetData())
    for place, data in (("cells", grid.GetCellData()), ("points", grid.GetPointData())):
        for k in range(data.GetNumberOfArrays()):
            out[f"{i}/{place}/{data.GetArrayName(k).split(' [')[0]}"] = vtk_to_numpy(data.GetArray(k))
out["times"] = numpy.array(times)
numpy.savez(sys.argv[2], **out)
"""


def interpreter(module):
    for python in (os.environ.get("COUPLET_PVPYTHON"), shutil.which("pvpython"), sys.executable, "/usr/bin/python3"):
        if python and subprocess.run([python, "-c", f"import vtkmodules.{module}"], capture_output=True).returncode == 0:
            return python
    return None


def by_meshio(pvd):
    """The same of meshio, where it is installed: {name: values}."""
    import meshio
    out, times = {}, []
    for i, entry in enumerate(xml.etree.ElementTree.parse(pvd).iter("DataSet")):
        mesh = meshio.read(pvd.parent / entry.get("file"))
        times.append(float(entry.get("timestep")))
        out[f"{i}/coordinates"] = mesh.points
        out |= {f"{i}/points/{name}": values for name, values in mesh.point_data.items()}
        out |= {f"{i}/cells/{name}": numpy.concatenate(values) for name, values in mesh.cell_data.items()}
    return {**out, "times": numpy.array(times)}


def compared(read, series, wanted):
    """How many fields of some outputs are the same in another program and in the file."""
    count = 0
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
of_vtu, of_xdmf = interpreter("vtkIOXML"), interpreter("vtkIOXdmf2")
if of_vtu is None:
    print("skipped: VTK's Python was not found (Debian: apt install python3-vtk9, or set COUPLET_PVPYTHON).")
    sys.exit(77)
with tempfile.TemporaryDirectory(prefix="couplet-paraview-") as folder:
    folder = pathlib.Path(folder)
    shutil.copy(cases / "square.msh", folder)
    shutil.copy(cases / f"{name}.yaml", folder / "case.yaml")
    more = ", modes: 2" if name == "solid" else ""
    subprocess.run([program, "case.yaml", "--accept", "error-estimate", "--set", "simulation.output.interval=0.5", "--set", f"participants.{name}.output={{surfaces: [bottom]{more}}}"],
                   cwd=folder, check=True, capture_output=True)
    out = folder / "out" / name
    subprocess.run([sys.executable, cases.parents[2] / "scripts/couplet", "export", folder / "out", "--to", "vtk"], check=True, capture_output=True)
    for file, wanted, least in ((name, 3, 6), ("surface-bottom", 2 if name == "fluid" else 3, 6), *([("mode-shapes", 1, 2)] if more else ())):
        pvd, counts = out / "vtk" / f"{file}.pvd", {}
        for python, index in ((of_vtu, pvd), (of_xdmf, out / f"{file}.xdmf")):
            if python:
                subprocess.run([python, "-c", INSIDE, str(index), str(folder / "read.npz")], check=True)
                counts[index.suffix] = compared(dict(numpy.load(folder / "read.npz")), out / file, wanted)
        if importlib.util.find_spec("meshio"):
            counts["meshio"] = compared(by_meshio(pvd), out / file, wanted)
        assert min(counts.values()) >= least, (file, counts)
        print(f"{file}: fields as they stand in the file, by reader: {counts}")
