# SPDX-License-Identifier: Apache-2.0
"""The command couplet on a small coupled case. Usage: run.py BIN PART [MPIRUN ...]; parts: by_hand, any_launcher, side_by_side, stop, wrong, kill, tell, reported, gallery, python"""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import h5py

from scene import ROOT, call, call_here, case_in, environment, start
from checks import COUPLED, check, end, mpmd  # noqa: E402  (scene knows where it is)
from couplet.runs import Case, Job  # noqa: E402
from couplet.runs.folder import driver  # noqa: E402

bin_, what = pathlib.Path(sys.argv[1]), sys.argv[2]


def left_behind(folder):
    """Processes that name the folder on their command line."""
    found = []
    for file in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = file.read_bytes().decode(errors="replace")
        except OSError:
            continue
        if str(folder) in words and words.startswith(("mpirun", "prterun", str(bin_))):
            found.append(words.replace("\0", " ")[:80])
    return found


def ask(bin_, command, *words):
    """A command whose answer counts; a run in a process of its own."""
    return (call if command == "run" else call_here)(bin_, command, *words)


def until(condition, seconds=60):
    limit = time.monotonic() + seconds
    while not condition() and time.monotonic() < limit:
        time.sleep(0.02)
    return condition()


def any_launcher(folder):
    """couplet-exec becomes the program of its rank, as each launcher tells it, and says how many processes a case needs."""
    case, programs = case_in(folder / "a", bin_), folder / "said/bin"
    programs.mkdir(parents=True)
    for name in COUPLED:
        (programs / name).write_text('#!/bin/sh\necho "$(basename $0) $COUPLET_PART $*"\n')
        (programs / name).chmod(0o755)
    run = [ROOT / "scripts/couplet-exec", case, "-n", "fluid=2", "--set", "a.b=1", "--bin", programs]
    wanted = [f"coupler 0 {case} --set a.b=1", *2 * [f"fluid_solver 1 {case} --participant fluid --set a.b=1"],
              f"solid_solver 2 {case} --participant solid --set a.b=1", f"mesh_mover 3 {case} --participant mover --set a.b=1"]
    for launcher in (("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"), ("PMI_RANK", "PMI_SIZE"), ("SLURM_PROCID", "SLURM_NTASKS"), ("PMIX_RANK",)):
        told = [subprocess.run(run, capture_output=True, text=True, env={**environment(bin_), **dict(zip(launcher, (str(rank), "5")))}).stdout.strip() for rank in range(5)]
        check(f"the programs by {launcher[0]}", told == wanted, told)
    few = subprocess.run(["mpirun", "--oversubscribe", "-n", "3", *map(str, run)], capture_output=True, text=True, env=environment(bin_))
    check("too few processes: one message with the right number", few.returncode == 2 and few.stderr.count("needs 5 processes (coupler 1, fluid 2, solid 1, mover 1), but 3 were started") == 1 and "mpirun -n 5 couplet-exec" in few.stderr, few.stderr)
    none = subprocess.run(run, capture_output=True, text=True, env=environment(bin_))
    check("no launcher", none.returncode == 2 and "needs 5 processes" in none.stderr and "but 1 was started" in none.stderr, none.stderr)
    missing = subprocess.run(["mpirun", "--oversubscribe", "-n", "5", *map(str, run), "--with", "solid=./no-such-program body"], capture_output=True, text=True, env=environment(bin_))
    check("a command that is not there is named once", missing.returncode == 2 and missing.stderr.count("couplet-exec: ./no-such-program: No such file or directory") == 1, missing.stderr)
    alone = subprocess.run(["mpirun", "--oversubscribe", "-n", "2", ROOT / "scripts/couplet-exec", case, "--participant", "solid", "--bin", programs], capture_output=True, text=True, env=environment(bin_))
    check("one participant takes all processes", alone.stdout.splitlines() == 2 * [f"solid_solver 0 {case} --participant solid"], alone.stdout + alone.stderr)


