# SPDX-License-Identifier: Apache-2.0
"""preCICE's own integration tests, unchanged, on this project's library. COUPLET_PRECICE_SOURCES names a checkout of
preCICE 3.4; Boost.Test and Eigen are needed. Each test is compiled against the library's headers, imported by its
configuration and run beside the coupler. Counted are the tests that use only the public interface. A test that compiles
only with preCICE's own classes does not count."""
import collections
import concurrent.futures
import os
import pathlib
import re
import shlex
import subprocess

from validation.parts.precice.programs import NOTE, commit_of, folder

FORWARDED = """action/RecorderAction io/TXTTableWriter logging/LogMacros logging/Logger mesh/Data mesh/Mesh mesh/SharedPointer mesh/Utils mesh/Vertex
precice/Participant precice/impl/MeshContext precice/impl/ParticipantImpl precice/impl/ParticipantState precice/impl/SharedPointer precice/impl/Types
testing/TestContext testing/Testing utils/IntraComm utils/assertion""".split()
HERE = (
    pathlib.Path(__file__).resolve().parents[4] / "tests/coupling/precice"
)  # with what stands for preCICE's own testing headers


def compiled(job, source, where, refused):
    """The executable of all tests that compile, and the files that do not. `refused`: whose configurations the import
    refuses."""
    for name in FORWARDED:
        header = where / f"headers/{name}.hpp"
        header.parent.mkdir(parents=True, exist_ok=True)
        header.write_text('#include "integration.hpp"\n')
    (where / "all.hpp").write_text(
        '#include "integration.hpp"\n#include "math/math.hpp"\n#include "testing/QuickTest.hpp"\n'
    )
    mpi = shlex.split(job.run(["mpicc", "--showme:compile"], check=True).stdout)
    places = [
        where / "headers",
        HERE,
        job.root / "client/precice/include",
        source / "src",
        source / "tests",
        "/usr/include/eigen3",
    ]
    words = [
        "g++",
        "-std=c++17",
        "-O0",
        "-w",
        "-DOMPI_SKIP_MPICXX",
        "-DBOOST_TEST_DYN_LINK",
        "-DBOOST_TEST_NO_MAIN",
        *(f"-I{p}" for p in places),
        *mpi,
    ]
    job.run([*words, "-x", "c++-header", where / "all.hpp", "-o", where / "all.hpp.gch"], check=True)
    files = [
        *(
            f
            for f in sorted((source / "tests").rglob("*.cpp"))
            if not refused & {f.with_suffix(""), f.with_name(f"{f.stem}-A")}
        ),
        HERE / "integration.cpp",
    ]
    objects = [where / f"{n}.o" for n in range(len(files))]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        made = list(
            pool.map(
                lambda pair: job.run([*words, "-include", where / "all.hpp", "-c", pair[0], "-o", pair[1]]).returncode
                == 0,
                zip(files, objects),
            )
        )
    good, out = {o for o, ok in zip(objects, made) if ok}, {f for f, ok in zip(files, made) if not ok}
    link = [
        "-o",
        where / "tests",
        f"-L{job.build / 'precice/lib'}",
        "-lprecice",
        f"-Wl,-rpath,{job.build / 'precice/lib'}",
        "-lboost_unit_test_framework",
        *shlex.split(job.run(["mpicc", "--showme:link"], check=True).stdout),
    ]
    done = job.run(["g++", *sorted(good), *link])
    needs = {
        where / name for name in re.findall(r"(\d+\.o): in function", done.stderr)
    }  # a helper that does not compile
    out |= {f for f, o in zip(files, objects) if o in needs}
    if needs:
        job.run(["g++", *sorted(good - needs), *link], check=True)
    return out


def starts(file):
    """Returns true if a test, or a helper that it calls, calls initialize()."""
    text = file.read_text()
    near = [p for folder in list(file.parents)[:3] for p in folder.glob("helper*.cpp")] if "helper" in text else []
    return "initialize(" in text.replace("BOOST_CHECK_THROW(p.initialize()", "") + "".join(p.read_text() for p in near)


def tried(job, where, full, people, case):
    """Runs a test beside the coupler; without a case, because it starts no coupling, each participant by itself. True:
    it passes."""
    where.mkdir(parents=True)
    launch = ["mpirun", "--oversubscribe", "--bind-to", "none", *(["--allow-run-as-root"] if os.geteuid() == 0 else [])]
    names = [(name, int(n)) for name, n in (p.split(":") for p in people)]
    job_of = lambda name, words: job.run(
        ["env", f"RESULTS={where / name}", *([f"TEST_ALONE={name}"] if name else []), *launch, *words],
        cwd=where,
        timeout=60,
    )  # noqa: E731
    try:
        if case is None:
            for name, n in names:
                (where / name).mkdir()
                job_of(name, ["-n", n, where.parent / "tests", f"--run_test={full}"])
            results, ended = [where / name / str(rank) for name, n in names for rank in range(n)], True
        else:
            n = sum(n for _, n in names)
            done = job_of(
                "",
                [
                    "-n",
                    "1",
                    job.build / "bin/coupler",
                    case,
                    ":",
                    "-n",
                    n,
                    where.parent / "tests",
                    f"--run_test={full}",
                ],
            )
            results, ended = [where / str(rank + 1) for rank in range(n)], done.returncode == 0
    except subprocess.TimeoutExpired:
        return False
    return ended and all(file.is_file() and file.read_text() == "0" for file in results)


def integration(job):
    source = folder("COUPLET_PRECICE_SOURCES")
    if source is None:
        return NOTE.format("COUPLET_PRECICE_SOURCES"), None
    where, refused, cases = job.scratch / "integration", {}, {}
    where.mkdir()
    job.environment |= {
        "COUPLET_PRECICE_LIBRARY": str(job.build / "precice/lib/libprecice.so.3"),
        "PRECICE_SOURCES": str(source),
    }
    for n, file in enumerate(sorted((source / "tests").rglob("*.xml"))):
        case = where / f"{n}.yaml"
        done = job.run([job.root / "scripts/couplet", "import", file, "-o", case])
        if done.returncode == 0:
            cases[file.with_suffix("")] = case
        else:
            refused[file.with_suffix("")] = done.returncode == 2 and str(file) in done.stderr
    inside = compiled(job, source, where, set(refused))
    verdicts = collections.defaultdict(list)
    for n, line in enumerate(job.run(["env", "LIST=1", where / "tests"], check=True).stdout.splitlines()):
        file, full, name, *people = line.split("\t")
        test = pathlib.Path(file).parent / name
        verdicts[test].append(
            tried(job, where / f"run-{n}", full, people, cases.get(test) if starts(pathlib.Path(file)) else None)
        )
    failed = sorted(str(test.relative_to(source / "tests")) for test, each in verdicts.items() if not all(each))
    return (
        (
            f"{len(verdicts) - len(failed)} of {len(verdicts)} pass; of {len(refused) + len(cases)} configurations"
            f" {len(refused)} are refused at import; {len(inside)} files use preCICE's own classes; fail:"
            f" {', '.join(failed)}{commit_of(source, job)}"
        ),
        len(verdicts) - len(failed) >= 160 and all(refused.values()),
    )
