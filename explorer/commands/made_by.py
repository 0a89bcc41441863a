"""made_by.json: which command made a folder of results, and each picture in it."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from explorer.errors import InputError, RunError
from explorer.runs import store
from explorer.runs.folder import read_record

FILE = "made_by.json"
UNKNOWN = "not known"


def leave_made_by(folder: Path, command: str, pictures: Mapping[str, str] | None = None) -> None:
    """Write made_by.json into a folder.

    pictures: commands that make one picture alone, by the picture's file name. Raises RunError where it cannot be
    written.
    """
    store.write_json(folder / FILE, {"made_by": command, "pictures": dict(pictures or {})})


def leave_page(
    folder: Path,
    lines: Iterable[str],
    command: str,
    pictures: Mapping[str, str] | None = None,
    name: str = "README.md",
) -> None:
    """Write a page into a folder, with what made both."""
    (folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    leave_made_by(folder, command, pictures)


def command_of(folder: Path, picture: str | None = None) -> str:
    """The command that made a folder, or a picture in it; UNKNOWN where nothing in the folder says it."""
    try:
        if (folder / FILE).is_file():
            content = store.read_json(folder / FILE)
            return str(content["pictures"].get(picture, content["made_by"]))
        record = read_record(folder)
        scene = record["options"].get("scene")
        return str(record.get("command") or f"ex.run({scene!r}, ...), with the options in run.json")
    except (InputError, RunError, KeyError, TypeError, AttributeError):
        return UNKNOWN
