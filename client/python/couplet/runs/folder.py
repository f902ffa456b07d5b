# SPDX-License-Identifier: Apache-2.0
"""Output folder of a job: its active processes, and how it was started."""
import datetime
import json
import os
import pathlib
import re
import signal
import sys
import time

from couplet import files

LOCK, RECORD = ".checkpoints.lock", "job.json"


def fields_of(pid):
    """Fields of /proc/PID/stat behind the name: state, parent, group, session, ..."""
    return pathlib.Path(f"/proc/{pid}/stat").read_text(errors="replace").rpartition(")")[2].split()


def processes():
    return (int(entry) for entry in os.listdir("/proc") if entry.isdigit())


def session(leader):
    """Running processes of a session."""
    found = []
    for pid in processes():
        try:
            state, _, _, its_session = fields_of(pid)[:4]
        except (OSError, ValueError):
            continue
        if int(its_session) == leader and state not in "ZX":
            found.append(pid)
    return found


def driver(folder):
    """Process that drives the steps of the job in this output folder, which holds the checkpoint lock. None if there is
    none."""
    try:
        lock = os.stat(pathlib.Path(folder) / LOCK)
    except OSError:
        return None
    for pid in processes():
        try:
            for file in os.scandir(f"/proc/{pid}/fd"):
                found = os.stat(file.path)
                if (found.st_dev, found.st_ino) == (lock.st_dev, lock.st_ino):
                    return pid
        except OSError:
            continue
    return None


def stop(folder):
    """Asks the job in this folder to end after the current step. Returns false if there is none."""
    pid = driver(folder)
    if pid is None:
        return False
    os.kill(pid, signal.SIGTERM)
    return True


def wait_for_end(folder, seconds):
    """Returns true if no job is active there any more."""
    end = time.monotonic() + seconds
    while driver(folder) is not None:
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


def sets_since(folder, seconds):
    """Names of the complete checkpoints written at `seconds` (Unix time) or later."""
    return [
        file.parent.name
        for file in (pathlib.Path(folder).absolute() / "checkpoints").glob("step-*/set.txt")
        if file.stat().st_mtime >= seconds
    ]


def is_damaged(file):
    """Returns true if a list of the files of a checkpoint is truncated, or if one of them differs in size from the
    list."""
    text = file.read_text(errors="replace")
    sizes = {file.parent / name: int(size) for size, name in re.findall(r"^file (\d+) \w+ (.+)$", text, re.M)}
    return not re.search(r"^digest \w+$", text, re.M) or any(
        not f.is_file() or f.stat().st_size != size for f, size in sizes.items()
    )


def checkpoint(folder):
    """Name of the complete checkpoint with the latest time that the recorded run wrote or started from; None if there
    is none."""
    return next(iter(checkpoints(folder)), None)


def checkpoints(folder):
    """Names of the complete checkpoints that the recorded run wrote, else of the one that it started from, latest
    first. Those of another run in the folder may belong to another case. The id of a run begins with its start, which a
    copy of the folder keeps. Incomplete ones are named and left out."""
    all_sets = pathlib.Path(folder).absolute() / "checkpoints"
    damaged = sorted(filter(is_damaged, all_sets.glob("step-*/set.txt")))
    for file in damaged:
        print(f"warning: {file.parent} is damaged and is left out", file=sys.stderr)
    found = [
        (re.search("^run (.*)$", file.read_text(errors="replace"), re.M), file.parent.name)
        for file in all_sets.glob("step-*/set.txt")
        if file not in damaged
    ]
    runs = sorted((run[1], name) for run, name in found if run and re.match("[0-9a-f]{12}-", run[1]))
    record = read_record(folder)
    begun = (
        record["restart"] and pathlib.Path(os.path.normpath(all_sets.parent / record["restart"]))
        if "restart" in record
        else None
    )
    started = datetime.datetime.fromisoformat(record["started"]).timestamp() if "started" in record else 0
    own = [name for run, name in runs if int(run[:12], 16) / 1000 >= started or begun in (all_sets, all_sets.parent)]
    return own[::-1] if own else [name for _, name in runs if begun == all_sets / name][:1]


def warn_if_older(file):
    """Warns about a file in a participant's folder that the last run did not write: a monitor that its case no longer
    names."""
    try:
        began, written = ((file.parent / "effective.yaml").stat().st_mtime, file.stat().st_mtime)
        steps = json.loads((file.parent / "run.json").read_text())["steps"]  # does not exist during a run
    except (OSError, ValueError, KeyError, TypeError):
        return
    if written < began and steps > 0:
        print(
            f"warning: {file}: belongs to an earlier run; the last run in this folder did not write it", file=sys.stderr
        )


def write_record(folder, record):
    files.write(folder, RECORD, json.dumps(record, indent=1, default=str) + "\n")


def read_record(folder):
    """Record written by `couplet run`: case and restart (relative to the folder, so that a copy refers to its own),
    ranks, sets, flags, alone, with. Empty if the job was started by hand."""
    try:
        return json.loads((pathlib.Path(folder) / RECORD).read_text())
    except (OSError, ValueError):
        return {}
