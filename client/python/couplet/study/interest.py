# SPDX-License-Identifier: Apache-2.0
"""Errors of the quantities of interest (`study.quantities`) by differences: the case as it stands, with the study's
`set` and with --set, beside the same with a half and a quarter of the cells along each line, and with twice and four
times the step. The coarser runs cost a fraction of it.

  error = sum over mesh and step of |value - coarser value| / (2^p - 1),   2^p = |coarser - coarsest| / |value -
                                                                           coarser|

with the observed order p between 0.5 and the formal one; the formal one where the differences change their sign or the
coarsest run fails.

What is made coarser: `study.sources` where the case has it, from the setting that it names; else the size of the
study's refining axis that gives the mesh of the case, and `simulation.time-step` where the run has more than one step.

sources:
  mesh: {size: 16, set: {mesh-parameters: "{n: <n>}"}}   # compared with half the size and a quarter; order: 2
  step: {key: simulation.time-step, value: 0.1}          # compared with twice the step and four times; order: 2
  linear tolerance: {key: pressure-tolerance, value: 1.0e-5, tolerance: true}     # compared with a hundredth of the
                                                                                  tolerance
The part of a tolerance is what tightening it changes; mesh and step are compared with tight tolerances, so that what a
solver leaves is not taken for theirs."""
import dataclasses
import json
import math

import yaml

from couplet import files
from couplet.runs import Task, expect, run_all
from couplet.runs.case import Wrong, with_changes
from couplet.study.axes import Axes, filled
from couplet.study.quantities import quantities_of

KEYS = {"size", "set", "key", "value", "tolerance", "order", "factor"}  # of a source
AS_IT_IS, COARSER, COARSEST, TIGHTER, ALL_TIGHTER = "as-it-is", "coarser", "coarsest", "tighter", "all tighter"
LEAST_ORDER = 0.5
LARGEST = 4  # sizes up to this multiple of the largest on the axis are searched for that of the case
NOTHING = 0.1  # of the largest part; less is not worth reducing


@dataclasses.dataclass
class Source:
    name: str
    changes: object  # (factor) -> {key: value}; 1 unchanged, above 1 coarser, below 1 finer
    tolerance: bool
    ratio: float  # ratio of coarsening, or of tightening the tolerance
    order: float


def source_of(name, given, where):
    where = f"{where}: study.sources.{name}"
    expect(
        isinstance(given, dict) and not set(given) - KEYS, f"{where}: expected a mapping of {', '.join(sorted(KEYS))}."
    )
    if "size" in given:
        expect(isinstance(given.get("set"), dict), f"{where}: 'size' needs 'set', keys with <expressions in n>.")
        return Source(
            name,
            lambda f: {k: filled(str(t), max(1, given["size"] / f)) for k, t in given["set"].items()},
            False,
            given.get("factor", 2),
            given.get("order", 2),
        )
    expect(
        "key" in given and isinstance(given.get("value"), (int, float)),
        f"{where}: expected {{key: ..., value: number}}.",
    )
    tolerance = bool(given.get("tolerance"))
    return Source(
        name,
        lambda f: {given["key"]: given["value"] * f},
        tolerance,
        given.get("factor", 100 if tolerance else 2),
        given.get("order", 2),
    )


def value_at(data, key):
    for part in key.split("."):
        data = data.get(part) if isinstance(data, dict) else None
    return data


def mesh_source(case, section, participant, data):
    """Refining axis at the size that gives the values of `data`, or None."""
    axis = Axes(case, section, participant).refining if section.get("axes") else None
    if not axis:
        return None

    def fits(n):
        return all(
            value_at(data, case.absolute(key, participant)) == yaml.safe_load(str(text))
            for key, text in axis.at(n).items()
        )

    sizes = sorted({*axis.sizes.values(), *range(1, LARGEST * int(max(axis.sizes.values())) + 1)})
    own = next((n for n in sizes if fits(n)), None)
    return Source("mesh", lambda f: axis.at(max(1, own / f)), False, 2, 2) if own else None


def sources_of(case, participant, base=None):
    """`base` contains the changes of the study's `set` and --set, {absolute key: value}."""
    section, base = case.study, base or {}
    if section.get("sources"):
        return [source_of(n, g, case.file) for n, g in section["sources"].items()]
    data = with_changes(case.data, base)
    found = [mesh_source(case, section, participant, data)]
    if found[0] and "simulation.time-step" in found[0].changes(1):
        return found  # mesh and step together
    step, end = (seconds(data["simulation"].get(k)) for k in ("time-step", "end-time"))
    if step and end and end > 1.5 * step:
        found.append(Source("step", lambda f: {"simulation.time-step": step * f}, False, 2, 2))
    return [s for s in found if s]


def seconds(text):
    """Seconds of "0.1 s" or a number. None if unknown."""
    words = str(text).split()
    try:
        return float(words[0]) if words[1:] in ([], ["s"]) else None
    except (ValueError, IndexError):
        return None


