#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A coupled run is stopped in its middle and goes on on other numbers of ranks, and from there back: its last state is that of the run
on one rank within the tolerances of its solvers (the coupling's, or what runs on those ranks that were never stopped are apart by), and
the same bits where the number stays. Files hold fields by the numbers of cells, points and faces, so that those of different ranks are
compared as they are. Coarse meshes.
Usage: ranks.py CASE CONFIGS BIN [--ranks 1,2,3]      CASE: flap, tube, fsi1"""
import pathlib
import shutil
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import COUPLED, mpmd, said  # noqa: E402

FLAP = {"n_side = 80": "n_side = 20", "n_side = 160": "n_side = 40", "n_tip = 8": "n_tip = 4", "n_tip = 16": "n_tip = 8",
        "growth = 1.12; ": "growth = 1.25; ", "wall_cells = 10": "wall_cells = 5"}
FLUIDS = ("fluid", "mover")
CASES = {  # folder, file, step [s], texts in its meshes, further keys
    "flap": ("perpendicular-flap", "case.yaml", 0.01, FLAP, []),
    "tube": ("tube-3d", "case.yaml", 1e-4, {}, [f"participants.{p}.mesh-parameters={{n: 3, n_ring: 2, n_z: 10}}" for p in FLUIDS]
             + ["participants.solid.mesh-parameters={n: 3, n_wall: 2, n_z: 10}"]),
    "fsi1": ("turek-hron", "fsi1.yaml", 0.02, {}, [f"participants.{p}.mesh-parameters={{n: 6}}" for p in FLUIDS]
             + ["participants.solid.mesh-parameters={nx: 24, ny: 3}", "coupling.convergence.relative=1e-7"]),
}
# Of what the last state holds, what users look at: by the largest value of the field.
FIELDS = {"coupler": ("now", "old"), "fluid": ("velocity", "pressure-0", "flux"), "solid": ("cell-displacement", "cell-velocity"), "mover": ("displacement",)}
STEPS = 6


class Case:
    def __init__(self, name, configs, binaries, here):
        folder, self.file, self.step, texts, self.sets = CASES[name]
        self.bin, self.here = binaries, here / folder
        shutil.copytree(configs / folder, self.here, ignore=shutil.ignore_patterns("out*"))
        if name == "fsi1":
            shutil.copytree(configs / "cfd3", here / "cfd3", ignore=shutil.ignore_patterns("out*"))
        for mesh in self.here.glob("*.geo"):
            text = mesh.read_text()
            for old, new in texts.items():
                text = text.replace(old, new)
            mesh.write_text(text)

    def run(self, out, ranks, steps, restart=None):
        """To the end of `steps`, with a checkpoint there, of which this gives the folder. Fields are written there by all runs: what a
        participant learns from them is in its state."""
        words = [f"--set={s}" for s in (*self.sets, f"simulation.end-time={steps * self.step}", "simulation.checkpoint.interval=0",
                                        f"simulation.output={{folder: {out}, interval: {STEPS // 2 * self.step}}}")]
        words += ["--restart", restart, "--restart-with-changes"] if restart else []
        said(mpmd([[self.bin / program, self.file, *words] for program in COUPLED], 4 * [ranks]), 900, cwd=self.here)
        return self.here / out / "checkpoints" / f"step-{steps:08d}"


def tables(folder):
    state = {}
    for file in sorted(folder.glob("*.h5")):
        with h5py.File(file) as data:
            data.visititems(lambda name, item: state.update({(file.stem, name): item[()]}) if isinstance(item, h5py.Dataset) else None)
    return state


def same(a, b):
    a, b = tables(a), tables(b)
    return [key for key in sorted(a.keys() | b.keys()) if key not in a or key not in b or not numpy.array_equal(a[key], b[key], equal_nan=True)]


def apart(a, b):
    """Largest differences over the largest values, and of which field."""
    a, b = tables(a), tables(b)
    found = {}
    for program, names in FIELDS.items():
        for name in names:
            one, other = (state[program, "fields/" + name] for state in (a, b))
            found[f"{program} {name}"] = numpy.abs(one - other).max() / numpy.abs(one).max()
    field = max(found, key=found.get)
    return found[field], field


def main():
    arguments = sys.argv[1:]
    chosen = [1, 2, 3]
    if "--ranks" in arguments:
        at = arguments.index("--ranks")
        chosen = [int(n) for n in arguments[at + 1].split(",")]
        del arguments[at:at + 2]
    name, configs, binaries = arguments[0], *(pathlib.Path(a).resolve() for a in arguments[1:3])
    failed = False
    with tempfile.TemporaryDirectory(prefix="couplet-ranks-") as scratch:
        case = Case(name, configs, binaries, pathlib.Path(scratch))
        half, whole = {}, {}
        for n in chosen:
            half[n] = case.run(f"half-{n}", n, STEPS // 2)
            whole[n] = case.run(f"whole-{n}", n, STEPS)
            differ = same(whole[n], case.run(f"again-{n}", n, STEPS, half[n]))
            print(f"{name}: {n} to {n}: {len(differ)} tables differ {differ[:6] if differ else ''}", flush=True)
            failed = failed or bool(differ)
        for one, other in [(chosen[0], n) for n in chosen[1:]] + [(n, chosen[0]) for n in chosen[1:]]:
            ended = case.run(f"from-{one}-to-{other}", other, STEPS, half[one])
            off, field = apart(whole[one], ended)
            ranks, _ = apart(whole[one], whole[other])
            print(f"{name}: {one} to {other}: apart by {off:.2g} ({field}); runs that never changed their ranks by {ranks:.2g}", flush=True)
            failed = failed or not off <= max(TOLERANCE, ranks)
    sys.exit(failed)


TOLERANCE = 1e-5  # of the coupling, for displacements; runs that were never stopped show what it leaves to the velocities
if __name__ == "__main__":
    main()
