"""The pictures of a run: one of them on a user's axes, all of them in its folder."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from explorer.errors import InputError, one_of
from explorer.scenes.scene import Picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw(pictures: Mapping[str, Picture], name: str, options: dict[str, Any]) -> "Figure":
    """The picture of that name. Raises InputError where there is none, or where it takes no such keywords."""
    from explorer.plot import figure_of

    picture = pictures[one_of("figure", name, pictures)]
    try:
        return figure_of(picture(**options))
    except (TypeError, AttributeError) as error:  # the latter is matplotlib's answer to an unknown keyword
        if not options:
            raise
        raise InputError(f"figure = {name!r} cannot be drawn with {', '.join(options)} ({error})") from None


def draw_missing(
    pictures: Mapping[str, Picture], folder: Path, formats: Sequence[str], stopped: Callable[[], bool]
) -> bool:
    """Draw the pictures whose files are not there; whether all are, since none is begun once stopped."""
    from explorer.plot.captions import write_figure

    folder.mkdir(exist_ok=True)
    for name in pictures:
        missing = [path for kind in formats if not (path := folder / f"{name}.{kind}").is_file()]
        if not missing:
            continue
        if stopped():
            return False
        figure = draw(pictures, name, {})
        for path in missing:
            write_figure(figure, begun := path.with_name(f".{path.name}"))
            begun.replace(path)
            # Parts stay where the first file has them: to place them is half the work. With a layout engine of any
            # kind, also "none", matplotlib would draw twice, once to let it place parts.
            figure.set_layout_engine(None)
    return True
