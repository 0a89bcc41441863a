"""Files that users name: paths, what may be read, and what is written."""

import errno
import os
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from explorer.errors import InputError, said, shown


def path_of(name: str, value: Any) -> Path:
    """Read a path: text that is not empty, or a Path; ~ at its beginning is a home folder. Raises InputError."""
    if not isinstance(value, str | os.PathLike) or not (text := os.fspath(value)) or "\0" in str(text):
        raise InputError(f"{said(name, value)} is no path; give text or a Path")
    path = Path(value)
    if not str(path).startswith("~"):
        return path
    if not str(text).startswith("~"):  # ./~name, of which Path drops ./
        return path.absolute()
    try:
        return path.expanduser()
    except RuntimeError:
        raise InputError(f"{said(name, value)}: there is no such home folder; give the path in full") from None


def read_toml(path: Path, option: str) -> dict[str, Any]:
    """The content of a TOML file. Raises InputError naming the option and the file."""
    path = path_of(option, path)
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{option} {path}: cannot be read ({error.strerror}); check the path") from None
    except ValueError as error:
        raise InputError(f"{option} {path}: not valid TOML ({error}); correct the file") from None


def made_folder(name: str, folder: Path) -> Path:
    """Make a folder, before anything is computed for it. Raises InputError where it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    except OSError as error:
        raise InputError(f"{name} {folder}: cannot be written ({error.strerror}); give another") from None
    return folder


@contextmanager
def writing(name: str, value: Any, endings: tuple[str, ...], what: str = "") -> Iterator[Path]:
    """Read the path of a file that is written within this context.

    Parameters
    ----------
    name, value
        The argument, and what the user gave: text or a Path.
    endings : tuple of str
        One of which the name must have, in small or capital letters.
    what : str
        What the file is, where the endings do not say it.

    Raises
    ------
    InputError
        For what is no path, another ending, a folder that is not there, and a file that the system does not take.
    """
    path = path_of(name, value)
    named = f"{name} = {shown(str(path))}"
    if path.suffix.lower() not in endings:
        *others, last = endings
        choice = f"{', '.join(others)} or {last}" if others else last
        raise InputError(f"{named}: {what}give a name that ends in {choice}")
    if not path.parent.is_dir():
        raise InputError(f"{named}: there is no folder {shown(str(path.parent))}; make it first")
    try:
        yield path
    except OSError as error:
        raise InputError(f"{named}: cannot be written ({error.strerror or error})") from None
