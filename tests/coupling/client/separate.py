#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Participants that are launched separately from the job and join through its relay: the values of the native client, bit for bit; each
side's death is named on the other within 5 s; strangers and noise at the relay's socket do no harm.
Usage: separate.py PROJECT BUILD MPIRUN... -- [same | lost | strangers N]"""
import os
import pathlib
import random
import shutil
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end, mpmd  # noqa: E402

project, build = map(pathlib.Path, sys.argv[1:3])
split = sys.argv.index("--")
mpirun, what = sys.argv[3:split], sys.argv[split + 1]
slower = float(os.environ.get("COUPLET_SLOWER", "1")) * max(1, os.getloadavg()[0] / os.cpu_count())  # a machine with more to do than cores keeps no clock
here = project / "tests/coupling/client"
environment = dict(os.environ, PYTHONPATH=str(project / "client/python"))
apart = {name: value for name, value in environment.items() if not name.startswith(("OMPI_COMM", "PMIX_"))}
bodies = {"c++": [build / "bin/tests/spring_cylinder"], "c": [build / "bin/tests/spring_cylinder_c"],
          "python": ["/usr/bin/python3", project / "client/examples/spring_cylinder.py"]}
if subprocess.run(["/usr/bin/python3", "-c", "import mpi4py, numpy"], capture_output=True).returncode:
    print("without Python: no mpi4py or numpy")
    del bodies["python"]
parameters = ["body", "2", "0.1", "3", "0.05"]


def words(*parts):
    return [str(p) for p in parts]


def job(folder, body, *sets):
    """The job with `body` as its last program."""
    for name in ("case.yaml", "cylinder.geo"):
        shutil.copy(here / name, folder)
    parts = [[build / "bin" / program, "case.yaml", *(f"--set={s}" for s in sets)] for program in ("coupler", "fluid_solver", "mesh_mover")]
    return subprocess.Popen(mpmd([*parts, body], mpirun=mpirun), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment,
                            start_new_session=True)


def relay(*options):
    return [build / "bin/relay", "body", *options]


def participant(folder, body, *more, **variables):
    return subprocess.Popen(words(*body, *(more or parameters)), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            env={**apart, "COUPLET_JOIN": "body.relay", **variables}, start_new_session=True)


def result_of(process, seconds=120):
    """Exit code (None: it did not end) and what it said."""
    try:
        said, _ = process.communicate(timeout=seconds * slower)
        return process.returncode, said
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        return None, process.communicate()[0]


def address(folder):
    """Token and place, once the relay has written them."""
    file, limit = pathlib.Path(folder) / "body.relay", time.monotonic() + 60 * slower
    while not file.exists():
        if time.monotonic() > limit:
            raise RuntimeError("the relay wrote no address")
        time.sleep(0.02)
    return file.read_text().splitlines()[2].removeprefix("token "), file.read_text().splitlines()[3].split()


def steps(folder):
    file = pathlib.Path(folder) / "body.csv"
    return file.read_text().splitlines() if file.exists() else []


def has_loopback6():
    table = pathlib.Path("/proc/net/if_inet6")
    return table.exists() and any(line.split()[-1] == "lo" for line in table.read_text().splitlines())


def listening(token):
    """TCP ports on which processes listen whose command line has the token, as (address, port)."""
    inodes = set()
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and token in (entry / "cmdline").read_text() and "relay" in os.readlink(entry / "exe"):
                inodes |= {os.readlink(f).removeprefix("socket:[").rstrip("]") for f in (entry / "fd").iterdir() if os.readlink(f).startswith("socket:[")}
        except OSError:
            pass
    found = []
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        for line in pathlib.Path(table).read_text().splitlines()[1:] if os.path.exists(table) else []:
            fields = line.split()
            if fields[3] == "0A" and fields[9] in inodes:
                found.append(fields[1])
    return found


loop6 = [["--listen", "tcp6:lo"]] if has_loopback6() else []


def same():
    short = ["simulation.end-time=0.08"]
    for language, body in bodies.items():
        with tempfile.TemporaryDirectory() as folder:
            result_of(job(folder, [*body, *parameters], *short))
            native = steps(folder)
        ways = ([], ["--listen", "tcp:lo"], *loop6) if language == "c++" else loop6 or ([],)
        for way in ways:
            with tempfile.TemporaryDirectory() as folder:
                whole, guest = job(folder, relay(*way), *short), participant(folder, body)
                codes = result_of(guest), result_of(whole)
                check(f"{language}, {way or 'unix'}: both end well", [c for c, _ in codes] == [0, 0], str(codes) if any(c for c, _ in codes) else "")
                check(f"{language}, {way or 'unix'}: the native client's values, bit for bit", len(native) == 4 and steps(folder) == native, str(steps(folder)[-1:]))
                check("the address is taken away", not (pathlib.Path(folder) / "body.relay").exists())


def killed(body, who):
    """After the first step the job or its participant is killed: exit code of the other, what it said, and how long it took [s]."""
    with tempfile.TemporaryDirectory() as folder:
        processes = {"job": job(folder, relay(), "simulation.end-time=100"), "participant": participant(folder, body)}
        while len(steps(folder)) < 1 and processes["participant"].poll() is None:
            time.sleep(0.02)
        victim = processes.pop(who)
        os.killpg(victim.pid, signal.SIGKILL)
        begin = time.monotonic()
        code, said = result_of(*processes.values(), 30)
        took = time.monotonic() - begin
        victim.communicate()
        return code, said, took


def lost():
    for language, body in bodies.items():
        for who, reasons in (("participant", ["relay of 'body': the participant is lost"]), ("job", ["the connection was closed", "sending failed"])):
            code, said, took = killed(body, who)
            check(f"{language}, {who} killed: the other side ends within 5 s", code not in (0, None) and took < 5 * slower, f"{code}, {took:.1f} s")
            check("and reports why", any(reason in said for reason in reasons), said[-300:])
    if "python" in bodies:
        with tempfile.TemporaryDirectory() as folder:
            broken = pathlib.Path(folder) / "broken.py"
            text = bodies["python"][1].read_text()
            broken.write_text(text.replace('if event == "solve":', 'if event == "solve":\n            1 / 0', 1))
            whole, guest = job(folder, relay(), "simulation.end-time=100"), participant(folder, ["/usr/bin/python3", broken])
            (code, _), (job_code, said) = result_of(guest), result_of(whole, 30)
            check("a participant that fails takes the job along", code != 0 and job_code not in (0, None), f"{code} {job_code}")
            check("with its reason", "participant 'body' ended before the job was over" in said, said[-300:])


def connect(place):
    kind, *where = place
    s = socket.socket(socket.AF_UNIX if kind == "unix" else socket.AF_INET)
    s.settimeout(10)
    s.connect(where[0] if kind == "unix" else (where[0], int(where[1])))
    return s


def answer(place, data):
    with connect(place) as s:
        try:
            s.sendall(data)
            return s.recv(400).decode()
        except OSError:
            return ""


def noise(number, place, token):
    """Greetings that are almost right, and bytes that are nothing."""
    generator = random.Random(20261123)
    good = f"couplet-join 6 {token} 0 1 body\n".encode()
    welcome = 0
    for _ in range(number):
        data = bytearray(good)
        for _ in range(generator.randrange(1, 6)):
            kind, at = generator.randrange(4), generator.randrange(min(13, len(data) - 1), len(data))
            if kind == 0:
                data[at] ^= 1 << generator.randrange(8)
            elif kind == 1:
                del data[at:at + generator.randrange(1, 40)]
                data += b"\n"
            elif kind == 2:
                data[at:at] = generator.randbytes(generator.randrange(1, 300))
            else:
                data = bytearray(generator.randbytes(generator.randrange(14, 900))) + b"\n"
        line = bytes(data)
        if line.partition(b"\n")[0] != good.strip():
            welcome += answer(place, line).startswith("welcome")
    return welcome


def strangers(number):
    for way in ("unix", "tcp:lo"):
        with tempfile.TemporaryDirectory() as folder:
            token_of_folder = str(pathlib.Path(folder) / "body.relay")
            whole = job(folder, relay("--listen", way, "--address", token_of_folder), "simulation.end-time=0.04")
            token, place = address(folder)
            check(f"{way}: the file is for its owner alone", stat.S_IMODE(os.stat(token_of_folder).st_mode) == 0o600)
            ports = listening(token_of_folder)
            check(f"{way}: it listens there and nowhere else", ports == ([] if way == "unix" else [f"0100007F:{int(place[2]):04X}"]), str(ports))
            if way == "unix":
                check("the socket's folder is for its owner alone", stat.S_IMODE(os.stat(pathlib.Path(place[1]).parent).st_mode) == 0o700)
            wrong = "0" * len(token)
            check("a wrong token is refused", "the token is wrong" in answer(place, f"couplet-join 6 {wrong} 0 1 body\n".encode()))
            check("so is part of the token", "the token is wrong" in answer(place, f"couplet-join 6 {token[:32]} 0 1 body\n".encode()))
            check("another version", "not the greeting of version 8" in answer(place, f"couplet-join 4 {token} 0 1 body\n".encode()))
            check("another participant", "the relay of 'body'" in answer(place, f"couplet-join 6 {token} 0 1 fluid\n".encode()))
            check("another number of processes", "expected process 0 of 1" in answer(place, f"couplet-join 6 {token} 1 2 body\n".encode()))
            with connect(place):  # says nothing and stays: refused after a second
                check(f"{number} greetings that are almost right: none is let in", noise(number, place, token) == 0)
            guest = participant(folder, bodies["c++"])
            check("then the participant comes, and the job runs", (result_of(guest)[0], result_of(whole)[0]) == (0, 0) and len(steps(folder)) == 2)
            if way == "unix":
                check("the socket is taken away", not pathlib.Path(place[1]).parent.exists())
    for options, code, text in ((["--listen", "tcp:nowhere0"], 1, "no network interface 'nowhere0'"), (["--listen", "tcp6:nowhere0"], 1, "no network interface 'nowhere0' with an IPv6 address"), (["--listen", "udp"], 1, "expected unix, or tcp:INTERFACE"),
                                (["--listen", "tcp:lo:70000"], 1, "is not a port"), (["--wait", "never"], 2, "expected a number of seconds above 0"),
                                (["--wait", "1"], 1, "nobody connected within 1 s"), (["--door"], 2, "unknown option '--door'")):
        with tempfile.TemporaryDirectory() as folder:
            got, said = result_of(job(folder, relay(*options)), 60)
            check(f"{' '.join(options)}: exit code {code}, with its reason", got == code and text in said, f"{got} {said[-300:]}" if got != code or text not in said else "")
    with tempfile.TemporaryDirectory() as folder:
        for body in bodies.values():
            code, said = result_of(participant(folder, body, COUPLET_JOIN_WAIT="0.5"))
            check("a participant without a relay ends", code not in (0, None) and "no relay of the job has written it" in said, said[-200:])
        (pathlib.Path(folder) / "body.relay").write_text("something else\n\n\n\n")
        code, said = result_of(participant(folder, bodies["c++"]))
        check("a file that no relay has written is refused", code not in (0, None) and "was not written by a relay" in said, said[-200:])


{"same": same, "lost": lost, "strangers": lambda: strangers(int(sys.argv[split + 2]))}[what]()
end()
