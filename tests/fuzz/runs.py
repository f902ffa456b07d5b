#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Small cases with odd values through the real programs, for two steps: each ends in time with exit code 0, 1, 2 or 4, in
less than 1 GB, and what it says when it fails ends with a sentence of its own. Usage: runs.py BIN COUNT [SEED]"""
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
WRONG = ROOT / "tests/cli/wrong"
CASES = {"solid_solver": "solid.yaml", "fluid_solver": "fluid.yaml", "thermocline": "tank.yaml"}
NUMBERS = ["0", "1e-30", "1e30", "-1", "1", "2", "3", "0.5", "1e-3", "1e6", "nan", "1e308", "1e-308", "100", "0.999999", "[0, 0]",
           "[1e30, 0]", "[sin(x/t), 0]", "[1/x, 1/y]", "[t^9999, 0]", "sqrt(x - 1)", "true", "implicit", "explicit", "static",
           "stress", "free", "slip", "interface", "symmetry", "auto", "-5 bar", "20 degC", "table(t, 0, 0, 1, 1e9)"]
SECONDS = 5.0  # of processor time, which a busy machine does not change
WORK = 12 * SECONDS  # a case may ask for much work (155 000 cells, 44 km of soil): it is counted, and must end by itself in this time
MEGABYTES = 1000


def odd(value, dice):
    """Mostly the same number many times larger or smaller, so that it passes the check and is computed with."""
    number = re.fullmatch(r"(-?[0-9.]+(?:e-?[0-9]+)?)(.*)", value)
    if dice.random() < 0.15 or not number and not value.startswith("["):
        return dice.choice(NUMBERS) if dice.random() < 0.5 else value
    return re.sub(r"-?[0-9.]+(?:e-?[0-9]+)?", lambda n: f"{float(n.group()) * dice.choice((-1, 1, 1, 1)) * 10 ** dice.uniform(-4, 4):.6g}", value)


def vary(text, dice):
    """One to three values of the participant replaced; the simulation's own stay, so that a right case is short."""
    head, body = text.split("participants:", 1)
    places = list(re.finditer(r"(?<=: )(\[[^\]]*\]|[^,{}\[\]\n]+)", body))
    for place in sorted(dice.sample(places, min(len(places), dice.randint(1, 3))), key=lambda p: -p.start()):
        before = body[:place.start()]
        if before.endswith(("program: ", "mesh: ", "dimension: ")):
            continue
        body = body[:place.start()] + odd(place.group(), dice) + body[place.end():]
    return head + "participants:" + body


def limits(seconds):
    resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run(program, folder, seconds=SECONDS, patience=60):
    """(exit code, what was said, seconds of wall time, MB)"""
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMP_NUM_THREADS="1")
    start = time.monotonic()
    with open(folder / "said", "w+", encoding="utf-8", errors="replace") as said:
        process = subprocess.Popen([program, "case.yaml"], cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=said,
                                   stderr=subprocess.STDOUT, preexec_fn=lambda: limits(seconds))
        pid, status, usage = 0, 0, None
        while pid == 0:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid == 0 and time.monotonic() - start > patience:
                process.kill()
            time.sleep(0.005)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read()
    return process.returncode, text, time.monotonic() - start, usage.ru_maxrss / 1024


def main():
    binaries, count = pathlib.Path(sys.argv[1]).resolve(), int(sys.argv[2])
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else int(os.environ.get("COUPLET_FUZZ_SEED", "1"))
    dice, failed, codes, slowest, largest, much = random.Random(seed), 0, {}, 0.0, 0.0, 0
    with tempfile.TemporaryDirectory(prefix="couplet-fuzz-runs-") as name:
        folder = pathlib.Path(name)
        shutil.copy(WRONG / "square.msh", folder)
        for i in range(count):
            program = dice.choice(sorted(CASES))
            text = vary((WRONG / CASES[program]).read_text(), dice)
            (folder / "case.yaml").write_text(text)
            shutil.rmtree(folder / "out", ignore_errors=True)
            code, said, seconds, megabytes = run(binaries / program, folder)
            if code == -signal.SIGXCPU:
                much += 1
                shutil.rmtree(folder / "out", ignore_errors=True)
                code, said, seconds, megabytes = run(binaries / program, folder, WORK, 10 * WORK)
            codes[code] = codes.get(code, 0) + 1
            slowest, largest = max(slowest, seconds), max(largest, megabytes)
            problems = []
            if code not in (0, 1, 2, 4):
                problems.append(f"exit code {code}")
            if megabytes > MEGABYTES:
                problems.append(f"{megabytes:.0f} MB")
            last = said.strip().splitlines()[-1] if said.strip() else ""
            if code in (1, 2) and (not last or "MPI_ABORT" in said or last.startswith("---")):
                problems.append("does not end with a sentence")
            if problems:
                failed += 1
                kept = pathlib.Path(tempfile.gettempdir()) / f"couplet-fuzz-run-{seed}-{i}.yaml"
                kept.write_text(text)
                print(f"not ok  {i} {program}: {'; '.join(problems)}; the case is kept in {kept}\n    " + "\n    ".join(said.splitlines()[-8:]),
                      flush=True)
    if much > count / 100:
        failed += 1
        print(f"not ok  {much} of {count} runs take more than {SECONDS:.0f} s")
    print(f"{count} runs, {failed} failed; exit codes {dict(sorted(codes.items()))}; {much} took over {SECONDS:.0f} s; slowest {slowest:.1f} s, largest {largest:.0f} MB")
    sys.exit(1 if failed else 0)


main()
