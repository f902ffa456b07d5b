# SPDX-License-Identifier: Apache-2.0
"""One reader per format: which source file may open files, part lines or turn texts into numbers, and what for. Tables, weather
and all other text data come in by common/csv alone; HDF5 by common/io (its header is seen nowhere else)."""
import re

# What opens a file to read, takes lines apart, decompresses, or makes a number of a text.
READING = (r"\bstd::(?:ifstream|fstream|filebuf|basic_ifstream|from_chars|getline|sto(?:d|f|ld|i|l|ll|ul|ull)|strto\w+|ato(?:f|i|l|ll)|sscanf|fopen)\b"
           r"|\bgetline\(|\bgz(?:open|dopen|read|gets)\w*\(|\binflate\w*\(|\bf(?:open|dopen|scanf|gets)\(|\bv?sscanf\(|\bato(?:f|i|l|ll)\("
           r"|\bstrto(?:d|f|ld|l|ul|ll|ull|imax|umax)\(|\bmmap\(|\bO_RD(?:ONLY|WR)\b|\bfrom_chars\(")

# Every file that does, each with its reason.
READERS = {
    "client/examples/spring_cylinder.cpp": "an example of a program of somebody else, which reads its own checkpoint",
    "client/address.cpp": "the client knows nothing of common: the one reader of a relay's file and of greetings",
    "client/relay/main.cpp": "the client knows nothing of common: the relay's command line",
    "client/socket_link.cpp": "the client knows nothing of common: seconds of COUPLET_JOIN_WAIT, the relay's answer",
    "client/transports.cpp": "the client knows nothing of common: the system's settings of MPI",
    "client/wire.cpp": "the client knows nothing of common: fields of messages",
    "client/within.cpp": "the client knows nothing of common: the share of a step in the name of a value",
    "client/precice/configuration.cpp": "the first lines of a case, which name the XML that it was made of",
    "client/precice/xml.cpp": "the client knows nothing of common: the one reader of preCICE's configuration in a program",
    "common/app/case/case_keys.cpp": "lines of keys.txt, which its set's digest covers; bytes of files for their digest",
    "common/coupling/within_step.cpp": "the share of a step in the name of a value, which a message holds",
    "common/app/watch/fault_injection.cpp": "an environment variable of the tests",
    "common/app/job.cpp": "the lock of an output folder",
    "common/app/case/questions.cpp": "indents text of its own",
    "common/app/case/roll_call.cpp": "fields of messages between programs",
    "common/app/run_report.cpp": "/proc/self/status",
    "common/app/watch/start_guard.cpp": "/proc: what the launcher has started",
    "common/app/watch/watch.cpp": "a file of its own shared between the processes of a job",
    "common/app/watch/watch_board.cpp": "a page of its own shared between the processes of a job; /proc",
    "common/base/own_file.cpp": "a file just written, to flush it",
    "common/base/units.cpp": "the one reader of quantities, such as '3 bar'",
    "common/config/document.cpp": "the one reader of YAML",
    "common/csv/byte_source.cpp": "the one reader of text data",
    "common/csv/byte_source.hpp": "the one reader of text data",
    "common/csv/cells.cpp": "the one reader of text data: numbers",
    "common/log/terminal.cpp": "/proc: whose terminal it is under mpirun",
    "common/io/checkpoint_set.cpp": "set.txt, whose digest is checked; bytes of files for their digest",
    "common/mesh/gmsh/geo_script.cpp": "the one reader of .geo",
    "common/mesh/gmsh/gmsh.cpp": "what gmsh has printed; bytes of a cached mesh for their digest",
    "common/mesh/gmsh/sandbox.cpp": "/dev/null for gmsh",
    "common/mesh/gmsh/mesh_geo.cpp": "a .msh that gmsh has just written",
    "common/mesh/msh/msh_cursor.cpp": "the one reader of .msh",
    "common/parallel/mpi_start.cpp": "settings of MPI and of the machine",
}


def check_readers(texts):
    """What reads without being in the list, and what is in the list and does not read. `texts`: (path, text) of sources."""
    trouble, seen = [], set()
    for path, text in texts:
        if path.suffix not in (".cpp", ".hpp") or path.parts[0] in ("tests", "benchmarks", "configs"):
            continue
        for number, line in enumerate(text.splitlines(), 1):
            match = re.search(READING, line.split("//")[0])
            if not match:
                continue
            seen.add(str(path))
            if str(path) not in READERS:
                trouble.append(f"{path}:{number}: {match.group().rstrip('(')}: a second reader? Text data are read by common/csv "
                               "(LineReader, CsvReader, number_of); what is another format stands in tests/architecture/readers.py with its reason")
    return trouble, [f"tests/architecture/readers.py: {name} reads nothing any more" for name in READERS if name not in seen]
