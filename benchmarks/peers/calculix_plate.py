# SPDX-License-Identifier: Apache-2.0
"""Elliptic plate for CalculiX: write an input deck, read the error. Elements nr x nt x nz of one kind.
Its outer edge is clamped (plate B), or held sideways and, in a strip of height STRIP about its middle, downwards (LE10)."""
import pathlib

import numpy as np

from plate import POISSON, PRESSURE, THICKNESS, YOUNG, error, place

CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))

STRIP = 0.05  # [m]


def numbers(n, element):
    """Node number of each grid place, 0 where there is none, and the grid steps of an element."""
    step = 2 if element.startswith("C3D20") else 1
    shape = [step * m + 1 for m in n]
    i, j, k = np.indices(shape)
    there = np.ones(shape, bool) if step == 1 else i % 2 + j % 2 + k % 2 <= 1
    number = np.zeros(shape, int)
    number[there] = np.arange(1, there.sum() + 1)
    return number, step


def write(file, n, element, solver, le10=False):
    """`element`: C3D8, C3D8I or C3D20; `solver`: as CalculiX calls it; `le10`: its support, and stresses of nodes are written."""
    number, step = numbers(n, element)
    i, j, k = np.nonzero(number)
    x, y, z = place(i / (step * n[0]), j * np.pi / 2 / (step * n[1]), k * THICKNESS / (step * n[2]))
    x = np.where(j == step * n[1], 0.0, x)
    offsets = [tuple(step * a for a in c) for c in CORNERS]
    if step == 2:
        offsets += [tuple((a + b) // 2 for a, b in zip(offsets[p], offsets[q])) for p, q in EDGES]
    first = [a.ravel() * step for a in np.meshgrid(*map(np.arange, n), indexing="ij")]
    nodes = np.column_stack([number[first[0] + a, first[1] + b, first[2] + c] for a, b, c in offsets])
    up = np.arange(number.shape[2]) * THICKNESS / (step * n[2])
    strip = number[-1][:, np.abs(up - THICKNESS / 2) <= STRIP / 2 + 1e-9]
    held = "OUTER,1,2\nSTRIP,3,3" if le10 else "OUTER,1,3"
    wanted = "*EL FILE\nS" if le10 else "*NODE FILE,NSET=MIDDLE\nU"
    top = np.nonzero(first[2] == step * (n[2] - 1))[0] + 1
    with open(file, "w") as out:
        def put(head, rows):
            out.write(head + "\n")
            out.writelines(row + "\n" for row in rows)

        def rows_of(values, width):
            return (",".join(map(str, values[a : a + width])) for a in range(0, len(values), width))

        put("*NODE,NSET=ALL", ("%d,%.12g,%.12g,%.12g" % row for row in zip(number[i, j, k], x, y, z)))
        put(f"*ELEMENT,TYPE={element},ELSET=ALL",
            (f"{e + 1}," + ",\n".join(rows_of(row, 10)) for e, row in enumerate(nodes)))
        put("*ELSET,ELSET=TOP", map(str, top))
        for name, where in (("X0", number[:, -1]), ("Y0", number[:, 0]), ("OUTER", number[-1]),
                            ("MIDDLE", number[::step, ::step, step * n[2] // 2]), *((("STRIP", strip),) if le10 else ())):
            put(f"*NSET,NSET={name}", rows_of(where[where > 0], 12))
        put(f"*MATERIAL,NAME=M\n*ELASTIC\n{YOUNG},{POISSON}\n*SOLID SECTION,ELSET=ALL,MATERIAL=M\n*BOUNDARY\nX0,1,1\n"
            f"Y0,2,2\n{held}\n*STEP\n*STATIC,SOLVER={solver}\n*DLOAD\nTOP,P2,{PRESSURE}\n{wanted}\n*END STEP", ())


def stress_at(result, node, component):
    """Returns the stress of the .frd file, averaged over the surrounding elements; `component`: 0 xx, 1 yy, 2 zz, ..."""
    rows = pathlib.Path(result).read_text().split("STRESS", 1)[1].split("\n -3", 1)[0].splitlines()
    return next(float(row[13 + 12 * component : 25 + 12 * component]) for row in rows if row.startswith(" -1") and int(row[3:13]) == node)


def plate_error(result, n, element):
    """Nodal values of the middle plane from the .frd file."""
    number, step = numbers(n, element)
    middle = number[::step, ::step, step * n[2] // 2]
    found, reading = {}, False
    for line in pathlib.Path(result).read_text().splitlines():
        if line.startswith(" -4"):
            reading = line.split()[1] == "DISP"
        elif reading and line.startswith(" -1"):
            found[int(line[3:13])] = [float(line[13 + 12 * c : 25 + 12 * c]) for c in range(3)]
    u = np.array([[found[node] for node in row] for row in middle])
    return error(np.linspace(0, 1, n[0] + 1), np.linspace(0, np.pi / 2, n[1] + 1), u)
