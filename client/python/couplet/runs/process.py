# SPDX-License-Identifier: Apache-2.0
"""One process (or mpirun) from start to end with its costs, and mpirun's own messages about the end of a job, between
lines of dashes."""
import dataclasses
import os
import pathlib
import platform
import re
import signal
import subprocess
import threading
import time

from couplet import files

STOP = threading.Event()  # when set, everything launched from any thread ends
PATIENCE = 5.0  # [s] between SIGTERM and SIGKILL


class RunFailed(RuntimeError):
    """A program failed; the text states how."""


@dataclasses.dataclass
class Cost:
    wall: float  # [s]
    cpu: float  # [s] user and system, of all descendants, including waiting MPI ranks
    memory: float  # [MB] peak of one process, as counted by the system


def environment():
    """Uses one thread per rank. Ranks are not bound, because Open MPI would bind those of concurrent jobs to the same
    cores."""
    ours = dict(
        OMP_NUM_THREADS="1",
        OPENBLAS_NUM_THREADS="1",
        OMPI_ALLOW_RUN_AS_ROOT="1",
        OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
        MPLBACKEND="Agg",
    )
    return {"OMPI_MCA_hwloc_base_binding_policy": "none", **os.environ, **ours}


CLIENT = "couplet client: "  # begins a line of the library in an external participant


def raised(text):
    """Last line of the last traceback of Python in a text; empty if there is none."""
    lines = iter(text.rpartition("Traceback (most recent call last):\n")[2].splitlines() if "Traceback" in text else ())
    return next((line for line in lines if line[:1].strip()), "")


def last_words(text):
    """Last output of a program without MPI's messages."""
    lines = [line.strip() for line in text.strip().splitlines() if line.strip() and not set(line.strip()) <= set("-=")]
    if guest := next((line for line in lines if line.startswith(CLIENT)), ""):  # an external participant gives up
        return guest.removeprefix(CLIENT)
    # A line of the watch over the job says why it ends; the error estimate is written at the end of a failed run, too.
    named = [line for line in lines if line.startswith("couplet: ")] or [
        line for line in lines if "error:" in line.lower()
    ]
    if not named:
        return " / ".join(lines[-3:])
    at = len(lines) - 1 - lines[::-1].index(named[-1])
    return " / ".join(lines[at : at + 2]) if named[-1].endswith(":") else named[-1]


def launch(command, log, folder=None, timeout=3600, env=None):
    """Runs a command with its output in the file `log` and returns its Cost. Raises RunFailed with its last output."""
    log = pathlib.Path(log)
    start = time.monotonic()
    with files.in_place(log.parent, log.name) as out:
        process = subprocess.Popen(
            [str(c) for c in command],
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=subprocess.STDOUT,
            cwd=folder,
            env=env or environment(),
            start_new_session=True,
        )
        late = False
        try:
            while True:
                pid, status, usage = os.wait4(process.pid, os.WNOHANG)
                if pid:
                    break
                if STOP.is_set():
                    raise KeyboardInterrupt
                if time.monotonic() - start > timeout:
                    late = True
                    os.killpg(process.pid, signal.SIGKILL)
                    _, status, usage = os.wait4(process.pid, 0)
                    break
                time.sleep(min(0.02, 0.002 + 0.01 * (time.monotonic() - start)))
        except BaseException:  # stopped by the user: no process is left running
            os.killpg(process.pid, signal.SIGTERM)
            limit = time.monotonic() + PATIENCE
            while (
                os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None
                and time.monotonic() < limit
            ):
                time.sleep(0.02)
            os.killpg(process.pid, signal.SIGKILL)
            os.wait4(process.pid, 0)
            raise
        finally:
            process.returncode = 0  # waited for above
    wall = time.monotonic() - start
    code = os.waitstatus_to_exitcode(status)
    if late:
        raise RunFailed(f"not finished after {timeout:g} s")
    if code != 0:
        raise RunFailed(f"exit code {code}: {last_words(log.read_text(errors='replace'))} (see {log})")
    return Cost(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def machine():
    """Returns {name, cores, load} of this machine."""
    model = (
        next(
            (
                line.split(":", 1)[1].strip()
                for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines()
                if line.startswith("model name")
            ),
            platform.machine(),
        )
        if pathlib.Path("/proc/cpuinfo").exists()
        else platform.machine()
    )
    return {"processor": model, "cores": len(os.sched_getaffinity(0)), "load": round(os.getloadavg()[0], 1)}


def commit(root):
    result = subprocess.run(["git", "-C", str(root), "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    return result.stdout.strip() or "unknown"


FRAME = re.compile(rb"-{40,}\s*")
KILLED = re.compile(r"process rank (\d+) .*exited on signal (\d+)(?: \((.*?)\))?", re.S)
EXITED = re.compile(r"first process to do so was: Process name: \[\[\d+,\d+\],(\d+)\] Exit code: (\d+)")
OTHERS = (
    "Primary job terminated normally",
    "mpirun detected that one or more processes exited",
    "MPI_ABORT was invoked",
)  # a program ended the job, with a message of its own
LONGEST = 40  # maximum lines between two lines of dashes; longer texts are not mpirun's


class Pages:
    """Removes mpirun's messages from a stream of bytes."""

    def __init__(self):
        self.rest, self.page, self.killed, self.exited = b"", None, None, None

    def feed(self, data, last=False):
        """Returns complete parts that are not mpirun's."""
        *lines, self.rest = (self.rest + data).splitlines(keepends=True) + (
            [b""] if (self.rest + data).endswith(b"\n") else []
        ) or [b""]
        if last:
            lines, self.rest = [*lines, self.rest], b""
        out = b""
        for line in lines:
            if self.page is not None:
                self.page.append(line)
                if FRAME.fullmatch(line) or len(self.page) > LONGEST:
                    out += self._end()
            elif FRAME.fullmatch(line):
                self.page = [line]
            else:
                out += line
        if self.page is None and not self.rest.startswith(b"-"):  # an incomplete line of a program is shown at once
            out, self.rest = out + self.rest, b""
        return out + (self._end() if last and self.page else b"")

    def _end(self):
        text, self.page = b"".join(self.page), None
        words = " ".join(text.decode(errors="replace").split())
        if found := KILLED.search(words):
            self.killed = self.killed or (int(found[1]), int(found[2]), found[3] or "")
        if failed := EXITED.search(words):
            self.exited = self.exited or (int(failed[1]), int(failed[2]))
        return b"" if found or any(other in words for other in OTHERS) else text


def owner(rank, sizes):
    """(name of the program that has this rank, its own number of the rank, its number of ranks). `sizes` is [(name,
    ranks)] in the order of the launch line."""
    for who, ranks in sizes:
        if rank < ranks:
            return who, rank, ranks
        rank -= ranks
    return None, rank, 1


def culprit(killed, sizes):
    """Name of the killed program."""
    rank, number, name = killed
    who, rank, ranks = owner(rank, sizes)
    if who is None:
        return f"a process was killed by signal {number}"
    return (
        f"'{who}'{f', rank {rank},' if ranks > 1 else ''} was killed by signal {number}{f' ({name})' if name else ''}"
    )
