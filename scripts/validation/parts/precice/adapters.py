# SPDX-License-Identifier: Apache-2.0
"""Adapters of preCICE in solvers of others, unchanged, beside programs of this project. COUPLET_PRECICE_CALCULIX names ccx_preCICE, which was built
from the adapter and CalculiX against build/precice; COUPLET_PRECICE_OPENFOAM libpreciceAdapterFunctionObject.so, which was built from the adapter and OpenFOAM's headers
against build/precice and the installed libraries; COUPLET_PRECICE_TUTORIALS the tutorials.
Without them the rows report that."""
import os
import pathlib
import re
import shutil

from validation.parts.precice.programs import NOTE, commit_of, folder, passes

PUBLISHED = {
    "first": (0.198, 0.74),
    "second": (0.184, 2.36),
}  # OpenFOAM and CalculiX: tip of the flap [m] at [s], read off the tutorial's plot to 0.002 m
TIP = 489  # the node at (0, 1) in solid-calculix/all.msh

COUPLING = """coupling:
  scheme: semi-implicit
  fluid: {participant: fluid}
  structure: {participant: Solid, displacement: Displacement, load: Force}
  mesh: {participant: mover}
  mapping: {type: projection}
  convergence: {relative: 1e-4, max-iterations: 30}
"""
UNDER_OPENFOAM = """coupling:
  scheme: implicit
  fluid: {participant: Fluid, displacement: Displacement, load: Force}
  structure: {participant: solid}
  mapping: {type: projection}
  convergence: {relative: 1e-4, max-iterations: 30}
"""


def flap_case(text, *others):
    """configs/perpendicular-flap to 2.5 s with the tutorial's participant in place of one of ours; `others`: (pattern, replacement) of the participants and the coupling."""
    for what, by in (
        *others,
        (r"\nplot:(.*\n)+", "\n"),
        (r"checkpoint: .*", "checkpoint: {interval: 0}"),
        (r"interval: 0.05 s", "interval: 1 s"),
        (r"end-time: 5 s", "end-time: 2.5 s"),
    ):
        text, found = re.subn(what, by, text)
        if found != 1:
            raise RuntimeError(f"the case of the flap has {found} places like {what}")
    return text


def libraries(job):
    return f"{job.build}/precice/lib:{os.environ.get('LD_LIBRARY_PATH', '')}"


def motion_of(frd, node):
    """Returns (time, x displacement) of each step of CalculiX's result file."""
    rows, time, displacement = [], 0.0, False
    with open(frd, errors="replace") as lines:
        for line in lines:
            if line[2:7] == "100CL":
                time = float(line[12:24])
            elif line.startswith(" -4"):
                displacement = "DISP" in line
            elif displacement and line.startswith(" -1") and int(line[3:13]) == node:
                rows.append((time, float(line[13:25])))
    return rows


def calculix(job):
    source, program = folder("COUPLET_PRECICE_TUTORIALS"), os.environ.get("COUPLET_PRECICE_CALCULIX")
    if source is None:
        return NOTE.format("COUPLET_PRECICE_TUTORIALS"), None
    if not program or not os.access(program, os.X_OK):
        return NOTE.format("COUPLET_PRECICE_CALCULIX"), None
    where = job.scratch / "flap-calculix"
    shutil.copytree(source / "perpendicular-flap/solid-calculix", where / "solid-calculix")
    shutil.copy(source / "perpendicular-flap/precice-config.xml", where)
    ours = job.root / "configs/perpendicular-flap"
    shutil.copy(ours / "fluid.geo", where)
    case = where / "case.yaml"
    case.write_text(
        flap_case(
            (ours / "case.yaml").read_text(),
            (r"  solid:\n(    .*\n)+", "  Solid: {program: precice}\n"),
            (r"coupling:\n(  .*\n)+", COUPLING),
        )
    )
    line = ["mpirun", "--oversubscribe", *(["--allow-run-as-root"] if os.geteuid() == 0 else [])]
    for i, name in enumerate(("coupler", "fluid_solver", "mesh_mover")):
        line += [":"] * (i > 0) + ["-n", "1", job.build / "bin" / name, case]
    line += [
        ":",
        "-n",
        "1",
        "sh",
        "-c",
        (
            f"cd solid-calculix && LD_LIBRARY_PATH={libraries(job)} OMP_NUM_THREADS=1 exec"
            f" {pathlib.Path(program).resolve()} -i flap -precice-participant Solid > ccx.log"
        ),
    ]
    done = job.done(line, cwd=where)
    return bent(job, source, motion_of(where / "solid-calculix/flap.frd", TIP), done.stdout + done.stderr)


