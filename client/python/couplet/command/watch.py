# SPDX-License-Identifier: Apache-2.0
"""Shows the progress of a run from its output files: time, step, iterations, residual, remaining time, and findings as
they appear. With --web, a page for a browser on this machine also draws residuals, probes and step size. Exits when the
run ends. Ctrl-C stops watching, not the run."""
import pathlib
import threading
import time

from couplet.runs import folder as folders
from couplet.runs.case import expect
from couplet.runs.job import RUN_HELP, run_folder
from couplet.runs.progress import Logs, Progress, by_tables
from couplet.runs.results import Results
from couplet.runs.terminal import Screen


def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="RUN", help=RUN_HELP)
    parser.add_argument("--every", type=float, default=0.5, metavar="SECONDS", help="refresh interval (default: 0.5)")
    parser.add_argument("--once", action="store_true", help="prints the current state and exits")
    parser.add_argument(
        "--web", action="store_true", help="serves a page on localhost; the URL contains an access token"
    )
    parser.add_argument("--port", type=int, default=0, metavar="N", help="port of the page (default: any free one)")


def ending(folder):
    """Outcome of the run, according to its reports."""
    results = Results(folder)
    reports = {name: results.report(name) for name in results.participants()}
    driver = reports.get("coupler") or next(iter(reports.values()), {})
    if not driver:
        return "no run is active here, and none has finished"
    findings = results.findings()
    at = (
        f"t = {driver['time']:g} s" if driver.get("steps") else by_tables(folder) or "t = 0 s"
    )  # a resumed run that was complete has made no step
    text = f"{driver.get('state', 'ended')} at {at} after {driver.get('steps', 0)} steps, {driver.get('wall', 0):.1f} s"
    text += f": {driver['reason']}" if driver.get("reason") else ""
    return text + (f"; findings: {', '.join(sorted({f['id'] for f in findings}))}" if findings else "")


def run(arguments):
    folder = run_folder(arguments.folder)
    expect(folder.is_dir(), f"{folder}: there is no such folder")
    if arguments.web:
        from couplet.command import page

        server, address = page.server(Progress(folder), arguments.port)
        print(f"{address} (press Ctrl-C to stop)", flush=True)
        threading.Thread(target=server.serve_forever, daemon=True).start()
    logs, screen = Logs(folder), Screen()
    try:
        while True:
            at_work = folders.driver(folder) is not None
            status, worth = logs.look()
            for text in worth:
                screen.line(text)
            screen.status(status)
            if arguments.once or not (at_work or arguments.web):
                break
            time.sleep(arguments.every)
    except KeyboardInterrupt:
        pass
    if screen.live and screen.shown:
        print()
    if folders.driver(folder) is None:
        print(ending(folder))
    return 0
