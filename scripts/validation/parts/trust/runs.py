# SPDX-License-Identifier: Apache-2.0
"""Bars of runs, files and input: step counts, checkpoints, what is overwritten, geometry that runs commands, broken inputs,
--check, start-up, signals."""
import json
import os
import re
import shutil
import statistics
import sys
import time

from validation.job import Bar

PROGRAMS = ("solid_solver", "fluid_solver", "mesh_mover", "thermocline", "coupler")


def tests(pattern, least=1, seconds=1800):
    """A bar that asks whether registered tests pass."""
    def measure(job):
        passed, total, skipped, output = job.ctest(pattern, seconds)
        lost = re.findall(r"\d+ - (\S+) \((?:Failed|Timeout|Not Run)", output)
        return f"{passed} of {total} tests pass{' (lost: ' + ', '.join(lost[:4]) + ')' if lost else ''}", passed == total >= least
    return measure


def gtests(program, *names):
    """A bar that asks whether some claims of a test executable hold."""
    def measure(job):
        found, _ = job.gtest(program)
        chosen = {n: v["passed"] for n, v in found.items() if any(re.search(p, n) for p in names)}
        good = sum(chosen.values())
        return f"{good} of {len(chosen)} claims hold", len(chosen) >= len(names) and good == len(chosen)
    return measure


def fuzz(job, name, count):
    """What a fuzz test recorded, and whether it passed."""
    def make():
        program = next(p for p in (job.build / "tests").rglob(name) if p.is_file() and os.access(p, os.X_OK))
        file = job.scratch / f"{name}.json"
        result = job.run(["env", f"COUPLET_FUZZ_COUNT={count}", program, f"--gtest_output=json:{file}"], 3600, cwd=job.scratch)
        if not file.exists():
            raise RuntimeError(f"{name} ended with code {result.returncode}: {result.stdout[-200:]}")
        test = json.loads(file.read_text())["testsuites"][0]["testsuite"][0]
        return test, not test.get("failures") and result.returncode == 0
    return job.once(("fuzz", name, count), make)


def yaml(job):
    found = [fuzz(job, f"fuzz_yaml_{program}", 4000) for program in PROGRAMS]
    tried = sum(int(t["tried"]) for t, _ in found)
    return (f"{tried} tried over {len(found)} programs, {sum(int(t['refused']) for t, _ in found)} refused, "
            f"{sum(int(t['unplaced']) for t, _ in found)} messages without a place, slowest {max(float(t['slowest']) for t, _ in found):.2f} s, "
            f"{max(float(t['megabytes']) for t, _ in found):.0f} MB"), tried >= 20000 and all(good for _, good in found)


def meshes(job):
    test, good = fuzz(job, "fuzz_meshes", 10000)
    return (f"{test['tried']} tried, {test['refused']} refused, slowest {test['slowest']} s, {test['megabytes']} MB",
            good and int(test["tried"]) >= 10000)


def checkpoints(job):
    test, good = fuzz(job, "fuzz_checkpoints", 2000)
    return (f"{test['tried']} damaged: {test['refused']} refused, {test['earlier_set']} continued from an earlier set, "
            f"{test['unharmed']} unharmed, 0 with another result", good and int(test["tried"]) >= 2000)


def script(path, *words, timeout=7200):
    """A bar of a script that prints its sum in its last line."""
    def measure(job):
        words_ = [str(w).format(bin=job.build / "bin", root=job.root) for w in words]
        result = job.run(["/usr/bin/python3", job.root / path, *words_], timeout)
        last = (result.stdout.strip() or result.stderr.strip()).splitlines()[-1]
        return last[:300], result.returncode == 0
    return measure


def wrong(*names, least):
    """A bar of those cases of tests/cli/wrong whose names begin so."""
    def measure(job):
        sys.path.insert(0, str(job.root / "tests/cli/wrong"))
        import table
        chosen = [case.name for case in table.CASES if case.name.startswith(names)]
        result = job.run(["/usr/bin/python3", job.root / "tests/cli/wrong/run.py", job.build / "bin", *chosen])
        good = len(re.findall(r"^ok ", result.stdout, re.M))
        return f"{good} of {len(chosen)} cases pass", result.returncode == 0 and good == len(chosen) >= least
    return measure


def start_up(job):
    folder = job.scratch / "start-up"
    folder.mkdir(exist_ok=True)
    shutil.copy(job.root / "tests/cli/wrong/tank.yaml", folder / "case.yaml")
    times = []
    for _ in range(9):
        start = time.monotonic()
        result = job.run([job.build / "bin/thermocline", "case.yaml"], cwd=folder)
        times.append(time.monotonic() - start)
        if result.returncode != 0:
            raise RuntimeError(result.stderr[-200:])
    return f"{statistics.median(times):.2f} s (least {min(times):.2f} s) of 9 runs", statistics.median(times) <= 0.2


