# SPDX-License-Identifier: Apache-2.0
"""Creates a case from a configuration of preCICE, for a job of programs that use preCICE's interface (docs/precice.md). The programs still read the XML
themselves. Differences are listed. If an element is not supported, it is named with its line, and no case is written (exit code 2)."""
import os
import pathlib

import yaml

from couplet import files
from couplet.precice.configuration import Import
from couplet.precice.elements import read
from couplet.runs.case import CONTROL, Wrong, expect


def declare(parser):
    parser.add_argument("configuration", type=pathlib.Path, metavar="XML", help="configuration file, such as precice-config.xml")
    parser.add_argument("-o", "--output", type=pathlib.Path, metavar="YAML", help="case to write (default: beside the XML, with its name and .yaml)")
    parser.add_argument("--check", action="store_true", help="lists differences and unsupported elements without writing a case")
    parser.add_argument("--force", action="store_true", help="overwrites an existing case")


def text_of(found, file, output):
    case = {"simulation": {"name": file.resolve().parent.name or "precice", **found.case["simulation"], "output": {"folder": f"{output.stem}-run", "interval": 0}, "checkpoint": {"interval": 0}},
            "participants": found.case["participants"], "coupling": found.case["coupling"]}
    source = os.path.relpath(file, output.parent)
    expect(not CONTROL.search(source), f"{source!r}: the name contains a control character; rename it.")
    lines = [f"# precice-config: {source}", "# A job of programs on preCICE's interface, made by couplet import. Each program is given that file, or this one:",
             f"#   couplet run {output.name} --with NAME='./program {source}' ...", *(f"# Line {line}: {note}." for line, note in sorted(found.notes))]
    return "\n".join([*lines, ""]) + yaml.dump(case, sort_keys=False, default_flow_style=None, width=160, allow_unicode=True)


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
    files.write(output.parent, output.name, text_of(found, file, output))
    print(f"{output}: a case of {', '.join(found.case['participants'])}. couplet run {output} --with NAME='./program {file.name}' ... starts it")
    return 0
