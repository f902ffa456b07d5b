# SPDX-License-Identifier: Apache-2.0
"""Memory of the coupled cases on their own meshes, what the work of a step is made of, and their places on the maps of the atlas."""
import json

from couplet.runs.case import Case
from validation.parts.benchmarks import gallery

WORDS = {"fluid_solver": "fluid", "mesh_mover": "moving mesh", "coupler": "coupler"}


def reports(job, entry):
    """{participant: its run.json} of a short run on the mesh of the case; of an external program there is none."""
    folder = job.once(("costs", entry.name), lambda: gallery.run(job, entry, "own-mesh", coarse=False))
    return {f.parent.name: json.loads(f.read_text()) for f in sorted(folder.glob("*/run.json"))}


def effect(participant):
    """What a participant's work is for, in words."""
    program = participant.get("program")
    if program != "solid_solver":
        return WORDS.get(program, program)
    return "solid at large strain" if participant.get("kinematics") == "finite-strain" else "linear solid"


def costs(job):
    texts = []
    for entry in gallery.GALLERY:
        found = reports(job, entry)
        programs = {**Case(job.root / "configs" / entry.file, job.build).participants, "coupler": {"program": "coupler"}}
        if any("kinematics=finite-strain" in word for word in entry.sets):
            programs["solid"] = {**programs["solid"], "kinematics": "finite-strain"}
        shares = {}
        for name, report in found.items():
            shares[effect(programs[name])] = shares.get(effect(programs[name]), 0) + report["processor-working"]
        total = sum(shares.values())
        parts = ", ".join(f"{what} {100 * share / total:.0f} %" for what, share in sorted(shares.items(), key=lambda pair: -pair[1]) if share > 0)
        texts.append(f"{entry.name}: {sum(r['memory-all'] for r in found.values()):.0f} MB, {total / entry.steps:.2g} processor s per step ({parts})")
    return "; ".join(texts), None


def used(c):
    """Of the way to the limit; with a floor the way begins at 1."""
    return (1 - c["value"]) / (1 - c["limit"]) if c["floor"] else c["value"] / c["limit"]


def places(job):
    """Each case has its place: the participant whose limit is nearest."""
    texts, missing = [], []
    for entry in gallery.GALLERY:
        found = [(c, name) for name, report in reports(job, entry).items() for c in report.get("atlas", ())]
        if not found:
            missing.append(entry.name)
            continue
        nearest, name = max(found, key=lambda pair: used(pair[0]))
        texts.append(f"{entry.name}: {name}'s {nearest['quantity']} {nearest['value']:.2g}, {100 * used(nearest):.0f} % of the way to its limit (map {nearest['map']})")
    return "; ".join(texts) + (f"; none: {', '.join(missing)}" if missing else ""), not missing
