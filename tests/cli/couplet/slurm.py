# SPDX-License-Identifier: Apache-2.0
"""couplet run --slurm and the lines of docs/how-to/cluster.md on a Slurm of one node, set up in a scratch folder on the loopback address (Debian: slurm-wlm,
munge; as root): a coupled job, the same by mpirun and by srun, an end by scancel and going on. Usage: slurm.py BIN"""
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

from scene import COUPLET, call, case_in, environment
from checks import check, end  # noqa: E402

bin_ = pathlib.Path(sys.argv[1])
SBIN = f"{os.environ['PATH']}:/usr/sbin:/sbin"
if os.geteuid() != 0 or not all(shutil.which(p, path=SBIN) for p in ("munged", "slurmctld", "slurmd", "sbatch")):
    print("skipped: no Slurm here, or not root (Debian: slurm-wlm, munge)")
    sys.exit(77)

CONF = """ClusterName=couplet
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CommunicationParameters=NoInAddrAny
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
MpiDefault=none
ReturnToService=2
SlurmctldPort={ctld}
SlurmdPort={d}
SlurmctldPidFile={folder}/ctld.pid
SlurmdPidFile={folder}/d.pid
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldLogFile={folder}/ctld.log
SlurmdLogFile={folder}/d.log
SlurmdParameters=config_overrides
KillWait=10
NodeName={host} NodeAddr=127.0.0.1 CPUs=16 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Slurm:
    """munged, slurmctld and slurmd of our own, in the foreground."""

    def __init__(self, folder):
        self.folder, self.processes = folder, []
        folder.mkdir(mode=0o755)
        for name in ("state", "spool"):
            (folder / name).mkdir()
        (folder / "slurm.conf").write_text(CONF.format(folder=folder, host=socket.gethostname(), ctld=free_port(), d=free_port()))
        (folder / "key").write_bytes(os.urandom(1024))
        (folder / "key").chmod(0o600)
        self.env = {**environment(bin_), "PATH": f"{COUPLET.parent}:{bin_}:{SBIN}", "SLURM_CONF": str(folder / "slurm.conf"),
                    "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        self.start("munged", "--foreground", "--force", f"--key-file={folder}/key", f"--socket={folder}/munge.socket", f"--pid-file={folder}/munge.pid",
                   f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed")
        self.until(lambda: (folder / "munge.socket").exists(), 20)
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        self.ready = self.until(lambda: "idle" in self.run("sinfo", "-h", "-o", "%T").stdout, 60)

    def start(self, *words):
        self.processes.append(subprocess.Popen(words, env=self.env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))

    def run(self, *words, **more):
        return subprocess.run([str(w) for w in words], capture_output=True, text=True, env=self.env, **more)

    @staticmethod
    def until(condition, seconds):
        limit = time.monotonic() + seconds
        while not condition() and time.monotonic() < limit:
            time.sleep(0.2)
        return condition()

    def number(self, said):
        return (re.search(r"Submitted batch job (\d+)", said.stdout) or [None, None])[1]

    def ended(self, number, seconds=90):
        return self.until(lambda: re.search(r"JobState=(COMPLETED|FAILED|CANCELLED|TIMEOUT|NODE_FAIL)", self.run("scontrol", "show", "job", number).stdout), seconds)

    def close(self):
        for process in reversed(self.processes):
            process.terminate()
        for process in self.processes:
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()


def same(folder, what):
    compared = call(bin_, "compare", folder / "local", folder / "a/out")
    check(f"{what}: the results of the same run without Slurm, bit for bit", compared.returncode == 0, compared.stdout[-300:] + compared.stderr)


def a_job(slurm, folder, case):
    said = slurm.run(COUPLET, "run", case, "--bin", bin_, f"--slurm=--output={folder}/said --time=5")
    check("couplet run --slurm hands it over", said.returncode == 0 and slurm.number(said), said.stdout + said.stderr)
    state = slurm.ended(slurm.number(said))
    text = (folder / "said").read_text() if (folder / "said").exists() else ""
    check("it comes to its end, told by the last line", state and state[1] == "COMPLETED" and "done in" in text, text[-400:])
    same(folder, "couplet run --slurm")


def by_hand(slurm, folder, case):
    """Runs the lines of docs/how-to/cluster.md."""
    shutil.rmtree(folder / "a/out")
    script = "#!/bin/bash\n#SBATCH --job-name=flap --ntasks=4 --time=00:05:00\ncase=$SLURM_SUBMIT_DIR/case.yaml\nmpirun --oversubscribe -n 4 couplet-exec $case\n"
    said = slurm.run("sbatch", f"--output={folder}/hand", input=script, cwd=case.parent)
    state = slurm.ended(slurm.number(said))
    check("the batch script of the page", state and state[1] == "COMPLETED", ((folder / "hand").read_text() if (folder / "hand").exists() else said.stderr)[-400:])
    same(folder, "mpirun in a batch job")
    shutil.rmtree(folder / "a/out")
    said = slurm.run("srun", "--mpi=pmix", "--ntasks=4", "couplet-exec", "case.yaml", cwd=case.parent, timeout=120)
    check("the srun line of the page", said.returncode == 0, said.stdout[-300:] + said.stderr[-500:])
    if said.returncode == 0:
        same(folder, "srun")


def cancelled(slurm, folder, case):
    """scancel asks couplet run, which saves; resume goes on."""
    for words in (["--batch", "--signal=TERM"], []):
        shutil.rmtree(folder / "a/out", ignore_errors=True)
        said = slurm.run(COUPLET, "run", case, "--bin", bin_, f"--slurm=--output={folder}/said")
        steps = folder / "a/out/solid/steps.csv"
        check("it steps", slurm.until(lambda: steps.exists() and len(steps.read_text().splitlines()) > 12, 60), said.stderr)
        slurm.run("scancel", *words, slurm.number(said))
        check(f"scancel {' '.join(words)}: the job ends", slurm.ended(slurm.number(said), 40), slurm.run("scontrol", "show", "job", slurm.number(said)).stdout)
        slurm.until(lambda: call(bin_, "watch", folder / "a/out", "--once").returncode == 0 and not [p for p in pathlib.Path("/proc").glob("[0-9]*/cmdline")
                    if (bytes_of(p)).startswith(str(bin_).encode()) and str(folder).encode() in bytes_of(p)], 20)
        resumed = call(bin_, "resume", folder / "a/out")
        check("couplet resume goes on", resumed.returncode == 0, resumed.stdout[-200:] + resumed.stderr[-300:])
        same(folder, "after scancel and resume")


def bytes_of(file):
    try:
        return file.read_bytes()
    except OSError:
        return b""


with tempfile.TemporaryDirectory(prefix="couplet-slurm-") as scratch:
    folder = pathlib.Path(scratch)
    folder.chmod(0o755)
    case = case_in(folder / "a", bin_, end_time=1, checkpoints=0.1)
    check("without Slurm", call(bin_, "run", case, "-q", "--set", f"simulation.output.folder={folder / 'local'}").returncode == 0)
    slurm = Slurm(folder / "slurm")
    try:
        check("a Slurm of one node is there", slurm.ready, slurm.run("sinfo").stdout + "".join((folder / f"slurm/{n}.log").read_text()[-800:] for n in ("ctld", "d") if (folder / f"slurm/{n}.log").exists()))
        if slurm.ready:
            a_job(slurm, folder, case)
            by_hand(slurm, folder, case)
            cancelled(slurm, folder, case)
    finally:
        slurm.close()
end()
