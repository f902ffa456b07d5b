# SPDX-License-Identifier: Apache-2.0
"""A beam of square section, clamped at one end and bent by a dead load at the other, for CalculiX: write an input deck, read the deflection."""
import dataclasses
import math
import pathlib

import numpy as np

from calculix_plate import CORNERS, EDGES, numbers


@dataclasses.dataclass(frozen=True)
class Beam:
    """[m], [Pa]; large displacements, Saint Venant-Kirchhoff, one step that CalculiX cuts as it needs."""
    side: float = 0.2
    length: float = 2.0
    young: float = 15.293e6
    poisson: float = 0.3


CASE_E = Beam()


def write(file, across, along, element, load, beam=CASE_E):
    """Elements across x across x along of `element` (C3D8, C3D8I, C3D20). `load`: K, the force over E I / L^2, along the diagonal of the section."""
    cells = (across, across, along)
    number, step = numbers(cells, element)
    i, j, k = np.nonzero(number)
    x, y, z = beam.side * (i / (step * across) - 0.5), beam.side * (j / (step * across) - 0.5), beam.length * k / (step * along)
    first = [v.ravel() * step for v in np.meshgrid(*map(np.arange, cells), indexing="ij")]
    offsets = [tuple(step * v for v in c) for c in CORNERS]
    if step == 2:
        offsets += [tuple((p + q) // 2 for p, q in zip(offsets[e], offsets[g])) for e, g in EDGES]
    nodes = np.column_stack([number[first[0] + p, first[1] + q, first[2] + r] for p, q, r in offsets])
    share = tip_shares(across, step)
    force = load * beam.young * beam.side**4 / 12 / beam.length**2 / math.sqrt(2)
    root, tip = number[:, :, 0], number[:, :, -1]
    middle = number[step * across // 2, step * across // 2, -1]
    with open(file, "w") as out:
        out.write("*NODE,NSET=ALL\n")
        out.writelines("%d,%.12g,%.12g,%.12g\n" % row for row in zip(number[i, j, k], x, y, z))
        out.write(f"*ELEMENT,TYPE={element},ELSET=ALL\n")
        for e, row in enumerate(nodes):
            out.write(f"{e + 1}," + ",\n".join(",".join(map(str, row[n : n + 10])) for n in range(0, len(row), 10)) + "\n")
        out.write("*NSET,NSET=ROOT\n")
        out.writelines(f"{v}\n" for v in root[root > 0])
        out.write(f"*NSET,NSET=TIP\n{middle}\n*MATERIAL,NAME=M\n*ELASTIC\n{beam.young},{beam.poisson}\n"
                  "*SOLID SECTION,ELSET=ALL,MATERIAL=M\n*BOUNDARY\nROOT,1,3\n*STEP,NLGEOM,INC=1000\n*STATIC\n1.,1.\n*CLOAD\n")
        for v, s in zip(tip[tip > 0], share[tip > 0]):
            out.write(f"{v},1,{force * s:.12g}\n{v},2,{force * s:.12g}\n")
        out.write("*NODE PRINT,NSET=TIP\nU\n*END STEP\n")


def tip_shares(across, step):
    """Parts of the tip's uniform traction by node of its grid: bilinear faces a quarter a corner, those of eight nodes -1/12 a corner
    and 1/3 a side."""
    if step == 1:
        return np.outer(*([np.r_[0.5, np.ones(across - 1), 0.5]] * 2)) / across**2
    share = np.zeros((2 * across + 1, 2 * across + 1))
    for p in range(0, 2 * across, 2):
        for q in range(0, 2 * across, 2):
            share[p : p + 3 : 2, q : q + 3 : 2] -= 1 / 12
            share[p + 1, [q, q + 2]] += 1 / 3
            share[[p, p + 2], q + 1] += 1 / 3
    return share / across**2


def deflection(file, length=CASE_E.length):
    """Over the length, from the last line of the .dat file."""
    last = [line.split() for line in pathlib.Path(file).read_text().splitlines() if line.strip()][-1]
    return math.hypot(float(last[1]), float(last[2])) / length
