#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Guests that break the protocol: the job ends, with a code that is not 0 and a sentence that names the guest and what is wrong, and
no process stays. Usage: odd_guests.py PROJECT BIN quick|all MPIRUN..."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

project, programs, mpirun = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), sys.argv[4:]
SLOWER = float(os.environ.get("COUPLET_SLOWER", "1"))
SECONDS = 20 * SLOWER
# stage, how, what must be said
SCENES = [
    ("handshake", "3", ["(an external program) uses version 3 of the protocol", "here use version 8"]),
    ("handshake", "9", ["(an external program) uses version 9 of the protocol", "here use version 8"]),
    ("handshake", "mark", ["is not a Couplet program", "begins with 42"]),
    ("introduction", "nothing", ["it has 0 fields, but 9 are expected"]),
    ("introduction", "words", ["not a whole number"]),
    ("introduction", "ends", ["it has 0 fields"]),
    ("reply", "version", ["The reply of 'body' to initialise", "protocol version 9", "uses version 8"]),
    ("reply", "mark", ["The reply of 'body' to initialise", "not the expected reply"]),
    ("reply", "status", ["'body'", "the status as 9; expected 0 to 2"]),
    ("reply", "dimension", ["'body'", "the dimension as 4; expected 2 to 3"]),
    ("reply", "name", ["'body'", "100000 bytes"]),
    ("reply", "twice", ["'body'", "announces 'pressure-force' twice"]),
    ("reply", "huge", ["'body'", "partitions its vertices over ranks"]),
    ("reply", "falls", ["'body'", "partitions its vertices over ranks"]),
    ("reply", "ranks", ["'body'", "over 2 ranks, but runs on 1"]),
    ("reply", "cut", ["'body'", "truncated"]),
    ("reply", "long", ["'body'", "at most"]),
    ("reply", "fewer", ["'body' announced 3 vertices and 2 faces", "described 2 and 2"]),
    ("reply", "corner", ["'body' refers to vertex 77 of 3"]),
    ("reply", "nowhere", ["gives a vertex as"]),
]


# Nobody waits for the others: one of each stage.
if sys.argv[3] == "quick":
    SCENES = [scene for scene in SCENES if scene[:2] in (("handshake", "3"), ("introduction", "words"), ("reply", "huge"))]


def left_behind(token):
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if token in (entry / "cmdline").read_text():
                    found.append(entry.name)
            except OSError:
                pass
    return found


def run(stage, how):
    with tempfile.TemporaryDirectory() as folder:
        token = pathlib.Path(folder).name
        shutil.copy(project / "tests/coupling/client/odd.yaml", pathlib.Path(folder) / f"{token}.yaml")
        guest = programs / "tests/odd_guest"
        command = [*mpirun, "-n", "1", programs / "coupler", f"{token}.yaml", ":", "-n", "1", guest, "body", stage, how, token, ":",
                   "-n", "1", guest, "fluid", "reply", "right", token]
        if stage != "reply":  # one guest is enough, and nobody else would wait for it
            command = command[:-8]
        start = time.monotonic()
        try:
            result = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, errors="replace", timeout=SECONDS)
        except subprocess.TimeoutExpired:
            return [f"still running after {SECONDS:.0f} s"], SECONDS
        seconds = time.monotonic() - start
        trouble = []
        if result.returncode not in (1, 2):
            trouble.append(f"exit code {result.returncode}")
        said = result.stdout + result.stderr
        if "terminate called" in said or "Signal:" in said:
            trouble.append("it crashed")
        return said, trouble, seconds, left_behind(token)


def main():
    failed = 0
    for stage, how, wanted in SCENES:
        answer = run(stage, how)
        if len(answer) == 2:
            trouble, seconds = answer
        else:
            said, trouble, seconds, left = answer
            trouble += [f"'{words}' is not said" for words in wanted if words not in said]
            trouble += [f"processes {left} are left"] if left else []
            if trouble:
                print(said[-1500:])
        failed += bool(trouble)
        print(f"{'not ok' if trouble else 'ok'}  {stage} {how} ({seconds:.1f} s)  {'; '.join(trouble)}", flush=True)
    print(f"{len(SCENES) - failed} of {len(SCENES)} guests that break the protocol end the job as they should")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
