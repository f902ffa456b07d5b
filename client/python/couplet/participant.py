# SPDX-License-Identifier: Apache-2.0
"""Python program as a participant of a Couplet job, using only mpi4py and numpy. docs/protocol.md defines the protocol.

    c = couplet.Client("solid", "my_solver")            # all processes of the participant
    c.vertices(xyz, dimension=2)                        # (n, 3): part of this process, or all on process 0
    c.faces(centres, areas, corners)                    # corners: vertex positions of each face
    c.takes("pressure-force", "N", "faces"); c.gives("displacement", "m", "vertices")
    for event in c:                                     # "begin", "solve", "accept", "output", "save", "load"
        if event == "solve": c.write("displacement", motion(c.read("pressure-force")))
"""
from __future__ import annotations

import atexit
import math
import os
import socket
import struct
import sys
import time
import traceback
from collections.abc import Iterator, Sequence

import numpy
from mpi4py import MPI  # MPI starts here

from couplet.relay import OverMpi, OverSocket, wait as _wait

VERSION, COMMAND, REPLY, HELLO = 8, 0x434F4D4D, 0x5245504C, 0x434F55504C4554
JOIN_TAG, COMMAND_TAG, REPLY_TAG, INPUT_TAG, PLACES_TAG, OUTPUT_TAG = 100, 101, 102, 103, 104, 105
EVENTS = {2: "begin", 3: "solve", 4: "accept", 5: "output", 6: "save", 7: "load"}
INITIALISE, SOLVE, FINALISE = 1, 3, 8


def _integers(*values):
    return struct.pack(f"={len(values)}q", *values)


def _reals(*values):
    return struct.pack(f"={len(values)}d", *values)


def _text(value):
    data = value.encode()
    return _integers(len(data)) + data


def _list(values):
    return _integers(len(values), *values)


class _Reader:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, kind):
        (value,) = struct.unpack_from("=" + kind, self.data, self.at)
        self.at += 8
        return value

    def text(self):
        n = self.take("q")
        self.at += n
        return bytes(self.data[self.at - n : self.at]).decode()


