# SPDX-License-Identifier: Apache-2.0
"""A step that cannot be solved, whatever its length, ends the run: exit code not 0, the reason, no result of that step.
Usage: run.py BIN CONFIGS"""
import pathlib
import subprocess
import sys
import tempfile

programs, configs = map(pathlib.Path, sys.argv[1:3])
CASES = {  # what is set beside the case, exit code 0 wanted
    "too few iterations": ("participants.solid.solution-method={preconditioner: multigrid, max-iterations: 3, face-gradient: symmetric}", False),
    "enough of them": ("participants.solid.solution-method={preconditioner: multigrid, max-iterations: 2000, face-gradient: symmetric}", True),
}
failed = 0
for name, (setting, is_sound) in CASES.items():
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([str(programs / "solid_solver"), str(configs / "cook/case.yaml"), "--set", setting,
                              "--set", f"simulation.output.folder={folder}"], capture_output=True, text=True, timeout=60)
        probes = pathlib.Path(folder) / "solid/probes.csv"
        steps = [line for line in probes.read_text().splitlines()[1:] if line] if probes.exists() else []
        reached_end = any(line.startswith("1,") for line in steps)
        told = "did not converge" in run.stdout + run.stderr
        tries = (run.stdout + run.stderr).count("step 1 with dt")  # a shorter static step meets the same equations: one try
        text = run.stdout + run.stderr
        # What a failed run saw until then proves nothing sound, nor what its answer errs by.
        judged = (": justified" in text or ": matters" in text) and "estimated error" in text
        unjudged = ": justified" not in text and ": matters" not in text and "estimated error" not in text and "the run failed: its error and neglected effects" in text
        good = (run.returncode == 0 and reached_end and judged) if is_sound else (
            run.returncode != 0 and told and not reached_end and tries == 1 and unjudged)
        print("ok    " if good else "FAILED", name, f"(exit code {run.returncode}, told {told}, end reached {reached_end})")
        if not good:
            print(run.stdout[-1500:], run.stderr[-1500:])
        failed += not good
sys.exit(failed > 0)
