# SPDX-License-Identifier: Apache-2.0
"""The wrong configurations of table/*.yml: how each differs from a right one, and what the program must say about it.
(.yml: the fuzzer takes each .yaml of this folder for a case.)"""
import pathlib
from dataclasses import dataclass, field

import yaml

HERE = pathlib.Path(__file__).resolve().parent


@dataclass
class Case:
    name: str
    program: str
    base: str  # NAME.yaml beside this file ...
    edits: list = field(default_factory=list)  # ... with these (old, new) replacements
    text: str = None  # or the whole YAML file
    arguments: list = None  # or run: true (without --check), or set: the assignments of --set
    files: dict = field(default_factory=dict)  # further files in the folder of the case: texts, or edits of a text or file
    exit_code: int = 2
    message: str = ""


def content(value):
    if isinstance(value, str):
        return value
    text = value["of"] if "\n" in value["of"] else (HERE / value["of"]).read_text(encoding="utf-8")
    for old, new in value["edits"]:
        text = text.replace(old, new)
    return text


def read(file):
    table = yaml.safe_load(file.read_text(encoding="utf-8"))
    for row in table["cases"]:
        run, sets = row.pop("run", False), row.pop("set", [])
        row["arguments"] = row.get("arguments") or ["case.yaml", *([] if run else ["--check"]), *(w for s in sets for w in ("--set", s))]
        row["files"] = {name: content(value) for name, value in row.get("files", {}).items()}
        yield Case(program=table["program"], base=table["base"], exit_code=row.pop("exit-code", 2), **row)


CASES = [case for file in sorted((HERE / "table").glob("*.yml")) for case in read(file)]
RIGHT = [case for case in CASES if case.exit_code == 0]
