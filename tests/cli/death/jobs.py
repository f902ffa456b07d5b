# SPDX-License-Identifier: Apache-2.0
"""Runs small MPMD jobs of the coupler and the two toy participants, and checks how they end."""
import concurrent.futures
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import living  # noqa: E402

MPIRUN = ["mpirun", "--oversubscribe"]
PATIENCE = 120  # [s] with a whole job: a busy machine is no failure

CASE = """\
simulation:
  end-time: {end}
  time-step: 0.1 s
  output: {{folder: out}}
participants:
  fluid: {{program: toy_piston, added-mass: 2 kg, driving-force: 1 N{fluid}}}
  solid: {{program: toy_spring, mass: 0.5 kg, stiffness: 3 N/m{solid}}}
coupling:
  scheme: implicit
  fluid: {{participant: fluid}}
  structure: {{participant: solid}}
  convergence: {{relative: 1e-10}}
"""


def case_text(end="1 s", fluid="", solid=""):
    return CASE.format(end=end, fluid=fluid, solid=solid)


class Suite:
    """Scenarios that report themselves; each runs in an empty folder. `at_once`: so many at a time; a job that fails mostly waits, as
    mpirun gives its processes a second to end."""

    def __init__(self, at_once=1):
        self.pool = concurrent.futures.ThreadPoolExecutor(at_once) if at_once > 1 else None
        self.begun = []
        programs = [os.path.abspath(p) for p in sys.argv[1:3]]
        os.environ["PATH"] = os.pathsep.join(programs + [os.environ["PATH"]])
        self.failed = []

    def scenario(self, *words, **more):
        """As run(), at once or when its turn has come."""
        if self.pool:
            self.begun.append(self.pool.submit(self.run, *words, **more))
        else:
            self.run(*words, **more)

    def run(self, name, command, cases, code, lines, fault=None, within=5.0, not_lines=(), once=None, prepare=None):
        """`lines`: each must be part of a line of the output, `once` of exactly one; `code`: None is any but 0. `within`: so
        many seconds after the first program of the job is gone (not after the start) all of it is. `prepare`: called with
        the folder."""
        with tempfile.TemporaryDirectory() as folder:
            for file, text in cases.items():
                with open(os.path.join(folder, file), "w", encoding="utf-8") as out:
                    out.write(text)
            if prepare:
                prepare(folder)
            environment = dict(os.environ)
            environment.pop("COUPLET_FAULT", None)
            if fault:
                environment["COUPLET_FAULT"] = fault
            # A group of its own: nothing may be left of it afterwards.
            process = subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                       start_new_session=True)
            clock = threading.Thread(target=watch, args=(process, deaths := [])) if fault else None
            if clock:
                clock.start()
            try:
                output, _ = process.communicate(timeout=PATIENCE)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, 9)
                output, _ = process.communicate()
                output += f"\n(still running after {PATIENCE} s)"
            if clock:
                clock.join()
            start = deaths[0] if fault and deaths else time.monotonic()
            # The last of them may still be on their way out when mpirun returns.
            while living(process.pid) and time.monotonic() - start < within:
                time.sleep(0.05)
            seconds = time.monotonic() - start
            problems = []
            if seconds > within:
                problems.append(f"took {seconds:.1f} s, allowed are {within:g} s")
            wrong_code = process.returncode == 0 if code is None else process.returncode != code
            if wrong_code:
                problems.append(f"exit code {process.returncode}")
            if left := living(process.pid):
                problems.append(f"processes left: {left}")
            for line in lines:
                if not any(line in printed for printed in output.splitlines()):
                    problems.append(f"no line holds: {line}")
            if once and output.count(once) != 1:
                problems.append(f"printed {output.count(once)} times: {once}")
            for line in not_lines:
                if line in output:
                    problems.append(f"a line holds: {line}")
        said = f"{'not ok' if problems else 'ok'}  {name}  ({seconds:.1f} s)"
        if problems:
            self.failed.append(name)
            said += "\n  " + "\n  ".join(problems) + "\n  output:\n    " + "\n    ".join(output.splitlines()[-40:])
        print(said + "\n", end="", flush=True)

    def finish(self):
        for scenario in self.begun:
            scenario.result()
        print(f"{len(self.failed)} scenarios failed" if self.failed else "all scenarios passed")
        sys.exit(1 if self.failed else 0)


def watch(process, deaths):
    """Notes when the first process of the job that is not mpirun itself is gone."""
    seen = set()
    while process.poll() is None and not deaths:
        now = set(living(process.pid)) - {process.pid}
        if seen - now:
            deaths.append(time.monotonic())
        seen |= now
        time.sleep(0.01)


def mpmd(*parts):
    """("1 coupler case.yaml", ...) to the words of an mpirun command."""
    words = list(MPIRUN)
    for i, part in enumerate(parts):
        words += ([":"] if i else []) + ["-n"] + part.split()
    return words
