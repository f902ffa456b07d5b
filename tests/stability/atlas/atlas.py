# SPDX-License-Identifier: Apache-2.0
"""No square of the atlas is red: every map has its whole table, the outcome of each square follows from its error, exit code and warning, and each
hard case has its test.
Usage: atlas.py PROJECT_ROOT"""
import math
import pathlib
import sys

root = pathlib.Path(sys.argv[1]).resolve()
sys.path[:0] = [str(root / "scripts"), str(root / "client/python")]
import atlas  # noqa: E402

wrong = []
count = 0
for name, m in atlas.maps().items():
    squares = atlas.read(root / f"docs/stability/{name}.csv")
    if set(squares) != set(atlas.keys(m)):
        wrong.append(f"{name}: {len(squares)} squares")
    count += len(squares)
    wrong += [f"{name} {key}: {s}" for key, s in squares.items() if s.outcome == atlas.RED or s.outcome != atlas.outcome(s.error, s.code, s.doubted)]

# Red is only what is more than 20 % off, ends with exit code 0, and has no warning.
for number, code, doubted, wanted in ((2, 0, False, atlas.RED), (math.nan, 0, False, atlas.RED), (2, 0, True, atlas.WARNED), (2, 1, False, atlas.REFUSED),
                                      (0.97, 0, False, atlas.HOLDS), (0.85, 0, False, atlas.POOR), (0.75, 0, False, atlas.RED), (1.1, 0, True, atlas.POOR)):
    if atlas.judged(number, code, doubted, abs(number - 1)).outcome != wanted:
        wrong.append(f"judged wrongly: {number}, exit code {code}, doubted {doubted}")
wrong += [f"no test in tests/stability: {name}" for name in atlas.missing_tests(root)]
if count < 1000:
    wrong.append(f"{count} squares only")
print("\n".join(wrong) or f"{count} squares, none red; {len(atlas.hard_cases())} hard cases have their tests")
sys.exit(1 if wrong else 0)
