# SPDX-License-Identifier: Apache-2.0
"""The atlas of stability: where each scheme is stable and where it fails, from runs of the programs. Writes MAP.csv and MAP.png and,
for docs/stability, docs/stability.md. Exit code 1 if a square is a wrong result without a guard or warning."""
import collections
import pathlib
import tempfile
import time

from couplet.atlas import atlas, cases, coupling, draw, fluid, large, moving, periodic, plant, plate, soft_flap, solid, strong, tank, viscous
from couplet.places import ROOT, build
from couplet.runs import expect

MAPS = [*solid.MAPS, *large.MAPS, *fluid.MAPS, *periodic.MAPS, *moving.MAPS, *coupling.MAPS, *viscous.MAPS, *soft_flap.MAPS, *strong.MAPS, *tank.MAPS, *plant.MAPS, *plate.MAPS]
# Maps with runs of earlier settings: they only hold fewer squares than the defaults do now.
WITHOUT_HALVING = ("coupling-viscous", "strong-robin")
HEAD = """# Where each scheme is stable

Written by `couplet atlas` from runs of the programs; do not edit. Each square shows the number of the map's criterion; each picture has
its table.

| colour | meaning |
|---|---|
| green | within 5 % |
| pale | within 20 % |
| yellow | further off, and the run warned (`--strict` makes it a failed run) |
| blue | a guard ended the run: exit code 1 |
| red | silent: more than 20 % off with exit code 0 and no warning: there must be none |

All runs have default settings but for what the map varies; a failed step is halved up to ten times, as in any run. `error` in a table is what the colour is of.
A run whose estimated error is above 0.15 warns ([findings](findings.md)).
"""


def page(maps, folder):
    text = HEAD
    for m in maps:
        squares = atlas.read(folder / f"{m.name}.csv")
        if not squares:
            continue
        counts = collections.Counter(s.outcome for s in squares.values())
        text += f"\n## {m.title}\n\n{m.about}\n\n![{m.title}](stability/{m.name}.png)\n\n"
        text += f"*{m.criterion}; {', '.join(f'{n} {o}' for o, n in sorted(counts.items()))}: [table](stability/{m.name}.csv).*\n"
        if m.name in WITHOUT_HALVING:
            text += "\n*Drawn without halving of steps, which the default settings have: squares that stopped may hold now.*\n"
    if lost := cases.missing(ROOT):
        raise SystemExit(f"hard cases without their test in tests/stability: {', '.join(lost)}")
    return text + cases.page()


def declare(parser):
    parser.add_argument("maps", nargs="*", metavar="MAP", help="names of maps (listed by --list); default: all")
    parser.add_argument("--build", type=pathlib.Path, default=build(), metavar="FOLDER", help="the folder with bin/ of the programs")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs" / "stability", metavar="FOLDER", help="where tables and pictures go (docs/stability)")
    parser.add_argument("--fresh", action="store_true", help="reruns every square; otherwise only missing ones")
    parser.add_argument("--list", action="store_true", help="lists the maps")
    parser.add_argument("--page", action="store_true", help="no runs: only docs/stability.md, from existing tables")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="number of concurrent runs")


def run(arguments):
    unknown = set(arguments.maps) - {m.name for m in MAPS}
    expect(not unknown, f"there is no map '{min(unknown, default='')}'; there is: {', '.join(m.name for m in MAPS)}")
    if arguments.list:
        print("\n".join(f"{m.name:18} {m.title}" for m in MAPS))
        return 0
    arguments.out.mkdir(parents=True, exist_ok=True)
    red = []
    for m in MAPS if not arguments.page else ():
        if arguments.maps and m.name not in arguments.maps:
            continue
        start = time.monotonic()
        with tempfile.TemporaryDirectory(prefix="couplet-stability-") as scratch:
            squares = atlas.make(m, arguments.out / f"{m.name}.csv", atlas.Runner(arguments.build.resolve(), scratch), arguments.fresh,
                                 arguments.jobs)
        draw.picture(m, squares, arguments.out / f"{m.name}.png")
        wrong = [k for k, s in squares.items() if s.outcome == atlas.RED]
        red += [(m.name, *k) for k in wrong]
        print(f"{m.name}: {len(squares)} squares, {len(wrong)} red, {time.monotonic() - start:.0f} s", flush=True)
    if arguments.out == ROOT / "docs" / "stability":
        (ROOT / "docs" / "stability.md").write_text(page(MAPS, arguments.out))
    for name, panel, x, y in red:
        print(f"RED {name}: {panel}, x {x:g}, y {y:g}")
    return 1 if red else 0

