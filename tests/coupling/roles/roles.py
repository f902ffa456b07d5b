# SPDX-License-Identifier: Apache-2.0
"""Roles given to the wrong programs: refused by name before the first step, by --check too, or the right answer.
Usage: roles.py BIN CONFIGS check | launch | flaps"""
import itertools
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
import checks  # noqa: E402
from checks import check, end, mpmd  # noqa: E402

binaries, configs = map(pathlib.Path, sys.argv[1:3])
MPIRUN = ["mpirun", "--oversubscribe"]
PATIENCE = 120  # [s] with one job: nothing here takes more than seconds
PROGRAMS = {"coupler": "coupler", "fluid": "fluid_solver", "solid": "solid_solver", "mover": "mesh_mover"}
ROLES = ("fluid", "structure", "mesh")
COARSE = {"perpendicular-flap": {"participants.fluid.mesh-parameters": "{n_side: 10, n_tip: 1, growth: 1.5, wall_growth: 1.5, wall_cells: 3}",
                                 "participants.mover.mesh-parameters": "{n_side: 10, n_tip: 1, growth: 1.5, wall_growth: 1.5, wall_cells: 3}",
                                 "participants.solid.mesh-parameters": "{n_side: 20, n_tip: 2}"},
          "two-flaps": {"participants.fluid.mesh-parameters": "{n_side: 10, n_tip: 1, n_gap: 10, growth: 1.5}",
                        "participants.mover.mesh-parameters": "{n_side: 10, n_tip: 1, n_gap: 10, growth: 1.5}",
                        "participants.front.mesh-parameters": "{n_side: 20, n_tip: 2}",
                        "participants.rear.mesh-parameters": "{x: 1, n_side: 20, n_tip: 2}"}}
SHORT = {"simulation.end-time": "0.05 s", "simulation.output.interval": "1 s", "simulation.checkpoint.interval": "0 s"}
counts = {"refused": 0, "right": 0}


def run(words, folder):
    try:
        done = subprocess.run(list(map(str, words)), cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=PATIENCE)
        return done.returncode, done.stdout
    except subprocess.TimeoutExpired as late:
        return None, (late.stdout or b"").decode() + f"\n(still running after {PATIENCE} s)"


def options(sets):
    return [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]


def job(folder, parts, sets):
    """`parts`: (program, participant) in the order of the launch line."""
    return run(mpmd([binaries / program, "case.yaml", "--participant", participant, *options(sets)] for program, participant in parts), folder)


def prepare(folder, case):
    for file in [*(configs / case).glob("*.yaml"), *(configs / case).glob("*.geo")]:
        shutil.copy(file, folder)


def tip(folder, participant):
    """At the end of the run."""
    rows = (pathlib.Path(folder) / "out" / participant / "probes.csv").read_text().splitlines()
    return float(rows[-1].split(",")[rows[0].split(",").index("tip x [m]")])


def judge(claim, code, output, names, folder, right):
    """Refused by the name of somebody and before the first step, or the right answer: `right` by participant."""
    first_step = re.search(r"step 1\b", output)
    if code == 0:
        off = max(abs(tip(folder, who) / value - 1) for who, value in right.items())
        check(claim, off < 1e-3, f"another answer, apart by {off:.1e}")
        counts["right"] += off < 1e-3
        return
    # The participant that cannot play its part is named, or the program that was started for it.
    named = any(f"'{name}'" in output or f"participants.{name}" in output or f"--participant {name}:" in output for name in names)
    good = code == 2 and named and not first_step
    check(claim, good, f"code {code}\n{output[-1500:]}")
    counts["refused"] += good


def assignments():
    """All ways to give the three roles to three participants; the first is the right one."""
    names = ("fluid", "solid", "mover")
    return sorted(itertools.product(names, repeat=3), key=lambda given: given != names)


def role_sets(given):
    return {f"coupling.{role}.participant": name for role, name in zip(ROLES, given)}