def by_hand(folder):
    """What couplet run leaves is bit for bit what the line that it prints leaves, typed by hand."""
    case = case_in(folder / "a", bin_)
    printed = call(bin_, "run", case, "--print")
    check("--print shows the launch line alone", printed.returncode == 0 and printed.stdout.startswith("mpirun ") and not (folder / "a/out").exists(), printed.stderr)
    ran = call(bin_, "run", case)
    lines = ran.stdout.strip().splitlines()
    check("a run ends with one line", ran.returncode == 0 and re.fullmatch(r"done in [\d.]+ s: results in \S+out", lines[-3]) and lines[-2].startswith("picture: couplet plot ") and lines[-1].startswith("more: couplet report "), lines[-3:])
    check("what the programs say is passed on", any("t=0.03/0.03 s" in line for line in lines))
    shutil.copytree(folder / "a/out", folder / "by-couplet")
    shutil.rmtree(folder / "a/out")
    hand = subprocess.run(printed.stdout, shell=True, capture_output=True, text=True, cwd=folder, env={
        **environment(bin_), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
    check("the printed line runs", hand.returncode == 0, hand.stderr)
    same = call_here(bin_, "compare", folder / "by-couplet", folder / "a/out")
    count = re.match(r"(\d+) columns and fields: equal bit for bit", same.stdout)
    check("both leave the same, bit for bit", same.returncode == 0 and count and int(count[1]) > 50, same.stdout)
    shutil.rmtree(folder / "a/out")
    short = subprocess.run(mpmd([[bin_ / program, case] for program in COUPLED]), capture_output=True, text=True, env=environment(bin_))
    same = call_here(bin_, "compare", folder / "by-couplet", folder / "a/out")
    check("and so does a line that names the programs", short.returncode == 0 and same.returncode == 0, short.stderr + same.stdout)
    for run, rounded in (("by-couplet", "1e-12"), ("a/out", "-2e-12")):
        (folder / run / "solid/round-off.csv").write_text(f"time [s],x [N],y [N]\n1,1000,{rounded}\n")
    same = call_here(bin_, "compare", folder / "by-couplet", folder / "a/out", "--tolerance", "1e-9")
    check("a column of round-off is compared with the others of its table, and differences within the tolerance are not listed", same.returncode == 0 and "1 differ, 0 by more than 1e-09" in same.stdout and "round-off" not in same.stdout, same.stdout)
    for run in ("by-couplet", "a/out"):
        (folder / run / "solid/round-off.csv").unlink()
    for run, value in (("by-couplet", ""), ("a/out", "8")):
        (folder / run / "solid/gaps.csv").write_text(f"time [s],x [N]\n1,{value}\n2,10\n3,{10 + len(value)}\n")
    same = call_here(bin_, "compare", folder / "by-couplet", folder / "a", "--tolerance", "0.5")
    check("compare has one line for each table first, with the largest difference and its place; gaps differ and are not infinite", same.returncode == 1
          and same.stdout.startswith("solid/gaps.csv: 1 of 2 columns differ, by at most 0.091 of the largest value (x [N] at t = 3 s)\n  solid/gaps.csv: x [N]: the values differ by at most 1,")
          and "a gap in only one run: 1 of 3 values" in same.stdout and "inf" not in same.stdout, same.stdout)
    for run in ("by-couplet", "a/out"):
        (folder / run / "solid/gaps.csv").unlink()
    for tolerance in ("nan", "inf", "-1"):
        refused = call_here(bin_, "compare", folder / "by-couplet", folder / "a/out", f"--tolerance={tolerance}")
        check(f"compare refuses the tolerance {tolerance}", refused.returncode == 2 and "at least 0" in refused.stderr, refused.stderr)
    for run in ("empty-1", "empty-2"):
        shutil.copytree(folder / "a/out", folder / run, ignore=shutil.ignore_patterns("*.csv", "*.h5"))
    nothing = call_here(bin_, "compare", folder / "empty-1", folder / "empty-2")
    check("compare refuses runs without results", nothing.returncode not in (0, 1) or "did the runs fail" in nothing.stderr, nothing.stdout + nothing.stderr)
    longer = call(bin_, "run", case, "--set", "participants.solid.material.youngs-modulus=3.9e6", "--set", f"simulation.output.folder={folder / 'other'}", "-q")
    other = call_here(bin_, "compare", folder / "a/out", folder / "other")
    check("compare tells what another setting changes", longer.returncode == 0 and other.returncode == 1 and "  solid/probes.csv: tip" in other.stdout, other.stdout[-300:])
    check("in one line for each field, whatever its outputs", len(re.findall(r"^  fluid/fluid.h5: cells/velocity: the values differ by at most .* outputs differ\)$", other.stdout, re.M)) == 1, other.stdout[-300:])
    for words in (("report",), ("watch", "--once"), ("plot", "--field", "velocity"), ("export", "--to", "vtk", "--participant", "solid", "--folder", folder / "vtk")):
        of_case = call_here(bin_, words[0], folder / "a", *words[1:])
        check(f"{words[0]} takes the case of a run for its output folder", of_case.returncode == 0 and of_case.stdout, of_case.stdout + of_case.stderr)
    check("export --to vtk honors --folder and --participant", [f.name for f in (folder / "vtk").iterdir()] == ["solid"] and (folder / "vtk/solid/solid.pvd").is_file() and not (folder / "a/out/solid/vtk").exists())
    for option in ("--strict", "--slurm", "--strict=effects"):
        before = call_here(bin_, "run", option, case, "--print")
        check(f"{option} leaves the case behind it alone", before.returncode == 0 and str(case) in before.stdout and option.replace("--slurm", "#SBATCH") in before.stdout, before.stdout + before.stderr)
    two = call(bin_, "run", case, "-n", "fluid=2", "--print").stdout
    check("-n gives ranks", two.startswith("mpirun --oversubscribe -n 5 ") and two.endswith(" -n fluid=2\n"), two)
    for name, seconds in (("fluid", 3), ("solid", 1), ("mover", 0.5)):
        report = folder / f"a/out/{name}/run.json"
        report.write_text(re.sub(r'"processor-working": [\d.e-]+', f'"processor-working": {seconds}', report.read_text()))
    shared = call(bin_, "run", case, "-n", "6", "--print")
    check("-n 6 is divided by the work measured", " -n 6 " in shared.stdout and shared.stdout.endswith(" -n fluid=3,solid=1,mover=1\n"), shared.stdout + shared.stderr)
    for text in ("{", "[]"):
        report.write_text(text)
        told = call_here(bin_, "report", folder / "a/out")
        check("a damaged run.json is named", told.returncode == 2 and f"{report}: this is not the report of a run" in told.stderr and "Traceback" not in told.stderr, told.stderr)
    shutil.rmtree(folder / "a/out")
    foreseen = call(bin_, "run", case, "-n", "5", "--print")
    check("or by the work expected", " -n 5 " in foreseen.stdout and foreseen.stdout.endswith(" -n fluid=2,solid=1,mover=1\n"), foreseen.stdout + foreseen.stderr)
    batch = call(bin_, "run", case, "-n", "fluid=2", "--slurm=--time=5", "--print").stdout
    check("--slurm makes a script", batch.startswith("#!/bin/bash\n#SBATCH") and "--ntasks=5" in batch and "#SBATCH --time=5" in batch, batch)


def side_by_side(folder):
    """Two jobs at once: none is bound to the cores of the other, and both leave the same."""
    case = case_in(folder / "a", bin_, end_time=0.1)
    jobs = [start(bin_, "run", case, "--participant", "fluid", "-n", "fluid=2", "--set", f"simulation.output.folder={folder / name}") for name in "bc"]
    check("both step", until(lambda: all((folder / name / "fluid/steps.csv").exists() for name in "bc")))
    own = pathlib.Path("/proc/self/status").read_text().partition("Cpus_allowed_list:")[2].split()[0]
    lists = []
    for file in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if file.read_bytes().startswith(f"{bin_ / 'fluid_solver'}\0{case}".encode()):
                lists.append((file.parent / "status").read_text().partition("Cpus_allowed_list:")[2].split()[0])
        except OSError:
            continue
    check("every rank may run on every core", len(lists) == 4 and set(lists) == {own}, (lists, own))
    codes = [job.communicate() and job.returncode for job in jobs]
    same = call_here(bin_, "compare", folder / "b", folder / "c")
    check("both end well, with the same results", codes == [0, 0] and same.returncode == 0, same.stdout)
    alone = call(bin_, "run", case, "--participant", "fluid", "--set", f"simulation.output.folder={folder / 'one'}")
    # Iterations and what round-off leaves differ between numbers of ranks; fields do not.
    fields = re.findall(r"^  fluid/fluid\.h5: \w.*: .* ([\d.e+-]+) of the largest", call_here(bin_, "compare", folder / "b", folder / "one").stdout, re.M)
    check("compare knows cells and points by their numbers: one rank is the same as two", alone.returncode == 0 and fields and all(float(v) < 1e-6 for v in fields), fields)


def stop(folder):
    """A run that is stopped goes on to what the undisturbed one leaves."""
    case = case_in(folder / "a", bin_, end_time=3, checkpoints=0.1)
    whole = call(bin_, "run", case, "--set", f"simulation.output.folder={folder / 'whole'}", "-q")
    check("undisturbed", whole.returncode == 0, whole.stderr)
    for how in ("couplet stop", "SIGINT", "SIGTERM"):
        shutil.rmtree(folder / "a/out", ignore_errors=True)
        job = start(bin_, "run", case)
        check(f"{how}: it steps", until(lambda: (folder / "a/out/solid/steps.csv").exists() and len((folder / "a/out/solid/steps.csv").read_text().splitlines()) > 3))
        if how == "couplet stop":
            second = call(bin_, "run", case)
            check("a second job in the same folder is refused", second.returncode == 2 and "in use by another job" in second.stderr, second.stderr)
            watched = call_here(bin_, "watch", folder / "a/out", "--once")
            check("watch shows the time", re.search(r"t=[\d.e-]+/3 s .* its", watched.stdout), watched.stdout)
            stopped = call(bin_, "stop", folder / "a/out")
            check("stop waits for the end and names the checkpoint", stopped.returncode == 0 and "saved as step-" in stopped.stdout, stopped.stdout + stopped.stderr)
        else:
            job.send_signal(getattr(signal, how))
        _, said = job.communicate(timeout=60)
        check(f"{how}: exit code 3, and how to go on", job.returncode == 3 and "continue: couplet resume" in said, f"{job.returncode} {said[-300:]}")
        check(f"{how}: nobody is left", not left_behind(folder / "a"), left_behind(folder / "a"))
    last_set = max((folder / "a/out/checkpoints").glob("step-*/set.txt"))
    saved = float(re.search(r"^time (\S+)", last_set.read_text(), re.M)[1])
    for name in ("fluid", "solid"):
        with h5py.File(folder / f"a/out/{name}/{name}.h5") as series:
            last = max(float(step.attrs["time"]) for step in series["steps"].values())
        check(f"{name}: the fields of the last step are written", abs(last - saved) <= 1e-8 * saved, (last, saved))
    for copy in ("stopped", "copied", "hostile"):
        shutil.copytree(folder / "a", folder / copy)
    check("the record has no absolute path", str(folder) not in (folder / "a/out/job.json").read_text(), (folder / "a/out/job.json").read_text())
    refused = call(bin_, "resume", folder / "a/out", "--set", "participants.solid.material.density=2000 kg/m^3")
    check("a resume with another density is refused, and leaves no trace", refused.returncode not in (0, 3) and "density" in refused.stderr, f"{refused.returncode} {refused.stderr[-300:]}")
    resumed = call(bin_, "resume", folder / "a/out")
    check("resume goes on to the end", resumed.returncode == 0 and "done in" in resumed.stdout, resumed.stdout[-200:] + resumed.stderr)
    same = call_here(bin_, "compare", folder / "whole", folder / "a/out")
    check("to what the undisturbed run leaves, bit for bit", same.returncode == 0 and "equal bit for bit" in same.stdout, same.stdout)
    before = {file: (file.stat().st_mtime_ns, file.read_bytes()) for file in (folder / "a/out").rglob("*") if file.is_file()}
    for words in ((folder / "a/out",), (folder / "a", "-q"), (folder / "a/out", "--set", "simulation.end-time=900 ms")):
        again = call(bin_, "resume", *words)
        check(f"a finished run is not resumed {words[1:]}", again.returncode == 0 and "this run is finished (t = 3 s); to continue it: couplet resume " in again.stdout
              and "--set simulation.end-time='4.5 s'" in again.stdout, again.stdout + again.stderr)
    check("nor changed", before == {file: (file.stat().st_mtime_ns, file.read_bytes()) for file in (folder / "a/out").rglob("*") if file.is_file()})
    shutil.copytree(folder / "a", folder / "longer")
    longer = call(bin_, "resume", folder / "longer", "-q", "--set", "simulation.end-time=3.05")
    check("with a later end time it is, quietly", longer.returncode == 0 and "] t=" not in longer.stdout and abs(json.loads((folder / "longer/out/coupler/run.json").read_text())["time"] - 3.05) < 1e-9, longer.stdout + longer.stderr)
    others = call(bin_, "resume", folder / "stopped/out", "-n", "fluid=2,solid=2")
    check("resume goes on on other ranks", others.returncode == 0 and "done in" in others.stdout, others.stdout[-200:] + others.stderr)
    one, other = ([float(word) for word in (run / "solid/probes.csv").read_text().splitlines()[-1].split(",")] for run in (folder / "whole", folder / "stopped/out"))
    check("to what the undisturbed run leaves, within the solvers' tolerance", len(one) == len(other) and max(abs(a - b) for a, b in zip(one, other)) <= 1e-5 * max(map(abs, one)), (one, other))
    newest = max((folder / "a/out/checkpoints").glob("step-*"))
    content = (newest / "solid.h5").read_bytes()
    os.truncate(newest / "solid.h5", 100)
    earlier = call(bin_, "resume", folder / "a/out", "--print")
    check("a damaged checkpoint is named and left out", f"{newest} is damaged and is left out" in earlier.stderr and newest.name not in earlier.stdout, earlier.stdout + earlier.stderr)
    (newest / "solid.h5").write_bytes(content)
    shutil.copytree(folder / "whole", folder / "truncated")
    os.truncate(folder / "truncated/solid/solid.h5", 1000)
    same = call_here(bin_, "compare", folder / "whole", folder / "truncated")
    check("compare names a truncated file", same.returncode == 2 and "truncated/solid/solid.h5: cannot be read" in same.stderr, same.stderr)
    edited = folder / "copied/case.yaml"
    edited.write_text(edited.read_text().replace("density: ", "density: 2", 1))
    of_copy = call(bin_, "resume", folder / "copied/out")
    check("a copy is resumed with its own case", of_copy.returncode not in (0, 3) and "density: was" in of_copy.stderr, of_copy.stderr[-300:])
    shutil.move(folder / "copied/out", folder / "out")
    alone = call(bin_, "resume", folder / "out")
    check("results without their case are not resumed", alone.returncode == 2 and f"its case is not at {folder / 'case.yaml'}" in alone.stderr, alone.stderr)
    touch = f"touch {folder / 'EXECUTED'}"
    hostile = folder / "hostile/case.yaml"
    hostile.write_text(hostile.read_text().replace("program: solid_solver", "program: own"))
    (folder / "hostile/own.py").write_text(f"import os\nos.system('{touch}')\n")
    foreign = call(bin_, "resume", folder / "hostile/out")
    check("resume starts no program of a folder from elsewhere", foreign.returncode == 2 and "give its command again: --with solid=" in foreign.stderr, foreign.stderr)
    record = json.loads((folder / "stopped/out/job.json").read_text())
    (folder / "stopped/out/job.json").write_text(json.dumps({**record, "bin": str(folder), "with": {"fluid": ["sh", "-c", touch]}}))
    foreign = call(bin_, "resume", folder / "stopped/out", "--set", "simulation.end-time=4 s")
    check("nor one that its record names", foreign.returncode == 2 and "--with fluid=" in foreign.stderr, foreign.stderr)
    for program in ("/bin/sh", "../../bin/sh", "sh"):
        hostile.write_text(f'note: "$({touch})"\nsimulation: {{end-time: 1 s, time-step: 1 s}}\nparticipants: {{solid: {{program: {program}}}}}\n')
        for command in ("check", "explain", "watch", "plot", "stop"):
            call_here(bin_, command, hostile)
    check("nothing that a case names was started", not (folder / "EXECUTED").exists())
    again = start(bin_, "run", case, "--set", "simulation.checkpoint.interval=0", "--set", "participants.solid.material.density=2000 kg/m^3")
    check("another run in the same folder steps", until(lambda: "2000 kg" in (folder / "a/out/job.json").read_text() and "density: 2000" in (folder / "a/out/solid/effective.yaml").read_text()))
    os.kill(driver(folder / "a/out"), signal.SIGKILL)
    _, said = again.communicate(timeout=60)
    check("its coupler is killed: named, and nothing to resume", again.returncode not in (0, 3) and "'coupler'" in said and "couplet resume" not in said, f"{again.returncode} {said[-300:]}")
    check("checkpoints of an earlier run stay", list((folder / "a/out/checkpoints").glob("step-*/set.txt")))
    other = call(bin_, "resume", folder / "a/out")
    check("but are no state of this one", other.returncode == 2 and "no complete checkpoint to continue from" in other.stderr, other.stdout[-300:] + other.stderr)
    nobody = call(bin_, "stop", folder / "a/out")
    check("without a running job, stop says so", nobody.returncode == 2 and "no running job found" in nobody.stderr, nobody.stderr)
    (folder / "empty").mkdir()
    lost = call(bin_, "resume", folder / "empty")
    check("resume names what is missing", lost.returncode == 2 and "was not started by couplet run" in lost.stderr, lost.stderr)


def wrong(folder):
    """A bad case ends with exit code 2 and what to do, and leaves nothing."""
    case = case_in(folder / "a", bin_)
    for change in ("participants.solid.program=plate_modal", "participants.solid={program: plate_modal}"):
        parts = Job(Case(case, bin_.parent), sets=[change]).parts
        check(f"{change}: this program is started", [words[0] for _, words in parts] == [str(bin_ / name) for name in ("coupler", "fluid_solver", "plate_modal", "mesh_mover")], parts)
    for change, said in (("participants.solid.material.density=heavy", "'heavy' is not a number"), ("participants.fluid.densty=1", "densty")):
        for command in ("run", "check"):
            result = ask(bin_, command, case, "--set", change)
            check(f"{command}: {change}", result.returncode == 2 and said in result.stderr and "Traceback" not in result.stderr, result.stderr)
            if command == "run":
                check("  says what to do, without the launcher's pages", f"couplet check {case} --set {change}" in result.stderr and "mpirun detected" not in result.stderr, result.stderr)
    text = case.read_text()
    for edited, said in ((text.replace("participants:", "participants: ["), "case.yaml:12:12: "), ("simulation: {}\n", "there are no 'participants'"),
                         (text.replace("program: solid_solver", "program: solid_solvr"), "the program 'solid_solvr' of 'solid'"), ("- a\n- b\n", "expected a mapping")):
        case.write_text(edited)
        result = call(bin_, "run", case)
        check(said, result.returncode == 2 and said in result.stderr and "Traceback" not in result.stderr, result.stderr)
    case.write_text(text)
    for words, said in ((("run", folder / "none.yaml"), "does not exist"), (("run", case, "-n", "fluid=0"), "whole numbers"), (("run", case, "-n", "air=1"), "there is no participant 'air'"),
                        (("run", case, "-n", "3"), "at least 4 ranks"), (("run", case, "-n", "fluid=100000"), "would make almost no progress"), (("run", case, "--print", "-n", "1" + 20 * "0"), "at most 1000000"),
                        (("run", case, "-n", "fluid=2,fluid=3"), "a participant is named twice"), (("run", case, "-n", "1e3"), "one whole number"), (("run", case, "--set", "a"), "a.b=value"), (("rnu", case), "did you mean 'run'"), (("run", case, "--fast"), "--fast"),
                        (("new", folder / "a"), "exists and is not empty"), (("new", folder / "b", "--from", "perpendicular-flop"), "near: perpendicular-flap"),
                        (("new", folder / "b", "--from", "flap"), "near: perpendicular-flap")):
        result = ask(bin_, *words)
        check(" ".join(map(str, words[2:] or words)), result.returncode == 2 and said in result.stderr and "Traceback" not in result.stderr, result.stderr)
    for name, content, said in (("binary", b"\x85\xff" * 99, "binary.yaml:1:1: the byte 0x85 is not text in UTF-8"), ("three", b"{simulation: 3, participants: {a: {program: fluid_solver}}}", "simulation"), ("nobody", b"{participants: {a: }}", "participants.a: expected a mapping")):
        (folder / f"{name}.yaml").write_bytes(content)
        for command in ("run", "check", *(("explain",) if name != "three" else ())):
            result = ask(bin_, command, folder / f"{name}.yaml")
            check(f"{command} {name}.yaml", result.returncode == 2 and said in result.stderr and "Traceback" not in result.stderr, result.stderr)
    for participants, said in (("{a: {program: calculix}}", "there is no program 'calculix'; Couplet has"), ("{a: {program: fluid_solver}, b: {program: solid_solver}}", "2 participants, but no section 'coupling'")):
        (folder / "whole.yaml").write_text(f"participants: {participants}\n")
        result = call(bin_, "check", folder / "whole.yaml")
        check(f"check: {said}", result.returncode == 2 and said in result.stderr, result.stdout + result.stderr)
    result = call(bin_, "run", case, "--restart", folder / "none")
    check("what no check of the case finds", result.returncode == 2 and "no complete checkpoint" in result.stderr and "couplet check" not in result.stderr, result.stderr)
    picture = folder / "no folder/x.png"  # written nowhere: by who may not write there, too
    (folder / "m.csv").write_text("time [s],a\n0,1\n1,2\n")
    result = ask(bin_, "plot", folder / "m.csv", "--picture", picture)
    check("a picture that cannot be written", result.returncode == 1 and f"{picture}: No such file" in result.stderr and "Traceback" not in result.stderr, result.stderr)
    result = ask(bin_, "new", folder / "m.csv/mine")
    check("a folder that cannot be made", result.returncode in (1, 2) and "m.csv" in result.stderr and "Traceback" not in result.stderr, result.stderr)
    (folder / "h.csv").write_bytes(b"\x89HDF\xff")
    result = ask(bin_, "plot", folder / "h.csv")
    check("a file that is no text", result.returncode == 1 and "is not a text file" in result.stderr and "Traceback" not in result.stderr, result.stderr)
    (folder / "m.yaml").write_text("simulation: {output: {folder: .}}\nparticipants: {a: {program: b}}\nplot: {panels: [{curves: [{monitor: m.csv, y: 'tip x [m]'}]}]}\n")
    result = ask(bin_, "plot", folder / "m.yaml")
    check("a column that is not there", result.returncode == 2 and "y: 'tip x [m]' is neither a name nor an expression" in result.stderr and "has: time [s], a." in result.stderr, result.stderr)
    for end, said in (("import nothere", "'solid' ended with exit code 1: ModuleNotFoundError: No module named 'nothere'"), ("raise SystemExit(3)", "'solid' ended with exit code 3"), ("raise SystemExit(4)", "'solid' ended with exit code 4"),
                      ("import couplet\ncouplet.Client('solid', 'own')\n1 / 0", "participant 'solid' ended before the job was over: ZeroDivisionError: division by zero")):
        (folder / "own.py").write_text(end + "\n")
        result = call(bin_, "run", case, "--with", f"solid={sys.executable} {folder / 'own.py'}", "--set", "participants.solid={program: own}")
        check(f"a participant of the user fails ({end[-20:]!r}): it is named with its error", result.returncode == 1 and re.search(r"^failed after [\d.]+ s, exit code 1: (.*)$", result.stderr, re.M)[1] == said, f"{result.returncode} {result.stderr}")
    failing = call(bin_, "run", case, "--strict=effects", "--set", "simulation.time-step=0.03", "--set", "coupling.convergence.max-iterations=1")
    check("a run that fails passes its exit code on", failing.returncode == 1 and "failed after" in failing.stderr, f"{failing.returncode} {failing.stderr}")


def kill(folder):
    """However the launcher ends, no process is left."""
    case = case_in(folder / "a", bin_, end_time=100, checkpoints=10)
    for how, times in (("SIGKILL", 1), ("SIGTERM", 3), ("SIGHUP", 1)):
        shutil.rmtree(folder / "a/out", ignore_errors=True)
        job = start(bin_, "run", case)
        check(f"{how}: it steps", until(lambda: (folder / "a/out/solid/steps.csv").exists()) and len(left_behind(folder / "a")) >= 5, left_behind(folder / "a"))
        for _ in range(times):
            job.send_signal(getattr(signal, how))
            time.sleep(0.05)
        job.communicate(timeout=60)
        check(f"{how}: nobody is left", until(lambda: not left_behind(folder / "a"), 20), left_behind(folder / "a"))
    deaf = folder / "a/deaf/mpirun"
    deaf.parent.mkdir()
    deaf.write_text("#!/bin/sh\ntrap '' TERM\necho listens to nobody\nwhile true; do sleep 1; done\n")
    deaf.chmod(0o755)
    job = start(bin_, "run", case, env={**environment(bin_), "PATH": f"{deaf.parent}:{os.environ['PATH']}"})
    check("mpirun does not listen", "nobody" in job.stdout.readline())
    job.terminate()
    job.communicate(timeout=30)
    check("a job that ignores SIGTERM is killed", job.returncode not in (0, 3) and until(lambda: not left_behind(folder / "a"), 5), job.returncode)
    shutil.rmtree(folder / "a/out", ignore_errors=True)
    job = start(bin_, "run", case)
    until(lambda: (folder / "a/out/solid/steps.csv").exists())
    solver = next(p.parent.name for p in pathlib.Path("/proc").glob("[0-9]*/cmdline") if p.read_bytes().startswith(str(bin_ / "solid_solver").encode()) and str(folder).encode() in p.read_bytes())
    subprocess.run(["kill", "-KILL", solver])
    _, said = job.communicate(timeout=60)
    check("a program that is killed ends the run, and is named", job.returncode not in (0, 2, 3) and "failed after" in said and "solid" in said, f"{job.returncode} {said[-400:]}")
    check("nobody is left", until(lambda: not left_behind(folder / "a"), 20), left_behind(folder / "a"))


def tell(folder):
    """What couplet tells without running, and of what is there."""
    told = call(bin_)
    check("couplet lists its commands", told.returncode == 0 and all(f"  {word} " in told.stdout for word in ("run", "resume", "watch", "doctor")), told.stdout)
    for word in re.findall(r"^  (\w+) ", told.stdout, flags=re.M):
        told = call_here(bin_, word, "--help")
        check(f"{word} --help", told.returncode == 0 and "usage: couplet " + word in told.stdout, told.stderr)
    case = case_in(folder / "a", bin_)
    valid = call(bin_, "check", case)
    check("check", valid.returncode == 0 and "keys and files are valid; patches, probes" in valid.stdout, valid.stdout + valid.stderr)
    explained = call_here(bin_, "explain", case)
    check("explain", explained.returncode == 0 and explained.stdout.count(" as '") == 4 and "launch line:     mpirun" in explained.stdout and "  off" not in explained.stdout, explained.stdout)
    check("explain --all", "  off" in call_here(bin_, "explain", case, "--all").stdout)
    gallery = call_here(bin_, "gallery", "tank")
    check("gallery", gallery.returncode == 0 and "thermocline-andasol" in gallery.stdout and "perpendicular-flap" not in gallery.stdout, gallery.stdout)
    doctor = call(bin_, "doctor")
    check("doctor", doctor.returncode == 0 and "ok  self-test" in doctor.stdout and "Open MPI" in doctor.stdout, doctor.stdout + doctor.stderr)
    (folder / "bin").mkdir()
    ill = call(folder / "bin", "doctor", "--quick")
    check("doctor names programs that are missing", ill.returncode == 1 and "NO  fluid_solver" in ill.stdout, ill.stdout)
    guest = call(bin_, "new", folder / "warm", "--from", "warm-flap", "--end-time", "0.02 s")
    ran = call(bin_, "run", folder / "warm", "-q")
    check("a new case runs at once, also with a program of somebody else", guest.returncode == 0 and ran.returncode == 0 and "done in" in ran.stdout,
          guest.stderr + ran.stderr)
    alone = call(bin_, "run", case, "--participant", "fluid", "--set", "simulation.end-time=0.01", "-q")
    check("one participant alone", alone.returncode == 0 and not (folder / "a/out/solid").exists(), alone.stderr)
    soft = call(bin_, "run", case, "--set", "simulation.end-time=0.05", "--set", "participants.solid.material.youngs-modulus=1 kPa", "--set", f"simulation.output.folder={folder / 'soft'}")
    verdicts = [re.findall(r"^Verdict: .*\n  .*", text, flags=re.M) for text in (soft.stdout, call_here(bin_, "report", folder / "soft").stdout)]
    check("the verdict of a coupled run counts what the participants find at its end", "[solid 0] warning: " in soft.stdout and "geometric-non-linearity" in verdicts[0][0] and verdicts[0] == verdicts[1], (verdicts, soft.stdout[-2000:]))
    drawn = call_here(bin_, "plot", folder / "a/out/fluid/forces.csv")
    for name, field, more in (("fluid", "velocity", ("--component", "x")),):
        picture = folder / f"{field}.png"
        told = call_here(bin_, "plot", folder / "a/out" / name, "--field", field, "--picture", picture, *more)
        check(f"plot --field {field}", told.returncode == 0 and picture.stat().st_size > 5000, told.stderr)
    plate = call(bin_, "run", ROOT / "configs/free-plate", "-q", "--set", f"simulation.output.folder={folder / 'plate'}")
    mode = call_here(bin_, "plot", folder / "plate", "--mode", "7", "--picture", folder / "mode.png")
    check("plot --mode", plate.returncode == 0 and mode.returncode == 0 and (folder / "mode.png").stat().st_size > 5000, plate.stderr + mode.stderr)
    wrong_field = call_here(bin_, "plot", folder / "a/out/fluid", "--field", "speed")
    check("a field that is not there", wrong_field.returncode == 2 and "the fields are: pressure, velocity" in wrong_field.stderr, wrong_field.stderr)
    check("plot", drawn.returncode == 0 and (folder / "a/out/fluid/forces.png").exists(), drawn.stderr)


def reported(folder):
    """What a run ends with: its own probes first, then forces, then the rest, in numbers that can be read."""
    def value(rank, name, text):
        return {"name": name, "rank": rank, "text": text}
    for name, found in (("solid", [value(0, "tip", "0.1234  0 mm"), value(0, "equivalent stress", "253.5 MPa +- 5.1 (2 %)"), value(1, "reaction root", "5.6 kN"), value(2, "largest displacement", "0.2 mm")]),
                        ("mover", [value(2, "least scaled Jacobian", "0.5")]), ("air", [value(1, "heat wall", "25 MW")])):
        (folder / "out" / name).mkdir(parents=True)
        (folder / "out" / name / f"{name}.log").touch()
        (folder / "out" / name / "run.json").write_text(json.dumps({"time": 1, "results": found, "error": "estimated error: displacement 2 % (mesh)"}))
    told = call_here(bin_, "report", folder / "out").stdout
    wanted = ["Results of 'solid' at t = 1 s", "tip 0.1234 0 mm", "equivalent stress 253.5 MPa +- 5.1 (2 %)", "reaction root 5.6 kN", "largest displacement 0.2 mm",
              "Results of 'air' at t = 1 s", "heat wall 25 MW", "Results of 'mover' at t = 1 s", "least scaled Jacobian 0.5", "Verdict: no warning; estimated error: displacement 2 % (mesh)"]
    check("report", [" ".join(line.split()) for line in told.splitlines()][:len(wanted)] == wanted, told)
    for name, total, error in (("coupler", 0.1, "0.1 % (mesh)"), ("fluid", 0.01, "velocity 1 % (mesh)"), ("solid", 0.05, "displacement 5 % (step)"), ("mover", 0.0001, "motion 0.01 % (mesh)")):
        (folder / "two" / name).mkdir(parents=True)
        (folder / "two" / name / f"{name}.log").touch()
        (folder / "two" / name / "run.json").write_text(json.dumps({"time": 1, "results": [], "error": f"estimated error: {error}", "errors": {"mesh": total}, "next": f"refine {name}"}))
    told = " ".join(call_here(bin_, "report", folder / "two").stdout.split())
    check("the verdict of a coupled run names the field of each participant", "Verdict: no warning; estimated error: displacement of 'solid' 5 % (step); velocity of 'fluid' 1 % (mesh) "
          "next for 'solid': refine solid" in told, told)
    from couplet.command.report import rows
    from couplet.runs import Results
    few = [line.split()[0] for line in rows(Results(folder / "out"), ["mover", "air", "solid"], 5)]
    check("where few lines fit, they are the most important", few == ["Results", "tip", "equivalent", "reaction", "and"], few)


def gallery(folder):
    """Every case of the gallery, copied into an empty folder, is a valid case."""
    names = [line.split()[0] for line in call(bin_, "gallery").stdout.splitlines()]
    check("all cases of configs/ are listed", sorted(names) == sorted(f.parent.name for f in ROOT.glob("configs/*/case.yaml")), names)
    for name in names:
        made = call_here(bin_, "new", folder / name, "--from", name)
        valid = call_here(bin_, "check", folder / name)
        check(name, made.returncode == 0 and valid.returncode == 0 and "keys and files are valid" in valid.stdout, made.stderr + valid.stderr)


def python(folder):
    """import couplet: starts a run and reads it."""
    import couplet
    case = case_in(folder / "a", bin_)
    run = couplet.run(case, ranks={"fluid": 2}, changes={"simulation.end-time": 0.02}, build=bin_.parent)
    tip = run.probes("solid")
    check("probes are columns", len(tip["time [s]"]) == 2 and any("tip" in head for head in tip), list(tip))
    fields = run.fields("fluid")
    check("fields are arrays", fields.field(-1, "velocity").shape == (len(fields.cells), 3) and fields.times[-1] == 0.02, fields.times)
    check("budget and findings", 0 < run.budget()["fluid"]["mesh"] < 1 and isinstance(run.findings(), list), run.budget())
    try:
        couplet.run(case, changes={"participants.solid.material.density": "x"}, build=bin_.parent)
        check("a bad case is an exception", False)
    except couplet.RunFailed as failure:
        check("a bad case is an exception", "exit code 2" in str(failure) and "'x' is not a number" in str(failure), failure)


with tempfile.TemporaryDirectory(prefix="couplet-command-") as scratch:
    {"by_hand": by_hand, "any_launcher": any_launcher, "side_by_side": side_by_side, "stop": stop, "wrong": wrong, "kill": kill, "tell": tell, "reported": reported, "gallery": gallery, "python": python}[what](pathlib.Path(scratch))
end()
