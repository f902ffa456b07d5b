# SPDX-License-Identifier: Apache-2.0
"""A terminal of 80 by 24. Usage: terminal.py BIN PART; parts: command (couplet run), program (a program started by itself; and by mpirun),
shipped (couplet run of twelve shipped cases; a bar of `scripts/validate newcomer`)"""
import fcntl
import os
import pathlib
import pty
import re
import struct
import subprocess
import sys
import tempfile
import termios

from scene import ROOT, call, case_in, environment
from checks import check, end  # noqa: E402

bin_, what = pathlib.Path(sys.argv[1]), sys.argv[2]
RENEW = "\r\x1b[K"


def on_terminal(*words):
    """(exit code, words on standard output, on standard error) where the former is a terminal."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    env = {k: v for k, v in environment(bin_).items() if k not in ("COLUMNS", "LINES")}
    env |= {"TERM": "xterm", "OMP_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    job = subprocess.Popen(list(map(str, words)), stdout=theirs, stderr=subprocess.PIPE, env=env)
    os.close(theirs)
    said = b""
    try:
        while data := os.read(ours, 65536):
            said += data
    except OSError:  # the other side has closed
        pass
    errors = job.stderr.read().decode()
    return job.wait(), said.decode().replace("\r\n", "\n"), errors


def looks_right(name, text):
    """At most 12 lines before the first status, at most 20 after the last; nothing wider than the terminal."""
    begin, last = text.partition(RENEW)[0], text.rpartition(RENEW + "t=")[2].partition(RENEW)[2]
    lines = [part for line in text.split("\n") for part in line.split(RENEW)]
    check(f"{name}: start of at most 12 lines, end of at most 20", begin.count("\n") <= 12 and 2 <= last.count("\n") <= 20, (begin, last))
    check(f"{name}: no line is wider than the terminal", all(len(line) <= 80 for line in lines if not line.startswith(("done in", "results in", "picture: ", "more: "))), max(lines, key=len))
    return re.findall(r"\r\x1b\[K(t=[^\n\r]*)", text)


def last_screen(name, text):
    """It holds results with a number and the verdict, and nothing is cut."""
    last = "\n".join(line.rpartition(RENEW)[2] for line in text.rstrip("\n").split("\n")[-24:])
    good = re.search(r"^Results of '\w+' at t = .*\n  .*\d", last, flags=re.M) and re.search(r"^Verdict: ", last, flags=re.M) and "..." not in last
    check(f"{name}: the last screen shows results and the verdict", good, last)


SHIPPED = {"cantilever": None, "lame-cylinder": None, "elastic-bar": None, "buckling-column": None, "cavity": 2, "taylor-green-2d": None, "plate-square": None, "plate-drop": None,
           "thermocline-solar-one": None, "schumann": None, "moving-mesh": 0.1, "perpendicular-flap": 0.3}  # with an earlier end [s]


def shipped(folder):
    """All programs, alone and coupled."""
    for name, last in SHIPPED.items():
        more = [] if last is None else ["--set", f"simulation.end-time={last}"]
        code, text, errors = on_terminal(ROOT / "scripts/couplet", "run", ROOT / "configs" / name, "--bin", bin_, "--set", f"simulation.output.folder={folder / name}", *more)
        check(f"{name}: it ends", code in (0, 4), text + errors)
        last_screen(name, text)
        looks_right(name, text)


def command(folder):
    """couplet run: of coupled jobs, too, with at least three renewals of the status."""
    case = case_in(folder / "a", bin_, end_time=0.3)
    for name, words in (("flap", (case,)), ("fluid alone", (case, "--participant", "fluid")), ("tank", (ROOT / "configs/thermocline-solar-one", "--set", f"simulation.output.folder={folder / 'tank'}")),
                        ("solid", (ROOT / "configs/cantilever", "--set", f"simulation.output.folder={folder / 'solid'}"))):
        code, text, _ = on_terminal(ROOT / "scripts/couplet", "run", *words)
        check(f"{name}: it ends well", code == 0 and "done in" in text.splitlines()[-3], text[-400:])
        last_screen(name, text)
        statuses = looks_right(name, text)
        check(f"{name}: a status line that renews itself", name != "flap" or len(statuses) >= 3 and all("to go" in s for s in statuses) and "steps/s" in statuses[-1], statuses[-3:])
        check(f"{name}: it can be resumed", call(bin_, "resume", folder / {"tank": "tank", "solid": "solid"}.get(name, "a/out"), "--print").stdout.startswith(("mpirun ", str(bin_))))
    code, text, errors = on_terminal(ROOT / "scripts/couplet", "run", ROOT / "configs/cantilever", "--set", "participants.solid.material.density=heavy")
    check("what is wrong with a case is shown", code == 2 and "'heavy' is not a number" in text + errors, text + errors)


def launched(folder, out):
    """mpirun by hand: one program of the job has the status line; where mpirun marks lines or writes to a file they stand as they are."""
    words = ("mpirun", "--oversubscribe", "-n", 2, bin_ / "solid_solver", ROOT / "configs/cantilever/case.yaml", "--set", out + "two")
    text = on_terminal(*words)[1]
    statuses = looks_right("mpirun, two ranks", text)
    check("mpirun, two ranks: one status line, once where results lie", len(statuses) == 1 and text.count("results in ") == 1 and "[solid 0]" not in text, text)
    marked = on_terminal("mpirun", "--tag-output", *words[1:])[1]
    check("mpirun --tag-output: lines", "\x1b" not in marked and "[solid 0] t=1/1 s" in marked, marked)
    case = case_in(folder / "b", bin_, end_time=0.2)
    line = call(bin_, "run", case, "--print").stdout.split()
    code, text, _ = on_terminal(*line)
    statuses = looks_right("mpirun, flap", text)
    check("mpirun, flap: a status line that renews itself", code == 0 and len(statuses) >= 3 and all("to go" in s for s in statuses) and "steps/s" in statuses[-1], text)
    check("mpirun, flap: each program says once who it is, and one where results lie", all(text.count(f"runs '{name}'") <= 1 for name in ("fluid", "solid", "mover")) and text.count(f"results in {case.parent / 'out'}") == 1, text)
    check("mpirun, flap: the logs have every line", all("] t=" in f.read_text() or "time of" in f.read_text() for f in (case.parent / "out").glob("*/*.log")))
    piped = subprocess.run(line, capture_output=True, text=True, env={**environment(bin_), "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}).stdout
    check("mpirun, flap, in a file: lines", "\x1b" not in piped and "[coupler 0] t=" in piped and "[solid 0] solid_solver runs" in piped, piped[-500:])


def program(folder):
    """The programs themselves: the same limits, where the results lie; all lines in the log; lines as in a file with --verbose."""
    out = f"simulation.output.folder={folder}/"
    for name, words in (("solid", ("solid_solver", ROOT / "configs/cantilever/case.yaml")), ("fluid", ("fluid_solver", ROOT / "configs/cavity/case.yaml", "--set", "simulation.end-time=4")),
                        ("tank", ("thermocline", ROOT / "configs/thermocline-solar-one/case.yaml")), ("plate", ("plate_modal", ROOT / "configs/plate-square/case.yaml"))):
        words = (bin_ / words[0], *words[1:], "--set", out + name)
        code, text, errors = on_terminal(*words)
        check(f"{name}: it ends with where results lie", code == 0 and text.rstrip("\n").split("\n")[-1].startswith(f"{RENEW}results in {folder / name}"), text[-300:] + errors)
        statuses = looks_right(name, text)
        check(f"{name}: a status line that renews itself", len(statuses) >= (2 if name == "fluid" else 1) and (name != "fluid" or "to go" in statuses[-1] and "steps/s" in statuses[-1]), statuses)
        piped = subprocess.run([*map(str, words), "--set", out + "piped"], capture_output=True, text=True, env=environment(bin_)).stdout
        (log,) = (folder / name).glob("*/*.log")
        check(f"{name}: the log has every line, and so has a file", all(f"] {kind}" in log.read_text() and f" 0] {kind}" in piped for kind in (f"{words[0].name} runs ", "t=", "time of ")) and "\x1b" not in piped, piped)
    loud = on_terminal(bin_ / "solid_solver", ROOT / "configs/cantilever/case.yaml", "--verbose", "--set", out + "loud")[1]
    check("--verbose: lines", "\x1b" not in loud and "[solid 0] t=1/1 s" in loud, loud)
    launched(folder, out)
    code, text, errors = on_terminal(bin_ / "solid_solver", ROOT / "configs/vibrating-cantilever/case.yaml", "--set", "simulation.time-step=0", "--set", out + "wrong")
    check("an error stands alone", code == 2 and "time-step" in errors and RENEW not in text, text + errors)
    code, text, errors = on_terminal(bin_ / "solid_solver", ROOT / "configs/cantilever/case.yaml", "--set", "participants.solid.material.youngs-modulus=1e4 Pa", "--set", out + "doubt")
    check("a finding stands above the status, whole", "warning: t = 1 s: geometric non-linearity neglected: max |grad u| = 11 " in text.replace(RENEW, "").replace("\n  ", " "), text)


with tempfile.TemporaryDirectory(prefix="couplet-terminal-") as scratch:
    {"command": command, "program": program, "shipped": shipped}[what](pathlib.Path(scratch))
end()
