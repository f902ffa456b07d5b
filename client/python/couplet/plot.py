# SPDX-License-Identifier: Apache-2.0
"""Draws the output of a run: its fields, mode shapes and monitors, or the picture that a case declares in its section
`plot`. For the folder of a run it draws the flow (in 3-D a section), the deformed bodies colored by stress,
temperatures, vibration and buckling modes, and the monitors with several instants, but no runs of a study in that
folder. Columns of the same unit share a diagram. A line is drawn over its length and a plane as a map of each column.
For the residuals of the coupling, the last one of each step is drawn above the number of iterations. The name of each
picture is printed."""
import functools
import os
import pathlib
import shlex
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["text.usetex"] = False  # a matplotlibrc in this folder could start LaTeX
import matplotlib.pyplot as plt
import matplotlib.ticker
import numpy as np

from couplet import files, places
from couplet.plots.sources import columns_of
from couplet.runs.case import Case, Wrong, expect
from couplet.runs.job import output_of, run_folder

PLACES = ("along [-]", "up [-]", "x [m]", "y [m]", "z [m]")
MOST_LINES = 12  # with names of their own
ITERATIONS = "coupling iterations [1]"


def read(file):
    """Columns by name. Truncated rows of a running job are skipped."""
    columns = columns_of(file)
    expect(
        next(iter(columns)).startswith("time") and not np.isnan(next(iter(columns.values()))).any(),
        f"{file}: is not a monitor file: its first line does not begin with 'time [s]', or there is no row below it.",
    )
    return columns


def is_monitor(file):
    """Returns true if the first line names a time, unlike the tables written at the end of a run."""
    with open(file, "rb") as lines:
        return lines.readline().lstrip(b'# "').startswith(b"time [")


def monitors_of(folder):
    """Monitors of a run and of its participants. Runs that lie deeper, such as those of a study, are left alone."""
    return [f for f in sorted((*folder.glob("*.csv"), *folder.glob("*/*.csv"))) if is_monitor(f)]


def has_one_instant(file):
    """Returns true if a chart over time would show a single dot."""
    columns = columns_of(file)
    return len(np.unique(next(iter(columns.values())))) < 2 and not {"along [-]", "z [m]", "depth [m]"} & set(columns)


def per_step(columns):
    """Residuals after the last iteration of each step, and the number of iterations."""
    time = next(iter(columns.values()))
    last = np.flatnonzero(np.append(np.diff(time) != 0, True))
    count = np.diff(np.append(-1, last)).astype(float)
    names = [n for n in columns if "residual" in n]
    return {next(iter(columns)): time[last], **{n: columns[n][last] for n in names}, ITERATIONS: count}


def chosen(columns, options):
    names = [n for n in columns if n != next(iter(columns)) and n not in PLACES]
    if options.only:
        names = [n for n in names if any(word.lower() in n.lower() for word in options.only)]
        expect(
            names,
            f"no column name contains {' or '.join(options.only)}; the columns are: {', '.join(list(columns)[1:])}",
        )
    return names


def by_unit(names):
    units = {}
    for name in names:
        units.setdefault(name[name.rfind("[") + 1 : name.rfind("]")] if "[" in name else "-", []).append(name)
    return units


def curves(x, label, columns, names, log, title):
    units = by_unit([n for n in names if np.isfinite(columns[n]).any()] or names)
    made, axes = plt.subplots(
        len(units),
        1,
        figsize=(7.5, 1.2 + 2.4 * len(units)),
        dpi=120,
        sharex=True,
        squeeze=False,
        constrained_layout=True,
    )
    for ax, (unit, some) in zip(axes[:, 0], units.items()):
        is_log = log and some != [ITERATIONS]
        for name in some:
            y = np.abs(columns[name]) if is_log else columns[name]
            if np.isfinite(y).any():
                ax.plot(x, y, lw=1, marker="." if len(x) < 30 else None, label=name.partition(" [")[0])
        if is_log and any((np.asarray(line.get_ydata()) > 0).any() for line in ax.get_lines()):
            ax.set_yscale("log")
            for which in (ax.yaxis.set_major_formatter, ax.yaxis.set_minor_formatter):
                which(matplotlib.ticker.LogFormatter())  # without formulas, which names must not be taken for
        elif some == [ITERATIONS]:
            ax.yaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
            ax.set_ylim(bottom=0)
        short = some[0].partition(" [")[0]
        ax.set_ylabel(f"{short} [{unit}]" if len(some) == 1 and len(short) < 26 else f"[{unit}]")
        ax.grid(alpha=0.3)
        if len(some) <= MOST_LINES and ax.get_legend_handles_labels()[0]:
            ax.legend(fontsize=7)
    axes[-1, 0].set_xlabel(label)
    axes[0, 0].set_title(title, fontsize=10)
    return made


