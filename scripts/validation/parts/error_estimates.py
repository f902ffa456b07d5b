# SPDX-License-Identifier: Apache-2.0
"""Estimated errors beside the true ones: other programs on a case by one command, a flow that a clock drives, quantities of one run, the positions that runs
report on the atlas of stability."""
import csv
import json
import math
import pathlib
import re
import sys
import tempfile

import atlas
import yaml

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "benchmarks"))
import ablation  # noqa: E402


def beside(job, file, only, quantity, wanted):
    """One command on the case as it is, or on a part of its runs (the sizes that a busy machine allows); what was run before with the same programs and input is not
    run again. `wanted`: the largest error of each program's best run."""
    case = job.root / "configs" / file
    done = job.run(
        [job.root / "scripts/couplet", "study", case, "--peers", f"--only={only}", f"--build={job.build}"], timeout=7200
    )
    folder = case.parent / "out" / "study"
    if done.returncode != 0:
        return f"exit code {done.returncode}: {(done.stderr or done.stdout).strip()[-200:]}", False
    with open(folder / "peers.csv", newline="") as table:
        rows = [r for r in csv.DictReader(table) if not r["reason"]]
    head = f"error of {quantity}" if rows and f"error of {quantity}" in rows[0] else quantity
    parts, met = [], True
    for program, limit in wanted.items():
        best = min(
            (
                (float(r[head]), float(r["processor [s]"]))
                for r in rows
                if re.fullmatch(rf"{re.escape(program)}(, .*)?", r["version"])
            ),
            default=None,
        )
        parts.append(
            f"{program} {100 * best[0]:.2g} % in {best[1]:.2g} s"
            if best
            else f"{program}: no run" + (" (not installed)" if "is not installed" in done.stdout else "")
        )
        met = met and best is not None and best[0] <= limit
    with open(folder / "runs.csv", newline="") as table:
        ours = [(float(r[head]), float(r["processor [s]"])) for r in csv.DictReader(table) if r[head]]
    text = (folder / "report.md").read_text()
    section = text[text.index(f"\n## {quantity}\n") :].split("\n![", 1)[0]
    front = [p for p in wanted if f"| {p}" in section]
    return (
        (
            f"{'; '.join(parts)}; ours {100 * min(ours)[0]:.2g} % in {min(ours)[1]:.2g} s; on the front:"
            f" {', '.join(front) or 'ours alone'}"
        ),
        met,
    )


def scenes(job):
    """Each case has a second run with the effect, or a closed form (tests/cli/budget)."""
    done = job.run(
        [sys.executable, job.root / "tests/cli/budget/run.py", job.build / "bin", job.root / "configs", "all"], 900
    )
    good, bad = (re.findall(rf"^{word} +(.*?):", done.stdout, re.M) for word in ("ok", "FAILED"))
    near = re.findall(r"^ok +.*share ([\d.e+-]+), truth ([\d.e+-]+) \(near\)", done.stdout, re.M)
    text = (
        f"{len(good)} of {len(good) + len(bad)} name the right one{' (not: ' + '; '.join(bad) + ')' if bad else ''};"
        " shares and truths "
    )
    return (
        text + ", ".join(f"{share} and {truth}" for share, truth in near),
        not bad and len(good) == 10 and len(near) >= 8,
    )


def interest(job, **truths_of):
    """`truths_of`: {study: {quantity: truth}}"""
    parts, met = [], True
    for case, truths in truths_of.items():
        out = job.scratch / f"quantities-{case}"
        done = job.run(
            [
                sys.executable,
                job.root / "scripts/couplet",
                "study",
                job.root / f"configs/{case}/case.yaml",
                "--quantities",
                f"--build={job.build}",
                f"--out={out}",
            ]
        )
        file = out / "quantities/quantities.json"
        if done.returncode != 0 or not file.exists():
            raise RuntimeError((done.stderr or done.stdout)[-300:])
        for name, truth in truths.items():
            found = json.loads(file.read_text())[name]
            ratio = found["error"] / abs(found["value"] - truth)
            parts.append(
                f"{case}, {name}: {found['error'] / abs(truth):.2%} by {found['method']}, {ratio:.2f} of the truth"
            )
            met = met and 1 / 3 <= ratio <= 3
    return "; ".join(parts), met


