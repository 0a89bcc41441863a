"""All pictures by name: `ex.picture` and `ex.pictures`."""

from collections.abc import Callable, Iterator
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from explorer.errors import one_of
from explorer.phase.portrait import Portrait
from explorer.pictures.register import PICTURES, Picture, Question

for _path in sorted(Path(__file__).parent.glob("[a-z]*.py")):
    import_module(f"{__package__}.{_path.stem}")  # each file registers its pictures


class Pictures(dict[str, Picture]):
    """All pictures by name. If you print it, they are grouped by the question that they answer.

    Each is a `Picture`, which says what it takes and what is seen on it, and can be called itself.

    Examples
    --------
    >>> import explorer as ex
    >>> print(repr(ex.pictures).splitlines()[0])
    What happens?
    >>> figure = ex.pictures["rotation"](ex.Disk.uniform(), points=20)
    """

    def __repr__(self) -> str:
        lines = []
        for question in Question:
            names = [name for name, each in self.items() if each.caption.question is question]
            lines += [str(question), *(f"  {name}{self[name].signature}" for name in names)] if names else []
        return "\n".join(lines)


pictures = Pictures(PICTURES)


def picture(name: str, *what: Any, ax: Axes | Figure | SubFigure | None = None, **numbers: Any) -> Figure:
    """Draw a picture of a disk, of a run or of a result.

    Parameters
    ----------
    name : str
        One of `explorer.pictures`, which says what each takes and shows.
    *what
        What is drawn: a disk, the summary of a run, or what a public function returned.
    ax : Axes, Figure or SubFigure, optional
        Where to draw; by default on a new figure. Pictures of several axes take a figure or a part of one.
    **numbers
        Keywords of the picture, in the units of the disk.

    Returns
    -------
    Figure
        The figure is not shown by itself: save it with its `savefig`, or make it the last line of a notebook cell.

    Raises
    ------
    InputError
        For an unknown name, and for keywords that the picture does not take.

    Examples
    --------
    >>> import explorer as ex
    >>> figure = ex.picture("rotation", ex.Disk.uniform(), energy=3.0, points=20)
    >>> figure.axes[0].get_title()
    'Turns jump where the disk comes flat ($E$ = 3 $mgr$)'
    """
    return pictures[one_of("picture", name, pictures)](*what, ax=ax, **numbers)


def portraits_of(group: str, asked: Portrait) -> Iterator[tuple[str, Callable[..., Figure]]]:
    """The pictures of a group by the names of their files; asked: what they are drawn of."""
    for each in [each for each in pictures.values() if each.group == group]:
        for name, what in each.portraits(asked):
            yield name, partial(each, *what)
