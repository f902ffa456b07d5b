# SPDX-License-Identifier: Apache-2.0
"""One process (or one mpirun) from start to end with its costs."""
import dataclasses
import os
import pathlib
import platform
import signal
import subprocess
import threading
import time

STOP = threading.Event()  # set: what was launched from whatever thread ends
PATIENCE = 5.0            # [s] between SIGTERM and SIGKILL


class RunFailed(RuntimeError):
    """A program failed; the text states how."""


@dataclasses.dataclass
class Cost:
    wall: float    # [s]
    cpu: float     # [s] user and system, of all processes under the one started, waiting MPI ranks included
    memory: float  # [MB] largest of one process, as the system counted it


def environment():
    """One thread per rank; ranks are not bound to cores: Open MPI would bind those of jobs side by side to the same ones."""
    ours = dict(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", MPLBACKEND="Agg")
    return {"OMPI_MCA_hwloc_base_binding_policy": "none", **os.environ, **ours}


def last_words(text):
    """The last output of a program, without MPI's frames around it."""
    lines = [line.strip() for line in text.strip().splitlines() if line.strip() and not set(line.strip()) <= set("-=")]
    # "error:" before other mentions: the estimate of the error is written at a failed run's end, too.
    named = [line for line in lines if "error:" in line.lower()] or [line for line in lines if "error" in line.lower()]
    return (named or lines or [""])[-1] if named else " / ".join(lines[-3:])


def launch(command, log, folder=None, timeout=3600, env=None):
    """Runs a command with its output in the file `log`; gives its Cost. Raises RunFailed with its last words."""
    log = pathlib.Path(log)
    start = time.monotonic()
    with open(log, "w") as out:
        process = subprocess.Popen([str(c) for c in command], stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT,
                                   cwd=folder, env=env or environment(), start_new_session=True)
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
        except BaseException:  # the user stops the study: nothing is left running
            os.killpg(process.pid, signal.SIGTERM)
            limit = time.monotonic() + PATIENCE
            while os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None and time.monotonic() < limit:
                time.sleep(0.02)
            os.killpg(process.pid, signal.SIGKILL)
            os.wait4(process.pid, 0)
            raise
        finally:
            process.returncode = 0  # waited for above
    wall = time.monotonic() - start
    code = os.waitstatus_to_exitcode(status)
    if late:
        raise RunFailed(f"not at its end after {timeout:g} s")
    if code != 0:
        raise RunFailed(f"exit code {code}: {last_words(log.read_text(errors='replace'))} (see {log})")
    return Cost(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def machine():
    """{name, cores, load} of where this runs."""
    model = next((line.split(":", 1)[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines()
                  if line.startswith("model name")), platform.machine()) if pathlib.Path("/proc/cpuinfo").exists() else platform.machine()
    return {"processor": model, "cores": len(os.sched_getaffinity(0)), "load": round(os.getloadavg()[0], 1)}


def commit(root):
    result = subprocess.run(["git", "-C", str(root), "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    return result.stdout.strip() or "unknown"
