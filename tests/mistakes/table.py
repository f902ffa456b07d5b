# SPDX-License-Identifier: Apache-2.0
"""The mistakes of a user in table/GROUP.yaml: how each differs from a right case, and what becomes of it."""
import pathlib
from dataclasses import dataclass, field

import yaml

REFUSED, FLAGGED, RIGHT = "refused", "flagged", "right"
PROGRAMS = {"solid": "solid_solver", "heat": "solid_solver", "fluid": "fluid_solver", "plate": "plate_modal", "tank": "thermocline",
            "mover": "mesh_mover", "coupled": "coupler"}


@dataclass
class Mistake:
    name: str
    base: str  # NAME.yaml beside this file, with the edits
    outcome: str  # refused: exit code 2 (1 once it runs); flagged: a warning, and --strict fails; right: nothing is wrong, for a reason
    edits: list = field(default_factory=list)  # (old, new)
    set: list = field(default_factory=list)  # of keys of the participant; without a value: it is removed
    message: str = ""  # part of what is said; of what is right: why it is
    run: bool = False  # else --check
    files: dict = field(default_factory=dict)
    code: int = None  # exit code, if it is another than the outcome's
    says: str = ""  # further part of what is said
    twice: list = None  # arguments of a second run in the same folder, which is the one judged

    @property
    def case(self):
        return pathlib.Path(__file__).parent / f"{'coupled' if self.base == 'mover' else self.base}.yaml"


MISTAKES = {group: [Mistake(**row) for row in yaml.safe_load((pathlib.Path(__file__).parent / f"table/{group}.yaml").read_text(encoding="utf-8"))["mistakes"]]
            for group in ("numbers", "flow", "scene", "reliability", "rules")}
