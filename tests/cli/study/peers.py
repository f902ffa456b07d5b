#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cases for other programs: the CalculiX input of LE1 runs and gives the stress of NAFEMS at D; the OpenFOAM case of the cylinder has
the right patches and closed cells; what has no counterpart is refused by the name of its key. usage: peers.py"""
import contextlib
import io
import pathlib
import re
import shutil
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "client/python"))
from couplet.peers import calculix, flow, race, solid, values  # noqa: E402
from couplet.peers.results import write_solid  # noqa: E402
from couplet.runs.case import Case, with_changes  # noqa: E402
from couplet.runs.process import environment, launch  # noqa: E402
from couplet.runs.results import read_csv  # noqa: E402
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check  # noqa: E402

STRESS = 92.66e6  # [Pa] sigma_yy at D, NAFEMS LE1


def data_of(name, **changes):
    case = Case(ROOT / "configs" / name / "case.yaml", ROOT)
    participant = next(iter(case.participants))
    return case, participant, with_changes(case.data, {case.absolute(k.replace("__", "."), participant): v for k, v in changes.items()})


def refusal(make):
    try:
        make()
    except values.Refused as error:
        return str(error)
    return "was not refused"


def units():
    pairs = {"210 GPa": 210e9, "7850 kg/m^3": 7850, "1e-3 Pa s": 1e-3, "2 1/(m K)": 2, "5 W/(m K)": 5, "3 min": 180, "20 mm": 0.02, "9.81 m/s^2": 9.81, "4 kN/mm^2": 4e9}
    wrong = {text: values.number(text, "key") for text, wanted in pairs.items() if abs(values.number(text, "key") / wanted - 1) > 1e-12}
    return check("units", not wrong, wrong) + check("an unknown unit is refused", "material.density: '3 stone'" in refusal(lambda: values.number("3 stone", "material.density")))


def le1(work):
    case, name, data = data_of("le1", **{"mesh-parameters": "{nr: 6, nt: 9}"})
    made = calculix.Input(solid.Solid(data, name, case.file.parent, work / "mesh", "CalculiX"), "CPS8R")
    command = made.write(work / "le1")
    text = (work / "le1/case.inp").read_text()
    pull = np.array([[float(w) for w in line.split(",")] for line in text.split("*CLOAD\n")[1].split("*NODE FILE")[0].splitlines()])
    total = [pull[pull[:, 1] == a, 2].sum() / made.depth for a in (1, 2)]
    failed = check("the forces add up to the pull of 10 MPa on the outer edge", np.allclose(total, [1e7 * 2.75, 1e7 * 3.25], rtol=1e-3), total)
    failed += check("54 elements of eight points", text.count("TYPE=CPS8R") == 1 and made.body.cells["quadrilateral"].shape == (54, 8))
    if not shutil.which("ccx"):
        print("skipped: LE1 by CalculiX: ccx is not installed")
        return failed
    launch(command, work / "run.log", work / "le1", 60, environment())
    made.read(work / "le1", work / "out" / name)
    found = float(read_csv(work / "out" / name / "probes.csv")["D stress-yy [Pa]"][0])
    return failed + check("CalculiX gives the stress at D of LE1 within 1 %", abs(found / STRESS - 1) < 0.01, found)


def fork(work):
    """A point of this mesh is off its place by round-off: -8.32667268468867e-17, of which CalculiX would read -8.32667268468867e-1."""
    case, name, data = data_of("tuning-fork", analysis="static", **{"mesh-parameters": "{h: 0.005}"})
    data["participants"][name]["probes"] = {"end": {"point": ["0 mm", "30 mm", 0]}}
    made = calculix.Input(solid.Solid(data, name, case.file.parent, work / "mesh", "CalculiX"), "C3D10")
    made.write(work / "fork")
    longest = max((w.strip() for w in re.findall(r"[-+\d.e]+", (work / "fork/case.inp").read_text())), key=len)
    failed = check("no number has more than 20 characters", len(longest) <= 20, longest)
    write_solid(work / "fork/out", made.flat, made.solid, np.zeros((made.flat.count(), 9)), lambda place: np.array([*place, *6 * [0.0]]))
    return failed + check("places of probes have units", read_csv(work / "fork/out/probes.csv")["end y [m]"][0] == 0.03)


def cylinder(work):
    case, name, data = data_of("cylinder", **{"mesh-parameters": "{n: 6}"})
    data["simulation"]["end-time"] = "0.5 s"
    made = flow.FlowCase(flow.Flow(data, name, case.file.parent, work / "flow"), "icoFoam")
    failed = check("the program", made.write(work / "foam") == ["icoFoam"])
    boundary, u, p = ((work / "foam" / f).read_text() for f in ("constant/polyMesh/boundary", "0/U", "0/p"))
    kinds = dict(re.findall(r"^(\w+) \{type (\w+);", boundary, re.M))
    failed += check("patches and their types", kinds == {"inlet": "patch", "outlet": "patch", "walls": "wall", "cylinder": "wall", "frontAndBack": "empty"}, kinds)
    conditions = {q: dict(re.findall(r"(\w+)\{type (\w+);", text)) for q, text in (("U", u), ("p", p))}
    failed += check("conditions", conditions["U"] == {"inlet": "timeVaryingMappedFixedValue", "outlet": "inletOutlet", "walls": "noSlip", "cylinder": "noSlip",
                                                      "frontAndBack": "empty"} and conditions["p"]["outlet"] == "fixedValue", conditions)
    profile = (work / "foam/constant/boundaryData/inlet/0.4/U").read_text()
    y = made.flow.mesh()[2].middles_of("inlet")[:, 1]
    given = np.array([[float(v) for v in row.split()] for row in re.findall(r"\(([^()]+)\)", profile)])
    failed += check("the inlet's profile, with its gust", np.allclose(given[:, 0], 6 * y * (0.41 - y) / 0.41**2) and np.allclose(given[:, 1], 2 * y * (0.41 - y) / 0.41**2))
    faces = made.flow.mesh()[2]
    points, closed = faces.mesh.points, np.zeros((len(faces.centres), 3))
    for k, face in enumerate(faces.faces):
        corners = points[face[face >= 0]]
        area = sum(np.cross(corners[i] - corners[0], corners[i + 1] - corners[0]) for i in range(1, len(corners) - 1)) / 2
        closed[faces.owner[k]] += area
        if k < len(faces.neighbour):
            closed[faces.neighbour[k]] -= area
    failed += check("the faces of every cell close it", np.abs(closed).max() < 1e-12, np.abs(closed).max())
    return failed + check("owners come before neighbours", (faces.owner[:len(faces.neighbour)] < faces.neighbour).all())


def refusals(work):
    failed = 0
    for name, changes, program, key in (("bent-beam", {}, "CalculiX", "participants.solid.kinematics"), ("le1", {"body-force": "[0, 1]"}, "CalculiX", "participants.solid.body-force"),
                                        ("le1", {"boundaries.outer": "{type: spring, stiffness: 1e9}"}, "CalculiX", "participants.solid.boundaries.outer.type"),
                                        ("le1", {"analysis": "dynamic"}, "CalculiX", "participants.solid.analysis"),
                                        ("cavity", {"turbulence": "{model: wale}"}, "OpenFOAM", "participants.fluid.turbulence"),
                                        ("cavity", {"boundaries.lid": "{type: convective-outlet}"}, "OpenFOAM", "participants.fluid.boundaries.lid.type")):
        case, participant, data = data_of(name, **changes)
        able, refused = race.contenders(data, participant, case.file.parent, work / "none")
        why = " / ".join(reason for who, reason in refused if who == program)
        failed += check(f"refused by its key: {key}", why.startswith(f"{key}: "), why or able)
    from couplet.command import main
    with contextlib.redirect_stderr(io.StringIO()) as told:
        code = main(["couplet", "export", str(ROOT / "configs/thermocline-andasol"), "--to", "calculix", "--folder", str(work / "tank")])
    return failed + check("couplet export: exit code 2, nothing written", code == 2 and "program" in told.getvalue() and not (work / "tank").exists(), told.getvalue())


def main():
    with tempfile.TemporaryDirectory(prefix="couplet-peers-") as scratch:
        work = pathlib.Path(scratch)
        failed = units() + refusals(work)
        if shutil.which("gmsh"):
            failed += le1(work) + fork(work) + cylinder(work)
        else:
            print("skipped: meshes of other programs: gmsh is not installed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
