# SPDX-License-Identifier: Apache-2.0
"""A case file as the runner sees it: who takes part, what changes become on a command line, what a result depends on."""
import copy
import functools
import hashlib
import json
import pathlib
import re
import shutil
import sys

import yaml

from couplet import places

COUPLER = "coupler"
OURS = ("coupler", "fluid_solver", "solid_solver", "mesh_mover", "thermocline", "plate_modal")


LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class Wrong(Exception):
    """Something the user can fix."""


def expect(condition, text):
    if not condition:
        raise Wrong(text)


def load(text, file=None):
    """The content of a YAML text; a mistake in it is reported with file and line."""
    try:
        return yaml.load(text, Loader=LOADER)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise Wrong(f"{file or 'YAML'}{f':{mark.line + 1}:{mark.column + 1}' if mark else ''}: {getattr(error, 'problem', None) or error}") from None


def words_of(file):
    """The text of a file that is to be one."""
    try:
        return file.read_text()
    except UnicodeDecodeError:
        raise Wrong(f"{file}: is not a text file.") from None


def text_of(value):
    """As it would stand in the YAML."""
    return value if isinstance(value, str) else json.dumps(value)


def mapping_of(value):
    """A mapping, also one that stands as text; an empty one of anything else."""
    found = load(value) if isinstance(value, str) else value
    return found if isinstance(found, dict) else {}


def with_changes(data, changes):
    """The sections of a case with {absolute key: value} set; a text is read as YAML."""
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
    """Digest of a file as it was at that time."""
    return hashlib.sha256(file.read_bytes()).digest()


class Case:
    """`file`: the YAML, or one that names a case beside it and holds another study of it ({case: case.yaml, study: ...});
    `build`: the folder with bin/."""

    def __init__(self, file, build=None):
        self.file, self.build = pathlib.Path(file), pathlib.Path(build or places.build())
        if self.file.is_dir():
            self.file /= "case.yaml"
        expect(self.file.is_file(), f"{self.file}: this file does not exist.")
        self.data = load(words_of(self.file), self.file) or {}
        expect(isinstance(self.data, dict), f"{self.file}: expected a mapping of sections.")
        self.asked, study = self.file, self.data.get("study")
        if "case" in self.data:
            unknown = set(self.data) - {"case", "study"}
            expect(not unknown, f"{self.file}: unknown key '{next(iter(unknown), '')}'; beside 'case' there is only 'study'.")
            self.file = self.file.parent / str(self.data["case"])
            expect(self.file.is_file(), f"{self.asked}: case: {self.file} does not exist.")
            self.data = {**(load(words_of(self.file), self.file) or {}), "study": study}
        self.participants = self.data.get("participants") or {}

    @property
    def study(self):
        section = self.data.get("study")
        expect(isinstance(section, dict), f"{self.asked}: there is no section 'study'.")
        return section

    @property
    def has_picture(self):
        """Of its own: a section `plot` or a plot.py beside it."""
        return "plot" in self.data or (self.file.parent / "plot.py").is_file()

    @property
    def coupled(self):
        return bool(self.data.get("coupling")) and len(self.participants) > 1

    def absolute(self, key, participant):
        """Keys start at a participant unless they start with a section."""
        return key if re.match(r"(simulation|participants|coupling)\.", key) else f"participants.{participant}.{key}"

    def assignments(self, changes):
        """Arguments of --set. A key below a mapping that the case does not have is given with that mapping, which an earlier change
        may have given whole; of two changes of the same key the later counts."""
        added, plain, whole = {}, [], {}
        for key, value in changes.items():
            parts, node = key.split("."), self.data
            for depth, part in enumerate(parts[:-1]):
                if isinstance(node, dict) and part not in node:
                    above = ".".join(parts[:depth + 1])
                    place = added.setdefault(above, copy.deepcopy(mapping_of(whole.get(above))))
                    for inner in parts[depth + 1:-1]:
                        place = place.setdefault(inner, {})
                    place[parts[-1]] = value
                    break
                node = node[part] if isinstance(node, dict) else None
            else:
                plain.append(f"{key}={text_of(value)}")
                whole[key] = value
                added.pop(key, None)
        return plain + [f"{key}={json.dumps(value)}" for key, value in added.items()]

    def program(self, participant):
        entry = self.participants.get(participant)
        expect(participant in self.participants, f"{self.file}: there is no participant '{participant}'.")
        expect(isinstance(entry, dict), f"{self.file}: participants.{participant}: expected a mapping with at least the key 'program'.")
        return self.build / "bin" / str(entry.get("program", "?"))

    def guest(self, participant, played_by=None):
        """The words that start an external program, which does not read the case: those given, else a file of the program's name
        beside the case, or one on the PATH, with the participant's name; None for a program of ours."""
        if played_by and participant in played_by:
            return played_by[participant]
        program = self.program(participant)
        if program.exists() or program.name in OURS:
            return None
        for name in (program.name, program.name + ".py"):
            beside = self.file.parent / name
            if beside.is_file():
                return [*([sys.executable] if name.endswith(".py") else []), beside, participant]
        found = shutil.which(program.name)
        return [found, participant] if found else None

    def command(self, changes, alone=None, ranks=None, raw=(), flags=(), played_by=None):
        """The command line. `alone`: this participant by itself; `ranks`: {participant or coupler: number}; `raw`: further
        arguments of --set as they are; `flags`: further arguments of all our programs; `played_by`: {participant: words that start it}."""
        sets = [*(word for a in (*self.assignments(changes), *raw) for word in ("--set", a)), *flags]
        ranks = ranks or {}
        if alone is not None or not self.coupled:
            name = alone or next(iter(self.participants))
            line = [self.program(name), self.file, "--participant", name, *sets]
            return line if ranks.get(name, 1) == 1 else ["mpirun", "--oversubscribe", "-n", ranks[name], *line]
        line = ["mpirun", "--oversubscribe", "-n", ranks.get(COUPLER, 1), self.build / "bin" / COUPLER, self.file, *sets]
        for name in self.participants:
            line += [":", "-n", ranks.get(name, 1), *(self.guest(name, played_by) or [self.program(name), self.file, "--participant", name, *sets])]
        return line

    def named(self, node):
        """Files that the case names, such as a mesh or a weather file in another folder."""
        if isinstance(node, dict) or isinstance(node, list):
            for child in node.values() if isinstance(node, dict) else node:
                yield from self.named(child)
        elif isinstance(node, str) and 0 < len(node) < 200 and "\n" not in node and (self.file.parent / node).is_file():
            yield self.file.parent / node

    def digest(self, changes=None):
        """Of all that a result depends on besides its settings: the files that case and changes name, and the programs."""
        mark = hashlib.sha256()
        inputs = {f.resolve() for f in self.named([self.data, list((changes or {}).values())])} | {
            f.resolve() for f in self.file.parent.glob("*.geo")}
        programs = {self.program(name) for name in self.participants} | ({self.build / "bin" / COUPLER} if self.coupled else set())
        sections = {k: v for k, v in self.data.items() if k not in ("study", "plot")}  # a study may grow without its runs being made again
        mark.update(json.dumps(sections, sort_keys=True, default=str).encode())
        for file in (*sorted(inputs), *sorted(programs)):
            if file.exists():
                status = file.stat()
                mark.update(str(file.name).encode() + content_of(file, status.st_mtime_ns, status.st_size))
        return mark.hexdigest()
