# SPDX-License-Identifier: Apache-2.0
"""Case file as seen by the runner: participants, changes on a command line, and dependencies of a result."""
from __future__ import annotations

import copy
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import yaml

from couplet import places

COUPLER = "coupler"
OURS = ("coupler", "fluid_solver", "solid_solver", "mesh_mover", "thermocline", "plate_modal")


CONTROL = re.compile("[\0-\x1f\x7f-\x9f]")
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class Wrong(Exception):
    """Error that the user can fix."""


def expect(condition, text):
    if not condition:
        raise Wrong(text)


DEEPEST, MOST_VALUES = 50, 1_000_000  # as Inspection of common/config/document.cpp


def expect_bounded(text):
    """Rejects nested levels and anchors that would take all time or memory, as the programs do, before anything is
    built."""
    around, sizes = [(None, 0)], {}  # anchors and numbers of values
    for event in yaml.parse(text, Loader=LOADER):
        size = 1 if isinstance(event, yaml.ScalarEvent) else 0
        if isinstance(event, yaml.CollectionStartEvent):
            around.append((event.anchor, 1))
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, size = around.pop()
            sizes[anchor] = size
        elif isinstance(event, yaml.AliasEvent):
            expect(event.anchor not in (name for name, _ in around), f"the anchor '&{event.anchor}' contains itself.")
            size = sizes.get(event.anchor, 1)
        around[-1] = (around[-1][0], around[-1][1] + size)
        expect(len(around) <= DEEPEST + 1, f"nested deeper than {DEEPEST} levels.")
        expect(around[-1][1] <= MOST_VALUES, f"more than {MOST_VALUES} values. Do anchors contain each other?")


def expect_plain(node):
    """Rejects control characters, as the programs do. Keys are names of files and of columns, and have no line breaks
    and tabs either."""
    if isinstance(node, dict):
        for key, value in node.items():
            expect(not CONTROL.search(str(key)), f"the key {str(key)!r} contains a control character; remove it.")
            expect_plain(value)
    elif isinstance(node, list):
        for value in node:
            expect_plain(value)
    elif isinstance(node, str):
        expect(
            not CONTROL.search(node.replace("\n", "").replace("\t", "")),
            f"the value {node!r} contains a control character; remove it.",
        )


def load(text, file=None):
    """Content of a YAML text. Errors are reported with file and line."""
    try:
        expect_bounded(text)
        found = yaml.load(text, Loader=LOADER)
        expect_plain(found)
        return found
    except Wrong as problem:
        raise Wrong(f"{file or 'YAML'}:1:1: {problem}") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise Wrong(
            f"{file or 'YAML'}{f':{mark.line + 1}:{mark.column + 1}' if mark else ''}:"
            f" {getattr(error, 'problem', None) or error}"
        ) from None


def words_of(file):
    """Text of a file, which must be in UTF-8."""
    content = file.read_bytes()
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        before = content[: error.start]
        raise Wrong(
            f"{file}:{before.count(10) + 1}:{error.start - before.rfind(10)}: the byte 0x{content[error.start]:02x} is"
            " not text in UTF-8; save the file in this encoding."
        ) from None


def text_of(value):
    """Formats a value as in the YAML."""
    return value if isinstance(value, str) else json.dumps(value)


def mapping_of(value):
    """Returns a mapping, also from text. Returns an empty one for anything else."""
    found = load(value) if isinstance(value, str) else value
    return found if isinstance(found, dict) else {}


def with_changes(data, changes):
    """Sections of a case with {absolute key: value} set. Texts are parsed as YAML."""
    data = copy.deepcopy(data)
    for key, value in changes.items():
        *path, last = key.split(".")
        node = data
        for part in path:
            if not isinstance(node.get(part), dict):
                node[part] = {}
            node = node[part]
        node[last] = load(value) if isinstance(value, str) else value
    return data


@functools.lru_cache(maxsize=256)
def content_of(file, time, size):
    """Digest of a file as of that time."""
    return hashlib.sha256(file.read_bytes()).digest()


