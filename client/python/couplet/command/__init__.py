# SPDX-License-Identifier: Apache-2.0
"""The command `couplet`: one module for each of its subcommands, with `declare(parser)` and `run(arguments)` -> exit
code; what they declare is help, man page and completion alike."""
import argparse
import importlib
import os
import signal
import sys

# name: (module, one line)
SUBCOMMANDS = {
    "run": ("command.run", "runs all programs of a case"),
    "exec": ("command.exec", "turns each process of your own launcher into a program of a case"),
    "resume": ("command.resume", "continues a stopped run"),
    "stop": ("command.stop", "stops a run after the current step and writes a checkpoint"),
    "watch": ("command.watch", "shows the progress of a run"),
    "report": ("command.report", "shows results, errors, warnings and costs of a finished run"),
    "check": ("command.check", "reports all errors of a case without running it"),
    "explain": ("command.explain", "lists what a case computes and neglects, and its expected cost"),
    "new": ("command.new", "creates a case of your own from an example"),
    "import": ("command.import_case", "creates a case from a CalculiX or Abaqus deck, or from a preCICE configuration"),
    "gallery": ("command.gallery", "lists the example cases"),
    "docs": ("command.docs", "shows the documentation with search and a gallery of all cases"),
    "plot": ("plot", "plots the results of a run"),
    "compare": ("command.compare", "lists the differences between two runs"),
    "study": ("study.main", "runs the study of a case: variants, error against time, optimization"),
    "mesh": ("command.mesh", "writes and checks partitionable meshes for very large cases"),
    "export": ("command.export", "writes results for VTK and meshio, or a case for CalculiX or OpenFOAM"),
    "weather": ("command.weather", "converts a weather file to the CSV that a tank reads"),
    "validate": ("command.validate", "runs the acceptance tests of the project (in a checkout)"),
    "doctor": ("command.doctor", "checks whether this machine can run coupled cases"),
}
GUIDE = (
    "couplet COMMAND --help describes each command. Exit codes, the same as those of the programs: 0 finished, 1"
    " failed, 2 invalid case or command, 3 stopped with a checkpoint, 4 finished, but the result is not usable."
)


def module_of(name):
    return importlib.import_module("couplet." + SUBCOMMANDS[name][0])


def parser_of(name):
    module = module_of(name)
    parser = argparse.ArgumentParser(
        prog=f"couplet {name}",
        description=module.__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    module.declare(parser)
    return parser


def whole(words, parser):
    """Words in which an option whose value may be left out has it behind an equals sign, since it would take the next
    word for it, such as the case in `--strict CASE`."""
    optional = {o for action in parser._actions if action.nargs == "?" for o in action.option_strings}
    return [f"{word}=" if word in optional else word for word in words]


def version():
    from couplet.places import BY_PIP, IN_CHECKOUT, PACKAGE, ROOT
    import re

    if BY_PIP:
        from importlib import metadata

        return metadata.version("couplet")
    if IN_CHECKOUT:
        return re.search(r"project\(couplet VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    return (PACKAGE / "VERSION").read_text().strip()


def overview():
    width = max(map(len, SUBCOMMANDS))
    lines = [f"  {name:{width}}  {text}" for name, (_, text) in SUBCOMMANDS.items()]
    return "\n".join(["usage: couplet COMMAND ...", "", *lines, "", GUIDE])


def dispatch(name, words):
    prog = f"couplet {name}"
    raw = name == "validate" and words[:1] not in (["-h"], ["--help"])  # its arguments are those of scripts/validate
    parser = None if raw else parser_of(name)
    arguments = argparse.Namespace(words=words) if raw else parser.parse_args(whole(words, parser))
    from couplet.runs.case import Wrong, yaml

    try:
        return module_of(name).run(arguments)
    except (Wrong, yaml.YAMLError, UnicodeDecodeError) as error:
        print(f"{prog}: {error}", file=sys.stderr)
        return 2
    except OSError as error:  # e.g. a read-only folder or a full disk
        if isinstance(error, BrokenPipeError):  # e.g. `| head` has read enough
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            return 0
        print(
            f"{prog}: " + ": ".join(str(part) for part in (error.filename, error.strerror or error) if part),
            file=sys.stderr,
        )
        return 1
    except KeyboardInterrupt:
        print(f"{prog}: interrupted" + ("; start it again to continue" if name == "study" else ""), file=sys.stderr)
        return 128 + signal.SIGINT


def main(argv=None):
    """Runs `argv`, the command line starting with `couplet` (default: sys.argv)."""
    words = (argv or sys.argv)[1:]
    if not words or words[0] in ("-h", "--help", "help"):
        print(overview())
        return 0
    if words[0] == "--version":
        print("couplet", version())
        return 0
    if words[0] not in SUBCOMMANDS:
        import difflib

        near = difflib.get_close_matches(words[0], SUBCOMMANDS, 1)
        print(
            f"couplet: there is no command '{words[0]}'"
            + (f"; did you mean '{near[0]}'?" if near else f"; there is: {', '.join(SUBCOMMANDS)}"),
            file=sys.stderr,
        )
        return 2
    return dispatch(words[0], words[1:])
