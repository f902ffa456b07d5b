# SPDX-License-Identifier: Apache-2.0
"""Draws the atlas of stability: where each scheme is stable and where it fails, from runs of the programs. Writes
MAP.csv and, for docs/stability, docs/stability.md; for other folders MAP.png. Exit code 1 if a square is a wrong result
without a guard or warning.
Usage: python3 scripts/atlas [MAP ...]"""
import argparse
import collections
import pathlib
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "client/python")]
import atlas  # noqa: E402


MARKS = {atlas.HOLDS: "", atlas.POOR: " ~", atlas.WARNED: " w", atlas.REFUSED: "", atlas.RED: " **wrong**"}


def tables(map_, squares):
    """The squares of each panel as a table, the largest y first as in the picture."""
    text, xs = "", map_.x["values"]
    for panel in map_.panels:
        text += f"\n| {panel or 'y'} | " + " | ".join(f"{x:g}" for x in xs) + " |\n|" + "---|" * (len(xs) + 1) + "\n"
        for y in reversed(map_.y["values"]):
            row = [squares[panel, float(x), float(y)] for x in xs]
            text += (
                f"| {y:g} | "
                + " | ".join("stop" if s.code else f"{s.number:.2g}{MARKS[s.outcome]}" for s in row)
                + " |\n"
            )
    return text


def page(maps, folder):
    text = (pathlib.Path(__file__).parent / "head.txt").read_text()
    for m in maps.values():
        squares = atlas.read(folder / f"{m.name}.csv")
        counts = collections.Counter(s.outcome for s in squares.values())
        if squares:
            text += f"\n## {m.title}\n\n{m.about}\n\n"
            found = [f"{n} {('are ' if n > 1 else 'is ') * ('with' in o)}{o}" for o, n in sorted(counts.items())]
            shown = " and ".join(filter(None, (", ".join(found[:-1]), found[-1])))
            shown = (
                f"Of {len(squares)} runs, {shown}" if len(found) > 1 else f"All {len(squares)} runs are {max(counts)}"
            )
            x, y = (("" if "'s " in a["label"] else "the ") + a["label"] for a in (m.x, m.y))
            text += (
                f"*The tables show the {m.criterion}. {shown}"
                f" ([table](stability/{m.name}.csv)). The columns vary {x}, and the rows vary {y}.*\n"
            )
            text += tables(m, squares)
        if squares and m.given.get("without-halving"):
            text += (
                "\n*In these runs, failed steps were not halved, although the default settings do so. Points that"
                " stopped may therefore be stable with default settings.*\n"
            )
    if lost := atlas.missing_tests():
        raise SystemExit(f"hard cases without their test in tests/stability: {', '.join(lost)}")
    text += (
        "\n## Hard cases\n\nThese cases are tests in `tests/stability` (label `stability`). Each has a failure"
        " mechanism, a criterion, and a neighboring case that fails.\n\n"
    )
    text += "| part | case | mechanism | criterion | tested by | failing neighbor |\n|---|---|---|---|---|---|\n"
    tests = lambda names: "<br>".join(f"`{n.split(': ')[-1]}`" for n in names)
    for c in atlas.hard_cases():
        text += (
            f"| {c['part']} | {c['case']} | {c['mechanism']} | {c['criterion']} | {tests(c['holds'])} |"
            f" {tests(c['fails'])} |\n"
        )
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", nargs="*", metavar="MAP", help="names of maps (listed by --list); default: all")
    parser.add_argument(
        "--build",
        type=pathlib.Path,
        default=ROOT / "build",
        metavar="FOLDER",
        help="the folder with bin/ of the programs",
    )
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=ROOT / "docs/stability",
        metavar="FOLDER",
        help="where tables and pictures go (docs/stability)",
    )
    parser.add_argument("--fresh", action="store_true", help="reruns every square; otherwise only missing ones")
    parser.add_argument("--list", action="store_true", help="lists the maps")
    parser.add_argument("--page", action="store_true", help="no runs: only docs/stability.md, from existing tables")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="number of concurrent runs")
    arguments, maps, red, lost = parser.parse_args(), atlas.maps(), [], []
    if unknown := set(arguments.maps) - set(maps):
        parser.error(f"there is no map '{min(unknown)}'; there is: {', '.join(maps)}")
    if arguments.list:
        print("\n".join(f"{m.name:18} {m.title}" for m in maps.values()))
        return 0
    arguments.out.mkdir(parents=True, exist_ok=True)
    for m in () if arguments.page else maps.values():
        if arguments.maps and m.name not in arguments.maps:
            continue
        from atlas import draw

        start = time.monotonic()
        try:
            with tempfile.TemporaryDirectory(prefix="couplet-stability-") as scratch:
                squares = atlas.make(
                    m,
                    arguments.out / f"{m.name}.csv",
                    atlas.Runner(arguments.build.resolve(), scratch),
                    arguments.fresh,
                    arguments.jobs,
                )
        except RuntimeError as error:
            lost.append(f"{m.name}: could not be measured: {error}")
            continue
        if arguments.out != ROOT / "docs/stability":  # the site draws those
            draw.picture(m, squares, arguments.out / f"{m.name}.png")
        wrong = [k for k, s in squares.items() if s.outcome == atlas.RED]
        red += [f"RED {m.name}: {panel}, x {x:g}, y {y:g}" for panel, x, y in wrong]
        print(f"{m.name}: {len(squares)} squares, {len(wrong)} red, {time.monotonic() - start:.0f} s", flush=True)
    if arguments.out == ROOT / "docs/stability":
        (ROOT / "docs/stability.md").write_text(page(maps, arguments.out))
    print(*lost, *red, sep="\n", end="\n" if lost or red else "")
    return 1 if lost or red else 0


if __name__ == "__main__":
    sys.exit(main())
