#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""scripts/couplet study by axes: every run is made once, whether the study is killed, started again or twice at once; a failed run is
a row with its reason; orders and extrapolations come out; the page needs nothing but itself. usage: axes.py BUILD"""
import base64
import csv
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[3]
STUDY = """
study:
  axes:
    mesh: {sizes: [2, 4, 8], set: {mesh-parameters: "{n_length: <10*n>, n_side: <n>}"}}
    method: {values: {direct: {solution-method.type: block-coupled, solution-method.linear-solver: direct},
                      iterative: {solution-method.type: newton-krylov}, broken: {material.poissons-ratio: 0.7}}}
  leave-out: [{mesh: [4, 8], method: broken}]
  quantities:
    tip: {probe: "tip y [m]", reference: 0.10008}
    again: {probe: "tip y [m]", reference: richardson}
"""


def command(build, folder, *options):
    return [ROOT / "scripts/couplet", "study", folder / "case.yaml", f"--build={build}", *options]


def study(build, folder, *options):
    return subprocess.run(command(build, folder, *options), capture_output=True, text=True)


def rows_of(folder):
    with open(folder / "out/study/runs.csv", newline="") as file:
        return list(csv.DictReader(file))


def made(text):
    """Names of the runs that a study made itself."""
    return re.findall(r"^\[\d+/\d+\] (\S+): [\d.]+ s,", text, flags=re.M)


def restartable(build, folder):
    """Killed after its first run, then two at once: each of the seven runs is made exactly once in all."""
    process = subprocess.Popen(command(build, folder), stdout=subprocess.PIPE, text=True)
    first = process.stdout.readline()
    process.send_signal(signal.SIGKILL)
    process.wait()
    time.sleep(3)  # what it had under way ends for itself
    both = [subprocess.Popen(command(build, folder), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) for _ in range(2)]
    texts = [p.communicate()[0] for p in both]
    names = made(first) + [name for text in texts for name in made(text)]
    wanted = {f"{n}-{m}" for n in (2, 4, 8) for m in ("direct", "iterative")}
    failed = check("killed and started twice at once: every run made once", sorted(names) == sorted(wanted), first + "\n--\n".join(texts))
    before = (folder / "out/study/runs.csv").read_text()
    result = study(build, folder)
    failed += check("started again nothing is repeated", made(result.stdout) == [] and "done before" in result.stdout, result.stdout)
    return failed + check("and the table is the same", (folder / "out/study/runs.csv").read_text() == before)


def content(folder):
    rows = {row["mesh"] + row["method"]: row for row in rows_of(folder)}
    errors = [float(rows[f"{n}iterative"]["error of tip"]) for n in (2, 4, 8)]
    failed = check("errors fall with the mesh", errors[0] > errors[1] > errors[2] > 0, str(errors))
    broken = rows["2broken"]
    failed += check("a failed run is a row with its reason", "poissons-ratio" in broken["reason"] and broken["tip"] == "", str(broken))
    failed += check("costs are there", all(float(r["processor [s]"]) > 0 and float(r["memory [MB]"]) > 10 and float(r["steps"]) == 1
                                           for r in rows.values() if not r["reason"]), str(rows))
    report = (folder / "out/study/report.md").read_text()
    limits = re.findall(r"\| (?:direct|iterative) \| 0\.09\d+ \| (0\.1\d+|0\.09\d+) \| (\d\.\d+) \|", report)
    failed += check("Richardson's limit lies at the reference, at first order or more", len(limits) >= 2 and all(
        abs(float(v) / 0.10008 - 1) < 0.02 and 0.8 < float(p) < 3 for v, p in limits), report)
    page = (folder / "out/study/report.html").read_text()
    pictures = re.findall(r'src="data:image/png;base64,([^"]+)"', page)
    failed += check("the page holds its pictures and asks for nothing else", len(pictures) >= 5 and not re.search(
        r'(src|href)="(?!data:)|url\(|@import|<script', page) and all(base64.b64decode(p)[:4] == b"\x89PNG" for p in pictures))
    return failed


def looked_at(folder):
    """A screenshot in a real browser."""
    browser = next((b for b in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if b), None)
    if not browser:
        print("skipped: the page is not looked at, as no browser is installed (apt-get install chromium)")
        return 0
    shot = folder / "page.png"
    subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--host-resolver-rules=MAP * ~NOTFOUND", f"--screenshot={shot}",
                    "--window-size=1000,3000", f"--user-data-dir={folder / 'profile'}", f"file://{folder / 'out/study/report.html'}"],
                   capture_output=True, timeout=120)
    if not shot.exists():
        return check("the browser draws the page", False)
    import matplotlib.image
    picture = matplotlib.image.imread(shot)
    ink = (picture[..., :3].min(axis=2) < 0.6).mean(axis=1) > 0.002  # rows of the screen with text or lines
    return check("the browser draws the page from top to bottom", ink[:200].any() and ink[1000:2500].mean() > 0.1, str(ink.mean()))


def wrong(build, folder):
    failed = 0
    for text, word in (("axes: {}", "expected axes by name"), ("axes: {a: {sizes: [1], set: {x: <m>}}}\n  quantities: {q: {probe: x}}", "not arithmetic in n"),
                       ("axes: {a: {key: b}}\n  quantities: {q: {probe: x}}", "values: [...]"),
                       ("axes: {a: {key: b, values: [1]}}", "quantities of interest by name"),
                       ("axes: {a: {key: b, values: [1]}}\n  quantities: {q: {prob: x}}", "unknown key 'prob'"),
                       ("axes: {a: {key: b, values: [1]}}\n  quantities: {q: {probe: x, reference: best}}", "expected a number, finest or richardson")):
        (folder / "wrong.yaml").write_text(f"case: case.yaml\nstudy:\n  {text}\n")
        result = subprocess.run([ROOT / "scripts/couplet", "study", folder / "wrong.yaml", f"--build={build}"], capture_output=True, text=True)
        failed += check(f"said: {word}", result.returncode != 0 and word in result.stderr and "Traceback" not in result.stderr, result.stderr)
    return failed


def mappings(folder):
    """A key that changes within a mapping that the case lacks and another axis has given keeps the rest of it, and the later counts."""
    sys.path.insert(0, str(ROOT / "client/python"))
    from couplet.runs import Case
    case, method = Case(folder / "case.yaml"), "participants.solid.solution-method"
    given = {method: {"type": "segregated", "acceleration": "aitken"}, f"{method}.face-gradient": "thesis", "simulation.end-time": "1 s"}
    both = case.assignments(given)[-1] == method + '={"type": "segregated", "acceleration": "aitken", "face-gradient": "thesis"}'
    text = case.assignments({**given, method: "{type: newton-krylov}"})[-1] == method + '={"type": "newton-krylov", "face-gradient": "thesis"}'
    later = case.assignments(dict(reversed(given.items())))[-1].startswith(f'{method}={{"type": "segregated"') and given[method] == {
        "type": "segregated", "acceleration": "aitken"}
    return check("keys within a mapping that another axis gave keep the rest of it", both and text and later,
                 str([case.assignments(given), case.assignments(dict(reversed(given.items())))]))


def covered(build, folder):
    """A mapping of a later axis would take away an earlier one's key in it: refused, with both names; the other way round it runs."""
    place = folder / "covered"
    place.mkdir()
    axes = ["gradient: {key: solution-method.face-gradient, values: [thesis]}", "method: {values: {direct: {solution-method: {type: block-coupled}}}}"]
    found = []
    for order in (axes, axes[::-1]):
        (place / "study.yaml").write_text("case: ../case.yaml\nstudy:\n  axes:\n" + "".join(f"    {a}\n" for a in order) + "  quantities: {tip: {probe: \"tip y [m]\"}}\n")
        found.append(subprocess.run([ROOT / "scripts/couplet", "study", place / "study.yaml", f"--build={build}", "--list"], capture_output=True, text=True))
    return check("a mapping that would replace another axis's key is refused", found[0].returncode != 0 and "'solution-method' of 'method' would replace" in
                 found[0].stderr + found[0].stdout and found[1].returncode == 0 and '"face-gradient": "thesis"' in found[1].stdout, str(found))


