# SPDX-License-Identifier: Apache-2.0
"""What the runs of peers have in common: each is made once, and OpenFOAM wants a header in every file."""
import json
import os
import pathlib
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "client/python")]
from couplet.runs import environment  # noqa: E402


def once(folder, make):
    """Returns the result of make(folder) in its JSON form, which is kept in the folder for later calls."""
    folder = pathlib.Path(str(folder).replace(" ", "-"))
    record = folder / "record.json"
    if not record.exists():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        record.write_text(json.dumps(make(folder)))
    return json.loads(record.read_text())


def series(folder, peers):
    """Returns [(name, [(seconds, error)])] for the picture of scripts/couplet study, of peers (name, its program, run, meshes): each run(folder, mesh) is
    made once; what is not installed is left out."""
    def one(name, run, mesh):
        label = "x".join(map(str, mesh)) if isinstance(mesh, tuple) else mesh
        return tuple(once(pathlib.Path(folder) / f"{name}-{label}", lambda place: run(place, mesh)))
    return [(name, [one(name, run, mesh) for mesh in meshes]) for name, program, run, meshes in peers if shutil.which(program)]


def foam_environment():
    return dict(environment(), WM_PROJECT_DIR=os.environ.get("WM_PROJECT_DIR", "/usr/share/openfoam"))


def foam_header(kind, name, note=""):
    return f"FoamFile {{version 2.0; format ascii; class {kind}; {note} object {name};}}\n"


def put_foam(folder, path, kind, text):
    """A file of a case, its folder made where there is none."""
    file = pathlib.Path(folder) / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(foam_header(kind, file.name) + text + "\n")
