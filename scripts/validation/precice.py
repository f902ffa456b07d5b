# SPDX-License-Identifier: Apache-2.0
"""Bars of programs on preCICE's interface: own ones by the tests, those of others as they were fetched (parts/precice)."""
from validation.job import Bar
from validation.parts.precice import adapters, programs
from validation.parts.trust.runs import tests

OWN = [
    Bar("own programs in C++, C, Python and Fortran against each other, serial implicit", "the monolithic trapezoidal rule, 1e-10", tests("^precice_languages$")),
    Bar("serial and parallel, explicit and implicit, 3 and 2 sub-steps a window, with and without initial data", "the same scheme computed by itself: 1e-13 explicit, 1e-9 implicit", tests("^precice_schemes$")),
    Bar("values at the sub-steps of both, degrees 1 to 3, serial and parallel, explicit and implicit; polynomials in time; a circuit's order; 3 and 2 processes",
        "the same scheme computed by itself: 1e-13 explicit, 1e-9 implicit; degree n to rounding, n + 1 not; order n + 1", tests("^precice_waveforms$")),
    Bar("values within a step in the coupler: serial and parallel, halved steps, a restart, sub-steps that change from pass to pass; interpolation in time",
        "the monolithic scheme of the sub-steps: 1e-10; the restart bit for bit", tests("^coupling_within_step$")),
    Bar("1 to 3 processes of each, 1 and 2 of the coupler", "the same motion, 1e-9", tests("^precice_ranks$")),
    Bar("two meshes of one participant in the same place", "each datum stays on its mesh; sums kept", tests("^precice_meshes$")),
    Bar("participants started by launches of their own, over a socket of the machine and of a network interface, 1 to 3 processes", "the values of one launch, bit for bit", tests("^precice_separate$")),
    Bar("client programs in C++, C and Python launched separately", "the native client's values, bit for bit", tests("^client_separate_same$")),
    Bar("participant killed, job killed, participant that fails", "named on the other side within 5 s", tests("^client_separate_lost$")),
    Bar("a relay's socket: token, permissions, where it listens, 5000 greetings that are almost right on each kind of socket", "strangers are refused, then the participant runs",
        tests("^client_separate_(strangers|noise_long)$")),
    Bar("wrong calls, an error that nobody catches, a program that leaves early", "each named; the job ends", tests("^precice_wrong$")),
    Bar("couplet import: a good configuration and bad ones", "a valid case; each bad one refused with its line", tests("^precice_import$")),
]
BARS = [*OWN, *programs.BARS, *adapters.BARS]
SOURCES = ("client", "coupler", "common/coupling", "tests/coupling/precice", "scripts/validation/parts/precice")
