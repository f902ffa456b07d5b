# SPDX-License-Identifier: Apache-2.0
"""Film of a run: the maps of a section `plot` at each output as PNG frames, and as an animated file if ffmpeg is
installed."""
import pathlib
import shutil
import subprocess

from couplet import fields, files
from couplet.plots.draw import across_of, draw, size_of
from couplet.plots.section import check
from couplet.plots.sources import series_in
from couplet.runs.case import expect

RATE = 10  # frames per second


def frame_of(section, case, out):
    """Section of one frame, with only its maps. A missing scale covers the whole run; titles state the time of the
    frame."""
    panels, across = section["panels"], across_of(section)
    maps = [dict(panel) for panel in panels if "field" in panel]
    for panel in maps:
        panel.setdefault("participant", next(iter(case.participants)))
        panel.pop("title", None)
        if "factor" not in panel:  # the field's own name and unit, without the time
            panel.pop("label", None)
        if "range" not in panel:
            series = series_in(out, panel["participant"])
            ends = []  # one output at a time, since a run may not fit into memory
            for i in range(len(series.times)):
                values = panel.get("factor", 1) * fields.values_of(series, i, panel["field"], panel.get("component"))
                ends += [float(values.min()), float(values.max())]
            panel["range"] = [min(ends), max(ends)]
    beside = min(across, len(maps))
    width, height = size_of(section)
    size = (width / across * beside, height / -(-len(panels) // across) * -(-len(maps) // beside))
    return {"panels": maps, "columns": beside, "size": size}


def film(case, out, low=None, high=None):
    """Draws the frames of the run in the folder `out` between two times. Returns their folder, and the animated file or
    None."""
    section, out = check(case), pathlib.Path(out)
    expect(
        any("field" in panel for panel in section["panels"]),
        f"{case.file}: plot: there is no map (a panel with `field`) to film.",
    )
    expect(out.is_dir(), f"{out}: there is no such folder; run the case first: couplet run {case.file}")
    frame = frame_of(section, case, out)
    times = [
        t
        for t in series_in(out, frame["panels"][0]["participant"]).times
        if (low is None or t >= low) and (high is None or t <= high)
    ]
    expect(times, f"{out}: '{frame['panels'][0]['participant']}' has no output between these times.")
    shutil.rmtree(files.below(out, "film"), ignore_errors=True)  # frames of an earlier film
    folder = files.folder(out, "film")
    for number, time in enumerate(times, 1):
        for panel in frame["panels"]:
            panel["at"] = float(time)
        draw(case, out, folder / f"frame-{number:04d}.png", frame)
    return folder, animate(folder, out)


def animate(folder, out):
    """Makes the animated file film.mp4 of the frames in the folder `out`. Returns None without ffmpeg."""
    program = shutil.which("ffmpeg")
    if not program:
        return None
    # The usual color format needs even numbers of pixels.
    with files.part(out, "film.mp4") as made:
        done = subprocess.run(
            [
                program,
                "-loglevel",
                "error",
                "-y",
                "-framerate",
                str(RATE),
                "-i",
                folder / "frame-%04d.png",
                "-vf",
                "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                "-pix_fmt",
                "yuv420p",
                made,
            ],
            capture_output=True,
            text=True,
        )
        expect(done.returncode == 0, f"ffmpeg made no film.mp4 of the frames in {folder}: {done.stderr.strip()[-200:]}")
    return out / "film.mp4"
