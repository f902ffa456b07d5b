# SPDX-License-Identifier: Apache-2.0
"""Adapters of preCICE in solvers of others, unchanged, beside programs of this project. COUPLET_PRECICE_CALCULIX names ccx_preCICE, which was built
from the adapter and CalculiX against build/precice; COUPLET_PRECICE_OPENFOAM libpreciceAdapterFunctionObject.so, which was built from the adapter and OpenFOAM's headers
against build/precice and the installed libraries; COUPLET_PRECICE_TUTORIALS the tutorials; COUPLET_PRECICE_NUTILS
the folders of nutils 7, treelog and stringly for PYTHONPATH. Without them the rows report that."""
import os
import pathlib
import re
import shutil

import numpy as np

from validation.parts.precice.programs import NOTE, commit_of, coupled, folder, passes

PUBLISHED = {"first": (0.198, 0.74), "second": (0.184, 2.36)}  # OpenFOAM and CalculiX: tip of the flap [m] at [s], read off the tutorial's plot to 0.002 m
TIP = 489  # the node at (0, 1) in solid-calculix/all.msh

COUPLING = """coupling:
  scheme: semi-implicit
  fluid: {participant: fluid}
  structure: {participant: Solid, displacement: Displacement, load: Force}
  mesh: {participant: mover}
  mapping: {type: rbf}
  convergence: {relative: 1e-4, max-iterations: 30}
"""


def flap_case(text):
    """configs/perpendicular-flap with the tutorial's solid in place of ours, to 2.5 s."""
    for what, by in ((r"  solid:\n(    .*\n)+", "  Solid: {program: precice}\n"), (r"coupling:\n(  .*\n)+", COUPLING), (r"\nplot:(.*\n)+", "\n"),
                     (r"checkpoint: .*", "checkpoint: {interval: 0}"), (r"interval: 0.05 s", "interval: 1 s"), (r"end-time: 5 s", "end-time: 2.5 s")):
        text, found = re.subn(what, by, text)
        if found != 1:
            raise RuntimeError(f"the case of the flap has {found} places like {what}")
    return text


UNDER_OPENFOAM = """coupling:
  scheme: implicit
  fluid: {participant: Fluid, displacement: Displacement, load: Force}
  structure: {participant: solid}
  mapping: {type: rbf}
  convergence: {relative: 1e-4, max-iterations: 30}
"""


def flap_under_openfoam(text):
    """configs/perpendicular-flap with the tutorial's fluid in place of ours, to 2.5 s."""
    for what, by in ((r"  fluid:\n(    .*\n)+\n", "  Fluid: {program: precice}\n"), (r"  mover:\n(    .*\n)+", ""), (r"coupling:\n(  .*\n)+", UNDER_OPENFOAM), (r"\nplot:(.*\n)+", "\n"),
                     (r"checkpoint: .*", "checkpoint: {interval: 0}"), (r"interval: 0.05 s", "interval: 1 s"), (r"end-time: 5 s", "end-time: 2.5 s")):
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
    case.write_text(flap_case((ours / "case.yaml").read_text()))
    line = ["mpirun", "--oversubscribe", *(["--allow-run-as-root"] if os.geteuid() == 0 else [])]
    for i, name in enumerate(("coupler", "fluid_solver", "mesh_mover")):
        line += [":"] * (i > 0) + ["-n", "1", job.build / "bin" / name, case]
    line += [":", "-n", "1", "sh", "-c", f"cd solid-calculix && LD_LIBRARY_PATH={libraries(job)} OMP_NUM_THREADS=1 exec {pathlib.Path(program).resolve()} -i flap -precice-participant Solid > ccx.log"]
    done = job.done(line, cwd=where)
    return bent(job, source, motion_of(where / "solid-calculix/flap.frd", TIP), done.stdout + done.stderr)


def bent(job, source, rows, said):
    """The verdict on (time, x displacement) of the flap's tip."""
    found = {"first": max((r for r in rows if r[0] < 1.5), key=lambda r: r[1]), "second": max((r for r in rows if r[0] > 1.5), key=lambda r: r[1])}
    off = max(abs(x / PUBLISHED[name][0] - 1) for name, (_, x) in found.items())
    text = ", ".join(f"{x:.4f} m at {t:.2f} s" for t, x in found.values())
    return f"{text}: {100 * off:.1f} % off; {len(rows)} steps, {passes(said):.2f} passes per step{commit_of(source, job)}", len(rows) == 250 and off < 0.02


def openfoam(job, solid):
    """pimpleFoam of Debian's OpenFOAM 1912 with preCICE's adapter, on our solid or on CalculiX with its adapter."""
    source, adapter, program = folder("COUPLET_PRECICE_TUTORIALS"), os.environ.get("COUPLET_PRECICE_OPENFOAM"), os.environ.get("COUPLET_PRECICE_CALCULIX")
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
    line = ["mpirun", "--oversubscribe", *(["--allow-run-as-root"] if os.geteuid() == 0 else []), "-n", "1", job.build / "bin/coupler", where / "case.yaml"]
    if solid == "calculix":
        job.run([job.root / "scripts/couplet", "import", where / "precice-config.xml", "-o", where / "case.yaml", "--force"], check=True)
        line += ["--set=simulation.end-time=2.5", ":", "-n", "1", "sh", "-c",
                 f"cd {where}/solid-calculix && LD_LIBRARY_PATH={path} OMP_NUM_THREADS=1 exec {pathlib.Path(program).resolve()} -i flap -precice-participant Solid > ccx.log"]
    else:
        ours = job.root / "configs/perpendicular-flap"
        shutil.copy(ours / "solid.geo", where)
        (where / "case.yaml").write_text(flap_under_openfoam((ours / "case.yaml").read_text()))
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


def values(vtk, name):
    """A scalar field of a binary VTK file."""
    data = vtk.read_bytes()
    count = int(re.search(rb"POINT_DATA (\d+)", data)[1])
    kind = re.search(rb"SCALARS " + name + rb" (\w+) 1\nLOOKUP_TABLE default\n", data)
    return np.frombuffer(data, {b"double": ">f8", b"float": ">f4"}[kind[1]], count, kind.end())


def heat(job):
    source, libraries = folder("COUPLET_PRECICE_TUTORIALS"), os.environ.get("COUPLET_PRECICE_NUTILS")
    if source is None or not libraries:
        return NOTE.format("COUPLET_PRECICE_TUTORIALS" if source is None else "COUPLET_PRECICE_NUTILS"), None
    where = job.scratch / "heat"
    shutil.copytree(source / "partitioned-heat-conduction", where)
    sides = "Dirichlet", "Neumann"
    words = [f"cd {where}/{side.lower()}-nutils && PYTHONPATH=$PYTHONPATH:{libraries} NUTILS_RICHOUTPUT=no exec /usr/bin/python3 heat.py > {where}/{side}.txt" for side in sides]
    said = coupled(job, where, where / "precice-config.xml", words)
    errors = []
    for side in sides:
        last = max((where / f"{side.lower()}-nutils").glob(f"{side}-*.vtk"), key=lambda f: f.stat().st_mtime_ns)
        errors.append(float(np.abs(values(last, b"Temperature") - values(last, b"reference")).max()))
    return f"largest errors {errors[0]:.2e} and {errors[1]:.2e} of 2.2 to 9.2, {passes(said):.1f} passes per step (nutils 7; the tutorial's FEniCS 2019 is not in Debian, DOLFINx 0.5 is)", None