def by_check(folder):
    """What --check alone finds, by whichever program of the case."""
    prepare(folder, "perpendicular-flap")
    for given in assignments():
        codes = []
        for program in PROGRAMS.values():
            code, output = run([binaries / program, "case.yaml", "--check", *options(role_sets(given))], folder)
            codes.append(code)
        right = given == ("fluid", "solid", "mover")
        as_wanted = codes == [0 if right else 2] * 4
        counts["right" if right else "refused"] += as_wanted
        check(f"--check: fluid, structure, mesh are {', '.join(given)}", as_wanted, f"codes {codes}\n{output}")
    code, output = run([binaries / "coupler", "case.yaml", "--check", *options(role_sets(("mover", "solid", "fluid")))], folder)
    for line in ("coupling.fluid.participant: 'mover' is run by mesh_mover, which cannot be the fluid: the role 'fluid' takes "
                 "'displacement' [m] at vertices and gives a load [N] at faces; it gives no load [N] at faces",
                 "In this case 'fluid' (fluid_solver) can.",
                 "coupling.mesh.participant: 'fluid' is run by fluid_solver, which cannot be the mesh"):
        check(f"--check says: {line}", line in output, output)


def launched(folder):
    """Every program at every post: all 24 permutations, with and without the YAML's programs permuted along; and every
    assignment of roles."""
    prepare(folder, "perpendicular-flap")
    posts = list(PROGRAMS)
    sets = {**COARSE["perpendicular-flap"], **SHORT}
    code, output = job(folder, [(PROGRAMS[p], p) for p in posts], sets)
    check("the case as it is runs", code == 0, output[-2000:])
    right = {"solid": tip(folder, "solid")}
    check("its tip moves down the stream", right["solid"] > 1e-4, str(right))
    for programs in itertools.permutations(PROGRAMS.values()):
        parts = list(zip(programs, posts))
        named = {f"participants.{post}.program": program for program, post in parts if post != "coupler"}
        for how, more in (("", {}), (", the YAML too", named)):
            code, output = job(folder, parts, {**sets, **more})
            judge(f"coupler, fluid, solid, mover run by {', '.join(programs)}{how}", code, output, posts + list(programs), folder, right)
    for given in assignments():
        code, output = job(folder, [(PROGRAMS[p], p) for p in posts], {**sets, **role_sets(given)})
        judge(f"fluid, structure, mesh are {', '.join(given)}", code, output, posts, folder, right)


def two_flaps(folder):
    """Every exchange of two of the posts of the two flaps."""
    prepare(folder, "two-flaps")
    people = {"fluid": "fluid_solver", "front": "solid_solver", "rear": "solid_solver", "mover": "mesh_mover"}
    parts = [("coupler", "coupler"), *((program, name) for name, program in people.items())]
    sets = {**COARSE["two-flaps"], **SHORT, "participants.fluid.boundaries.inlet.ramp": "0.05 s"}
    post_of = ["first", "second", "third", "fluid", "mesh"]
    cast = ["fluid", "front", "rear", "fluid", "mover"]

    def tried(given):
        members, fluid, mesh = given[:3], given[3], given[4]
        return job(folder, parts, {**sets, "coupling.exchange.participants": f"[{', '.join(members)}]",
                                   "coupling.fluid.participant": fluid, "coupling.mesh.participant": mesh})

    code, output = tried(cast)
    check("two flaps: the case as it is runs", code == 0, output[-2000:])
    right = {who: tip(folder, who) for who in ("front", "rear")}
    check("its tips move", min(map(abs, right.values())) > 1e-7, str(right))
    for a, b in itertools.combinations(range(5), 2):
        given = list(cast)
        given[a], given[b] = given[b], given[a]
        if given == cast:
            continue
        code, output = tried(given)
        judge(f"two flaps: {post_of[a]} and {post_of[b]} exchanged", code, output, list(people), folder, right)
    for one, other in itertools.combinations(people, 2):
        swapped = [other if name == one else one if name == other else name for name in cast]
        code, output = tried(swapped)
        judge(f"two flaps: '{one}' and '{other}' exchanged in all roles", code, output, list(people), folder, right)


start = time.monotonic()
with tempfile.TemporaryDirectory(prefix="couplet-roles-") as scratch:
    {"check": by_check, "launch": launched, "flaps": two_flaps}[sys.argv[3]](pathlib.Path(scratch))
print(f"{counts['refused']} refused by name, {counts['right']} right, {len(checks.failed)} failed in {time.monotonic() - start:.0f} s")
end()
