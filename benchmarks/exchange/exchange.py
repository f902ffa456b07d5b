#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What an exchange of 1e5 vectors of three costs a pass: two dummies and the coupler, against the same bytes by MPI alone,
between the two dummies and through a third process, which has the coupler's place.
Usage: exchange.py [VERTICES] [--bin build/bin]   (compiles dummy.cpp with the client's sources by mpicxx)"""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
CASE = """simulation: {{end-time: {end}, time-step: 0.01, output: {{folder: out, interval: 0}}, checkpoint: {{interval: 0}}, max-step-halvings: 0, accept: [interface-oscillation]}}
participants:
  one: {{program: dummy}}
  two: {{program: dummy}}
coupling:
  scheme: implicit
  exchange: {{participants: [one, two], order: serial}}
  mapping: {{type: nearest}}
  acceleration: {acceleration}
  convergence: {{relative: {relative}, max-iterations: 200}}
  predictor: {{order: 0}}
"""
KINDS = {"constant": "{type: constant, initial-relaxation: 0.66}", "aitken": "{type: aitken, initial-relaxation: 0.5}",
         "iqn-ils": "{type: iqn-ils, initial-relaxation: 0.5, reused-steps: 5}",
         "iqn-ils, changing": "{type: iqn-ils, initial-relaxation: 0.5, reused-steps: 5}"}  # at 1e-2: 6 passes a step, so 30 columns


def measure(vertices, programs, end=0.2):
    """Returns {kind: (passes a step, ms a pass without the dummies' own)} and ms of MPI alone, there and back: between two, and through a third."""
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    with tempfile.TemporaryDirectory() as folder:
        dummy = pathlib.Path(folder) / "dummy"
        sources = [HERE / "dummy.cpp", *(ROOT / "client").glob("*.cpp")]
        subprocess.run(["mpicxx", "-O2", "-std=c++17", "-DOMPI_SKIP_MPICXX", f"-I{ROOT / 'client'}", *sources, "-o", dummy], check=True)

        def run(*words):
            done = subprocess.run(["mpirun", "--oversubscribe", *map(str, words)], cwd=folder, env=environment, capture_output=True, text=True)
            if done.returncode:
                sys.exit(done.stdout[-2000:] + done.stderr[-2000:])
            return done.stdout
        plain = [float(re.search(r"plain ([\d.]+) ms", run("--mca", "pml", "ob1", "--mca", "btl", "self,vader", "-n", ranks, dummy, "plain", vertices))[1])
                 for ranks in (2, 3)]
        found = {}
        for kind, text in KINDS.items():
            changing = ["changing"] if "changing" in kind else []
            (pathlib.Path(folder) / "case.yaml").write_text(CASE.format(end=end, acceleration=text, relative="1e-2" if changing else "1e-6"))
            out = run("-n", 1, programs / "coupler", "case.yaml", ":", "-n", 1, dummy, "one", vertices, *changing, ":",
                      "-n", 1, dummy, "two", vertices, *changing)
            passes, ms, own = (float(w) for w in re.search(r"passes (\d+), ([\d.]+) ms a pass, of it the dummies' own ([\d.]+)", out).groups())
            found[kind] = passes / round(end / 0.01), ms - own
        return found, *plain


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("vertices", nargs="?", type=int, default=100000)
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/bin")
    options = parser.parse_args()
    results, alone, through = measure(options.vertices, options.bin.resolve())
    print(f"MPI alone: {alone:.3f} ms there and back of {options.vertices} vectors, {through:.3f} ms through a third process")
    for kind, (passes, ms) in results.items():
        print(f"{kind}: {ms:.3f} ms a pass ({ms / alone:.1f} and {ms / through:.1f} times), {passes:.1f} passes a step, {ms * passes:.1f} ms a step")
