# SPDX-License-Identifier: Apache-2.0
"""Measures of the first contact: what the last screen of a run shows, and tests whose claims are bars of their own."""
import os
import pty
import re
import subprocess
import sys
import termios


def screen_of(job, case, setting):
    """(exit code, the last 24 lines) of `couplet run` on a terminal of 80 columns."""
    ours, theirs = pty.openpty()
    termios.tcsetwinsize(theirs, (24, 80))
    words = [sys.executable, job.root / "scripts/couplet", "run", job.root / "configs" / case, "--bin", job.build / "bin", "--set", f"simulation.output.folder={job.scratch / case}"]
    words += ["--set", setting] if setting else []
    environment = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "LINES")} | {"TERM": "xterm"}
    process = subprocess.Popen([str(w) for w in words], stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs, env=environment)
    os.close(theirs)
    text = b""
    try:
        while data := os.read(ours, 65536):
            text += data
    except OSError:  # the other side has closed
        pass
    lines = text.decode(errors="replace").replace("\r\n", "\n").split("\n")
    return process.wait(), [line.rpartition("\r\x1b[K")[2] for line in lines][-24:]


def last_screens(job, **cases):
    """Each screen holds the head of the results with at least one number below it and the verdict, and its lines, but for names of files, fit."""
    wrong = []
    for case, setting in cases.items():
        code, lines = screen_of(job, case, setting)
        text = "\n".join(lines)
        good = (code in (0, 4) and re.search(r"^Results of '\w+' at t = .*\n  .*\d", text, flags=re.M) and re.search(r"^Verdict: ", text, flags=re.M)
                and "..." not in text and all(len(line) <= 80 or line.startswith(("done in", "picture: ", "more: ")) for line in lines))
        if not good:
            wrong.append(f"{case} (exit code {code})")
            print(f"{case}:\n{text}", file=sys.stderr)
    return f"{len(cases) - len(wrong)} of {len(cases)}" + (f"; not {', '.join(wrong)}" if wrong else ""), not wrong


def script(job, name, least, *words):
    """A test as a bar: it ends well and prints at least so many lines with results."""
    words = [str(word).format(bin=job.build / "bin", root=job.root) for word in words]
    done = subprocess.run([sys.executable, job.root / name, *words], capture_output=True, text=True)
    if done.returncode == 77:
        return done.stdout.strip(), False
    claims = [line for line in done.stdout.splitlines() if "ends with an error" in line or ": fields" in line]
    bad = [line for line in claims if line.startswith("not ok")]
    return f"{len(claims) - len(bad)} of {len(claims)}" + "".join(f"; {line[:100]}" for line in bad[:3]), done.returncode == 0 and len(claims) >= least
