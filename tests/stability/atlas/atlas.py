# SPDX-License-Identifier: Apache-2.0
"""No red square of the atlas: what is judged again from number and exit code of each committed square says what its table says, no
square is a wrong answer with exit code 0, every map has its table and picture whole, and each hard case has its test.
Usage: atlas.py PROJECT_ROOT"""
import math
import pathlib
import sys

root = pathlib.Path(sys.argv[1]).resolve()
sys.path.insert(0, str(root / "client/python"))
from couplet.atlas import atlas, cases, coupling, fluid, large, moving, plate, solid, strong, tank, viscous  # noqa: E402

wrong = []
count = 0
for part in (solid, large, fluid, moving, coupling, viscous, strong, tank, plate):
    for m in part.MAPS:
        squares = atlas.read(root / f"docs/stability/{m.name}.csv")
        if len(squares) != len(m.panels) * len(m.x.values) * len(m.y.values) or not (root / f"docs/stability/{m.name}.png").exists():
            wrong.append(f"{m.name}: {len(squares)} squares")
        count += len(squares)
        wrong += [f"{m.name} {key}: {s}" for key, s in squares.items()
                  if s.outcome == atlas.RED or s.outcome != atlas.outcome(m, s.number, s.code, s.outcome == atlas.WARNED)]

# The judge itself: red is only what misses the criterion, ends with exit code 0, and was not doubted.
one = atlas.Map("one", "", "", None, None, [], None, holds=lambda number: number < 1)
for number, code, doubted, wanted in ((2, 0, False, atlas.RED), (math.nan, 0, False, atlas.RED), (2, 0, True, atlas.WARNED), (2, 1, False, atlas.REFUSED),
                                      (0.5, 0, False, atlas.HOLDS)):
    if atlas.outcome(one, number, code, doubted) != wanted:
        wrong.append(f"judged wrongly: {number}, exit code {code}, doubted {doubted}")
wrong += [f"no test in tests/stability: {name}" for name in cases.missing(root)]
if count < 1000:
    wrong.append(f"{count} squares only")
print("\n".join(wrong) or f"{count} squares, none red; {len(cases.CASES)} hard cases have their tests")
sys.exit(1 if wrong else 0)