def dual_weighted(job, *cases):
    """`cases`: each a case, its meshes, and its quantities of one run with their truths."""
    parts, ratios = [], []
    for case, meshes, quantities in cases:
        for mesh in meshes:
            out = job.scratch / f"dual-{len(ratios)}"
            asked = ", ".join(f"{name}: {given}" for name, (given, _) in quantities.items())
            done = job.run(
                [
                    job.build / "bin/solid_solver",
                    job.root / f"configs/{case}/case.yaml",
                    "--set",
                    f"simulation.output.folder={out}",
                    "--accept",
                    "buckling",
                    "--set",
                    f"participants.solid.mesh-parameters={mesh}",
                    "--set",
                    f"participants.solid.quantities={{{asked}}}",
                ]
            )
            file = out / "solid/quantities.csv"
            if not file.exists():
                raise RuntimeError((done.stderr or done.stdout)[-300:])
            with open(file, newline="") as table:
                for row in csv.DictReader(table):
                    truth = quantities[row["quantity"]][1]
                    ratios.append(float(row["estimated error"]) / abs(float(row["value"]) - truth))
                    parts.append(
                        f"{case} {mesh} {row['quantity']}: {float(row['estimated error']) / abs(truth):.2%},"
                        f" {ratios[-1]:.2f} of the truth"
                    )
    near = [sum(1 / f <= r <= f for r in ratios) for f in (2, 3)]
    return f"{near[0]} of {len(ratios)} within a factor of 2, {near[1]} of 3: " + "; ".join(parts), near[0] == len(
        ratios
    )


# Words of series that are not what a run does by default: symmetric gradient, solver by choice, trapezoidal rule, implicit coupling,
# a tank's upwind scheme. Series of the first name of the study alone ("thesis-gradient") begin with theirs.
OTHERS = (
    "thesis",
    "block-coupled",
    "segregated",
    "aitken",
    "anderson",
    "newton-krylov",
    "bathe",
    "euler",
    "three-point",
    "loose-pressure",
    "viscous-implicit",
    "incremental",
    "explicit",
    "semi-implicit",
    "tvd",
    "implicit-60s",
)


def all_studies(job, studies):
    """`studies`: {folder in docs/validation/studies: file in configs}. Runs of the default schemes in the committed studies; a run whose reference is too coarse to judge it counts by the reference that it has."""
    from couplet.runs import Case
    from couplet.study import estimates, table
    from couplet.study.study import Study

    judged, coarse, lines = [], [], []
    for name, case in studies.items():
        study = Study(Case(job.root / "configs" / f"{case}.yaml", job.build), job.scratch / "estimates")
        rows = table.read(job.root / "docs/validation/studies" / name / "runs.csv", study.axes, study.quantities)
        # A tank's implicit scheme is not its default, a coupled case's is.
        others = OTHERS + (("implicit",) if name in ("schumann", "thermocline-andasol") else ())
        kept = [r for r in rows if not any(word.strip().startswith(others) for word in str(r.series).split(","))]
        for quantity in study.quantities:
            sure, every = (estimates.of(kept, quantity, clear) for clear in (estimates.CLEAR, 0))
            rest = [f for f in every if f not in sure]
            judged, coarse = judged + sure, coarse + rest
            wrong = len(every) - estimates.inside(every)
            lines += [f"{name} {quantity.name} {wrong} of {len(every)}"] if wrong else []
    good, all_ = estimates.inside(judged) + estimates.inside(coarse), len(judged) + len(coarse)
    return (
        (
            f"{good} of {all_} runs ({100 * good / all_:.0f} %): {estimates.inside(judged)} of {len(judged)} with a"
            f" clear reference, {estimates.inside(coarse)} of {len(coarse)} whose reference is too coarse; beyond:"
            f" {', '.join(lines)}"
        ),
        good >= 0.85 * all_,
    )


# -- new cases ---------------------------------------------------------------------------------------------------------
FRESH = pathlib.Path(__file__).resolve().parents[1] / "estimates"


