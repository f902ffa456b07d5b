# SPDX-License-Identifier: Apache-2.0
"""A small coupled case for the tests of the command, and how the command is called."""
import os
import pathlib
import subprocess
import sys
import tempfile
import traceback

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "tests/support")]
COUPLET = ROOT / "scripts/couplet"


def environment(bin_):
    """Without the binding of the tests' own environment: couplet sets it."""
    return {**{name: value for name, value in os.environ.items() if name != "OMPI_MCA_hwloc_base_binding_policy"}, "COUPLET_BIN": str(bin_)}


def case_in(folder, bin_, end_time=0.03, step=0.01, checkpoints=0.01):
    """The perpendicular flap on a coarse mesh, made by `couplet new`."""
    made = call(bin_, "new", folder, "--set", f"simulation.end-time={end_time}", "--set", f"simulation.time-step={step}",
                "--set", f"simulation.checkpoint.interval={checkpoints}", "--set", "simulation.output.interval=0.02")
    assert made.returncode == 0, made.stderr
    file = folder / "case.yaml"
    text = file.read_text()
    for mesh, numbers in (("fluid.geo", "{n_side: 20, n_tip: 2, growth: 1.3, wall_growth: 1.3}"), ("solid.geo", "{n_side: 40, n_tip: 4}")):
        text = text.replace(f"mesh: {mesh}", f"mesh: {mesh}\n    mesh-parameters: {numbers}")
    file.write_text(text)
    return file


def call(bin_, *words, **more):
    return subprocess.run([str(COUPLET), *map(str, words)], capture_output=True, text=True, env=environment(bin_), **more)


def call_here(bin_, *words):
    """As call(), in this process: to start Python takes longer than most commands. Not for runs, which handle signals."""
    from couplet.command import main
    os.environ["COUPLET_BIN"] = str(bin_)
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as complaints:
        said = []
        sys.stdout.flush()
        before = [os.dup(number) for number in (1, 2)]
        os.dup2(out.fileno(), 1)
        os.dup2(complaints.fileno(), 2)
        try:
            code = main(["couplet", *map(str, words)])
        except SystemExit as leave:
            code = leave.code or 0
        except Exception:  # as the interpreter does
            traceback.print_exc()
            code = 1
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            for number, file in zip((1, 2), before):
                os.dup2(file, number)
                os.close(file)
        for file in (out, complaints):
            file.seek(0)
            said.append(file.read())
    return subprocess.CompletedProcess(words, code, *said)


def start(bin_, *words, **more):
    return subprocess.Popen([str(COUPLET), *map(str, words)], **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": environment(bin_), **more})
