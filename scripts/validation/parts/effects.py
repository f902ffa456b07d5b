# SPDX-License-Identifier: Apache-2.0
"""What runs say about an effect that they leave out, beside the truth (effects/scenes.yaml)."""
import json
import math
import pathlib
import re

import atlas
import yaml

from validation.parts import error_estimates

DATA = pathlib.Path(__file__).resolve().parents[1] / "effects"
MATTERS = 0.1


def scenes(only=""):
    return {
        name: one for name, one in yaml.safe_load((DATA / "scenes.yaml").read_text())["scenes"].items() if only in name
    }


def run(job, name, one, with_effect=False):
    """Returns the folder of a scene's run and its reports."""
    folder, case = job.scratch / re.sub(r"\W+", "-", name) / ("with" if with_effect else "without"), one["case"]
    if isinstance(case, str):
        case = case.replace("<root>", str(job.root))
        who = re.search(r"^participants:\n  (\w+):", pathlib.Path(case).read_text(), re.M)[1]
    else:
        who = next(iter(case["participants"]))
    settings = {**(one.get("set") or {}), **(one["with"] if with_effect else {})}
    sets = [
        f"{key if key.startswith(('simulation.', 'coupling.', 'participants.')) else f'participants.{who}.{key}'}={json.dumps(value)}"
        for key, value in settings.items()
    ]
    return folder / "out", error_estimates.launched(job, folder, case, [*sets, "simulation.diagnostics=full"])


def truth(job, name, one):
    """|answer with the effect - answer without| / |answer without|."""
    answers = [error_estimates.numbers(one, run(job, name, one, with_effect)[0]) for with_effect in (True, False)]
    return error_estimates.ablation.distance(*answers)


def said(job, name, one):
    """Returns the share that the run states, NaN if it does not know it, and None if it does not name the effect as one that matters."""
    found = [
        f
        for report in run(job, name, one)[1].values()
        for f in report["findings"]
        if f["id"] == one["effect"] and f["severity"] != "note"
    ]
    return max((math.nan if f["share"] is None else f["share"] for f in found), default=None)


def verdicts(job, matters, most, only=""):
    """Scenes whose effect `matters` or not: how many runs are wrong or silent about it, and how many shares are near the truth."""
    chosen = {name: one for name, one in scenes(only).items() if (one["truth"] >= MATTERS) == matters}
    wrong, near = [], []
    for name, one in chosen.items():
        share = said(job, name, one)
        if (share is not None) != matters:
            wrong.append(name if share is None else f"{name}: {share:.2g} for {one['truth']:g}")
        elif matters and not 0.5 <= share / one["truth"] <= 2:
            near.append(f"{name}: {'unknown' if math.isnan(share) else format(share, '.2g')} for {one['truth']:g}")
    good = len(chosen) - len(wrong) - len(near)
    shares = (
        f"; share within a factor of 2 in {good} ({good / len(chosen):.0%}), not: {'; '.join(near) or 'none'}"
        if matters
        else ""
    )
    return (
        (
            f"{len(wrong)} of"
            f" {len(chosen)} {'wrong or silent' if matters else 'called otherwise'}{': ' if wrong else ''}{'; '.join(wrong)}{shares}"
        ),
        len(wrong) <= most and (not matters or good >= 0.8 * len(chosen)),
    )


def truths(job, only=""):
    """The truths of the scenes that have a run with the effect, computed again."""
    off = []
    for name, one in scenes(only).items():
        if "with" in one:
            found = truth(job, name, one)
            if one.get("truth") is None or abs(found - one["truth"]) > 0.05 * one["truth"] + 1e-3:
                off.append(f"{name}: {found:.3g}")
    return "all as recorded" if not off else "; ".join(off), not off


def unstable(job, *names):
    """Squares of these maps of the atlas whose runs stopped: those that stop again, and those that hold now, with their errors."""
    runner, stopped, holding, wrong = atlas.Runner(job.build, job.scratch), 0, [], []
    for name in names:
        for key, before in atlas.read(job.root / f"docs/stability/{name}.csv").items():
            if before.outcome != atlas.REFUSED:
                continue
            now = atlas.judged(*atlas.maps()[name].run(*key, runner))
            stopped += now.outcome == atlas.REFUSED
            if now.outcome != atlas.REFUSED:
                (holding if now.outcome == atlas.HOLDS else wrong).append(f"{name}, {key[0]}, {key[1]:g}, {key[2]:g}")
    said = [f"{stopped} of {stopped + len(holding) + len(wrong)} stop"]
    said += [
        f"{word}: {'; '.join(those)}"
        for word, those in (("hold within 5 %", holding), ("run on unsound", wrong))
        if those
    ]
    return ", ".join(said), not wrong