def order_of(own, coarser, coarsest, source):
    """Order of convergence of three values, within limits."""
    first, second = own - coarser, coarser - coarsest if coarsest is not None else 0.0
    if first * second <= 0:
        return source.order
    return min(source.order, max(LEAST_ORDER, math.log(second / first) / math.log(source.ratio)))


def runs_of(sources):
    """Returns {name: {source: factor}} of the runs."""
    tight = {s.name: 1 / s.ratio for s in sources if s.tolerance}
    found = {AS_IT_IS: {}, **{f"{name} {TIGHTER}": {name: factor} for name, factor in tight.items()}}
    if len(tight) > 1:
        found[ALL_TIGHTER] = tight
    for s in sources:
        if not s.tolerance:
            found |= {
                f"{s.name} {word}": {**tight, s.name: s.ratio**power} for power, word in ((1, COARSER), (2, COARSEST))
            }
    return found


def parts_of(values, sources):
    """Contributions to the error, and the orders, by source. `values` are those of the runs by name."""
    own, parts, orders = values[AS_IT_IS], {}, {}
    for s in sources:
        if s.tolerance:
            parts[s.name] = abs(values[f"{s.name} {TIGHTER}"] - own)
    exact = values[ALL_TIGHTER] if len(parts) > 1 else values[f"{next(iter(parts))} {TIGHTER}"] if parts else own
    for s in sources:
        if not s.tolerance:
            coarser = values[f"{s.name} {COARSER}"]
            orders[s.name] = order_of(exact, coarser, values.get(f"{s.name} {COARSEST}"), s)
            parts[s.name] = abs(exact - coarser) / (s.ratio ** orders[s.name] - 1)
    return parts, orders


def advice(parts):
    """Advice on the error."""
    worst = max(parts, key=parts.get)
    idle = [name for name, value in parts.items() if value < NOTHING * parts[worst]]
    return f"the {worst} dominates" + (f": improving {' or '.join(idle)} would not help" if idle else "")


def run(case, out, arguments, say):
    section = case.study
    participant = section.get("participant", next(iter(case.participants), None))
    base = {case.absolute(k, participant): v for k, v in {**(section.get("set") or {}), **arguments.changes}.items()}
    sources = sources_of(case, participant, base)
    expect(
        sources,
        (
            f"{case.file}: --quantities: nothing to make coarser: the case has neither 'study.sources' nor an axis with"
            " 'sizes' at its own mesh, and takes one step."
        ),
    )
    taken = (
        {case.absolute(k, participant) for s in sources for k in s.changes(1)} & set(arguments.changes)
        if section.get("sources")
        else ()
    )
    expect(not taken, f"{case.file}: --quantities: --set {next(iter(taken), '')}: study.sources sets this key itself.")
    folder, tasks = files.below(out, "quantities"), {}
    for name, factors in runs_of(sources).items():
        changes = {
            case.absolute(k, participant): v for s in sources for k, v in s.changes(factors.get(s.name, 1)).items()
        }
        tasks[name] = Task(case, name, folder / name.replace(" ", "-"), {**base, **changes})
    records = run_all(list(tasks.values()), arguments.jobs or 1, arguments.again, say)
    values, written = {}, {}
    for name, task in tasks.items():
        try:
            expect(records[task].state == "done", f"{name}: {records[task].reason}")
            values[name] = {q.name: q.value(task.results) for q in quantities_of(case, section, participant)}
        except (Wrong, LookupError) as error:  # the coarsest run may be too coarse to converge or to oscillate
            expect(name.endswith(COARSEST), f"{name}: {error}")
    for quantity in quantities_of(case, section, participant):
        of_runs = {name: found[quantity.name] for name, found in values.items()}
        expect(
            all(math.isfinite(v) for name, v in of_runs.items() if not name.endswith(COARSEST)),
            f"{quantity.name}: not a number in a run that ended well.",
        )
        parts, orders = parts_of(of_runs, sources)
        own, error, unit = of_runs[AS_IT_IS], sum(parts.values()), quantity.unit
        written[quantity.name] = {
            "value": own,
            "unit": unit,
            "error": error,
            "parts": parts,
            "orders": orders,
            "method": f"differences of {len(tasks)} runs",
        }
        share = f" ({100 * error / abs(own):.2g} %)" if own and not quantity.is_error else ""
        say(
            f"{quantity.name}: {own:.6g} {unit}, estimated error {error:.2g} {unit}{share} by differences of"
            f" {len(tasks)} runs: "
            + ", ".join(
                f"{n} {p:.2g}" + (f" of order {orders[n]:.2g}" if n in orders else "")
                for n, p in sorted(parts.items(), key=lambda part: -part[1])
            )
        )
        if len(parts) > 1:
            say(advice(parts))
    files.write(files.folder(folder, "."), "quantities.json", json.dumps(written, indent=1))
    say(f"table: {folder / 'quantities.json'}")
    return 0
