# SPDX-License-Identifier: Apache-2.0
"""Bars of the coupler: schedules, several bodies, ranks, scale, programs of other people."""
import csv
import resource

import numpy as np

import couplet
from validation.job import Bar
from validation.main_job import FLAP, registered, steps_of


def unit(executable, pattern, key, met=None):
    """A property that a test records; met if the tests passed and `met` of the values, reported without it."""
    def measure(job):
        values, passed = job.recorded(executable, pattern, key)
        return ", ".join(f"{v:g}" for v in values), bool(passed and met(values)) if met else None
    return measure


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


def length(job):
    """The row of a quick run states what it omits."""
    return "to 0.2 s" if job.quick else "to 1 s"


def tips(folder):
    probes = couplet.read_csv(folder / "solid" / "probes.csv")
    return np.array(probes["tip x [m]"])


def jacobi_against_gauss_seidel(job):
    acceleration = ("coupling.scheme=implicit", "coupling.acceleration.type=iqn-ils", "coupling.convergence.relative=1e-7")
    one = flap(job, "serial", *acceleration)
    other = flap(job, "parallel", *acceleration, "coupling.order=parallel")
    gap = np.abs(tips(one) - tips(other)).max() / np.abs(tips(one)).max()
    counts = [steps_of(f)[:, 0].mean() for f in (one, other)]
    return f"{gap:.1e} apart; {counts[0]:.2f} and {counts[1]:.2f} passes per step, {length(job)}", bool(gap <= 1e-4)


def coupler_ranks(job):
    one = flap(job, "ranks-1")
    gaps = []
    for n in (2, 3):
        gaps.append(np.abs(tips(one) - tips(flap(job, f"ranks-{n}", ranks=(n, 1, 1, 1)))).max() / np.abs(tips(one)).max())
    return f"{max(gaps):.1e} apart, {length(job)}", bool(max(gaps) <= 1e-10)