def maps(columns, names, title):
    """Plots each column of a plane over its two coordinates, which are straight on a mesh at rest."""
    a, b = columns["along [-]"], columns["up [-]"]
    across = int(np.ceil(np.sqrt(len(names))))
    down = -(-len(names) // across)
    made, axes = plt.subplots(
        down, across, figsize=(4.2 * across, 3.4 * down), dpi=120, squeeze=False, constrained_layout=True
    )
    for ax, name in zip(axes.flat, names):
        drawn = ax.scatter(a, b, c=columns[name], s=12, marker="s", cmap="viridis")
        made.colorbar(drawn, ax=ax)
        ax.set_title(name, fontsize=8)
    for ax in axes.flat[len(names) :]:
        ax.axis("off")
    made.suptitle(title, fontsize=10)
    return made


def profiles(columns, names, title):
    """Plots columns over height or depth with one line per output, at most MOST_LINES."""
    time, place = columns[next(iter(columns))], list(columns)[1]
    times = np.unique(time)
    times = times[np.linspace(0, len(times) - 1, min(MOST_LINES, len(times))).astype(int)]
    made, axes = plt.subplots(
        1, len(names), figsize=(1 + 3.2 * len(names), 4.2), dpi=120, sharey=True, squeeze=False, constrained_layout=True
    )
    for ax, name in zip(axes[0], names):
        for i, t in enumerate(times):
            ax.plot(
                columns[name][time == t],
                columns[place][time == t],
                lw=1,
                color=plt.get_cmap("viridis")(i / max(1, len(times) - 1)),
                label=f"{t / 3600:.4g} h",
            )
        ax.set_xlabel(name)
        ax.grid(alpha=0.3)
    axes[0, 0].set_ylabel(place)
    axes[0, -1].legend(fontsize=7)
    made.suptitle(title, fontsize=10)
    return made


def draw(folder, file, options):
    columns = read(file)
    time = columns[next(iter(columns))]
    names = chosen(columns, options)
    is_sample = "along [-]" in columns
    if is_sample:
        wanted = time[-1] if options.at is None else time[np.abs(time - options.at).argmin()]
        rows, title = time == wanted, f"{file.name} at t = {wanted:g} s"
    else:
        low, high = options.low, options.high
        rows = (time >= (-np.inf if low is None else low)) & (time <= (np.inf if high is None else high))
        title = str(file)
    expect(rows.any(), f"{file}: no row between these times; it goes from {time.min():g} s to {time.max():g} s.")
    columns = {n: v[rows] for n, v in columns.items()}
    if list(columns)[1] in ("z [m]", "depth [m]"):
        made = profiles(columns, [n for n in names if n != list(columns)[1]], title)
    elif is_sample and np.ptp(columns["up [-]"]) > 0:
        made = maps(columns, names, title)
    elif is_sample:
        made = curves(columns["along [-]"], "along the line [-]", columns, names, options.log, title)
    elif file.name == "residuals.csv":
        columns = per_step(columns)
        made = curves(
            next(iter(columns.values())),
            "time [s]",
            columns,
            chosen(columns, options),
            True,
            f"{file}: after the last iteration of each step",
        )
    else:
        made = curves(time[rows], "time [s]", columns, names, options.log, title)
    picture = options.picture or file.with_suffix(".png")
    base = picture.parent if options.picture else folder
    with files.part(base, picture.relative_to(base)) as new:
        made.savefig(new)
    plt.close(made)
    print(picture)


def of_case(file, options):
    """Draws the picture of the case, from its section `plot` or its own plot.py. Returns the exit code, or None if
    there are only monitors, which options.files then names."""
    case = Case(file)
    case.trusted = options.allow_commands
    out = options.out or output_of(case, ())
    expect(not options.film or "plot" in case.data, f"--film: {case.file} has no section plot with a map")
    matplotlib.rcParams["text.parse_math"] = "plot" in case.data  # whose titles may hold formulas
    if options.film:
        from couplet.plots.film import film

        folder, file = film(case, out, options.low, options.high)
        print(f"frames: {folder}", f"film: {file}" if file else "film: none, ffmpeg is not installed", sep="\n")
        return 0
    if "plot" in case.data:
        from couplet.plots.draw import draw

        print(f"picture: {draw(case, out, options.picture)}")
        return 0
    if case.has_picture:
        expect(
            case.trusted,
            f"{case.file.parent / 'plot.py'} draws the picture of this case. If you trust it, add --allow-commands",
        )
        expect(options.out is None, f"--out: {case.file.parent / 'plot.py'} looks for the run where the case puts it")
        paths = [str(places.PACKAGE.parent), *filter(None, [os.environ.get("PYTHONPATH")])]
        return subprocess.run(
            [sys.executable, case.file.parent / "plot.py", *([options.picture] if options.picture else [])],
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        ).returncode
    expect(out.is_dir(), f"{out}: there is no such folder; run the case first: couplet run {shlex.quote(str(file))}")
    options.files = [out]
    return None


def declare(parser):
    parser.add_argument(
        "files",
        nargs="+",
        type=pathlib.Path,
        metavar="FILE",
        help=(
            "a CSV file of a run, a folder of such files, or a case, for which its section `plot` (docs/plots.md), its"
            " plot.py, or all files of its run are drawn"
        ),
    )
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        metavar="FOLDER",
        help="output folder of the run, if a case is given (default: the folder that the case names)",
    )
    parser.add_argument(
        "--only", nargs="+", default=[], metavar="WORD", help="only columns whose name contains one of these words"
    )
    parser.add_argument("--from", dest="low", type=float, metavar="T", help="starts the plot at this time [s]")
    parser.add_argument("--to", dest="high", type=float, metavar="T", help="ends the plot at this time [s]")
    parser.add_argument(
        "--at",
        type=float,
        metavar="T",
        help="draws lines and planes of the output nearest to this time [s] (default: the last)",
    )
    parser.add_argument("--log", action="store_true", help="uses a logarithmic scale, which residuals always have")
    parser.add_argument(
        "--field",
        metavar="NAME",
        help=(
            "draws this field of the run in FOLDER or FOLDER/PARTICIPANT: cells in two dimensions, outer faces in three"
        ),
    )
    parser.add_argument(
        "--plane",
        metavar="'y = 0'",
        help="cuts the fields of a 3-D run by this plane [m] (default of a flow: the middle)",
    )
    parser.add_argument(
        "--surface",
        metavar="PATCH",
        help="draws --field on this patch (output.surfaces of the case), in two dimensions over the arc length",
    )
    parser.add_argument("--mode", type=int, metavar="N", help="draws this mode from modes.h5 in FOLDER")
    parser.add_argument(
        "--component", choices=("x", "y", "z"), help="draws a component of --field instead of its magnitude"
    )
    parser.add_argument(
        "--warp",
        type=float,
        metavar="F",
        help=(
            "draws bodies displaced by F times their displacement (default: 1 with --field, otherwise a factor that"
            " makes the motion visible)"
        ),
    )
    parser.add_argument(
        "--film",
        action="store_true",
        help=(
            "draws the maps of a case's section plot at each output between --from and --to: film/frame-*.png, and"
            " film.mp4 if ffmpeg is installed"
        ),
    )
    parser.add_argument(
        "--allow-commands",
        action="store_true",
        help="runs the plot.py and the Python functions with which a case draws its picture, with your permissions",
    )
    parser.add_argument(
        "--picture",
        type=pathlib.Path,
        metavar="FILE.png",
        help="name of the picture, for a single file (default: FILE.png next to FILE.csv)",
    )


