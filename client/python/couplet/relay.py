# SPDX-License-Identifier: Apache-2.0
"""Connection of a participant's process to the coupler: over MPI or, if launched separately, over a socket to its relay
in the job (docs/protocol.md, "Launched separately")."""
import os
import socket
import struct
import time

from mpi4py import MPI

LEAVE, FAIL = 1, 2
FRAME = struct.Struct("=iiq")


def pause(since):
    """Yields the core between two polls."""
    waited = time.monotonic() - since
    time.sleep(0 if waited < 8e-5 else min(waited / 16, 2.5e-4))


def wait(request):
    since = time.monotonic()
    while not request.Test():
        pause(since)


class OverMpi:
    def __init__(self, coupler):
        self._coupler, self.ranks = coupler, coupler.Get_remote_size()

    def receive(self, rank, tag):
        since, status = time.monotonic(), MPI.Status()
        while (message := self._coupler.Improbe(rank, tag, status)) is None:
            pause(since)
        data = bytearray(status.Get_count(MPI.BYTE))
        message.Recv([data, MPI.BYTE])
        return data

    def send(self, data, rank, tag):
        wait(self._coupler.Isend([data, MPI.BYTE], rank, tag))

    def leave(self):
        pass

    def fail(self, why):
        pass


class OverSocket:
    """Link over a socket. Raises ConnectionError or ValueError with the reason."""

    def __init__(self, file, participant, version, comm):
        seconds = float(os.environ.get("COUPLET_JOIN_WAIT", "60"))
        end = time.monotonic() + seconds
        while not os.path.exists(file):
            if time.monotonic() > end:
                raise ConnectionError(
                    f"COUPLET_JOIN: there is no '{file}' yet: no relay of the job has written it (COUPLET_JOIN_WAIT:"
                    " seconds to wait, 60)."
                )
            time.sleep(0.02)
        with open(file) as lines:
            mark, name, token, *places = lines.read().splitlines()
        if mark != "couplet relay 1":
            raise ValueError(f"COUPLET_JOIN: '{file}' was not written by a relay of this version.")
        if name != f"participant {participant}":
            raise ValueError(
                f"'{file}' belongs to the relay of '{name.removeprefix('participant ')}'; this program is"
                f" '{participant}'."
            )
        if comm.size != len(places):
            raise ValueError(
                f"'{participant}' has {comm.size} processes, but its relay has {len(places)}: start the same number of"
                " both."
            )
        kind, *where = places[comm.rank].split()
        if kind == "unix":
            self._socket = socket.socket(socket.AF_UNIX)
            self._socket.connect(where[0])
        else:  # numeric address of either family
            family, _, _, _, place = socket.getaddrinfo(
                *where, type=socket.SOCK_STREAM, flags=socket.AI_NUMERICHOST | socket.AI_NUMERICSERV
            )[0]
            self._socket = socket.socket(family)
            self._socket.connect(place)
        if kind == "tcp":  # like watch() of stream.cpp: a lost partner is detected within 5 s
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
            for option, value in (
                ("TCP_KEEPIDLE", 2),
                ("TCP_KEEPINTVL", 1),
                ("TCP_KEEPCNT", 3),
                ("TCP_USER_TIMEOUT", 5000),
                ("TCP_NODELAY", 1),
            ):
                self._socket.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)
        self._socket.sendall(
            f"couplet-join {version} {token.removeprefix('token ')} {comm.rank} {comm.size} {participant}\n".encode()
        )
        answer = b""
        while not answer.endswith(b"\n") and len(answer) < 400 and (byte := self._socket.recv(1)):
            answer += byte
        if not answer.startswith(b"welcome "):
            raise ConnectionError(f"the relay of '{participant}' refused the connection: {answer.decode().strip()}")
        self.ranks, self._early = int(answer[8:]), {}

    def _read(self, size):
        data = bytearray(size)
        view = memoryview(data)
        while view:
            try:
                n = self._socket.recv_into(view)
            except OSError as error:  # "reset by peer" if the other side had unread data
                raise ConnectionError(f"the connection was closed ({error.strerror})") from error
            if n == 0:
                raise ConnectionError("the connection was closed")
            view = view[n:]
        return data

    def receive(self, rank, tag):
        if self._early.get((rank, tag)):
            return self._early[rank, tag].pop(0)
        while True:
            *whose, size = FRAME.unpack(self._read(FRAME.size))
            data = self._read(size)
            if tuple(whose) == (rank, tag):
                return data
            self._early.setdefault(tuple(whose), []).append(data)

    def send(self, data, rank, tag):
        data = memoryview(data).cast("B")
        try:
            self._socket.sendall(FRAME.pack(rank, tag, len(data)))
            self._socket.sendall(data)
        except OSError as error:
            raise ConnectionError(f"sending failed ({error.strerror})") from error

    def leave(self):
        self.send(b"", 0, LEAVE)

    def fail(self, why):
        try:
            self.send(why.encode(), 0, FAIL)
        except OSError:
            pass  # it ends either way
