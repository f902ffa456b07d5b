# SPDX-License-Identifier: Apache-2.0
"""scripts/couplet plot draws monitors, lines, planes and residuals, and says what is wrong with a file."""
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "tests/support")]
from command import couplet  # noqa: E402


def run(*arguments):
    return couplet("plot", *arguments)


def by_its_own_name(*arguments):
    return subprocess.run([sys.executable, str(ROOT / "scripts/couplet"), "plot", *map(str, arguments)], capture_output=True, text=True)


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "forces.csv").write_text("time [s],wall x [N],wall y [N],p [Pa]\n" + "".join(f"{i / 10},{i},{i * i},3\n" for i in range(20)) + "2.0,1")
    line = "time [s],along [-],up [-],x [m],y [m],z [m],velocity x [m/s]\n"
    (folder / "sample-a.csv").write_text(line + "".join(f"{t},{s / 4},0,0,{s},0,{s * t}\n" for t in (1, 2) for s in range(5)))
    (folder / "sample-b.csv").write_text(line + "".join(f"1,{s / 4},{r / 3},{s},{r},0,{s * r}\n" for s in range(5) for r in range(4)))
    (folder / "residuals.csv").write_text("time [s],iteration [-],relative residual [-]\n0.1,1,1e-2\n0.1,2,1e-5\n0.2,1,1e-6\n")
    (folder / "static.csv").write_text("time [s],tip [m]\n1,2\n")
    (folder / "study/runs/one").mkdir(parents=True)
    (folder / "study/runs/one/forces.csv").write_text((folder / "forces.csv").read_text())
    all_of_it = by_its_own_name(folder)
    assert all_of_it.returncode == 0, all_of_it.stderr
    assert not (folder / "static.png").exists() and "static.csv" in all_of_it.stdout, "a chart of a single dot"
    assert not list((folder / "study").rglob("*.png")), "a picture in a run of a study below the folder"
    assert run(folder / "static.csv").returncode == 0 and (folder / "static.png").exists()  # asked for by its name
    from couplet.plot import per_step, read  # noqa: E402

    steps = list(per_step(read(folder / "residuals.csv")).values())
    assert [list(v) for v in steps] == [[0.1, 0.2], [1e-5, 1e-6], [2, 1]], steps
    (folder / "bed.csv").write_text("time [s],z [m],fluid [degC]\n" + "".join(f"{t},{z},{20 + t * z}\n" for t in (0, 1) for z in range(5)))
    assert run(folder / "bed.csv").returncode == 0 and (folder / "bed.png").stat().st_size > 2000
    for stem in ("forces", "sample-a", "sample-b", "residuals"):
        picture = folder / f"{stem}.png"
        assert str(picture) in all_of_it.stdout and picture.stat().st_size > 2000, (stem, all_of_it)
    one = run(folder / "forces.csv", "--only", "wall", "--from", "0.5", "--picture", folder / "mine.png")
    assert one.returncode == 0 and (folder / "mine.png").exists(), one.stderr
    for arguments, message in (
        ([folder / "none.csv"], "No such file"),
        ([folder / "forces.csv", "--only", "lift"], "no column name contains lift"),
        ([folder / "forces.csv", "--from", "9"], "no row between these times"),
        ([folder, "--picture", "x.png"], "--picture names one picture"),
    ):
        wrong = run(*arguments)
        assert wrong.returncode in (1, 2) and message in wrong.stderr, (arguments, wrong)
    (folder / "text.csv").write_text("name,value\nx,1\n")
    wrong = run(folder / "text.csv")
    assert wrong.returncode == 1 and "is not a monitor file" in wrong.stderr, wrong
    assert run(folder).returncode == 0  # one file of a folder that is none
print("ok")