def bent(job, source, rows, said):
    """The verdict on (time, x displacement) of the flap's tip."""
    found = {
        "first": max((r for r in rows if r[0] < 1.5), key=lambda r: r[1]),
        "second": max((r for r in rows if r[0] > 1.5), key=lambda r: r[1]),
    }
    off = max(abs(x / PUBLISHED[name][0] - 1) for name, (_, x) in found.items())
    text = ", ".join(f"{x:.4f} m at {t:.2f} s" for t, x in found.values())
    return (
        f"{text}: {100 * off:.1f} % off; {len(rows)} steps, {passes(said):.2f} coupling iterations per step{commit_of(source, job)}",
        len(rows) == 250 and off < 0.02,
    )


def openfoam(job, solid):
    """pimpleFoam of Debian's OpenFOAM 1912 with preCICE's adapter, on our solid or on CalculiX with its adapter."""
    source, adapter, program = (
        folder("COUPLET_PRECICE_TUTORIALS"),
        os.environ.get("COUPLET_PRECICE_OPENFOAM"),
        os.environ.get("COUPLET_PRECICE_CALCULIX"),
    )
    if source is None:
        return NOTE.format("COUPLET_PRECICE_TUTORIALS"), None
    if not adapter or not os.access(adapter, os.R_OK):
        return NOTE.format("COUPLET_PRECICE_OPENFOAM"), None
    if solid == "calculix" and (not program or not os.access(program, os.X_OK)):
        return NOTE.format("COUPLET_PRECICE_CALCULIX"), None
    where = job.scratch / f"flap-openfoam-{solid}"
    for part in ("fluid-openfoam", "solid-calculix"):
        shutil.copytree(source / "perpendicular-flap" / part, where / part)
    shutil.copy(source / "perpendicular-flap/precice-config.xml", where)
    path = f"{pathlib.Path(adapter).resolve().parent}:{libraries(job)}"
    job.run(["blockMesh"], cwd=where / "fluid-openfoam", check=True)
    fluid = f"cd {where}/fluid-openfoam && LD_LIBRARY_PATH={path} exec pimpleFoam > foam.log"
    line = [
        "mpirun",
        "--oversubscribe",
        *(["--allow-run-as-root"] if os.geteuid() == 0 else []),
        "-n",
        "1",
        job.build / "bin/coupler",
        where / "case.yaml",
    ]
    if solid == "calculix":
        job.run(
            [
                job.root / "scripts/couplet",
                "import",
                where / "precice-config.xml",
                "-o",
                where / "case.yaml",
                "--force",
            ],
            check=True,
        )
        line += [
            "--set=simulation.end-time=2.5",
            ":",
            "-n",
            "1",
            "sh",
            "-c",
            (
                f"cd {where}/solid-calculix && LD_LIBRARY_PATH={path} OMP_NUM_THREADS=1 exec"
                f" {pathlib.Path(program).resolve()} -i flap -precice-participant Solid > ccx.log"
            ),
        ]
    else:
        ours = job.root / "configs/perpendicular-flap"
        shutil.copy(ours / "solid.geo", where)
        (where / "case.yaml").write_text(
            flap_case(
                (ours / "case.yaml").read_text(),
                (r"  fluid:\n(    .*\n)+\n", "  Fluid: {program: precice}\n"),
                (r"  mover:\n(    .*\n)+", ""),
                (r"coupling:\n(  .*\n)+", UNDER_OPENFOAM),
            )
        )
        line += [":", "-n", "1", job.build / "bin/solid_solver", where / "case.yaml"]
    done = job.run([*line, ":", "-n", "1", "sh", "-c", fluid], cwd=where)
    said = done.stdout + done.stderr
    if done.returncode:
        raise RuntimeError(said.strip().splitlines()[-1][:200])
    if solid == "calculix":
        return bent(job, source, motion_of(where / "solid-calculix/flap.frd", TIP), said)
    with open(where / "out/solid/probes.csv") as table:
        head, *rows = (line.strip().split(",") for line in table)
    x = next(i for i, name in enumerate(head) if name.strip() == "tip x [m]")
    return bent(job, source, [(float(row[0]), float(row[x])) for row in rows if float(row[0]) > 0], said)
