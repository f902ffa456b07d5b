# SPDX-License-Identifier: Apache-2.0
"""Static solids as CalculiX input, and its results. Tractions and pressures become work-equivalent nodal forces
(integrated over the faces with their shape functions). CalculiX reads at most 20 characters per field, so numbers have
13 digits."""
import pathlib
import re

import numpy as np

from couplet import files
from couplet.peers.elements import CORNERS, EDGES
from couplet.peers.results import at_middles, of_points, write_solid
from couplet.peers.values import refuse

# Elements by the shape of cells: (kind, order of the mesh). {p} is S in plane stress, E in plane strain.
ELEMENTS = {
    "quadrilateral": (("CP{p}4", 1), ("C3D8I", 1), ("CP{p}8R", 2)),
    "triangle": (("CP{p}3", 1), ("CP{p}6", 2)),
    "hexahedron": (("C3D8I", 1), ("C3D20R", 2)),
    "tetrahedron": (("C3D4", 1), ("C3D10", 2)),
    "prism": (("C3D6", 1), ("C3D15", 2)),
}
MIDDLES = {
    "tetrahedron": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "hexahedron": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    "prism": ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
}
# relative thickness of a plane body: CalculiX expands plane elements to bricks, whose faces tilt if they thin unevenly
THIN = 0.1


def kinds(solid):
    """Returns [(element, order)] for the cells of a case. Meshes with several shapes are rejected."""
    shapes = list(solid.mesh(1).cells)
    if len(shapes) > 1:
        refuse(f"{solid.where}.mesh", f"cells of several shapes ({', '.join(shapes)}) are not exported to CalculiX")
    return [(name.format(p="S" if solid.plane == "stress" else "E"), order) for name, order in ELEMENTS[shapes[0]]]


class Input:
    """Input of one solid with one kind of element."""

    def __init__(self, solid, element):
        self.solid, self.element = solid, element
        order = dict(kinds(solid)).get(element)
        if order is None:
            refuse(
                "--element",
                f"'{element}' does not fit the cells of the mesh; use one of {', '.join(k for k, _ in kinds(solid))}",
            )
        self.flat = solid.mesh(order)
        self.layer = solid.dimension == 2 and element.startswith("C3D")
        self.depth = THIN * self.flat.size() if solid.dimension == 2 else 1.0
        self.body = self.flat.extruded(self.depth) if self.layer else self.flat

    def connections(self):
        """Returns (m, points) in CalculiX's order, numbered from 1."""
        ((shape, cells),) = self.body.cells.items()
        n = CORNERS[shape]
        if self.body.order == 2 and shape in MIDDLES:
            ours = {frozenset(e): k for k, e in enumerate(EDGES[shape])}
            cells = np.hstack([cells[:, :n], cells[:, [n + ours[frozenset(e)] for e in MIDDLES[shape]]]])
        return cells + 1

    def held(self):
        """Returns {(node, axis): displacement} prescribed by the case and through the thickness of a plane body."""
        found, n = self.solid.prescribed(self.body), len(self.flat.points)
        if self.layer:
            found |= {(node, 2): 0.0 for node in range(n if self.solid.plane == "stress" else 2 * n)}
        return found

    def solver(self):
        iterative = self.solid.dimension == 3 and self.body.order == 1 and not self.layer
        return "ITERATIVE CHOLESKY" if iterative else "SPOOLES"

    def text(self):
        points, cells, solid = self.body.points, self.connections(), self.solid
        lines = [
            "** written by couplet export",
            "*NODE, NSET=ALL",
            *("%d, %.13g, %.13g, %.13g" % (i + 1, *p) for i, p in enumerate(points)),
            f"*ELEMENT, TYPE={self.element}, ELSET=ALL",
        ]
        for i, row in enumerate(cells.tolist()):
            words = [str(i + 1), *map(str, row)]
            lines += [
                ", ".join(words[:12]) + ("," if len(words) > 12 else ""),
                *([", ".join(words[12:])] if len(words) > 12 else []),
            ]
        lines += [
            "*MATERIAL, NAME=M",
            "*ELASTIC",
            f"{solid.young:.13g}, {solid.poisson:.13g}",
            "*DENSITY",
            f"{solid.density:.13g}",
            "*SOLID SECTION, ELSET=ALL, MATERIAL=M",
            *([f"{self.depth:.13g}"] if not self.layer and solid.dimension == 2 else []),
            "*BOUNDARY",
            *(f"{n + 1}, {a + 1}, {a + 1}, {v:.13g}" for (n, a), v in sorted(self.held().items())),
            "*STEP",
            f"*STATIC, SOLVER={self.solver()}",
        ]
        forces = solid.forces(self.body) * (1 if self.layer else self.depth)
        loads = [f"{n + 1}, {a + 1}, {forces[n, a]:.13g}" for n, a in zip(*np.nonzero(forces))]
        lines += ["*CLOAD", *loads] if loads else []
        g = solid.gravity()
        if np.any(g):
            size = np.linalg.norm(g)
            lines += ["*DLOAD", "ALL, GRAV, " + ", ".join(f"{v:.13g}" for v in (size, *(g / size)))]
        plane = ", OUTPUT=2D" if not self.layer and solid.dimension == 2 else ""
        return "\n".join([*lines, f"*NODE FILE{plane}", "U", f"*EL FILE{plane}", "S", "*END STEP"]) + "\n"

    def write(self, folder):
        """Writes <folder>/case.inp. Run it there with `ccx case`."""
        folder = pathlib.Path(folder)
        files.write(files.folder(folder, "."), "case.inp", self.text())
        return ["ccx", "case"]

    def read(self, folder, out):
        """Writes the results in `folder` to the participant's folder `out` in the format of our programs."""
        n = len(self.flat.points)
        u, s = read_frd(pathlib.Path(folder) / "case.frd", len(self.body.points))
        if self.layer:
            u, s = (u[:n] + u[n:]) / 2, (s[:n] + s[n:]) / 2
        if not np.isfinite(u).all() or not np.isfinite(s).all():
            raise ValueError("the results of CalculiX are not complete")
        both = np.hstack([u, s])
        write_solid(
            out,
            self.flat,
            self.solid,
            at_middles(self.flat, both),
            of_points(self.flat, both),
            {"displacement": u} if self.flat.order == 1 else None,
        )


def read_frd(file, count):
    """Displacements (count, 3) and stresses (count, 6: xx, yy, zz, xy, yz, xz) of the points 1 to count."""
    found = {"DISP": np.full((count, 3), np.nan), "STRESS": np.full((count, 6), np.nan)}
    text = pathlib.Path(file).read_text()
    for name, body in re.findall(r"^ -4  (DISP|STRESS) .*?\n(.*?)^ -3", text, re.M | re.S):
        for line in body.splitlines():
            if line.startswith(" -1"):
                node = int(line[3:13])
                if node <= count:
                    width = found[name].shape[1]
                    found[name][node - 1] = [float(line[13 + 12 * k : 25 + 12 * k]) for k in range(width)]
    return found["DISP"], found["STRESS"]
