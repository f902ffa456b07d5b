# SPDX-License-Identifier: Apache-2.0
"""Runs many tasks, several at a time. Skips completed ones, waits for those of other processes, and lists their
warnings."""
import collections
import concurrent.futures
import re
import threading
import time

from couplet.runs import process


def run_all(tasks, jobs=1, again=False, say=print):
    """Returns {task: Record} of all tasks in their order. `again` repeats existing ones. `say` receives a line per
    task."""
    queue, records, mutex, start = collections.deque(tasks), {}, threading.Lock(), time.monotonic()
    made = set()

    def tell(task, record, word):
        with mutex:
            records[task] = record
            left = len(tasks) - len(records)
            rest = (
                (time.monotonic() - start) / max(len(made), 1) * left / max(jobs, 1) * min(len(made), jobs)
                if made and left
                else 0
            )
            say(
                f"[{len(records)}/{len(tasks)}] {task.name}: {record.reason or word}"
                + (f" (about {rest:.0f} s left)" if rest > 10 else "")
            )

    def worker():
        busy = 0  # consecutive tasks that others are running
        while True:
            with mutex:
                if not queue:
                    return
                task = queue.popleft()
                wait = busy > len(queue)
            record = None if again else task.record()
            if record:
                tell(task, record, "done before")
                continue
            with task.lock(wait) as mine:
                if not mine:
                    busy += 1
                    with mutex:
                        queue.append(task)
                    continue
                busy = 0
                record = None if again else task.record()
                if record:
                    tell(task, record, "done by another")
                    continue
                record = task.make()
                with mutex:
                    made.add(task)
            tell(task, record, f"{record.wall:.1f} s, processor {record.cpu:.1f} s")

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        try:
            for future in [pool.submit(worker) for _ in range(jobs)]:
                future.result()
        except BaseException:  # stopped by the user: running tasks end, no new ones start
            with mutex:
                queue.clear()
            process.STOP.set()
            raise
        finally:
            pool.shutdown()
            process.STOP.clear()
    return {task: records[task] for task in tasks}


WARNING = re.compile(r"\] warning: (.*)")
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")


def warnings_of(logs):
    """Lines for the end of a study: warnings in the logs that differ in more than numbers, with an example each."""
    found = {}  # text without numbers -> (example, runs)
    number = 0
    for log in logs:
        number += 1
        if not log.exists():
            continue
        seen = {}
        for text in WARNING.findall(log.read_text(errors="replace")):
            seen.setdefault(NUMBER.sub("#", text), text)
        for kind, text in seen.items():
            example, runs = found.get(kind, (text, 0))
            found[kind] = (example, runs + 1)
    return [f"warning in {runs} of {number} runs, for example: {example}" for example, runs in found.values()]
