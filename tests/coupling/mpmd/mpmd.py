# SPDX-License-Identifier: Apache-2.0
"""The coupler and the toy participants as one MPMD job: ranks, restart and step halving do not change the answer."""
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end, mpmd, said  # noqa: E402

os.environ["PATH"] = os.pathsep.join(sys.argv[1:3] + [os.environ["PATH"]])

CASE = """\
simulation:
  end-time: 2 s
  time-step: 0.1 s
  output: {folder: out}
  checkpoint: {interval: 0.5 s}
participants:
  fluid: {program: toy_piston, vertices: 9, added-mass: 2 kg, driving-force: 1 N}
  solid: {program: toy_spring, vertices: 9, mass: 0.5 kg, stiffness: 3 N/m}
coupling:
  scheme: semi-implicit
  fluid: {participant: fluid}
  structure: {participant: solid}
  convergence: {relative: 1e-9, max-iterations: 100}
"""


def run(folder, ranks=(1, 1), sets=(), restart=None):
    with open(os.path.join(folder, "case.yaml"), "w", encoding="utf-8") as out:
        out.write(CASE)
    words = [*(f"--set={s}" for s in sets), *(["--restart", restart] if restart else [])]
    return said(mpmd([[program, "case.yaml", *words] for program in ("coupler", "toy_piston", "toy_spring")], (1, *ranks)), 60, cwd=folder)


def text(folder, file):
    with open(os.path.join(folder, "out", file), encoding="utf-8") as lines:
        return lines.read()


def rows(folder, file):
    return [[float(word) for word in line.split(",")] for line in text(folder, file).splitlines()[1:]]


def difference(a, b):
    if len(a) != len(b):
        return float("inf")
    return max(abs(x - y) for row_a, row_b in zip(a, b) for x, y in zip(row_a, row_b))


with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other, tempfile.TemporaryDirectory() as third:
    output = run(one)
    whole = rows(one, "fluid/motion.csv")
    check("one console line a step", sum(" its  |r|=" in line for line in output.splitlines()) == 20)
    check("balance holds: what the fluid gives the structure takes",
          max(abs(r[2] - r[5]) for r in rows(one, "coupler/balance.csv")) < 1e-12)
    check("two checkpoints are kept", len(os.listdir(os.path.join(one, "out/checkpoints"))) == 2)

    for ranks in ((2, 1), (1, 3), (3, 2)):
        run(other, ranks)
        off = difference(whole, rows(other, "fluid/motion.csv"))
        check(f"the same on {ranks[0]} and {ranks[1]} ranks", off < 1e-13, f"difference {off:.1e}")

    files = ("fluid/motion.csv", "coupler/residuals.csv", "coupler/balance.csv")
    wanted = [text(one, f) for f in files]
    run(third, sets=["simulation.end-time=1"])
    run(third, restart="out/checkpoints")
    for file, want in zip(files, wanted):
        check(f"restart from the latest checkpoint: {file} bit for bit", text(third, file) == want)
    run(third, sets=["simulation.end-time=1"])
    output = run(third, restart="out/checkpoints", sets=["simulation.end-time=3"])
    check("the last one of the latest run is taken, and that an earlier run went further is said", "step-00000010, the last one of the latest run" in output and "step-00000020 of an earlier run" in output, output[-500:])
    run(other)
    run(other, restart="out/checkpoints/step-00000015")
    for file, want in zip(files, wanted):
        check(f"restart in the middle, later rows dropped: {file} bit for bit", text(other, file) == want)

    run(other, sets=["participants.fluid.fails-above=0.06"])
    halved = rows(other, "fluid/motion.csv")
    run(other, sets=["simulation.time-step=0.05"])
    fine = rows(other, "fluid/motion.csv")
    off = difference(halved, fine)
    check("a participant that fails above a step is followed by halving", off < 1e-7, f"difference {off:.1e}")

end()
