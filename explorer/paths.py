"""Files that users name: paths, what may be read, and what is written."""

import errno
import os
import re
import shlex
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from explorer.errors import InputError, RunError, said, shown

# How pages of nearflat begin, in Markdown and in HTML
_MADE = re.compile(rb"(?:# .*\s+Made by `|<!doctype html>[^{]*<meta name=.generator. content=.)nearflat( gal)?")


def path_of(name: str, value: Any) -> Path:
    """Read a path: text that is not empty, or a Path; ~ at its beginning is a home folder. Raises InputError."""
    if not isinstance(value, str | os.PathLike) or not (text := os.fspath(value)) or "\0" in str(text):
        raise InputError(f"{said(name, value)} is no path; give text or a Path")
    try:
        str(text).encode()
    except UnicodeEncodeError:  # Arrow takes no other
        raise InputError(f"{said(name, value)}: is no UTF-8, as paths must be; give another") from None
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
    except (ValueError, RecursionError) as error:
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


def require_own(named: str, path: Path) -> None:
    """Raise InputError where a page would be written over what nearflat has not made, also if only among it.

    path: of the page, or of its folder.
    """
    page = path / "README.md" if path.is_dir() else path
    made = _MADE.match(page.read_bytes()) if page.is_file() else None
    own = made and not (path.is_dir() and made[1])  # what a gallery lists may be anybody's
    if not own and (any(path.iterdir()) if path.is_dir() else path.exists()):
        raise InputError(f"{named}: holds what nearflat has not made; give another name")


def own_folder(name: str, folder: Path) -> Path:
    """Make a folder for a page and its pictures, or take one that has such a page. Raises InputError."""
    require_own(f"{name} {folder}", folder)
    page = made_folder(name, folder) / "README.md"
    if not page.exists():  # so that a command that is stopped may be given again
        page.write_text("# Not finished\n\nMade by `nearflat`.\n", encoding="utf-8")
    return folder


def command_line(name: str, folder: Path | None, *more: str) -> str:
    """A command about a folder, as it can be typed or pasted."""
    return shlex.join(["nearflat", name, f"./{folder}" if str(folder)[0] == "-" else str(folder), *more])


@contextmanager
def on_disk(path: Path) -> Iterator[None]:
    """Say of a file, or of what is in a folder, that the system does not take it. Raises RunError."""
    try:
        yield
    except OSError as error:
        at, fault = (path.is_dir() and error.filename) or path, error.strerror or error
        raise RunError(f"{at}: cannot be written ({fault}); what is finished is kept; resume the run") from error


@contextmanager
def writing_page(name: str, value: Any) -> Iterator[Path]:
    """Read the path of a web page that is written within this context.

    Parameters
    ----------
    name, value
        The argument, and what the user gave: text or a Path.

    Raises
    ------
    InputError
        For what is no path, a name that is none of a web page, a folder that is not there, a file that the system
        does not take, and one that is there and that nearflat has not made.
    """
    path = path_of(name, value)
    named = f"{name} = {shown(str(path))}"
    if path.suffix.lower() not in (".html", ".htm"):
        raise InputError(f"{named}: the page is HTML; give a name that ends in .html or .htm")
    if not path.parent.is_dir():
        raise InputError(f"{named}: there is no folder {shown(str(path.parent))}; make it first")
    try:
        require_own(named, path)
        yield path
    except OSError as error:
        raise InputError(f"{named}: cannot be written ({error.strerror or error})") from None
