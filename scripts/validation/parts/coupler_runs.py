# SPDX-License-Identifier: Apache-2.0
"""Bars of the coupler: divergence is named; programs of other people."""
import numpy as np

import couplet_series as couplet
from validation.job import Bar
from validation.main_job import FLAP, registered


def passed(executable, pattern):
    """All tests of the pattern."""
    def measure(job):
        tests, _ = job.gtest(executable)
        chosen = {k: v for k, v in tests.items() if pattern in k}
        good = sum(v["passed"] for v in chosen.values())
        return f"{good} of {len(chosen)} tests", bool(chosen) and good == len(chosen)
    return measure


def flap(job, name, *sets, ranks=(1, 1, 1, 1)):
    end = "simulation.end-time=0.2" if job.quick else "simulation.end-time=1"
    return job.coupled(job.root / FLAP, f"coupler-{name}", [end, *sets], ranks)


def tips(folder):
    probes = couplet.read_csv(folder / "solid" / "probes.csv")
    return np.array(probes["tip x [m]"])


def refused(job, *sets):
    """Runs a flap that cannot hold; gives steps until it was refused and the words."""
    command = ["mpirun", "--oversubscribe"]
    out = job.scratch / f"coupler-refused-{abs(hash(sets))}"
    options = [f"--set={s}" for s in (f"simulation.output.folder={out}", "simulation.end-time=0.6", *sets)]
    for i, program in enumerate(("coupler", "fluid_solver", "solid_solver", "mesh_mover")):
        command += [":"] * (i > 0) + ["-n", "1", job.build / "bin" / program, job.root / FLAP, *options]
    result = job.run(command, 600)
    text = result.stdout + result.stderr
    steps = len(couplet.read_csv(out / "coupler" / "balance.csv")["time [s]"])
    return result.returncode, steps, text


def explicit_heavy(job):
    folder = flap(job, "explicit", "coupling.scheme=explicit")
    gap = np.abs(tips(folder) - tips(flap(job, "default"))).max() / np.abs(tips(folder)).max()
    return f"holds; tip {gap:.1e} from the semi-implicit one", bool(gap < 1e-2)


def explicit_light(job):
    code, steps, text = refused(job, "coupling.scheme=explicit", "participants.solid.material.density=42")
    named = "added-mass instability" in text
    return f"exit code {code} after {steps} steps, {'named' if named else 'not named'}", code == 1 and named and steps <= 10


def viscous_swing(job):
    code, steps, text = refused(job, "participants.solid.material.density=1", "participants.fluid.boundaries.inlet.ramp=0.4")
    named = "wall shear at the guessed velocity" in text
    return f"exit code {code} after {steps} steps, {'named' if named else 'not named'}", code == 0 or (code == 1 and named)


RUNS = [
    Bar("flap explicit, rho_s 3000", "holds, tip within 1 %", explicit_heavy),
    Bar("flap explicit, rho_s 42", "refused within 10 steps with the reason", explicit_light),
    Bar("flap semi-implicit, rho_s 1, mu 1, ramp 0.4 s: holds since friction is renewed, or the swing is named",
        "end reached, or refused with the reason", viscous_swing),
    Bar("guards: each fires and does not", "all tests", passed("unit_coupler", "Guard")),
    Bar("strangers: C++, C, Python with the real fluid; two ranks of the fluid; restart bit for bit", "all", registered("^client_examples$")),
    Bar("strangers: installed library by CMake and pkg-config, Python module", "all", registered("^client_install$")),
    Bar("strangers: a wrong guest is named, the job ends", "named", registered("^client_handshake$")),
]