class Client:
    """One participant of a job. `dt` [s] is the step of the event, `time` [s] its begin (for "accept" and "output" its end), `number` counts
    steps, and `folder` is that of the checkpoint to save or load."""

    def __init__(self, participant: str, program: str):
        """Takes part in the start of the job. Collective over all processes of the participant. Ends the program with exit code 2 if the job does not
        start. If COUPLET_JOIN=FILE is set, the program was launched separately (MPI.COMM_WORLD is the participant) and joins through the relay that
        wrote FILE."""
        self.participant, self._takes, self._gives = participant, [], []
        self._xyz = self._centres = self._areas = numpy.zeros((0, 3))
        self._corners, self._dimension, self._advised, self._pending = [], 3, math.inf, False
        self._begun = self.dt = 0.0
        self._over, self._link = False, None
        if file := os.environ.get("COUPLET_JOIN"):
            self.comm = MPI.COMM_WORLD.Dup()
            try:
                self._link = OverSocket(file, participant, VERSION, self.comm)
            except (OSError, ValueError) as error:
                self._end(error)
        else:
            self.comm, coupler = self._join(participant, program)
            self._link = OverMpi(coupler)
        atexit.register(self._leave)

    def _join(self, participant, program):
        """Handshake, roll call and connection, collective over the whole job. Creates the own communicator and that to the coupler."""
        world = MPI.COMM_WORLD
        hello, everyone = numpy.array([HELLO, VERSION, 1, 0], "i8"), numpy.zeros(4 * world.size, "i8")
        _wait(world.Iallgather(hello, everyone))
        if (everyone[0::4] != HELLO).any() or (everyone[1::4] != VERSION).any():
            others = sorted(set(everyone[1::4].tolist()) - {VERSION})
            self._end(
                "a process of the job uses another protocol"
                + (f": version {others[0]}, but this client uses version {VERSION}" if others else "")
            )
        world.Split(MPI.UNDEFINED, world.rank)
        number = os.environ.get("COUPLET_PART") or world.Get_attr(MPI.APPNUM) or 0
        fields = [
            program,
            participant,
            "(guest)",
            "0",
            "",
            "1",
            str(number),
            str(world.rank),
            f"{os.getpid()}@{socket.gethostname()}",
        ]
        strings = self._all_strings(world, ("".join(f + "\x1f" for f in fields) + "\x1e").encode())
        participants = [s.split("\x1f")[1] for s in strings]
        problem, worst = numpy.zeros(1, "i8"), numpy.zeros(1, "i8")
        world.Allreduce(problem, worst, MPI.MAX)
        if worst[0]:
            MPI.Finalize()
            sys.exit(2)
        comm = world.Split(list(dict.fromkeys(participants)).index(participant), world.rank)
        return comm, comm.Create_intercomm(0, world, participants.index("coupler"), JOIN_TAG)

    def _leave(self):
        """Ends the job if the program ends first (an exception, sys.exit), because MPI_Finalize would wait forever."""
        if not self._over and not MPI.Is_finalized():
            sys.stdout.flush()
            error = getattr(sys, "last_value", None)  # set by the interpreter with the traceback that it prints
            why = "".join(traceback.format_exception_only(error)).strip().splitlines()[-1:] if error else []
            self._end(": ".join([f"participant '{self.participant}' ended before the job was over", *why]))

    @staticmethod
    def _all_strings(world, mine):
        counts = numpy.zeros(world.size, "i4")
        world.Allgather(numpy.array([len(mine)], "i4"), counts)
        everything = bytearray(int(counts.sum()))
        world.Allgatherv([mine, MPI.BYTE], [everything, counts, numpy.r_[0, counts.cumsum()[:-1]], MPI.BYTE])
        return bytes(everything).decode().split("\x1e")[:-1]

    # -- the interface, before the first event ------------------------------------------------------------------------
    def vertices(self, xyz: numpy.ndarray, dimension: int = 3) -> None:
        """Declares vertices `xyz` (n, 3) [m] in the reference configuration. For dimension 2, z = 0, and all values are per meter of depth."""
        self._xyz, self._dimension = numpy.asarray(xyz, float).reshape(-1, 3), dimension

    def faces(
        self, centres: numpy.ndarray, areas: numpy.ndarray, corners: Sequence[Sequence[int]] | None = None
    ) -> None:
        """Declares faces: centers [m] and areas out of this participant [m^2] (n, 3). `corners` lists vertex positions per face."""
        self._centres, self._areas = (numpy.asarray(a, float).reshape(-1, 3) for a in (centres, areas))
        self._corners = corners or [[] for _ in self._centres]

    def takes(self, datum: str, unit: str, place: str, components: int = 0) -> None:
        """Declares a received datum at `place` ("vertices" or "faces") with `components` values per location; 0 means one per dimension."""
        self._takes.append((datum, unit, ("vertices", "faces").index(place), components))

    def gives(self, datum: str, unit: str, place: str, components: int = 0) -> None:
        """Declares a datum that is written in each "solve", with the arguments of takes()."""
        self._gives.append((datum, unit, ("vertices", "faces").index(place), components))

    # -- events -------------------------------------------------------------------------------------------------------
    def __iter__(self) -> Iterator[str]:
        while (event := self.next()) is not None:
            yield event

    def next(self) -> str | None:
        """Replies to the last event and waits for the next one. Returns None when the job is over. Collective."""
        while True:
            if self._pending:
                self._send_reply()
                if self.operation == FINALISE:
                    self._over = True
                    self._link.leave()
                    return None
            self._receive_command()
            if self.operation == INITIALISE and self.sub_steps > 1:
                self._end(
                    f"'coupling.sub-steps' of '{self.participant}': this library takes one step per coupling step;"
                    " remove it, and subdivide the step in your own program."
                )
            if self.operation in EVENTS:
                return EVENTS[self.operation]

    def read(self, datum: str) -> numpy.ndarray:
        """Returns the data of this process, (places, components): zeros before they are first given, and the last values after the last event."""
        entry = next(d for d in self._takes if d[0] == datum)
        return self._input.get(datum, numpy.zeros(self._shape(entry)))

    def write(self, datum: str, values: numpy.ndarray) -> None:
        """Gives the data of this process, (places, components) in the unit that gives() declared."""
        entry = next(d for d in self._gives if d[0] == datum)
        self._output[datum] = numpy.ascontiguousarray(values, float).reshape(self._shape(entry))

    def fail(self, why: str, halving_helps: bool = True) -> None:
        """Reports a failed step instead of writing. The job repeats it with half the step unless halving does not help."""
        self._status, self._why = (1 if halving_helps else 2), why

    def advise(self, dt: float) -> None:
        """Asks for steps of at most `dt` [s] from now on."""
        self._advised = dt

    def checkpoint(self) -> str:
        """Prefix of file names for save and load."""
        return f"{self.folder}/{self.participant}"

    # -- messages -----------------------------------------------------------------------------------------------------
    def _shape(self, entry):
        return len(self._centres if entry[2] else self._xyz), entry[3] or self._dimension

    def _end(self, why):
        print(f"couplet client: {why}", file=sys.stderr, flush=True)
        if self._link is not None:
            self._link.fail(str(why))
        MPI.COMM_WORLD.Abort(1)

    def _receive(self, rank, tag):
        try:
            return self._link.receive(rank, tag)
        except OSError as error:
            self._end(error)

    def _send(self, data, rank, tag):
        try:
            self._link.send(data, rank, tag)
        except OSError as error:
            self._end(error)

    def _receive_command(self):
        head = self._receive(0, COMMAND_TAG) if self.comm.rank == 0 else bytearray()
        length = numpy.array([len(head)], "i8")
        _wait(self.comm.Ibcast(length, 0))
        head = head or bytearray(int(length[0]))
        _wait(self.comm.Ibcast([head, MPI.BYTE], 0))
        r = _Reader(head)
        if r.take("q") != COMMAND or r.take("q") != VERSION:
            self._end("a message of the coupler is not a command of this version")
        self.operation = r.take("q")
        step = r.take("d"), r.take("d")
        if self.operation == 2:
            self._begun, self.dt = step
        self.scheme, self.number, self.sub_steps = (r.take("q") for _ in range(3))
        accepted, self.output, self.folder = r.take("d"), r.take("q"), r.text()
        self.time = accepted if self.operation in (4, 5) else self._begun
        names = [r.text() for _ in range(r.take("q"))]
        self._input, self._output, self._status, self._why = {}, {}, 0, ""
        self._started, self._pending = time.monotonic(), True
        if names:
            self._receive_input(names)

    def _cut(self, n):
        counts = numpy.zeros(self.comm.size, "i8")
        self.comm.Allgather(numpy.array([n], "i8"), counts)
        return [0, *(int(c) for c in counts.cumsum())]

    def _peers(self):
        """Returns (rank of the coupler, slice of own vertices, slice of own faces) for all ranks with common entries."""
        ranks, mine = self._link.ranks, self.comm.rank
        list_ = []
        for c in range(ranks):
            slices = []
            for cut in (self._vertex_cut, self._face_cut):
                first, end = max(cut[mine], cut[-1] * c // ranks), min(cut[mine + 1], cut[-1] * (c + 1) // ranks)
                slices.append(slice(first - cut[mine], max(first, end) - cut[mine]))
            if any(s.stop > s.start for s in slices):
                list_.append((c, slices))
        return list_

    def _receive_input(self, names):
        entries = [next(d for d in self._takes if d[0] == name) for name in names]
        for entry in entries:
            if self._shape(entry)[0] > 0:
                self._input[entry[0]] = numpy.zeros(self._shape(entry))
        for rank, slices in self._peers():
            parts = [(e[0], slices[e[2]]) for e in entries if slices[e[2]].stop > slices[e[2]].start]
            if not parts:
                continue
            values, at = numpy.frombuffer(self._receive(rank, INPUT_TAG), "f8"), 0
            for name, part in parts:
                to = self._input[name][part]
                to[...] = values[at : at + to.size].reshape(to.shape)
                at += to.size

    def _places(self, vertices, faces):
        out = _integers(vertices.stop - vertices.start)
        for v in range(vertices.start, vertices.stop):
            out += _integers(v) + _reals(*self._xyz[v])
        out += _integers(faces.stop - faces.start)
        for f in range(faces.start, faces.stop):
            out += _integers(f) + _reals(*self._centres[f], *self._areas[f]) + _list(self._corners[f])
        return out + _integers(0)

    def _send_reply(self):
        first = self.operation == INITIALISE
        if first:
            self._dimension = self.comm.bcast(self._dimension, 0)
            self._vertex_cut, self._face_cut = self._cut(len(self._xyz)), self._cut(len(self._centres))
        if (
            self.operation == SOLVE
            and self._status == 0
            and (missing := {d[0] for d in self._gives} - set(self._output))
        ):
            self._end(f"'{self.participant}' did not give {', '.join(sorted(missing))}")
        names = sorted(self._output) if self._status == 0 else []
        if self.comm.rank == 0:
            head = _integers(REPLY, VERSION, self._status) + _text(self._why)
            head += (
                _reals(time.monotonic() - self._started, self._advised, self.dt)
                + _integers(0)
                + _reals(math.nan, math.nan, math.nan)
            )
            head += _integers(len(names)) + b"".join(map(_text, names)) + _integers(self._dimension, 0)
            for data in (self._takes, self._gives):
                head += _integers(len(data) if first else 0)
                for name, unit, place, components in data if first else []:
                    head += _text(name) + _text(unit) + _integers(place, components)
            head += _list(self._vertex_cut if first else [0]) + _list(self._face_cut if first else [0])
            self._send(head, 0, REPLY_TAG)
        for rank, slices in self._peers() if first or names else []:
            if first:
                self._send(self._places(*slices), rank, PLACES_TAG)
                continue
            parts = [self._output[n][slices[next(d for d in self._gives if d[0] == n)[2]]].ravel() for n in names]
            values = numpy.concatenate(parts)
            if values.size:
                self._send(values, rank, OUTPUT_TAG)
        self._pending = False
