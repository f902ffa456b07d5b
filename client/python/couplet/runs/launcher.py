# SPDX-License-Identifier: Apache-2.0
"""What mpirun itself writes about a job's end, between lines of dashes: which process was killed. The rest of those pages is not shown."""
import re

FRAME = re.compile(rb"-{40,}\s*")
KILLED = re.compile(r"process rank (\d+) .*exited on signal (\d+)(?: \((.*?)\))?", re.S)
OTHERS = ("Primary job terminated normally", "mpirun detected that one or more processes exited", "MPI_ABORT was invoked")  # a program ended the job, with a message of its own
LONGEST = 40  # lines between two lines of dashes: a longer text is no page of mpirun's


class Pages:
    """Takes mpirun's pages out of a stream of bytes."""

    def __init__(self):
        self.rest, self.page, self.killed = b"", None, None

    def feed(self, data, last=False):
        """The bytes that are not mpirun's, as far as they are whole."""
        *lines, self.rest = (self.rest + data).splitlines(keepends=True) + ([b""] if (self.rest + data).endswith(b"\n") else []) or [b""]
        if last:
            lines, self.rest = [*lines, self.rest], b""
        out = b""
        for line in lines:
            if self.page is not None:
                self.page.append(line)
                if FRAME.fullmatch(line) or len(self.page) > LONGEST:
                    out += self._end()
            elif FRAME.fullmatch(line):
                self.page = [line]
            else:
                out += line
        if self.page is None and not self.rest.startswith(b"-"):  # an unfinished line of a program is shown at once
            out, self.rest = out + self.rest, b""
        return out + (self._end() if last and self.page else b"")

    def _end(self):
        text, self.page = b"".join(self.page), None
        words = " ".join(text.decode(errors="replace").split())
        if found := KILLED.search(words):
            self.killed = self.killed or (int(found[1]), int(found[2]), found[3] or "")
        return b"" if found or any(other in words for other in OTHERS) else text


def culprit(killed, sizes):
    """`sizes`: [(name, ranks)] in the order of the launch line."""
    rank, number, name = killed
    for who, ranks in sizes:
        if rank < ranks:
            return f"'{who}'{f', rank {rank},' if ranks > 1 else ''} was ended by signal {number}{f' ({name})' if name else ''}"
        rank -= ranks
    return f"a process was ended by signal {number}"
