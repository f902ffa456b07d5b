# SPDX-License-Identifier: Apache-2.0
"""Rows as data: tables/NAME.yaml. Its keys: `about`; `sources`, folders whose change may change its rows; `note` before
its rows; `pages`, functions that write what is made of the table; `library`, files below parts whose functions measure;
`rows`.

A program among the `sources` stands for itself and for the folders of common that its numbers come from (COMMON),
without what only judges or prints them. Tables about diagnostics, messages or speed name 'common'.

A row is `quantity: {wanted, long, but, sources, MEASURE: ARGUMENTS}` (job.Bar describes these). MEASURE is a function
of shapes.py or of the library, 'file.function' where two have it. It gets the job and ARGUMENTS: one value, a list in
order, or a mapping by name. An entry with `rows` is a group: what else it holds is shared by its rows, and with `each`
they are written once for every combination, the first varying slowest. '{name}' in a text is replaced, and is the value
itself where it is the whole text:

    plates: {each: {n: [8, 16], 'word, limit': [[hard, 1e-3], [soft, 1e-2]]}, rows: {'{word} plate, {n} cells': {wanted:
    '<= {limit}', plate: ['{n}', '{limit}']}}}
"""
import dataclasses
import importlib
import inspect
import itertools
import pathlib
import re

import yaml

from validation import shapes
from validation.job import Bar

FOLDER = pathlib.Path(__file__).resolve().parent / "tables"
MESHES = ("base", "parallel", "linalg", "mesh", "fv", "time")
COMMON = {
    "fluid_solver": MESHES,
    "solid_solver": (*MESHES, "elasticity", "contact", "modes"),
    "mesh_mover": (*MESHES, "elasticity"),
    "plate_modal": (*MESHES, "contact", "modes"),
    "thermocline": ("base", "fv", "time"),
    "coupler": ("base", "parallel", "linalg", "coupling"),
}
WORDS = ("wanted", "long", "but", "sources")


class Loader(yaml.SafeLoader):
    """1e-6 is a number, and no key may stand twice."""

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key, deep) for key, _ in node.value]
        twice = {k for k in keys if keys.count(k) > 1}
        if twice:
            raise ValueError(f"{node.start_mark}: twice: {', '.join(map(str, twice))}")
        return super().construct_mapping(node, deep)


Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$"), list("-+0123456789.")
)


@dataclasses.dataclass
class Table:
    name: str
    bars: list
    sources: tuple
    note: str
    pages: list


def needed(sources):
    """Folders, and '!FOLDER' for what does not count, whose change may change rows with these sources."""
    if "common" in sources:
        return tuple(sources)
    below = dict.fromkeys(f"common/{folder}" for program in sources for folder in COMMON.get(program, ()))
    return (*below, *sources, *(f"!{program}/diagnostics" for program in sources if program in COMMON))


def known():
    return sorted(f.stem for f in FOLDER.glob("*.yaml"))


def part(path):
    return importlib.import_module("validation.parts." + path.replace("/", "."))


def named(text):
    """The function that 'folder/file.function' names."""
    path, name = text.rsplit(".", 1)
    return getattr(part(path), name)


def arguments(name, measure):
    """Returns {quantity: arguments} of the rows of a table by this measure."""
    data = yaml.load((FOLDER / f"{name}.yaml").read_text(), Loader)
    return {quantity: frozen(row[measure]) for quantity, row in written_out(data["rows"]) if measure in row}


def load(name, file=None):
    file = file or FOLDER / f"{name}.yaml"
    data = yaml.load(file.read_text(), Loader)
    unknown = set(data) - {"about", "sources", "note", "pages", "library", "rows"}
    if unknown:
        raise ValueError(f"{file.name}: unknown {', '.join(unknown)}")
    library = {path.split("/")[-1]: part(path) for path in data.get("library") or ()}
    if len(library) < len(data.get("library") or ()):
        raise ValueError(f"{file.name}: two files of the library have one name")
    bars = [bar(quantity, row, library) for quantity, row in written_out(data["rows"])]
    twice = {b.quantity for b in bars if sum(b.quantity == o.quantity for o in bars) > 1}
    if twice:
        raise ValueError(f"{file.name}: twice: {'; '.join(twice)}")
    return Table(
        name, bars, needed(data.get("sources") or ()), data.get("note", ""), [named(p) for p in data.get("pages") or ()]
    )


def written_out(rows, shared=None):
    """Returns (quantity, row) of all rows, groups resolved."""
    for quantity, row in rows.items():
        if "rows" not in row:
            yield quantity, {**(shared or {}), **row}
            continue
        rest = {k: v for k, v in row.items() if k not in ("rows", "each")}
        for values in combinations(row.get("each") or {}):
            yield from written_out(filled(row["rows"], values), {**(shared or {}), **filled(rest, values)})


def combinations(each):
    """Returns [{name: value}] of every combination of the lists."""
    lists = []
    for names, values in each.items():
        names = [n.strip() for n in names.split(",")]
        lists.append([dict(zip(names, value if len(names) > 1 else [value], strict=True)) for value in values])
    return [{k: v for one in chosen for k, v in one.items()} for chosen in itertools.product(*lists)]


def filled(thing, values):
    """Replaces '{name}' by the values of these names."""
    if not values:
        return thing
    if isinstance(thing, str):
        whole = re.fullmatch(r"\{(\w+)\}", thing)
        if whole and whole[1] in values:
            return values[whole[1]]
        return re.sub(r"\{(\w+)\}", lambda m: str(values[m[1]]) if m[1] in values else m[0], thing)
    if isinstance(thing, list):
        return [filled(v, values) for v in thing]
    if isinstance(thing, dict):
        return {filled(k, values): filled(v, values) for k, v in thing.items()}
    return thing


def bar(quantity, row, library):
    if "wanted" not in row:
        raise ValueError(f"'{quantity}': nothing is wanted")
    measures = [k for k in row if k not in WORDS]
    if len(measures) != 1:
        raise ValueError(f"'{quantity}': one measure, but there is {', '.join(measures) or 'none'}")
    function, arguments = function_of(measures[0], library), frozen(row[measures[0]])
    words, by_name = (
        ((), arguments)
        if isinstance(arguments, dict)
        else (arguments if isinstance(arguments, tuple) else () if arguments is None else (arguments,), {})
    )
    try:
        inspect.signature(function).bind(None, *words, **by_name)
    except TypeError as error:
        raise ValueError(f"'{quantity}', {measures[0]}: {error}") from None
    return Bar(
        quantity,
        str(row["wanted"]),
        lambda job: function(job, *words, **by_name),
        bool(row.get("long")),
        row.get("but", ""),
        needed(row.get("sources") or ()),
    )


def function_of(name, library):
    file, _, word = name.rpartition(".")
    places = (
        [library[file]] if file in library else [] if file else [shapes] if hasattr(shapes, word) else library.values()
    )
    found = [
        getattr(p, word)
        for p in places
        if inspect.isfunction(getattr(p, word, None)) and getattr(p, word).__module__ == p.__name__
    ]
    if len(found) != 1:
        raise ValueError(
            f"{len(found)} functions '{name}' in shapes.py or the library {', '.join(library) or '(none)'}"
        )
    return found[0]


def frozen(thing):
    """Lists as tuples, so that what was run can be looked up by its arguments."""
    if isinstance(thing, list):
        return tuple(frozen(v) for v in thing)
    return {k: frozen(v) for k, v in thing.items()} if isinstance(thing, dict) else thing
