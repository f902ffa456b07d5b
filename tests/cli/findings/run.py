# SPDX-License-Identifier: Apache-2.0
"""Findings act: exit code 4 for a useless answer, what is accepted passes, what is neglected is another channel, ten halvings end a run,
all programs of a job agree. Each is shown to fire and not to fire.
Usage: run.py BIN CONFIGS accept|strict|stress|scenes|sound|plant|coupled|effects|resumed"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import types

import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[3] / place) for place in ("client/python", "scripts")]
import scenes  # noqa: E402
from checks import check, end, mpmd  # noqa: E402
import atlas  # noqa: E402
from validation.parts import effects  # noqa: E402

LE1 = 92.66e6  # Pa, stress yy at D (NAFEMS); the other components are zero there
programs, configs, kind = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]


def run(program, case, *words, sets=()):
    """Exit code, all text, and the findings of run.json of each participant by id."""
    case = case if isinstance(case, pathlib.Path) else configs / case / "case.yaml"
    with tempfile.TemporaryDirectory() as folder:
        names = [program] if isinstance(program, str) else program
        common = [str(case), *(f"--set={s}" for s in sets), f"--set=simulation.output.folder={folder}", *words]
        parts = [[programs / name, *common] for name in names]
        line = mpmd(parts) if len(parts) > 1 else parts[0]
        done = subprocess.run(line, capture_output=True, text=True, timeout=280)
        reports = {f.parent.name: json.loads(f.read_text()) for f in pathlib.Path(folder).glob("*/run.json")}
    found = {name: {f["id"]: f for f in r["findings"]} for name, r in reports.items()}
    return done.returncode, done.stdout + done.stderr, found


def beam(step, length):
    return ["participants.solid.mesh-parameters={n_length: 20, n_side: 2}", f"simulation.time-step={step}", f"simulation.end-time={length}"]


def accept():
    """An estimated error as large as the solution."""
    useless = beam(10, 200)
    code, text, found = run("solid_solver", "vibrating-cantilever", sets=useless)
    finding = found["solid"].get("error-estimate", {})
    check("a useless answer ends with exit code 4", code == 4 and "The result is useless (error-estimate" in text, code)
    check("run.json lists it", finding.get("severity") == "wrong" and finding["number"] >= finding["limit"] == 1 and not finding["accepted"], finding)
    code, text, found = run("solid_solver", "vibrating-cantilever", "--accept", "error-estimate", sets=useless)
    check("--accept lets it pass", code == 0 and found["solid"]["error-estimate"]["accepted"] and "[error-estimate, accepted]" in text, code)
    code, _, found = run("solid_solver", "vibrating-cantilever", "--strict", sets=[*useless, "simulation.accept=[error-estimate, unseen-between-steps]"])
    check("simulation.accept lets it pass, with --strict as well", code == 0 and found["solid"]["error-estimate"]["accepted"], (code, found))
    code, _, found = run("solid_solver", "vibrating-cantilever", "--accept", "heat-swing", sets=useless)
    check("another id does not", code == 4, code)
    code, _, found = run("solid_solver", "vibrating-cantilever", sets=beam(0.5, 20))
    check("a sound answer ends with exit code 0", code == 0 and "error-estimate" not in found["solid"], (code, found))
    for words, sets in ((["--accept", "error-estimat"], []), ([], ["simulation.accept=[error-estimat]"])):
        code, text, _ = run("solid_solver", "vibrating-cantilever", *words, sets=[*useless, *sets])
        check(f"an unknown id is refused {words}", code == 2 and "did you mean 'error-estimate'?" in text and "heat-swing" in text, (code, text[-300:]))


def strict():
    """A large displacement gradient in a linear run is an opinion; a given step beyond its limit is about the answer."""
    pulled = ["simulation.end-time=1", "participants.solid.mesh-parameters={n_length: 10, n_side: 1}", "participants.solid.boundaries.tip.value=[6e5, 0, 0]"]
    code, _, found = run("solid_solver", "cantilever", "--strict", sets=pulled)
    check("--strict lets an opinion pass", code == 0 and found["solid"]["geometric-non-linearity"]["neglected-effect"], (code, found))
    code, text, _ = run("solid_solver", "cantilever", "--strict=effects", sets=pulled)
    check("--strict=effects counts it", code == 1 and "geometric-non-linearity" in text.splitlines()[-1], (code, text[-200:]))
    code, _, _ = run("solid_solver", "cantilever", "--strict=effects", "--accept", "geometric-non-linearity", sets=pulled)
    check("and lets it pass where it is accepted", code == 0, code)
    code, text, _ = run("solid_solver", "cantilever", "--strict=all", sets=pulled)
    check("--strict=all is refused", code == 2 and "--strict=effects" in text, (code, text[-200:]))
    slow = [*pulled[:2], "participants.solid.boundaries.tip.value=[1e3, 0, 0]"]
    code, _, found = run("solid_solver", "cantilever", "--strict=effects", sets=slow)
    check("a small load passes --strict=effects", code == 0 and all(f["severity"] == "note" or f["accepted"] for f in found["solid"].values()), (code, found))


def stress():
    """LE1's stress at D, 92.66 MPa: its estimated error is near the true one, a coarse mesh is told as doubtful, a fine one is not."""
    for rings in (8, 16):
        _, _, found = run("solid_solver", "le1", sets=[f"participants.solid.mesh-parameters={{nr: {rings}, nt: {3 * rings // 2}}}"])
        finding = found["solid"]["stress-error"]
        value = float(re.search(r": (\S+) Pa at \(2, 0, 0\)", finding["sentence"]).group(1))
        truth = abs(value / LE1 - 1)
        check(f"{rings} cells across: estimated and true error", truth / 3 < finding["number"] < 3 * truth, (finding, truth))
    code, _, _ = run("solid_solver", "le1", "--strict", sets=["participants.solid.mesh-parameters={nr: 4, nt: 6}"])
    check("a coarse mesh is doubtful", code == 1, code)
    code, text, _ = run("solid_solver", "le1", "--strict")
    check("the shipped one is not", code == 0, (code, text[-300:]))


