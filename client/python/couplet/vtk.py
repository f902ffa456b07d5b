# SPDX-License-Identifier: Apache-2.0
"""Writes the fields of a run as .vtu files, one an output, with a .pvd that lists them as a series in time: what every
version of ParaView and VTK, meshio and most other programs read. Coordinates are those of the moved mesh."""
import base64
import pathlib
from xml.sax.saxutils import quoteattr

import h5py
import numpy as np

from couplet import files
from couplet.series import FieldSeries

VTK = {1: 1, 2: 3, 4: 5, 5: 9, 6: 10, 7: 14, 8: 13, 9: 12}  # type of cell in VTK, by XDMF code
NAMES = {np.dtype("f8"): "Float64", np.dtype("i8"): "Int64", np.dtype("u1"): "UInt8"}


def array(name, values):
    values = np.ascontiguousarray(values)
    data = values.tobytes()
    text = base64.b64encode(np.uint64(len(data)).tobytes() + data).decode()
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    return (
        f'<DataArray type="{NAMES[values.dtype]}"'
        f' Name={quoteattr(name)}{components} format="binary">{text}</DataArray>\n'
    )


def padded(values):
    """Vectors in two dimensions get a third component, and tensors keep their number."""
    values = np.asarray(values, "f8")
    return np.pad(values, ((0, 0), (0, 1))) if values.ndim == 2 and values.shape[1] == 2 else values


def grid(series, i):
    """Text of one .vtu."""
    cells, points = series.cells, padded(series.coordinates(i))
    step = series.file["steps"][series.steps[i]]
    text = (
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"'
        f' header_type="UInt64">\n<UnstructuredGrid>\n<Piece NumberOfPoints="{len(points)}"'
        f' NumberOfCells="{len(cells)}">\n'
    )
    text += f"<Points>\n{array('Points', points)}</Points>\n<Cells>\n"
    text += array(
        "connectivity", np.concatenate([np.asarray(c, "i8") for c in cells]) if len(cells) else np.zeros(0, "i8")
    )
    text += (
        array("offsets", np.cumsum([len(c) for c in cells], dtype="i8"))
        + array("types", np.array([VTK[c] for c in series.codes], "u1"))
        + "</Cells>\n"
    )
    for place, word in (("points", "PointData"), ("cells", "CellData")):
        text += (
            f"<{word}>\n"
            + "".join(array(name, padded(values[...])) for name, values in step.get(place, {}).items())
            + f"</{word}>\n"
        )
    return text + "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"


def write(folder, target=None, participant=None):
    """Writes the series of all participants, or of one, below an output folder. They go to their folders vtk/, or to
    folders with their names in `target`. Returns the .pvd files."""
    lists, base = [], pathlib.Path(folder if target is None else target)
    for file in sorted(pathlib.Path(folder).glob("*/*.h5")):
        if participant not in (None, file.parent.name):
            continue
        with h5py.File(file, "r") as content:
            if content.attrs.get("format") not in (
                "couplet fields",
                b"couplet fields",
                "couplet surface",
                b"couplet surface",
            ):
                continue
        series, entries = FieldSeries(file), ""
        place = pathlib.Path(file.parent.name) / ("vtk" if target is None else "")
        for i, time in enumerate(series.times):
            name = f"{file.stem}-{i:06d}.vtu"
            files.write(base, place / name, grid(series, i))
            entries += f'<DataSet timestep="{time:.12g}" part="0" file={quoteattr(name)}/>\n'
        lists.append(
            files.write(
                base,
                place / f"{file.stem}.pvd",
                (
                    '<VTKFile type="Collection" version="1.0"'
                    f' byte_order="LittleEndian">\n<Collection>\n{entries}</Collection>\n</VTKFile>\n'
                ),
            )
        )
    return lists
