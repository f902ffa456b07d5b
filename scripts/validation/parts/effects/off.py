# SPDX-License-Identifier: Apache-2.0
"""An effect that is off executes none of its own code (callgrind); what one that is on costs is prices.py's."""
import re

from validation.parts.effects.scenes import EFFECTS, watched


def instructions(folder):
    """{function: instructions of its own}, by the names of the symbols."""
    found, function, skip = {}, "", False
    for line in (folder / "watched").read_text(errors="replace").splitlines():
        if line.startswith("fn="):
            function = line[3:]
        elif line.startswith("calls="):
            skip = True  # the next line is what was called, with all below it
        elif line[:1].isdigit():
            if not skip:
                found[function] = found.get(function, 0) + int(line.split()[1])
            skip = False
    return found


def symbols_of(job):
    """{file of the source: names that its object alone defines}."""
    def make():
        by_file, owners = {}, {}
        if any((job.build / "CMakeFiles").glob("*/Unity")):
            raise RuntimeError("the build compiles sources in batches; name one of single objects (preset single, --build build-single)")
        for file in sorted((job.build / "CMakeFiles").rglob("*.cpp.o")):
            source = re.sub(r".*\.dir/", "", str(file))[:-2]
            if not (job.root / source).exists():
                continue  # of an earlier state of the folder
            names = set()
            for line in job.run(["nm", "--defined-only", "--format=posix", file]).stdout.splitlines():
                name, kind = line.split()[:2]
                # what runs before main sets the constants of a file up, whether the effect is on or not
                if kind in "TtWw" and not name.startswith("_GLOBAL__sub_I"):
                    names.add(name)
                    owners.setdefault(name, set()).add(source)
            by_file[source] = names
        return {f: {n for n in names if len(owners[n]) == 1} for f, names in by_file.items()}
    return job.once("symbols", make)


def spent(job, own, keys):
    """Instructions in the effect's own files, and the name of the largest."""
    table, counts = symbols_of(job), instructions(watched(job, own.program, keys, "callgrind"))
    names = {n for f in own.files for n in table[f] if re.search(own.names, n)}
    inside = {n: c for n, c in counts.items() if n.split("'")[0] in names}
    return sum(inside.values()), max(inside, key=inside.get, default="")


def off_is_free(job):
    lost, least = [], None
    for own in EFFECTS:
        off, name = spent(job, own, own.needs)
        on, _ = spent(job, own, own.keys)
        least = on if least is None else min(on, least)
        print(f"  {own.program}, {own.effect}: off {off}, on {on}", flush=True)
        if off > 0 or on == 0:
            lost.append(f"{own.effect}: {off} off ({name[:60]}), {on} on")
    text = f"{len(EFFECTS) - len(lost)} of {len(EFFECTS)} execute nothing of theirs when off, and at least {least} instructions when on"
    return text + (f"; not: {'; '.join(lost)}" if lost else ""), not lost
