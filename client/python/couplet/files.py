# SPDX-License-Identifier: Apache-2.0
"""The only place of the package that writes files (tests/architecture checks it). A case folder from elsewhere may hold
links to files of the user, and nothing is written through them: a file is written under a new name and then renamed.
The folder of each function is the one that the user or the case names. It may be a link, as for the programs; nothing
below it may be."""
import contextlib
import csv
import os
import pathlib
import secrets
import shutil

from couplet.runs.case import expect


def below(folder, name):
    """Path of `name` below a folder, in which nothing is a symbolic link."""
    place, parts = pathlib.Path(folder), pathlib.PurePath(name).parts
    expect(not pathlib.PurePath(name).is_absolute() and ".." not in parts, f"'{name}': expected a name inside {place}.")
    for word in parts:
        place /= word
        expect(
            not place.is_symlink(),
            (
                f"{place} is a symbolic link; nothing is written through symbolic links. Remove it, or choose another"
                " name."
            ),
        )
    return place


def folder(base, name):
    """Folder `name` below another. Creates it."""
    place = below(base, name)
    place.mkdir(parents=True, exist_ok=True)
    return place


@contextlib.contextmanager
def part(folder, name):
    """Yields the path of a new, empty file with the suffix of `name`, which becomes that file when all is written.
    Creates the folders in `name`."""
    file = below(folder, name)
    expect(not file.exists() or file.is_file(), f"{file} is not a file; choose another name.")
    if file.parent != pathlib.Path(folder):
        file.parent.mkdir(parents=True, exist_ok=True)
    made = file.with_name(f".{secrets.token_hex(6)}{file.suffix}")
    try:
        os.close(os.open(made, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666))
    except OSError as error:
        error.filename = str(file)
        raise
    try:
        yield made
        os.replace(made, file)
    finally:
        made.unlink(missing_ok=True)


def write(folder, name, content):
    """Writes text or bytes. Returns the path."""
    with part(folder, name) as made:
        made.write_bytes(content if isinstance(content, bytes) else content.encode())
    return pathlib.Path(folder) / name


def write_rows(folder, name, rows):
    """Writes a table as CSV."""
    with part(folder, name) as made, open(made, "w", newline="") as out:
        csv.writer(out).writerows(rows)


def copy(source, folder, name=None):
    with part(folder, name or pathlib.Path(source).name) as made:
        shutil.copy(source, made)


def in_place(folder, name):
    """Opens a file that others read or lock while it is written: a log, a lock."""
    file = below(folder, name)
    file.parent.mkdir(parents=True, exist_ok=True)
    return os.fdopen(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666), "w")