def launched(job, folder, case, sets=()):
    """Reports of a run of a case of our own, in a folder with the geometries of such cases; `case`: its data, or the file of a shipped one."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "case.yaml"
    if isinstance(case, str):
        file = case
    else:
        for one in FRESH.parent.glob("e*s/*.geo"):
            (folder / one.name).write_text(one.read_text())
        file.write_text(json.dumps(case).replace("<root>", str(job.root)))
    return ablation.launch(job.build / "bin", file, sets, folder / "out")


def numbers(one, folder):
    """The numbers that `profile`, or `read` with `beyond` and `history`, names in the results of a run."""
    if "profile" in one:
        return ablation.profile(one["profile"])(folder)
    file, *columns = one["read"]
    values = ablation.probe(*columns, participant=file.split("/")[0], history=one.get("history", False))(folder)
    return values if one.get("history") else [v - one.get("beyond", 0) for v in values]


def fresh_run(job, one, n, name):
    """Numbers of a case of estimates/cases.yaml at one size, and the estimated error of its run."""
    text = re.sub(
        r'"<([^">]+)>"', lambda m: json.dumps(eval(m[1], {}, {"n": n})), json.dumps(one["case"])
    )  # expressions of our own file
    folder = job.scratch / f"fresh-{re.sub('[ :,]+', '-', name)}-{n}"
    reports = launched(job, folder, json.loads(text))
    return numbers(one, folder / "out"), ablation.estimated(reports, "all")


def fresh(job, least=(0.75, 0.92), only=""):
    """Estimates of runs of problems that no estimator was developed on, beside their true errors."""
    ratios, lines = [], []
    for name, one in yaml.safe_load((FRESH / "cases.yaml").read_text()).items():
        if only not in name:
            continue
        found = []
        for n in one["sizes"]:
            values, estimate = fresh_run(job, one, n, name)
            truth = ablation.distance(values, [t - one.get("beyond", 0) for t in one["truth"]])
            found.append((estimate or 0) / truth if truth else math.nan)
        ratios += found
        lines.append(f"{name} {', '.join(f'{r:.2g}' for r in found)}")
    near = [sum(1 / f <= r <= f for r in ratios) / len(ratios) for f in (2, 3)]
    return (
        (
            f"{near[0]:.0%} of {len(ratios)} within 2, {near[1]:.0%} within 3, the least {min(ratios):.2g}; estimate"
            f" over truth: {'; '.join(lines)}"
        ),
        near[0] >= least[0] and near[1] >= least[1] and min(ratios) >= 0.2,
    )


def fresh_targets(job):
    """Targets of --for-error on the cases of estimates: met where the true error is at most 1.1 times the target."""
    good, lines = 0, []
    for name, one in yaml.safe_load((FRESH / "cases.yaml").read_text()).items():
        for target in one.get("targets", ()):
            folder, settings = job.scratch / f"target-{name.replace(' ', '-').replace(',', '')}-{target[:-1]}", {}

            def filled(node, path=(), one=one, settings=settings):
                """The case at its middle size; `settings`: its keys that depend on the size."""
                if isinstance(node, dict):
                    return {key: filled(value, (*path, key)) for key, value in node.items()}
                if isinstance(node, str) and (found := re.fullmatch("<(.+)>", node)):
                    settings[".".join(path)] = f"<={found[1]}>"
                    return eval(found[1], {}, {"n": one["sizes"][1]})
                return node

            folder.mkdir(parents=True, exist_ok=True)
            for file in FRESH.glob("*.geo"):
                (folder / file.name).write_text(file.read_text())
            (file, column, *_), case = one["read"], filled(one["case"])
            fresh_run(job, one, one["sizes"][0], name)
            with open(next(job.scratch.glob(f"fresh-{re.sub('[ :,]+', '-', name)}-*/out/{file}"))) as table:
                head = next(h for h in next(csv.reader(table)) if h.startswith(column))
            case["study"] = {
                "axes": {"mesh": {"sizes": one["sizes"], "set": settings}},
                "quantities": {"q": {"probe": head}},
            }
            (folder / "case.yaml").write_text(json.dumps(case))
            done = job.run(
                [
                    sys.executable,
                    job.root / "scripts/couplet",
                    "study",
                    folder / "case.yaml",
                    f"--build={job.build}",
                    f"--out={folder}/out",
                    f"--for-error={target}",
                ]
            )
            files = list(folder.glob("out/for-error-*.json"))
            result = json.loads(files[0].read_text()) if files else {}
            share = abs(result["value"] / one["truth"][0] - 1) / result["target"] if "value" in result else math.nan
            met = done.returncode == 0 and share <= 1.1
            good += met
            lines.append(
                f"{name} {target}: {share:.2g} of it at size {result.get('size', 0):g}, before it"
                f" {result.get('before', 0) / (result.get('seconds') or 1):.1f} times"
                + ("" if met else " (not met)")
            )
    return f"{good} of {len(lines)} met: {'; '.join(lines)}", good >= 0.95 * len(lines)


def coupled_steps(job, **motions):
    """`motions`: {name: [case of estimates/cases.yaml with its size, or a shipped file, participant and column of its probes, period in s, steps a period,
    periods, settings]}. The estimated error of the step beside the true one, from a run with a quarter of the step; both over the largest motion.
    """
    ratios, lines = [], []
    for name, (case, participant, column, period, steps, periods, *sets) in motions.items():
        if not isinstance(case, str):
            one, n = yaml.safe_load((FRESH / "cases.yaml").read_text())[case[0]], case[1]
            case = json.loads(
                re.sub(r'"<([^">]+)>"', lambda m, n=n: json.dumps(eval(m[1], {}, {"n": n})), json.dumps(one["case"]))
            )
        found = []
        for parts in (1, 4):
            folder = job.scratch / f"motion-{re.sub('[ :,]+', '-', name)}-{parts}"
            times = [
                f"simulation.time-step={period / steps / parts!r}",
                f"simulation.end-time={period / steps * round(steps * periods)!r}",
            ]
            reports = launched(job, folder, case, [*sets, *times])
            found.append(
                (
                    ablation.probe(column, participant=participant, history=True)(folder / "out"),
                    ablation.estimated(reports, "step"),
                )
            )
        truth = 16 / 15 * ablation.distance(found[0][0], found[1][0])
        ratios.append((found[0][1] or math.nan) / truth)
        lines.append(f"{name} {ratios[-1]:.2g} of {truth:.1e}")
    near = sum(1 / 3 <= r <= 3 for r in ratios)
    return (
        f"{near} of {len(ratios)} within 3, the largest {max(ratios):.2g}; estimate over truth: {'; '.join(lines)}",
        near >= 0.8 * len(ratios) and max(ratios) <= 10,
    )


# -- positions on the atlas --------------------------------------------------------------------------------------------
def placed(folder):
    """Largest share of the way to a limit in any run.json of the folder; None without one."""
    found = [
        c
        for file in pathlib.Path(folder).glob("out/*/run.json")
        for c in json.loads(file.read_text()).get("atlas", [])
        if c["map"] != "strong-robin"
    ]
    return max(
        ((1 - c["value"]) / (1 - c["limit"]) if c["floor"] else c["value"] / c["limit"] for c in found), default=None
    )


def halved(folder):
    """Returns true if a failed step made the run continue with shorter ones."""
    for file in pathlib.Path(folder).glob("out/*/steps.csv"):
        with open(file, newline="") as rows:
            steps = [float(r["dt [s]"]) for r in csv.DictReader(rows)]
        if steps and min(steps) < 0.75 * steps[0]:
            return True
    return False


def positions(job, *between):
    """`between`: each a map, its panels, and places between its squares on both axes."""
    maps = atlas.maps()
    right, early, saved, wrong = 0, 0, 0, []
    with tempfile.TemporaryDirectory(prefix="couplet-atlas-") as scratch:
        for name, panels, xs, ys in between:
            for panel, x, y in ((p, x, y) for p in panels for x in xs for y in ys):
                runner = atlas.Runner(
                    job.build, pathlib.Path(scratch) / f"{name}-{panels.index(panel)}-{x}-{y}".replace(" ", "")
                )
                square = atlas.judged(maps[name], *maps[name].run(panel, x, y, runner))
                used = placed(next(runner.scratch.iterdir()))
                held = square.outcome in (atlas.HOLDS, atlas.POOR)
                if used is not None and held == (used <= 1):
                    right += 1
                elif used is not None and held and used <= 1.5:
                    early += 1  # a bound on the eigenvalues is beyond them on oblique cells
                elif used is not None and held and halved(next(runner.scratch.iterdir())):
                    saved += 1  # the first steps were where it is printed
                else:
                    wrong.append(
                        f"{name} {panel} {x:g}, {y:g}: {used if used is None else round(used, 2)} of the way,"
                        f" {square.outcome}"
                    )
    total = right + early + saved + len(wrong)
    return (
        f"{right} of {total} agree, {early} hold up to 1.5 times the limit, {saved} begin beyond it and hold by halved"
        " steps"
        + (f"; not: {'; '.join(wrong)}" if wrong else ""),
        total >= 50 and not wrong,
    )