BARS = [
    Bar("3e9 steps are counted, more than 1e12 refused", "tests pass",
        gtests("unit_coupling", "more_steps_than_an_int", "refuses_what_cannot_be_counted")),
    Bar("krylov: what is not finite never counts as converged", "test passes", gtests("unit_linalg_krylov", "not_finite")),
    Bar("--restart takes the set that has gone furthest; mixed, shifted, flipped sets refused; half-written ones cleared", "tests pass",
        gtests("unit_app", "gone_furthest", "two_sets", "flipped_bit", "half_written")),
    Bar("keys and files that changed since a checkpoint: listed, physics needs consent", "tests pass",
        gtests("unit_app", "CaseKeys")),
    Bar("participants named '', '..', '-o', 'a/b' or like folders of the run itself are refused; 'checkpoints2' is not", "cases pass",
        wrong("participant named", "right name", least=9)),
    Bar("only what this run wrote is deleted; links are not followed", "tests pass",
        gtests("unit_app", "only_those_of_this_run", "in_the_way", "through_a_link")),
    Bar("runs with no, one and a checkpoint each step, and continued ones: the coupled flap, on 1 and 2 ranks", "equal bit for bit",
        tests("^flap_is_not_changed_by_checkpoints", 2)),
    Bar("... fluid, solid, plate and tank alone (contract suites, 1 and 2 ranks), mover and whole tank", "equal bit for bit",
        tests("^contract_(solid|fluid|thermocline|plate)(_2)?$|^verification_mover_ranks(_2)?$|^verification_thermocline_tank$", 11)),
    Bar("SIGTERM saves and ends with code 3, a hang is named, the run continues bit for bit (toys)", "test passes", tests("^stop_and_go_on$")),
    Bar("real solvers killed in every phase, clock from their death", "ended in 5 s, named", tests("^kill_solvers$")),
    Bar("a .geo that runs commands or writes files is refused; includes are looked into", "tests pass",
        gtests("unit_mesh_files", "Geo")),
    Bar("hundreds of kilobytes of .geo in one blank, comment, name or bracket end nothing; the dimension is that of the groups", "tests pass",
        gtests("unit_mesh_files", "hundreds_of_kilobytes", "however_they_are_written")),
    Bar("an invalid number of cells (n_length: -3, 0, 2.5) is refused before gmsh makes another mesh of it", "tests pass",
        gtests("unit_mesh", "number_of_cells_that_is_none")),
    Bar("a table from a FIFO is refused at once; columns that are not there, too", "tests pass",
        gtests("unit_fv_table", "from_a_fifo", "name_or_number_of_its_column")),
    Bar("a mesh cache that was cut short is made anew", "test passes", gtests("unit_mesh", "truncated_cache")),
    Bar("a process that is stopped before the programs know each other does not hold the others for ever", "tests pass",
        gtests("unit_app", "ends_a_start_that_takes_too_long", "silent_once_disarmed")),
    Bar("alias bombs, brackets in units, control characters, 20 000 unknown keys", "refused at once", gtests("unit_config", "Limits")),
    Bar("--check: expressions, components, patches, files, floating bodies; every wrong configuration has its sentence",
        "tests pass", tests("^cli_wrong_configurations$")),
    Bar("start-up of a small case alone", "<= 0.2 s", start_up),
    Bar("start-up: several machines and the user's own choice are left alone", "tests pass", gtests("unit_app", "MpiStart")),
    Bar("20 000 broken cases over all programs: no crash, 5 s, 1 GB, every message with its place", "none fails", yaml, long=True),
    Bar("1 000 short real runs of odd values: code 0 to 2, 5 s, 1 GB", "none fails",
        script("tests/fuzz/runs.py", "{bin}", 1000), long=True,
        but="a case that asks for much work may take up to 60 s and is counted, at most one in a hundred"),
    Bar("10 000 broken meshes", "none fails", meshes, long=True),
    Bar("2 000 damaged checkpoint sets", "none accepted with another result", checkpoints),
    Bar("100 signals at random moments on the flap: ended in 5 s or resumed, no orphan, named, bit for bit", ">= 95 % named, none fails",
        script("tests/cli/signals/strikes.py", "{bin}", "{root}/configs/perpendicular-flap", 100), long=True),
]
