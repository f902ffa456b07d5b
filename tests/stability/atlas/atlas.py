# SPDX-License-Identifier: Apache-2.0
"""No red square of the atlas: what is judged again from number and exit code of each committed square says what its table says, no
square is a wrong answer with exit code 0, every map has its table and picture whole, and each hard case has its test.
Usage: atlas.py PROJECT_ROOT"""
import math
import pathlib
import sys

root = pathlib.Path(sys.argv[1]).resolve()
sys.path.insert(0, str(root / "client/python"))
from couplet.atlas import atlas, cases  # noqa: E402
from couplet.atlas.main import MAPS  # noqa: E402

wrong = []
count = 0
for m in MAPS:
    squares = atlas.read(root / f"docs/stability/{m.name}.csv")
    if len(squares) != len(m.panels) * len(m.x.values) * len(m.y.values) or not (root / f"docs/stability/{m.name}.png").exists():
        wrong.append(f"{m.name}: {len(squares)} squares")
    count += len(squares)
    wrong += [f"{m.name} {key}: {s}" for key, s in squares.items()
              if s.outcome == atlas.RED or s.outcome != atlas.outcome(s.error, s.code, s.doubted)]

# The judge itself: red is only what is more than 20 % off, ends with exit code 0, and was not doubted.
one = atlas.Map("one", "", "", None, None, [], None, error=lambda number: abs(number - 1))
for number, code, doubted, wanted in ((2, 0, False, atlas.RED), (math.nan, 0, False, atlas.RED), (2, 0, True, atlas.WARNED), (2, 1, False, atlas.REFUSED),
                                      (0.97, 0, False, atlas.HOLDS), (0.85, 0, False, atlas.POOR), (0.75, 0, False, atlas.RED), (1.1, 0, True, atlas.POOR)):
    if atlas.judged(one, number, code, doubted).outcome != wanted:
        wrong.append(f"judged wrongly: {number}, exit code {code}, doubted {doubted}")
wrong += [f"no test in tests/stability: {name}" for name in cases.missing(root)]
if count < 1000:
    wrong.append(f"{count} squares only")
print("\n".join(wrong) or f"{count} squares, none red; {len(cases.CASES)} hard cases have their tests")
sys.exit(1 if wrong else 0)