def participants(folder):
    """Rows of the steps but the first."""
    with open(folder / "coupler" / "participants.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))[1:]


def own_share(job):
    """Processor seconds of the coupler outside its waiting, beside those of all programs of the job."""
    def make():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        folder = flap(job, "own-share")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return participants(folder), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    rows, everybody = job.once("own share", make)
    own = sum(float(r["coupler working [s]"]) for r in rows)
    return f"{100 * own / everybody:.2f} %: {1e3 * own / len(rows):.2f} ms of a step's {1e3 * everybody / len(rows):.0f} ms, {length(job)}", \
        bool(rows and 0 < own < 0.03 * everybody)


def beside_work(job):
    """Wall clock of the steps less what fluid and structure, one after the other, worked: the coupler, and all waiting for the machine."""
    rows = participants(flap(job, "ranks-1"))
    wall = sum(float(r["wall clock [s]"]) for r in rows)
    worked = sum(float(r[f"{name} working [s]"]) for r in rows for name in ("fluid", "solid"))
    return f"{100 * (1 - worked / wall):.1f} % of {len(rows)} steps", None


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
    named = "wall shear at the predicted velocity" in text
    return f"exit code {code} after {steps} steps, {'named' if named else 'not named'}", code == 0 or (code == 1 and named)


def exchanged(kind, judge):
    """A pass of two dummies with 1e5 vectors of three each way, without their own work; the best of three runs."""
    def measure(job):
        def make():
            dummies = job.beside("benchmarks/exchange/exchange.py")
            return [dummies.measure(100000, job.build / "bin") for _ in range(3)]
        runs = job.once("exchange", make)
        passes, ms = min((found[kind] for found, _ in runs), key=lambda f: f[1])
        plain = min(p for _, p in runs)
        return f"{ms:.2f} ms per pass, {passes:.1f} passes per step; MPI alone {plain:.2f} ms there and back: {ms / plain:.1f} times", bool(judge(ms, plain))
    return measure


# Milliseconds for 1e5 vectors of three there and back by MPI alone on the machine where preCICE was measured: 15.4 GB/s of messages of 2 MiB.
PRECICE_PLAIN = 2 * 2.4e6 / 15.4e9 * 1e3

RUNS = [
    Bar("exchange of 1e5 3-vectors, Aitken, over MPI's own time for the same bytes", "< 2 times", exchanged("aitken", lambda ms, plain: ms < 2 * plain), long=True,
        but="a pass takes each vector to the coupler and on, so that 2.0 is the floor: not to be met by this way of exchange"),
    Bar("the same beside preCICE 3.4.1 over MPI, Aitken", f"at most {11.9 / PRECICE_PLAIN:.0f} times (11.9 ms per pass)",
        exchanged("aitken", lambda ms, plain: ms / plain <= 11.9 / PRECICE_PLAIN), long=True),
    Bar("the same, IQN-ILS of 6 passes beside preCICE's 106 ms per pass", f"at most {53 / PRECICE_PLAIN:.0f} times (half of 106 ms)",
        exchanged("iqn-ils, changing", lambda ms, plain: ms / plain <= 53 / PRECICE_PLAIN), long=True,
        but="the dummies' map is another one in each step and 1e-2 the tolerance, which make a step 6 passes; before, six of our passes stood beside one of preCICE's"),
    Bar("flap explicit, rho_s 3000", "holds, tip within 1 %", explicit_heavy),
    Bar("flap explicit, rho_s 42", "refused within 10 steps with the reason", explicit_light),
    Bar("flap semi-implicit, rho_s 1, mu 1, ramp 0.4 s: stable since friction is renewed, or the oscillation is named",
        "end reached, or refused with the reason", viscous_swing),
    Bar("guards: each fires and does not", "all tests", passed("unit_coupler", "Guard")),
    Bar("sub-steps 7 and 4, waveform linear: order in time", ">= 1.8",
        unit("coupling_groups", "keeps_the_second_order", "slope_linear", lambda v: min(v) >= 1.8)),
    Bar("sub-steps 7 and 4, waveform constant: order in time", "first order shown",
        unit("coupling_groups", "keeps_the_second_order", "slope_constant", lambda v: max(v) < 1.4)),
    Bar("two bodies in one fluid, serial and parallel", "monolithic solution to 1e-9, restart bit for bit",
        passed("coupling_groups", "Groups.")),
    Bar("two flaps in one flow, implicit, the real solvers", "runs, restart bit for bit", registered("^coupling_bodies_two-flaps$")),
    Bar("fluid, structure and heat program", "runs, restart bit for bit", registered("^coupling_bodies_warm-flap$")),
    Bar("flap implicit: Jacobi against Gauss-Seidel", "same tip to 1e-4", jacobi_against_gauss_seidel),
    Bar("coupler on 1, 2, 3 ranks: the flap", "same to 1e-10", coupler_ranks),
    Bar("coupler's own share of a flap step", "< 3 %", own_share,
        but="processor seconds outside its waiting over those of all programs with their start: wall clock holds other people's work, too"),
    Bar("wall clock of a flap step beside what fluid and structure worked", "reported", beside_work),
    Bar("set-up of 1e5 vertices (maps, checks, balance)", "< 2 s cpu",
        unit("coupling_groups", "set_up_of_a_large", "setup_seconds_1e5", lambda v: max(v) < 2)),
    Bar("mapping of 1e5 3-vectors, one rank [ms]", "reported", unit("coupling_groups", "set_up_of_a_large", "map_milliseconds_1e5")),
    Bar("maps over 1, 2, 3 ranks", "as on one", registered("^unit_coupler_maps")),
    Bar("external programs: C++, C, Python with the real fluid; ranks of fluid and coupler; restart bit for bit", "all", registered("^client_examples$")),
    Bar("external programs: installed library by CMake and pkg-config, Python module", "all", registered("^client_install$")),
    Bar("external programs: a wrong external program is named, the job ends", "named", registered("^client_handshake$")),
]