class Case:
    """One case. `file` is the YAML, its folder, or a YAML with another study of a case beside it ({case: case.yaml,
    study: ...}). `build` is the folder with bin/. `data` has the sections, and `participants` those of the
    participants. Raises Wrong with file and line for what cannot be read."""

    def __init__(self, file: str | pathlib.Path, build: str | pathlib.Path | None = None):
        self.file, self.build = pathlib.Path(file), pathlib.Path(build or places.build())
        if self.file.is_dir():
            self.file /= "case.yaml"
        expect(self.file.is_file(), f"{self.file}: this file does not exist.")
        self.data = load(words_of(self.file), self.file) or {}
        expect(isinstance(self.data, dict), f"{self.file}: expected a mapping of sections.")
        self.asked, study = self.file, self.data.get("study")
        if "case" in self.data:
            unknown = set(self.data) - {"case", "study"}
            expect(
                not unknown,
                f"{self.file}: unknown key '{next(iter(unknown), '')}'; besides 'case', only 'study' is allowed.",
            )
            self.file = self.file.parent / str(self.data["case"])
            expect(self.file.is_file(), f"{self.asked}: case: {self.file} does not exist.")
            self.data = {**(load(words_of(self.file), self.file) or {}), "study": study}
        self.participants = self.data.get("participants") or {}
        self.trusted = False  # True: Python that lies beside the case may draw its picture

    def changed(self, sets: Sequence[str]) -> Case:
        """The case with the participants and programs that arguments of --set give it."""
        case, own = copy.copy(self), re.compile(r"(participants(\.[^.]+(\.program)?)?|coupling)=")
        case.data = with_changes(self.data, dict(s.split("=", 1) for s in sets if own.match(s)))
        case.participants = case.data.get("participants") or {}
        return case

    @property
    def study(self) -> dict[str, Any]:
        """Section `study`. Raises Wrong if there is none."""
        section = self.data.get("study")
        expect(isinstance(section, dict), f"{self.asked}: there is no section 'study'.")
        return section

    @property
    def has_picture(self) -> bool:
        """Returns true if the case has a section `plot` or a plot.py."""
        return "plot" in self.data or (self.file.parent / "plot.py").is_file()

    @property
    def draws_itself(self) -> bool:
        """Returns true if Python beside the case draws its picture, or a curve of it."""
        return "'python':" in str(self.data["plot"]) if "plot" in self.data else self.has_picture

    @property
    def coupled(self) -> bool:
        """Returns true if the coupler takes part."""
        return bool(self.data.get("coupling")) and len(self.participants) > 1

    def absolute(self, key: str, participant: str) -> str:
        """Full path of a key, which starts at a participant unless it starts with a section."""
        return key if re.match(r"(simulation|participants|coupling)\.", key) else f"participants.{participant}.{key}"

    def assignments(self, changes: Mapping[str, Any]) -> list[str]:
        """Arguments of --set. A key below a missing mapping is set with that mapping, which an earlier change may have
        set as a whole. The last change of a key counts."""
        added, plain, whole = {}, [], {}
        for key, value in changes.items():
            parts, node = key.split("."), self.data
            for depth, part in enumerate(parts[:-1]):
                if isinstance(node, dict) and part not in node:
                    above = ".".join(parts[: depth + 1])
                    place = added.setdefault(above, copy.deepcopy(mapping_of(whole.get(above))))
                    for inner in parts[depth + 1 : -1]:
                        place = place.setdefault(inner, {})
                    place[parts[-1]] = value
                    break
                node = node[part] if isinstance(node, dict) else None
            else:
                plain.append(f"{key}={text_of(value)}")
                whole[key] = value
                added.pop(key, None)
        return plain + [f"{key}={json.dumps(value)}" for key, value in added.items()]

    def program(self, participant: str) -> pathlib.Path:
        """Path of the participant's program."""
        entry = self.participants.get(participant)
        expect(participant in self.participants, f"{self.file}: there is no participant '{participant}'.")
        expect(
            isinstance(entry, dict),
            f"{self.file}: participants.{participant}: expected a mapping with at least the key 'program'.",
        )
        name = str(entry.get("program", "?"))
        expect(
            name == pathlib.PurePath(name).name,
            (
                f"{self.file}: participants.{participant}.program: '{name}' is a path; give the name of a program, and"
                f" start one in another folder with --with {participant}='COMMAND ...'."
            ),
        )
        return self.build / "bin" / name

    def guest(self, participant: str, played_by: Mapping[str, Sequence] | None = None) -> Sequence | None:
        """Command of an external program, which does not read the case: the given one, else a file of that name beside
        the case, with the participant's name. None for our programs, and if there is none: another program beside ours,
        such as a shell, is never started."""
        if played_by and participant in played_by:
            return played_by[participant]
        program = self.program(participant)
        if program.name in OURS:
            return None
        for name in (program.name, program.name + ".py"):
            beside = self.file.parent / name
            if beside.is_file():
                return [*([sys.executable] if name.endswith(".py") else []), beside, participant]
        return None

    def parts(
        self,
        changes: Mapping[str, Any],
        alone: str | None = None,
        ranks: Mapping[str, int] | None = None,
        raw: Sequence[str] = (),
        flags: Sequence[str] = (),
        played_by: Mapping[str, Sequence] | None = None,
    ) -> list[tuple[int, list[str]]]:
        """Programs of a job in the order of their ranks: [(number of ranks, words)]. `alone` runs only this
        participant; `ranks` is {participant or coupler: number}; `raw` are further --set arguments; `flags` are
        arguments of all our programs; `played_by` is {participant: command}."""
        sets = [*(word for a in (*self.assignments(changes), *raw) for word in ("--set", a)), *flags]
        names = (
            [alone or next(iter(self.participants))]
            if alone is not None or not self.coupled
            else [COUPLER, *self.participants]
        )

        def words(name):
            if name == COUPLER:
                return [self.build / "bin" / COUPLER, self.file, *sets]
            return (
                len(names) > 1
                and self.guest(name, played_by)
                or [self.program(name), self.file, "--participant", name, *sets]
            )

        return [(int((ranks or {}).get(name, 1)), [str(word) for word in words(name)]) for name in names]

    def words(
        self,
        alone: str | None = None,
        ranks: Mapping[str, int] | None = None,
        sets: Sequence[str] = (),
        flags: Sequence[str] = (),
        played_by: Mapping[str, Sequence] | None = None,
    ) -> list:
        """Arguments of couplet run and couplet-exec for this job."""
        words = [
            self.file,
            *(["--bin", self.build / "bin"] if self.build != places.build() or "COUPLET_BIN" in os.environ else []),
            *(["--participant", alone] if alone else []),
        ]
        words += ["-n", ",".join(f"{name}={n}" for name, n in ranks.items())] if ranks else []
        return (
            words
            + [w for s in sets for w in ("--set", s)]
            + [*flags]
            + [
                w
                for name, line in (played_by or {}).items()
                for w in ("--with", f"{name}={shlex.join(map(str, line))}")
            ]
        )

    def command(
        self,
        changes: Mapping[str, Any],
        alone: str | None = None,
        ranks: Mapping[str, int] | None = None,
        raw: Sequence[str] = (),
        flags: Sequence[str] = (),
        played_by: Mapping[str, Sequence] | None = None,
    ) -> list:
        """Command line of a job, for the arguments of parts(). Several programs are one application, whose processes
        couplet-exec turns into them."""
        parts = self.parts(changes, alone, ranks, raw, flags, played_by)
        total = sum(n for n, _ in parts)
        line = (
            parts[0][1]
            if len(parts) == 1
            else [
                places.command("couplet-exec"),
                *self.words(None, ranks, [*self.assignments(changes), *raw], flags, played_by),
            ]
        )
        return line if total == 1 else ["mpirun", "--oversubscribe", "-n", total, *line]

    def named(self, node: Any) -> Iterator[pathlib.Path]:
        """Files named in the case, such as a mesh or a weather file in another folder."""
        if isinstance(node, dict) or isinstance(node, list):
            for child in node.values() if isinstance(node, dict) else node:
                yield from self.named(child)
        elif isinstance(node, str) and 0 < len(node) < 200 and "\n" not in node and (self.file.parent / node).is_file():
            yield self.file.parent / node

    def digest(self, changes: Mapping[str, Any] | None = None) -> str:
        """Digest of everything a result depends on besides its settings: the files of case and changes, and the
        programs."""
        mark = hashlib.sha256()
        inputs = {f.resolve() for f in self.named([self.data, list((changes or {}).values())])} | {
            f.resolve() for f in self.file.parent.glob("*.geo")
        }
        programs = {self.program(name) for name in self.participants} | (
            {self.build / "bin" / COUPLER} if self.coupled else set()
        )
        sections = {
            k: v for k, v in self.data.items() if k not in ("study", "plot")
        }  # a study may grow without repeating its runs
        mark.update(json.dumps(sections, sort_keys=True, default=str).encode())
        for file in (*sorted(inputs), *sorted(programs)):
            if file.exists():
                status = file.stat()
                mark.update(str(file.name).encode() + content_of(file, status.st_mtime_ns, status.st_size))
        return mark.hexdigest()