def of_fields(build, folder):
    """A bar pulled without contraction: its displacement is the exact field in cells and at points."""
    place = folder / "bar"
    place.mkdir()
    shutil.copy(folder / "cantilever.geo", place)
    (place / "case.yaml").write_text((folder / "case.yaml").read_text().split("\nstudy:")[0] + """
study:
  axes: {pulled: {values: {along: {material.poissons-ratio: 0, boundaries.tip: "{type: traction, value: [125, 0, 0]}"}}},
         mesh: {sizes: [2], set: {mesh-parameters: "{n_length: <10*n>, n_side: <n>}"}}}
  quantities:
    points: {field: displacement, exact: ["1.25e-5*x", "0", "0"]}
    cells: {field: cell-displacement, exact: ["1.25e-5*x", "0", "0"]}
""")
    said = study(build, place)
    rows = rows_of(place)
    return check("norms of fields of points and of cells", all(float(rows[0][f"error of {q}"]) < 1e-6 for q in ("points", "cells")), said.stdout + said.stderr)


def estimated():
    """What runs say of their errors, on made-up numbers."""
    sys.path.insert(0, str(ROOT / "client/python"))
    from types import SimpleNamespace as S
    from couplet.study.estimates import guesses, uncertainty
    found = guesses({"tvd": ([10, 20, 40], [1.04, 1.01, 1.0025]), "implicit": ([10, 20, 40], [1.17, 1.13, 1.115])})
    failed = check("what a series cannot see another one shows", 0.1 < found["implicit", 2] < 0.12 and found["tvd", 2] < 0.005, str(found))
    chance = guesses({"hexahedra": ([2, 4, 8], [0.0996, 0.09998, 0.10006]), "tetrahedra": ([2, 4], [0.10064, 0.10063])})
    failed += check("a run with one coarser beside it accuses none with two", chance["hexahedra", 2] < 1e-4, str(chance))
    first, second = (guesses({"upwind": ([10, 20], [1.4, 1.2])}, orders)["upwind", 1] for orders in ({"upwind": 1}, None))
    left = [uncertainty([], S(is_error=False, reference=1.0, given=given)) for given in ({"good-to": 1e-3}, {})]
    failed += check("a reference may be good to so much only", left == [1e-3, 0], str(left))
    return failed + check("a series may be of another order", abs(first - 0.2) < 1e-12 and abs(second - 0.2 / 3**0.5) < 1e-12, f"{first} {second}")


def main(build):
    with tempfile.TemporaryDirectory(prefix="couplet-axes-") as name:
        folder = pathlib.Path(name)
        shutil.copy(ROOT / "configs/cantilever/cantilever.geo", folder)
        (folder / "case.yaml").write_text((ROOT / "configs/cantilever/case.yaml").read_text().split("\nstudy:")[0] + STUDY)
        failed = estimated()
        failed += mappings(folder)
        failed += covered(build, folder)
        failed += of_fields(build, folder)
        failed += restartable(build, folder)
        failed += content(folder)
        failed += looked_at(folder)
        failed += wrong(build, folder)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