def in_folder(make, program, *words, sets=()):
    with tempfile.TemporaryDirectory() as folder:
        return run(program, make(pathlib.Path(folder)), *words, sets=sets)


def scenes_():
    code, text, _ = in_folder(scenes.folded, "mesh_mover")
    check("a folded mesh does not run in the mover alone", code != 0 and "folded at (0" in text, (code, text[-300:]))
    code, text, _ = in_folder(lambda f: scenes.folded(f, fold=False), "mesh_mover")
    check("the same mesh without the fold does", code == 0, (code, text[-300:]))
    code, text, found = in_folder(scenes.pushed_in, "mesh_mover")
    check("a cell that the motion folds at a corner is a finding", code == 0 and -0.3 < found["mover"].get("distorted-mesh", {}).get("number", 0) < -0.2, (code, found, text[-300:]))
    code, text, found = in_folder(scenes.explicit_step, "fluid_solver")
    check("an explicit step far beyond its limit ends the run with its cause",
          code == 1 and "10 halvings of the step for one cause did not help: The flow diverges" in text, (code, text[-400:]))
    code, text, found = in_folder(lambda f: scenes.explicit_step(f, 0.002), "fluid_solver")
    check("a step below its limit runs", code == 0 and not found["fluid"], (code, found, text[-300:]))
    for case in ("oscillating-cylinder", "pitching-plate"):
        text = subprocess.run([str(programs / "fluid_solver"), str(configs / case / "case.yaml"), "--explain"], capture_output=True, text=True,
                              timeout=60).stdout
        check(f"--explain: {case} moves its mesh", "on   mesh-motion: " in text, text[-300:])


def sound():
    code, text, found = in_folder(scenes.duct, "fluid_solver", "--strict")
    mach = found["fluid"].get("compressibility", {})
    check("SF6 at 48 m/s is flagged by its own speed of sound", 0.06 < mach.get("share", 0) < 0.08 and "air" not in mach["sentence"], mach)
    # On so coarse a mesh the estimated error is 0.18: that alone, no neglected effect, is what --strict ends on.
    check("neglected effects alone do not fail under --strict", code == int("error-estimate" in found["fluid"]), (code, found))
    code, text, found = in_folder(scenes.duct, "fluid_solver", sets=["participants.fluid.density=1.2", "participants.fluid.viscosity=1.8e-5"])
    check("air at 48 m/s is not", "compressibility" not in found["fluid"], found)
    code, _, found = in_folder(scenes.duct, "fluid_solver", sets=["participants.fluid.compressibility={speed-of-sound: 135 m/s}"])
    check("by its speed", "compressibility" in found["fluid"], found)
    code, _, found = in_folder(scenes.duct, "fluid_solver", sets=["participants.fluid.compressibility={speed-of-sound: 1000}"])
    check("by key", "compressibility" not in found["fluid"], found)
    code, text, found = run("fluid_solver", "perpendicular-flap", "--participant", "fluid", sets=["simulation.end-time=0.02", "simulation.checkpoint.interval=0"])
    check("a fluid of 1 kg/m^3 and 1 Pa s is no air", code == 0 and not {"compressibility", "waves-of-pressure"} & set(found["fluid"]) and " air" not in text,
          (code, found))


