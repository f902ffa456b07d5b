# SPDX-License-Identifier: Apache-2.0
"""The mistakes of a user: how each differs from a right case, and what becomes of it."""
from dataclasses import dataclass, field

import flow_mistakes
import number_mistakes
import reliability_mistakes
import scene_mistakes

REFUSED, FLAGGED, RIGHT = "refused", "flagged", "right"
PROGRAMS = {"solid": "solid_solver", "heat": "solid_solver", "fluid": "fluid_solver", "plate": "plate_modal", "tank": "thermocline",
            "mover": "mesh_mover", "coupled": "coupler"}


@dataclass
class Mistake:
    name: str
    base: str  # NAME.yaml beside this file ...
    edits: list  # ... with these (old, new) replacements
    outcome: str  # refused: exit code 2 (1 once it runs); flagged: a warning, and --strict fails; right: nothing is wrong, for a reason
    message: str = ""  # part of what is said; of what is right: why it is
    run: bool = False  # else --check
    files: dict = field(default_factory=dict)
    code: int = None  # exit code, if it is another than the outcome's
    says: str = ""  # further part of what is said
    twice: list = None  # arguments of a second run in the same folder, which is the one judged


GROUPS = {"numbers": number_mistakes, "flow": flow_mistakes, "scene": scene_mistakes, "reliability": reliability_mistakes}
MISTAKES = {name: [Mistake(*words[:4], **(words[4] if len(words) > 4 else {})) for words in group.MISTAKES] for name, group in GROUPS.items()}
