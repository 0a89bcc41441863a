"""The pictures of a run: which there are, one of them on a user's axes, all of them in its folder."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

from explorer.errors import InputError, shown, suggest
from explorer.runs.progress import Progress
from explorer.scenes.base import Picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = ("png", "svg")
KNOWN = ("png", "svg", "pdf")


def read_formats(flag: str, value: Any) -> tuple[str, ...]:
    """Read formats of pictures: "png,svg", or a list of names. Raises InputError."""
    names = [name.strip().lower() for name in value.split(",")] if isinstance(value, str) else value
    if not isinstance(names, list | tuple) or not names:
        raise InputError(f"{flag} {shown(value)} names no format; give some of {','.join(KNOWN)}")
    for name in names:
        if name not in KNOWN:
            raise InputError(f"{flag} {shown(name)} is no format of pictures; {suggest(name, KNOWN)}")
    return tuple(dict.fromkeys(names))


def draw(
    pictures: Iterable[tuple[str, Picture]], name: str, ax: "Axes | None", options: dict[str, Any]
) -> "Figure":
    """The picture of that name. Raises InputError where there is none, or where it takes no such keywords."""
    known: list[str] = []
    for each, picture in pictures:
        known.append(each)
        if each == name:
            return _drawn(picture, name, {**({} if ax is None else {"ax": ax}), **options})
    raise InputError(f"figure = {shown(name)} is no picture of this run; {suggest(name, known)}")


def _drawn(picture: Picture, name: str, options: dict[str, Any]) -> "Figure":
    from matplotlib.figure import Figure

    from explorer.plot import figure_of

    if isinstance(picture, Figure):
        if options:
            raise InputError(f"figure = {name!r}: is drawn as a whole; leave {' and '.join(options)} out")
        return picture
    try:
        return figure_of(picture(**options))
    except (TypeError, AttributeError) as error:  # the latter is matplotlib's answer to an unknown keyword
        if not options:
            raise
        raise InputError(f"figure = {name!r} cannot be drawn with {', '.join(options)} ({error})") from None


def save_all(
    pictures: Iterable[tuple[str, Picture]], folder: Path, formats: Sequence[str], progress: Progress
) -> list[str]:
    """Draw all pictures, one at a time, into files; returns their names."""
    from explorer.plot.captions import write_figure

    waiting = list(pictures)
    progress.expect(len(waiting))
    names = []
    for name, picture in waiting:
        progress.drawing(name)
        figure = _drawn(picture, name, {})
        for kind in formats:
            write_figure(figure, folder / f"{name}.{kind}")
            # Parts stay where the first file has them: to place them is half the work. With a layout engine of any
            # kind, also "none", matplotlib would draw twice, once to let it place parts.
            figure.set_layout_engine(None)
        progress.drawn()
        names.append(name)
    return names


def is_of_matplotlib(error: BaseException) -> bool:
    """Whether matplotlib raised it: of its settings, for instance, or of a program that these ask for."""
    places = [place.f_globals.get("__name__") for place, _ in walk_tb(error.__traceback__)]
    return str(places[-1] if places else None).partition(".")[0] == "matplotlib"


def there(folder: Path, names: Any, formats: Sequence[str]) -> list[str]:
    """The pictures that a record names, where all of them are in the folder, in these formats."""
    if not isinstance(names, list):
        return []
    files = files_of(names, formats)
    return names if all((folder / "figures" / file).is_file() for file in files) else []


def files_of(names: Iterable[str], formats: Sequence[str]) -> list[str]:
    """The names of the files in which pictures of these names are."""
    return [f"{name}.{kind}" for name in names for kind in formats]
