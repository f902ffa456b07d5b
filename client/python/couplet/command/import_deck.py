# SPDX-License-Identifier: Apache-2.0
"""Creates a case from a deck of CalculiX or Abaqus, for `couplet import` (command/import_case.py)."""
import os
import re

import yaml

from couplet import files
from couplet.deck.blocks import read
from couplet.deck.case import case_of
from couplet.deck.physics import Physics
from couplet.runs.case import CONTROL, expect


def plain(text):
    return CONTROL.sub(" ", str(text)).encode(errors="replace").decode()


def run(arguments):
    deck = arguments.configuration
    output = arguments.output or deck.with_suffix(".yaml")
    expect(
        arguments.check or arguments.force or not output.exists(), f"{output}: the file exists; --force overwrites it."
    )
    blocks, mesh, said = read(deck)
    physics = Physics(blocks, mesh, arguments.units or "si")
    own_mesh, source = f"{output.stem}-mesh.msh", os.path.relpath(deck, output.parent)
    name = re.sub(r"[^\w-]", "_", output.stem)
    case, is_own = case_of(physics, name, lambda is_own: source if is_own else own_mesh)
    notes = [(plain(place), plain(text)) for place, text in said + physics.notes]
    if arguments.units is None:
        other = f"couplet import {deck} --units mm"
        notes.append(
            (plain(deck), f"numbers are taken as SI values; if the deck is in mm, N and MPa, run: {plain(other)}")
        )
    notes = [f"{place}: {text}." for place, text in dict.fromkeys(notes)]
    print("".join(f"{note}\n" for note in notes), end="")
    if arguments.check:
        return 0
    body = yaml.dump(case, sort_keys=False, default_flow_style=None, width=140, allow_unicode=True)
    expect(
        body == body.encode(errors="replace").decode(),
        f"{deck}: the names of sets are not in UTF-8; save the deck in UTF-8.",
    )
    lines = [f"# Made by couplet import from {plain(source)}.", *(f"# {note}" for note in notes), body]
    if not is_own:
        with files.part(output.parent, own_mesh) as made:
            mesh.write(made)
        print(f"{output.parent / own_mesh}: the mesh of the deck, with patches for its supports and loads")
    files.write(output.parent, output.name, "\n".join(lines))
    print(f"{output}: a case of solid_solver. couplet run {output} starts it")
    return 0
