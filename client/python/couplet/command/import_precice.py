# SPDX-License-Identifier: Apache-2.0
"""Creates a case from a configuration of preCICE, for a job of programs that use preCICE's interface (docs/precice.md).
The programs still read the XML themselves. Differences are listed. If an element is not supported, it is named with its
line, and no case is written (exit code 2)."""
import os
import pathlib
import subprocess
import tempfile

import yaml

from couplet import files, places
from couplet.precice.configuration import Import
from couplet.precice.elements import read
from couplet.runs.case import CONTROL, COUPLER, Wrong, expect
from couplet.runs.job import surroundings


def text_of(found, file, output):
    case = {
        "simulation": {
            "name": file.resolve().parent.name or "precice",
            **found.case["simulation"],
            "output": {"folder": f"{output.stem}-run", "interval": 0},
            "checkpoint": {"interval": 0},
        },
        "participants": found.case["participants"],
        "coupling": found.case["coupling"],
    }
    source = os.path.relpath(file, output.parent)
    expect(not CONTROL.search(source), f"{source!r}: the name contains a control character; rename it.")
    lines = [
        f"# precice-config: {source}",
        (
            "# A job of programs on preCICE's interface, made by couplet import. Each program is given that file, or"
            " this one:"
        ),
        f"#   couplet run {output.name} --with NAME='./program {source}' ...",
        *(f"# Line {line}: {note}." for line, note in sorted(found.notes)),
    ]
    return "\n".join([*lines, ""]) + yaml.dump(
        case, sort_keys=False, default_flow_style=None, width=160, allow_unicode=True
    )


def refusal(text):
    """Complaint of the coupler about a case. Empty if there is none, or no coupler."""
    coupler = places.build() / "bin" / COUPLER
    if not coupler.is_file():
        return ""
    with tempfile.TemporaryDirectory() as folder:
        case = pathlib.Path(folder) / "case.yaml"
        files.write(folder, case.name, text)
        done = subprocess.run(
            [coupler, case, "--check"], stdin=subprocess.DEVNULL, capture_output=True, text=True, env=surroundings()
        )
    return done.stderr.replace(str(case), "case.yaml").strip() if done.returncode else ""


def run(arguments):
    file = arguments.configuration
    found = Import(read(file))
    found.ask_library(file)
    if found.refusals:
        raise Wrong("\n".join(f"{file}:{line}: {why}." for line, why in sorted(set(found.refusals))))
    for line, note in sorted(found.notes):
        print(f"{file}:{line}: note: {note}.")
    if arguments.check:
        return 0
    output = arguments.output or file.with_suffix(".yaml")
    expect(arguments.force or not output.exists(), f"{output}: the file exists; --force overwrites it.")
    text = text_of(found, file, output)
    expect(
        not (problem := refusal(text)), f"{file}: the coupler would refuse a case with this configuration:\n{problem}"
    )
    files.write(output.parent, output.name, text)
    print(
        f"{output}: a case of {', '.join(found.case['participants'])}. couplet run {output} --with NAME='./program"
        f" {file.name}' ... starts it"
    )
    return 0