def run(options):
    matplotlib.rcParams["text.parse_math"] = False  # names are no formulas
    expect(options.field or not options.surface, "--surface: name the field that is drawn on it with --field NAME")
    if options.field or options.mode is not None:
        from couplet import fields

        folder = options.out or run_folder(options.files[0])
        warp = 1.0 if options.warp is None else options.warp
        look = (options.picture, options.at, options.component, warp)
        expect(not options.plane or not options.surface, "--plane: it cuts the whole mesh, so remove --surface")
        expect(len(options.files) == 1, "--field, --mode: give one folder of a run")
        expect(folder.is_dir(), f"{folder}: there is no such folder; has the case been run?")
        print(
            fields.draw_mode(folder, options.mode, options.picture)
            if options.mode is not None
            else (
                fields.draw_surface(folder, options.field, options.surface, *look)
                if options.surface
                else fields.draw(folder, options.field, *look, plane=options.plane)
            )
        )
        return 0
    if options.files[0].suffix in (".yaml", ".yml") or (options.files[0] / "case.yaml").is_file():
        expect(len(options.files) == 1, "one case at a time")
        code = of_case(*options.files, options)
        if code is not None:
            return code
    else:
        expect(
            options.out is None and not options.film,
            "--out, --film: belong to CASE.yaml; for a run, give only its folder",
        )
    monitors, folders = [], [name for name in options.files if name.is_dir()]
    for name in options.files:
        monitors += [(name, f) for f in monitors_of(name)] if name.is_dir() else [(name.parent, name)]
    single = [file for folder, file in monitors if folder in folders and has_one_instant(file)]
    monitors = [pair for pair in monitors if pair[1] not in single]
    expect(not options.picture or not folders and len(monitors) == 1, "--picture names one picture: give one file.")
    tasks = [functools.partial(draw, folder, file, options) for folder, file in monitors]
    if not options.only:
        from couplet.plots import usual

        tasks += [task for folder in folders for task in usual.tasks(folder, options)]
    expect(tasks or single, "There is no monitor (.csv) and no field (.h5) in these folders. Run the case first.")
    failed = 0
    for task in tasks:
        try:
            task()
        except Wrong as problem:
            print(problem, file=sys.stderr)
            failed += 1
    if single:
        names = ", ".join(file.name for file in single)
        print(f"no chart of a single instant: {names} (numbers: couplet report)")
    return 1 if tasks and failed == len(tasks) or (failed and not folders) else 0
