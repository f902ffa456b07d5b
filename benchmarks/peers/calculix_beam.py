# SPDX-License-Identifier: Apache-2.0
"""Case E, the beam bent by a dead load at its tip, for CalculiX: write an input deck, read the deflection."""
import math
import pathlib

import numpy as np

SIDE, LENGTH, YOUNG, POISSON = 0.2, 2.0, 15.293e6, 0.3


def write(file, across, along, element, load):
    """Elements across x across x along of `element` (C3D8, C3D8I); Saint Venant-Kirchhoff, large displacements, one step that
    CalculiX cuts as it needs. `load`: K, the force over E I / L^2, along the diagonal of the section."""
    n = (across + 1, across + 1, along + 1)
    number = np.arange(1, n[0] * n[1] * n[2] + 1).reshape(n)
    i, j, k = np.indices(n)
    x, y, z = SIDE * (i / across - 0.5), SIDE * (j / across - 0.5), LENGTH * k / along
    a, b, c = (v.ravel() for v in np.meshgrid(np.arange(across), np.arange(across), np.arange(along), indexing="ij"))
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    nodes = np.column_stack([number[a + p, b + q, c + r] for p, q, r in corners])
    share = np.outer(*([np.r_[0.5, np.ones(across - 1), 0.5]] * 2)) / across**2  # of the tip's uniform traction
    force = load * YOUNG * SIDE**4 / 12 / LENGTH**2 / math.sqrt(2)
    with open(file, "w") as out:
        out.write("*NODE,NSET=ALL\n")
        out.writelines("%d,%.12g,%.12g,%.12g\n" % row for row in zip(number.ravel(), x.ravel(), y.ravel(), z.ravel()))
        out.write(f"*ELEMENT,TYPE={element},ELSET=ALL\n")
        out.writelines(f"{e + 1}," + ",".join(map(str, row)) + "\n" for e, row in enumerate(nodes))
        out.write("*NSET,NSET=ROOT\n")
        out.writelines(f"{v}\n" for v in number[:, :, 0].ravel())
        out.write(f"*NSET,NSET=TIP\n{number[across // 2, across // 2, along]}\n*MATERIAL,NAME=M\n*ELASTIC\n{YOUNG},{POISSON}\n"
                  "*SOLID SECTION,ELSET=ALL,MATERIAL=M\n*BOUNDARY\nROOT,1,3\n*STEP,NLGEOM,INC=1000\n*STATIC\n1.,1.\n*CLOAD\n")
        for v, s in zip(number[:, :, along].ravel(), share.ravel()):
            out.write(f"{v},1,{force * s:.12g}\n{v},2,{force * s:.12g}\n")
        out.write("*NODE PRINT,NSET=TIP\nU\n*END STEP\n")


def deflection(file):
    """Over the length, from the last line of the .dat file."""
    last = [line.split() for line in pathlib.Path(file).read_text().splitlines() if line.strip()][-1]
    return math.hypot(float(last[1]), float(last[2])) / LENGTH
