# SPDX-License-Identifier: Apache-2.0
"""Keywords of a deck with their data, and its mesh. Both are read by the script of the programs, so that a case has the
patches and zones that the programs find."""
import dataclasses
import functools
import math

from couplet import places
from couplet.runs.case import Wrong


@functools.cache
def script():
    """Names of the script that reads decks (common/mesh/gmsh/to_msh.py)."""
    names = {}
    for part in ("deck.py", "deck_mesh.py"):
        file = places.ROOT / "common/mesh/gmsh" / part
        exec(compile(file.read_text(), file, "exec"), names)
    return names


def real(cell, place):
    try:
        value = float(cell.upper().replace("D", "E", 1))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise Wrong(f"{place}: '{cell[:60]}' is not a number.")
    return value


@dataclasses.dataclass
class Block:
    """A keyword with its parameters and its data, which are rows of a place and cells."""

    word: str
    values: dict
    place: str
    rows: list = dataclasses.field(default_factory=list)

    def lines(self):
        """Yields a block for each line of the data."""
        for place, cells in self.rows:
            yield Block(self.word, self.values, place, [(place, cells)])

    def text(self, column):
        cells = self.rows[0][1] if self.rows else []
        return cells[column] if column < len(cells) else ""

    def number(self, column, default=None):
        """Number in the first line of the data; `default` where there is none."""
        if not self.text(column) and default is None:
            raise Wrong(f"{self.place}: *{self.word} needs a number as value {column + 1} of its data.")
        return real(self.text(column), self.rows[0][0]) if self.text(column) else default


def read(file):
    """Returns the blocks of a deck, its mesh, and what the script says of them."""
    names, said, name = script(), [], str(file)
    names.update(
        NAME=name, say=lambda text, kind="", place="": said.append((place or name, text.removeprefix(f"{place}: ")))
    )

    class Blocks(names["Reader"]):
        def __init__(self, *names):
            self.blocks = []
            super().__init__(*names)

        def keyword(self):
            word, values = super().keyword()
            self.blocks.append(Block(word, values, self.place()))
            return word, values

        def skip(self, word="", values=None):
            while self.data():
                self.blocks[-1].rows.append((self.place(), [cell.strip().strip('"') for cell in self.line.split(",")]))

    class Mesh(names["Mesh"]):
        has_overlaps = False

        def assign(self, key, patch):
            """Gives a face of two surfaces, which the programs refuse, to the first one."""
            self.has_overlaps |= self.patch_of.setdefault(key, patch) != patch

    try:
        reader = Blocks(file, name)
        deck = reader.read()
        deck.skipped, deck.connections = set(), set()  # named with their lines
        return reader.blocks, Mesh(deck), said
    except names["Problem"] as problem:
        raise Wrong(str(problem)) from None
