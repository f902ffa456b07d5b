# SPDX-License-Identifier: Apache-2.0
"""The picture of a case: what its section `plot` declares, what its own plot.py draws, or nothing of its own."""
import os
import shlex
import subprocess
import sys

from couplet import places
from couplet.runs.case import Case, expect
from couplet.runs.job import output_of


def has_picture(case):
    return "plot" in case.data or (case.file.parent / "plot.py").is_file()


def of_case(file, options):
    """Draws it; gives the exit code, or None where there are only the monitors of its run, which options.files then names."""
    case = Case(file)
    out = options.out or output_of(case, ())
    expect(not options.film or "plot" in case.data, f"--film: {case.file} has no section plot with a map")
    if options.film:
        from couplet.plots.film import film
        folder, file = film(case, out, options.low, options.high)
        print(f"frames: {folder}", f"film: {file}" if file else "film: none, ffmpeg is not installed", sep="\n")
        return 0
    if "plot" in case.data:
        from couplet.plots.draw import draw
        print(f"picture: {draw(case, out, options.picture)}")
        return 0
    if has_picture(case):
        expect(options.out is None, f"--out: {case.file.parent / 'plot.py'} looks for the run where the case puts it")
        paths = [str(places.PACKAGE.parent), *filter(None, [os.environ.get("PYTHONPATH")])]
        return subprocess.run([sys.executable, case.file.parent / "plot.py", *([options.picture] if options.picture else [])],
                              env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)}).returncode
    expect(out.is_dir(), f"{out}: there is no such folder; run the case first: couplet run {shlex.quote(str(file))}")
    options.files = [out]
    return None
