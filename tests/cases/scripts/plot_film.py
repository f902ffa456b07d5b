# SPDX-License-Identifier: Apache-2.0
"""`couplet plot --film`: a frame of the maps for each output, one scale for all, and the animated file that ffmpeg makes of them where it is installed."""
import argparse
import os
import pathlib
import sys
import tempfile

import h5py
import numpy as np
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "tests/support")]
from checks import check, end  # noqa: E402
from command import couplet  # noqa: E402
from couplet.plots.film import frame_of  # noqa: E402
from couplet.runs.case import Case  # noqa: E402

SQUARES = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
STILL = np.array([[x, y, 0.0] for y in (0, 1) for x in (0, 1, 2)])
PANELS = [{"curves": [{"levels": [5]}]}, {"field": "stress", "factor": 1e-6, "at": "1 s", "title": "stress at 1 s", "label": "stress [MPa]"},
          {"field": "stress", "range": [0, 1], "label": "stress at 1 s"}]
FFMPEG = """#!/bin/sh
for word; do echo "$word" >> "$FILM_WORDS"; last=$word; done
echo film > "$last"
"""


def case_in(folder, panels):
    folder.mkdir(exist_ok=True)
    (folder / "case.yaml").write_text(yaml.safe_dump({"simulation": {"end-time": 1, "time-step": 1, "output": {"folder": "out"}}, "participants": {"solid": {"program": "solid_solver"}},
                                                      "plot": {"panels": panels, "columns": 3, "size": [9, 3]}}))
    return Case(folder)


def run_in(out):
    (out / "solid").mkdir(parents=True)
    with h5py.File(out / "solid/solid.h5", "w") as file:
        file.attrs["format"], file.attrs["kind"] = "couplet fields", 5
        file["mesh/cells"], file["mesh/coordinates"] = SQUARES, STILL
        for k in range(4):
            step = file.create_group(f"steps/{k:06d}")
            step.attrs["time"] = 0.5 * k
            step["coordinates"] = STILL
            step["cells/stress"] = np.array([1e6, 3e6]) * k


argparse.ArgumentParser(description=__doc__).parse_args()
with tempfile.TemporaryDirectory(prefix="a film ") as name:
    folder = pathlib.Path(name)
    case, out, tools = case_in(folder / "case", PANELS), folder / "case/out", folder / "tools"
    tools.mkdir()
    path = os.environ["PATH"]
    os.environ["PATH"] = str(tools)  # whatever is installed here
    run_in(out)

    frame = frame_of(case.data["plot"], case, out)
    check("the maps alone, as large as in the picture", len(frame["panels"]) == 2 and frame["columns"] == 2 and np.allclose(frame["size"], (6, 3)), frame["size"])
    check("one scale over the whole run", frame["panels"][0]["range"] == [0, 9], frame["panels"][0])
    check("what is given stays", frame["panels"][1]["range"] == [0, 1] and frame["panels"][0]["label"] == "stress [MPa]", frame["panels"])
    check("titles and scales name no other time", all("title" not in p for p in frame["panels"]) and "label" not in frame["panels"][1], frame["panels"])

    done = couplet("plot", case.file, "--film")
    frames = sorted(p.name for p in (out / "film").glob("*"))
    check("a frame for each output", done.returncode == 0 and frames == [f"frame-{i:04d}.png" for i in (1, 2, 3, 4)], (done, frames))
    check("frames differ", len({(out / "film" / f).read_bytes() for f in frames}) == 4)
    check("without ffmpeg there is no animated file, which is said", "film: none, ffmpeg is not installed" in done.stdout and not (out / "film.mp4").exists(), done.stdout)

    (tools / "ffmpeg").write_text(FFMPEG)
    (tools / "ffmpeg").chmod(0o755)
    os.environ.update(FILM_WORDS=str(folder / "words"), PATH=f"{tools}:{path}")
    done = couplet("plot", case.file, "--film", "--from", "0.4", "--to", "1.1")
    frames = sorted(p.name for p in (out / "film").glob("*"))
    words = (folder / "words").read_text().splitlines()
    check("--from and --to; no frame of an earlier film is left", done.returncode == 0 and frames == ["frame-0001.png", "frame-0002.png"], (done, frames))
    check("ffmpeg is given the frames", str(out / "film/frame-%04d.png") in words and words[-1].startswith(f"{out}/.") and words[-1].endswith(".mp4") and f"film: {out / 'film.mp4'}" in done.stdout, (words, done.stdout))
    (tools / "ffmpeg").write_text("#!/bin/sh\necho no encoder >&2\nexit 1\n")
    done = couplet("plot", case.file, "--film")
    check("an ffmpeg that fails", done.returncode == 2 and "ffmpeg made no film.mp4" in done.stderr and "no encoder" in done.stderr, done)
    done = couplet("plot", case.file, "--film", "--from", "9")
    check("no output between these times", done.returncode == 2 and "no output between these times" in done.stderr, done)
    done = couplet("plot", case_in(folder / "flat", PANELS[:1]).file, "--film", "--out", out)
    check("no map", done.returncode == 2 and "there is no map (a panel with `field`) to film" in done.stderr, done)
    done = couplet("plot", out, "--film")
    check("a folder alone", done.returncode == 2 and "--film: belong to CASE.yaml" in done.stderr, done)
end()
