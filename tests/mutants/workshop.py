# SPDX-License-Identifier: Apache-2.0
"""Compiles broken files, links test executables and programs with them before the libraries, and runs registered tests so."""
import dataclasses
import functools
import json
import os
import pathlib
import resource
import shlex
import signal
import subprocess
import time


def text_of(*command, **options):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=True, **options).stdout


@dataclasses.dataclass
class Outcome:
    failed: bool
    seconds: float  # of processor time
    text: str
    stopped: bool = False  # it went on for longer than it may


class Workshop:
    """A configured build, of which nothing is changed."""

    def __init__(self, root, build):
        self.root, self.build = root, build

    @functools.cached_property
    def _compiling(self):
        lines = text_of("ninja", "-C", self.build, "-t", "commands").splitlines()
        return {line.rsplit(" -c ", 1)[1]: line for line in lines if " -c " in line}

    def _command(self, file):
        """How the build compiles a file, which it must do by itself: in a batch the broken object would stand beside the sound one."""
        command = self._compiling.get(str(self.root / file))
        if command is None:
            raise SystemExit(f"{self.build} compiles {file} in a batch with others; mutants need a build of single objects: "
                             "make one by the preset single")
        return shlex.split(command)

    @functools.cached_property
    def registered(self):
        return {t["name"]: t for t in json.loads(text_of("ctest", "--test-dir", self.build, "--show-only=json-v1"))["tests"]
                if "command" in t}  # one that is not built has none

    @functools.lru_cache(maxsize=None)
    def _linking(self, target):
        words = shlex.split(text_of("ninja", "-C", self.build, "-t", "commands", target).splitlines()[-1])
        return [w for w in words if w not in (":", "&&")]

    @functools.lru_cache(maxsize=None)
    def sound(self, target):
        words = self._linking(target)
        return (self.build / words[words.index("-o") + 1]).resolve()

    @functools.cached_property
    def programs(self):
        return sorted(p.name for p in (self.build / "bin").iterdir() if os.access(p, os.X_OK) and p.is_file())

    # -- making -------------------------------------------------------------------------------------------------------
    def compiled(self, file, text, folder):
        """The object of another text of a file, by the command that the build has for the sound one; raises where it does not compile."""
        source = self.root / file
        broken, made = folder / source.name, folder / (source.name + ".o")
        broken.write_text(text)
        words = [w for w in self._command(file) if not w.endswith("ccache")]
        words[words.index("-o") + 1], words[words.index("-c") + 1] = str(made), str(broken)
        for option in ("-MT", "-MF"):  # the build's own record of what depends on what stays as it is
            place = words.index(option)
            del words[place:place + 2]
        words.remove("-MD")
        text_of(*words, "-iquote", source.parent, cwd=self.build)
        return made

    def linked(self, target, made, folder):
        """A test or program with broken objects before the libraries: their sound ones are then not asked for."""
        words = list(self._linking(target))
        result = folder / target
        words[words.index("-o") + 1] = str(result)
        first = next(k for k, w in enumerate(words) if w.endswith(".a"))
        words[first:first] = [str(m) for m in made]
        text_of(*words, cwd=self.build)
        return result

    def holds(self, target, file):
        """Whether a test or program has the object of a file, by the library that it is in."""
        words = self._command(file)
        library = pathlib.PurePath(words[words.index("-o") + 1]).parts
        name = library[library.index("CMakeFiles") + 1].removesuffix(".dir")
        return any(pathlib.PurePath(w).name == f"lib{name}.a" for w in self._linking(target))

    # -- running ------------------------------------------------------------------------------------------------------
    def target_of(self, test):
        """The test executable that a registered test calls, or nothing for a script."""
        for word in self.registered[test]["command"]:
            path = pathlib.Path(word)
            if path.is_absolute() and path.is_file() and self.build / "tests" in path.parents and os.access(path, os.X_OK):
                return path.name
        return None

    def broken_command(self, test, made, folder, files, only=""):
        """The command of a registered test that calls what was linked with the broken objects. None where it calls nothing of the build."""
        command = list(self.registered[test]["command"])
        if only:
            command = [*(w for w in command if not w.startswith("--gtest_filter")), f"--gtest_filter={only}"]
        target = self.target_of(test)
        if target:
            sound, broken = self.sound(target), str(self.linked(target, made, folder)) if made else str(self.sound(target))
            return [broken if "/" in w and pathlib.Path(w).resolve() == sound else w for w in command]
        if not made:
            return command
        place, mirror = self.build / "bin", folder / "build" / "bin"
        mirror.mkdir(parents=True, exist_ok=True)
        for program in self.programs:
            if not (mirror / program).exists() and any(self.holds(program, file) for file in files):
                broken = self.linked(program, made, folder)
                broken.rename(mirror / program)
        for entry in place.iterdir():
            if not (mirror / entry.name).exists():
                (mirror / entry.name).symlink_to(entry)
        for entry in self.build.iterdir():
            if not (folder / "build" / entry.name).exists():
                (folder / "build" / entry.name).symlink_to(entry)
        put = [w.replace(str(place), str(mirror)) for w in command]
        put = [str(folder / "build") if w == str(self.build) else w for w in put]
        return put if put != command else None

    def run(self, test, command, most, **more):
        """One test, at most so many seconds of processor time (by all its processes together: three times that on the clock of an idle machine)."""
        entry = self.registered[test]
        settings = {p["name"]: p["value"] for p in entry.get("properties", [])}
        more = {**dict(pair.split("=", 1) for pair in settings.get("ENVIRONMENT", [])), "GTEST_FAIL_FAST": "1", **more}
        before = time.monotonic()
        with subprocess.Popen(command, cwd=settings.get("WORKING_DIRECTORY", str(self.build)), env={**os.environ, **more},
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(most) + 1, int(most) + 2))) as process:
            return self._watched(process, before, most)

    @staticmethod
    def _watched(process, before, most):
        import threading
        parts = []
        reader = threading.Thread(target=lambda: parts.append(process.stdout.read()))
        reader.start()
        stopped = False
        while True:
            pid, status, used = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() - before > 8 * most + 20:
                stopped = True
                os.killpg(process.pid, signal.SIGKILL)
                _, status, used = os.wait4(process.pid, 0)
                break
            time.sleep(0.02)
        process.returncode = os.waitstatus_to_exitcode(status)
        try:
            os.killpg(process.pid, signal.SIGKILL)  # what a broken program has left behind
        except ProcessLookupError:
            pass
        reader.join(10)
        text = (parts[0] if parts else b"").decode(errors="replace")
        seconds = used.ru_utime + used.ru_stime
        return Outcome(process.returncode != 0, seconds, text, stopped or seconds >= most)
