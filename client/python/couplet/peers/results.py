# SPDX-License-Identifier: Apache-2.0
"""Results of another program in the format of our programs, so that all quantities of a study are read in the same
way."""
import h5py
import numpy as np
from scipy.spatial import cKDTree

from couplet import files
from couplet.peers import elements
from couplet.peers.values import number

XDMF = {"triangle": 4, "quadrilateral": 5, "tetrahedron": 6, "prism": 8, "hexahedron": 9}
STRESS = ("xx", "yy", "zz", "xy", "yz", "xz")
UNITS = {"velocity": "m/s", "pressure": "Pa", "displacement": "m", "cell-displacement": "m"}


def write_fields(folder, name, mesh, time, cells, points=None):
    """Writes a series of one output (docs/formats.md) with fields of `cells` and `points` by name."""
    flat = mesh if mesh.order == 1 else mesh.corners()
    kinds = list(flat.cells)
    with files.part(folder, name) as made, h5py.File(made, "w") as out:
        out.attrs["format"], out.attrs["kind"] = np.bytes_("couplet fields"), float(
            XDMF[kinds[0]] if len(kinds) == 1 else 0
        )
        out["mesh/coordinates"] = flat.points
        out["mesh/cells"] = (
            flat.cells[kinds[0]]
            if len(kinds) == 1
            else np.concatenate([np.hstack([np.full((len(c), 1), XDMF[s]), c]).ravel() for s, c in flat.cells.items()])
        )
        step = out.create_group("steps/000000")
        step.attrs["time"] = float(time)
        for place, fields in (("cells", cells), ("points", points or {})):
            for name, values in fields.items():
                step[f"{place}/{name}"] = values
                step[f"{place}/{name}"].attrs["unit"] = np.bytes_(UNITS.get(name, "Pa"))


def write_table(folder, name, columns):
    files.write_rows(folder, name, [list(columns), *zip(*columns.values())])


def at_middles(mesh, values):
    """Interpolates point values to the cell centers."""
    return np.concatenate(
        [
            np.einsum("n,cnk->ck", elements.shape_functions(s, mesh.order, [elements.CENTRES[s]])[0], values[c])
            for s, c in mesh.cells.items()
        ]
    )


def von_mises(s):
    xx, yy, zz, xy, yz, xz = s.T
    return np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy**2 + yz**2 + xz**2))


def of_points(mesh, values):
    """Function of a position that interpolates point values."""

    def at(place):
        nodes, weights = elements.weights_at(mesh, place)
        return weights @ values[nodes]

    return at


def of_cells(mesh, values):
    """Function of a position: least-squares parabola through the surrounding cell values."""
    d = mesh.dimension
    centres = np.vstack([mesh.points[c].mean(axis=1) for c in mesh.cells.values()])[:, :d]
    tree = cKDTree(centres)

    def at(place):
        far, near = tree.query(np.asarray(place, float)[:d], k=min(12 if d == 2 else 27, len(centres)))
        x = (centres[near] - np.asarray(place, float)[:d]) / far[-1]
        terms = [np.ones(len(x)), *x.T, *(x[:, i] * x[:, j] for i in range(d) for j in range(i + 1))]
        return np.linalg.lstsq(np.stack(terms, axis=1), values[near], rcond=None)[0][0]

    return at


def write_solid(folder, mesh, solid, cells, at, points=None):
    """Writes `cells` (m, 9): displacements [m] and stresses [Pa] at the cell centers. `at` returns the same at any
    position; `points` are fields at the points of a first-order mesh."""
    files.folder(folder, ".")
    fields = {
        "cell-displacement": cells[:, :3],
        "equivalent-stress": von_mises(cells[:, 3:]),
        **{f"stress-{c}": cells[:, 3 + k] for k, c in enumerate(STRESS)},
    }
    write_fields(folder, f"{solid.name}.h5", mesh, solid.time, fields, points)
    table = {"time [s]": [solid.time]}
    for name, probe in (solid.section.get("probes") or {}).items():
        found = at([number(v, f"{solid.where}.probes.{name}.point") for v in probe["point"]])
        table |= {f"{name} {c} [m]": [v] for c, v in zip("xyz"[: mesh.dimension], found)}
        table |= {f"{name} stress-{c} [Pa]": [v] for c, v in zip(STRESS, found[3:])} | {
            f"{name} equivalent-stress [Pa]": [von_mises(found[None, 3:])[0]]
        }
    write_table(folder, "probes.csv", table)
