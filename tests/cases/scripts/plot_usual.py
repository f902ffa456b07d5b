# SPDX-License-Identifier: Apache-2.0
"""The pictures of a run whose case declares none: what of a run they show, and the cut of a plane through any mesh."""
import argparse
import pathlib
import sys
import tempfile

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "tests/support")]
from checks import check, end  # noqa: E402
from command import couplet  # noqa: E402
from couplet import fields  # noqa: E402
from couplet.plots import space, usual  # noqa: E402
from couplet.runs.case import Wrong  # noqa: E402
from couplet.series import FieldSeries  # noqa: E402

TRIANGLE, SQUARE, TETRAHEDRON, HEXAHEDRON = 4, 5, 6, 9  # XDMF codes
CUBES = np.array([[x, y, z] for z in (0, 1, 2) for y in (0, 1) for x in (0, 1, 2)], float)
BRICKS = [[a, a + 1, a + 4, a + 3, a + 6, a + 7, a + 10, a + 9] for layer in (0, 6) for a in (layer, layer + 1)]
SIX = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))  # tetrahedra of a hexahedron
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
FLAT = np.array([[x, y, 0.0] for y in (0, 1) for x in (0, 1, 2)])


def write(file, kind, cells, points, times, at_cells=None, at_points=None):
    """A series whose fields grow with time. Returns it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with h5py.File(file, "w") as made:
        made.attrs["format"], made.attrs["kind"] = "couplet fields", kind
        made["mesh/cells"], made["mesh/coordinates"] = np.array(cells), points
        for k, time in enumerate(times):
            step = made.create_group(f"steps/{k:06d}")
            step.attrs["time"] = float(time)
            for place, some in (("cells", at_cells), ("points", at_points)):
                for name, values in (some or {}).items():
                    step[f"{place}/{name}"] = time * np.asarray(values, float)
                    step[f"{place}/{name}"].attrs["unit"] = {"equivalent-stress": "Pa", "displacement": "m"}.get(name, "")
    return FieldSeries(file)


def area(c):
    return 0.5 * abs(np.dot(c[:, 0], np.roll(c[:, 1], 1)) - np.dot(c[:, 1], np.roll(c[:, 0], 1)))


def refused(words, function):
    try:
        function()
    except Wrong as problem:
        return words in str(problem)
    return False


argparse.ArgumentParser(description=__doc__).parse_args()
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    block = write(folder / "block.h5", HEXAHEDRON, BRICKS, CUBES, [1], {"p": range(4)})
    # Faces in the plane belong to the cells above it, else to those below; inside of cells it cuts them.
    for plane, wanted in (("z = 1", [2, 3]), ("z = 2", [2, 3]), ("y=0", [0, 1, 2, 3]), ("x = 1", [1, 3]), ("z = 0.3", [0, 1]), ("y = 0.5", [0, 1, 2, 3])):
        corners, cells, ways = space.polygons_of(block, CUBES, plane, "")
        areas = [area(c) for c in corners]
        check(f"hexahedra cut by {plane}", list(cells) == wanted and np.allclose(areas, 1) and plane[0] not in ways, (cells, areas, ways))
    for plane, words in (("z = 2.5", "no cell meets the plane z = 2.5: z goes from 0 to 2 m"), ("z", "expected a plane such as y = 0"), ("r = 1", "expected a plane such as y = 0")):
        check(f"no cut by {plane}", refused(words, lambda: space.polygons_of(block, CUBES, plane, "")))

    tetrahedra = write(folder / "tetrahedra.h5", TETRAHEDRON, [[brick[k] for k in four] for brick in BRICKS for four in SIX], CUBES, [1], {"p": range(24)})
    for plane, whole in (("y = 0.3", 4), ("z = 1.7", 2), ("x = 0.01", 2), ("z = 1", 2), ("x = 0", 2)):
        corners, cells, _ = space.polygons_of(tetrahedra, CUBES, plane, "")
        check(f"tetrahedra cut by {plane}: no gap and no overlap", np.isclose(sum(map(area, corners)), whole) and len(set(cells)) == len(cells), list(map(area, corners)))
    moved = CUBES * [2, 1, 1]
    check("the cut follows points that moved", np.isclose(sum(map(area, space.polygons_of(tetrahedra, moved, "y = 0.3", "")[0])), 8))
    faces = space.outer_faces(tetrahedra)
    check("outer faces: two triangles for each of 16 squares", len(faces) == 2 * 16 and len(space.outer_faces(block)) == 16, len(faces))
    shell = write(folder / "shell.h5", TRIANGLE, [[0, 1, 4], [0, 4, 3]], CUBES, [1], {"p": [1, 2]})
    check("a shell is its own surface", [face for face, _ in space.outer_faces(shell)] == [[0, 1, 4], [0, 4, 3]])

    # a run: flow, body, coupling and a plate with its shapes
    out = folder / "out"
    write(out / "fluid/fluid.h5", SQUARE, QUADS, FLAT, [0, 1], {"pressure": [1, 2], "velocity": [[1, 0, 0], [2, 0, 0]]})
    move = np.column_stack([0 * FLAT[:, 0], 1e-4 * FLAT[:, 0], 0 * FLAT[:, 0]])
    solid = write(out / "solid/solid.h5", SQUARE, QUADS, FLAT - [0, 1, 0], [0, 1], {"equivalent-stress": [1e6, 3e6]}, {"displacement": move, "temperature": [5] * 6})
    still = write(out / "still/still.h5", SQUARE, QUADS, FLAT, [0, 1], {"equivalent-stress": [0, 0]}, {"displacement": 0 * move})
    heat = write(out / "heat/heat.h5", SQUARE, QUADS, FLAT, [0, 1], {"cell-temperature": [1, 2]}, {"temperature": range(6)})
    shape = np.column_stack([FLAT[:, :2] * 0, FLAT[:, 0]])
    plate = write(out / "plate/mode-shapes.h5", SQUARE, QUADS, FLAT, [1], None, {f"mode-{k}": shape for k in range(1, 10)})
    (out / "plate/modes.csv").write_text("number,frequency [Hz]\n" + "".join(f"{k},{0 if k < 7 else 10 * k}\n" for k in range(1, 10)))
    shapes, rigid = fields.shapes_of(plate, out / "plate/mode-shapes.h5")
    check("shapes without rigid motions, with their frequencies", rigid == 6 and shapes == [((0, f"mode-{k}"), 10 * k, k) for k in (7, 8, 9)], shapes)
    flow = FieldSeries(out / "fluid/fluid.h5")
    check("fields that have a picture", [usual.names_of(s) for s in (flow, solid, still, heat)] == [["velocity"], ["equivalent-stress"], [], ["temperature"]], [usual.names_of(s) for s in (flow, solid, still, heat)])
    check("the bodies in a flow", list(fields.bodies_beside(flow)) == ["solid", "still"] and not fields.bodies_beside(solid), fields.bodies_beside(flow))
    check("a small displacement is drawn enlarged by a round factor", fields.warp_of(solid, 1) == 1000 and fields.warp_of(still, 1) == 1)
    check("a flow in 3-D is cut in its middle, across its shortest extent", usual.middle_of(block) == "y = 0.5" and usual.middle_of(flow) is None, usual.middle_of(block))
    check("stress in MPa", fields.with_prefix(np.array([3e6]), "equivalent-stress [Pa]") == (np.array([3.0]), "equivalent stress [MPa]"))
    check("small displacements in mm", fields.with_prefix(np.array([2e-3]), "displacement [m]") == (np.array([2.0]), "displacement [mm]"))
    done = couplet("plot", out)
    made = sorted(str(f.relative_to(out)) for f in out.rglob("*.png"))
    check("pictures of the run", done.returncode == 0 and made == ["fluid/velocity.png", "heat/temperature.png", "plate/mode-shapes.png", "solid/equivalent-stress.png"], (made, done))
    check("their names are printed", all(str(out / picture) in done.stdout for picture in made), done.stdout)
    done = couplet("plot", out, "--field", "equivalent-stress", "--picture", folder / "one.png")
    check("--field finds the participant that has the field", done.returncode == 0 and (folder / "one.png").exists(), done.stderr)
    done = couplet("plot", folder / "out", "--field", "velocity", "--plane", "y = 0")
    check("--plane of a 2-D run", done.returncode != 0 and "two-dimensional" in done.stderr, done.stderr)
    (folder / "inside").mkdir()
    (folder / "tetrahedra.h5").rename(folder / "inside/tetrahedra.h5")
    done = couplet("plot", folder / "inside", "--field", "p", "--plane", "y = 0.3", "--picture", folder / "cut.png")
    check("--plane in tetrahedra", done.returncode == 0 and (folder / "cut.png").exists(), done.stderr)

    content = (out / "heat/heat.h5").read_bytes()
    (out / "torn").mkdir()
    (out / "torn/torn.h5").write_bytes(content[: len(content) // 2])
    done = couplet("plot", out)
    check("a damaged file is named, the rest is drawn", done.returncode == 0 and "torn: fields cannot be drawn" in done.stderr and "velocity.png" in done.stdout, done)
    plate.file.close()
    with h5py.File(out / "plate/mode-shapes.h5", "a") as file:
        file["mesh/cells"][0, 0] = 99
    done = couplet("plot", out / "plate")
    check("so is one with a wrong number", done.returncode == 1 and "plate: fields cannot be drawn" in done.stderr and "Traceback" not in done.stderr, done)

    # mesh lines hide the colors of a fine mesh
    import matplotlib.pyplot as plt

    def collections(count):
        axes = plt.figure().add_subplot()
        space.flat_map(axes, [np.array([[k, 0], [k + 1, 0], [k, 1]]) for k in range(count)], np.arange(float(count)), lines="black")
        plt.close()
        return len(axes.collections)

    check("mesh lines of 5000 cells at most", [collections(n) for n in (5000, 5001)] == [2, 1])
    size = space.shape_of(np.array([[0, 0, 0], [50, 1, 0]]))[0]
    tall = space.shape_of(np.array([[0, 0, 0], [1, 50, 0]]))[0]
    check("the picture has the shape of a slender body", size[0] > 4 * size[1] and tall[1] > 1.5 * tall[0], (size, tall))
end()