def plant():
    """Few cells and the upwind scheme spread a front that the plant's control sees: half of the exergy is lost with 60 cells (atlas, tank-plant)."""
    def case(folder, advection):
        file = folder / "case.yaml"
        square = atlas.maps()["tank-plant"]
        file.write_text(yaml.safe_dump(square.case(advection, square.names(advection, 60, 5))[0]))
        return file
    for advection, warned in (("upwind", True), ("tvd", False)):
        code, text, found = in_folder(lambda f: case(f, advection), "thermocline")  # noqa: B023
        number = found["tank"].get("error-estimate", {}).get("number", 0)
        check(f"a plant's tank of 60 cells, {advection}", code == 0 and (number > 0.2 if warned else number == 0), (code, number, text[-300:]))


def coupled():
    """All programs end with the code of the one that has the finding; mpirun shows the first that is not 0."""
    programs_ = scenes.WRONG_COUPLED["programs"]
    code, text, found = in_folder(scenes.wrong_coupled, programs_)
    ids = {i for f in found.values() for i, v in f.items() if v["severity"] == "wrong"}
    check("a coupled job with a useless answer ends with exit code 4", code == 4 and ids == {scenes.WRONG_COUPLED["id"]}, (code, ids, text[-500:]))
    check("the coupler writes run.json, too", "coupler" in found, list(found))
    code, text, found = in_folder(scenes.wrong_coupled, programs_, "--accept", scenes.WRONG_COUPLED["id"])
    check("accepted by all it ends with 0", code == 0, (code, text[-300:]))


def effects_():
    """Effects of scripts/validation/effects/scenes.yaml are named where they matter, and only there."""
    judged = ("inertia", "storage-of-heat", "resolved-grains", "waves-of-pressure", "shear-and-rotary-inertia")
    with tempfile.TemporaryDirectory() as folder:
        job = types.SimpleNamespace(root=configs.parent, build=programs.parent, scratch=pathlib.Path(folder))
        for name, one in effects.scenes().items():
            if one["effect"] in judged:
                share = effects.said(job, name, one)
                check(f"{name}: {one['truth']:g}", 0.05 <= one["truth"] < effects.MATTERS or (share is not None) == (one["truth"] >= effects.MATTERS), share)
        pebbles = {**effects.scenes()["bed of pebbles of one temperature each"], "effect": "range-of-the-film-correlation"}
        fast = {"flow.rows": [{"at": "0 s", "mass-flow": "2 kg/s", "inlet-temperature": "300 K"}]}
        for reynolds, more in ((5, {}), (51, fast)):
            share = effects.said(job, f"Re {reynolds}", {**pebbles, "set": {**pebbles["set"], **more}})
            check(f"film correlation at Re {reynolds}, fitted from 15", (share is not None) == (reynolds < 15), share)


def resumed():
    """The energy of a stiffer material is no growth, and the change is a finding."""
    sets = [*beam(0.5, 12), "simulation.checkpoint.interval=6"]
    with tempfile.TemporaryDirectory() as folder:
        line = [programs / "solid_solver", configs / "vibrating-cantilever/case.yaml", *(f"--set={s}" for s in sets), f"--set=simulation.output.folder={folder}/out"]
        subprocess.run([*line, "--set=simulation.end-time=6"], capture_output=True, check=True)
        done = subprocess.run([*line, "--set=participants.solid.material.youngs-modulus=20 MPa", "--restart", f"{folder}/out/checkpoints", "--restart-with-changes"],
                              capture_output=True, text=True)
        report = pathlib.Path(f"{folder}/out/solid/run.json")
        ids = {f["id"] for f in json.loads(report.read_text())["findings"]} if report.exists() else done.stdout[-400:]
    check("resumed with another modulus", done.returncode == 0 and "changed-since-checkpoint" in ids and "energy-growth" not in ids, (done.returncode, ids))


{"accept": accept, "strict": strict, "stress": stress, "scenes": scenes_, "sound": sound, "plant": plant, "coupled": coupled, "effects": effects_, "resumed": resumed}[kind]()
end()
