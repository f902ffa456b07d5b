# SPDX-License-Identifier: Apache-2.0
"""Errors of the quantities of interest (`study.quantities`) by differences: the case as it stands, with the study's `set` and with --set, beside
the same with a half and a quarter of the cells along each line, and with twice and four times the step. The coarser runs cost a fraction of it.

  error = sum over mesh and step of |value - coarser value| / (2^p - 1),   2^p = |coarser - coarsest| / |value - coarser|

with the observed order p between 0.5 and the formal one; the formal one where the differences change their sign or the coarsest run fails.

What is made coarser: `study.sources` (docs/studies.md) where the case has it, from the setting that it names; else the size of the study's
refining axis that gives the mesh of the case, and `simulation.time-step` where the run has more than one step."""
import json
import math

import yaml

from couplet.runs import Task, expect, run_all
from couplet.runs.case import with_changes
from couplet.study.axes import Axes
from couplet.study.dominance import Source, source_of
from couplet.study.quantities import quantities_of

AS_IT_IS, COARSER, COARSEST = "as-it-is", "coarser", "coarsest"
LEAST_ORDER = 0.5
LARGEST = 4  # sizes up to this many times the largest of the axis are looked at for that of the case


def value_at(data, key):
    for part in key.split("."):
        data = data.get(part) if isinstance(data, dict) else None
    return data


def mesh_source(case, section, participant, data):
    """The refining axis at the size that gives the values of `data`; None where there is no such size."""
    axis = Axes(case, section, participant).refining if section.get("axes") else None
    if not axis:
        return None

    def fits(n):
        return all(value_at(data, case.absolute(key, participant)) == yaml.safe_load(str(text)) for key, text in axis.at(n).items())
    sizes = sorted({*axis.sizes.values(), *range(1, LARGEST * int(max(axis.sizes.values())) + 1)})
    own = next((n for n in sizes if fits(n)), None)
    return Source("mesh", lambda f: axis.at(max(1, own / f)), False, 2, 2) if own else None


def sources_of(case, participant, base=None):
    """`base`: what the study's `set` and --set change, {absolute key: value}."""
    section, base = case.study, base or {}
    if section.get("sources"):
        return [s for s in (source_of(n, g, case.file) for n, g in section["sources"].items()) if not s.tolerance]
    data = with_changes(case.data, base)
    found = [mesh_source(case, section, participant, data)]
    if found[0] and "simulation.time-step" in found[0].changes(1):
        return found  # mesh and step together
    step, end = (seconds(data["simulation"].get(k)) for k in ("time-step", "end-time"))
    if step and end and end > 1.5 * step:
        found.append(Source("step", lambda f: {"simulation.time-step": step * f}, False, 2, 2))
    return [s for s in found if s]


def seconds(text):
    """Of "0.1 s" or a number; None: not known."""
    words = str(text).split()
    try:
        return float(words[0]) if words[1:] in ([], ["s"]) else None
    except (ValueError, IndexError):
        return None


def values_of(task, quantities):
    """{quantity: value}; those that are errors themselves are omitted."""
    return {q.name: q.value(task.results) for q in quantities if not q.is_error}


def unit_of(quantity):
    head = str(quantity.given.get("probe", quantity.given.get("column", "")))
    return quantity.given.get("unit") or (head[head.rindex("[") + 1:-1] if head.endswith("]") else "1")


def order_of(own, coarser, coarsest, source):
    """By which the values of three runs converge, within bounds."""
    first, second = own - coarser, coarser - coarsest if coarsest is not None else 0.0
    if first * second <= 0:
        return source.order
    return min(source.order, max(LEAST_ORDER, math.log(second / first) / math.log(source.ratio)))


def estimate(own, coarser, coarsest, sources):
    """The parts of the error, and their orders, by source."""
    orders = {s.name: order_of(own, coarser[s.name], coarsest[s.name], s) for s in sources}
    return {s.name: abs(own - coarser[s.name]) / (s.ratio ** orders[s.name] - 1) for s in sources}, orders


def run(case, out, arguments, say):
    section = case.study
    participant = section.get("participant", next(iter(case.participants), None))
    base = {case.absolute(k, participant): v for k, v in {**(section.get("set") or {}), **arguments.changes}.items()}
    sources = sources_of(case, participant, base)
    expect(sources, f"{case.file}: --quantities: nothing to make coarser: the case has neither 'study.sources' nor an axis with 'sizes' at its own "
                    "mesh, and takes one step.")
    taken = {case.absolute(k, participant) for s in sources for k in s.changes(1)} & set(arguments.changes) if section.get("sources") else ()
    expect(not taken, f"{case.file}: --quantities: --set {next(iter(taken), '')}: study.sources gives it its own values.")
    folder = out / "quantities"

    def changes(coarser=None, factor=1):
        """Of the case as it stands, but for one source."""
        found = {k: v for s in sources for k, v in s.changes(factor if s is coarser else 1).items()}
        return {**base, **{case.absolute(k, participant): v for k, v in found.items()}}
    tasks = {AS_IT_IS: Task(case, AS_IT_IS, folder / AS_IT_IS, changes())}
    for s in sources:
        for power, word in ((1, COARSER), (2, COARSEST)):
            name = f"{s.name} {word}"
            tasks[name] = Task(case, name, folder / name.replace(" ", "-"), changes(s, s.ratio**power))
    records = run_all(list(tasks.values()), arguments.jobs or 1, arguments.again, say)
    quantities = quantities_of(case, section, participant)
    found = {}
    for name, task in tasks.items():
        good = records[task].state == "done"
        expect(good or name.endswith(COARSEST), f"{name}: {records[task].reason}")
        try:
            found[name] = values_of(task, quantities) if good else {}
        except LookupError as error:  # a step too coarse to oscillate
            expect(name.endswith(COARSEST), f"{name}: {error}")
            found[name] = {}
    written = {}
    for quantity in quantities:
        if quantity.name not in found[AS_IT_IS]:
            continue
        own = found[AS_IT_IS][quantity.name]
        coarser, coarsest = ({s.name: found[f"{s.name} {word}"].get(quantity.name) for s in sources} for word in (COARSER, COARSEST))
        expect(all(map(math.isfinite, (own, *coarser.values()))), f"{quantity.name}: not a number in a run that ended well.")
        parts, orders = estimate(own, coarser, coarsest, sources)
        error, unit = sum(parts.values()), unit_of(quantity)
        written[quantity.name] = {"value": own, "unit": unit, "error": error, "parts": parts, "orders": orders, "method": f"differences of {len(tasks)} runs"}
        share = f" ({100 * error / abs(own):.2g} %)" if own else ""
        say(f"{quantity.name}: {own:.6g} {unit}, estimated error {error:.2g} {unit}{share} by differences of {len(tasks)} runs: "
            + ", ".join(f"{n} {p:.2g} of order {orders[n]:.2g}" for n, p in parts.items()))
    expect(written, f"{case.file}: study.quantities: all of them are errors already.")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "quantities.json").write_text(json.dumps(written, indent=1))
    say(f"table: {folder / 'quantities.json'}")
    return 0
