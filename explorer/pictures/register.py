"""The register of pictures: each is one function, marked with the question that it answers and its caption.

    @picture(Question.WHERE_TO, "What is seen, in whole sentences.", group="rotation")
    def rotation(ax, disk, energy=2.0): ...

The function draws on what its first parameter names, `ax` or, where a picture has several axes, `figure`.
Marked, it is a `Picture`: `rotation(disk, energy=3.0)` draws on a new figure. `ex.pictures`, `nearflat
portrait`, the scenes and the captions in files all take it from here.
"""

import inspect
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias
from weakref import WeakKeyDictionary

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure, SubFigure
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from explorer.errors import InputError, shown
from explorer.paths import on_disk
from explorer.phase.disk import require_axial_inertia
from explorer.phase.portrait import Portrait
from explorer.pictures.style import SIZE

DPI = 150
Portraits: TypeAlias = Callable[[Portrait], Iterable[tuple[str, tuple[Any, ...]]]]


class Question(StrEnum):
    """What pictures answer, in the order of a gallery."""

    HAPPENS = "What happens?"
    FROM_WHERE = "From where does the disk fall?"
    HOW_RARELY = "How rarely does it nearly fall?"
    EACH_SIDE = "What is the limit from each side?"
    HOW_FAR = "How far does the contact point race?"
    WHICH_MOTIONS = "Which motions are there?"
    WHERE_TO = "Where does the disk go in the long run?"
    PAPER = "What do the figures of the paper show?"
    HOW_GOOD = "How accurate is it, and how fast?"


class Caption(NamedTuple):
    """Which question a picture answers, and what is seen on it, in whole sentences."""

    question: Question
    text: str


@dataclass(frozen=True)
class Picture:
    """A picture of the register: called with what it shows, it draws it and returns the figure.

    Attributes
    ----------
    name : str
        As `explorer.picture` takes it.
    caption : Caption
        The question that it answers, and the text that says what is seen.
    draw : callable
        The function itself, which takes the Axes first, or the Figure where there are several.
    size : (float, float)
        Of a figure of its own, in inches.
    group : str or None
        With which others `nearflat portrait` draws it; None where it does not.
    portraits : callable
        What is drawn then: names of files, each with what the picture takes, for a `Portrait`.

    Examples
    --------
    >>> import explorer as ex
    >>> str(ex.pictures["rotation"].caption.question)
    'Where does the disk go in the long run?'
    """

    name: str
    caption: Caption
    draw: Callable[..., None]
    size: tuple[float, float]
    group: str | None
    portraits: Portraits

    def __repr__(self) -> str:
        return f"{self.name}{self.signature}: {inspect.getdoc(self.draw)}\n{self.caption.text}"

    @cached_property
    def signature(self) -> inspect.Signature:
        """What it takes after the axes."""
        _, *others = inspect.signature(self.draw).parameters.values()
        return inspect.Signature([each.replace(annotation=each.empty) for each in others])

    @cached_property
    def has_panels(self) -> bool:
        """Whether it has several axes, and so draws on a figure."""
        return next(iter(inspect.signature(self.draw).parameters)) == "figure"

    def __call__(self, *what: Any, ax: Axes | Figure | SubFigure | None = None, **numbers: Any) -> Figure:
        """Draw it; `explorer.picture` says how. Raises InputError."""
        try:
            given = self.signature.bind(*what, **numbers).arguments
        except TypeError as error:
            raise InputError(
                f"picture {self.name}: {error}; it takes {', '.join(self.signature.parameters)}"
            ) from None
        for name, value in given.items():
            kind = inspect.signature(self.draw).parameters[name].annotation
            if inspect.isclass(kind) and kind.__module__.startswith("explorer.") and not isinstance(value, kind):
                raise InputError(f"picture {self.name}: {name} = {shown(value)} is no {kind.__name__}; give one")
        if "disk" in given:
            require_axial_inertia(given["disk"])
        if ax is None:
            ax = ShownFigure(figsize=self.size, layout="constrained")
        if self.has_panels and isinstance(ax, Axes):
            raise InputError(f"picture {self.name}: has several axes; give a Figure or a part of one as ax")
        self.draw(ax if self.has_panels or isinstance(ax, Axes) else ax.subplots(), *what, **numbers)
        figure = whole_figure(ax)
        add_caption(figure, self.caption)
        return figure


class ShownFigure(Figure):
    """A figure that a notebook shows where it is the last value of a cell, without pyplot."""

    def _repr_png_(self) -> bytes:
        written = BytesIO()
        FigureCanvasAgg(self).print_png(written)
        return written.getvalue()


PICTURES: dict[str, Picture] = {}  # by name, of the files that are loaded


def picture(
    question: Question,
    text: str,
    size: tuple[float, float] = SIZE,
    group: str | None = None,
    portraits: Portraits | None = None,
) -> Callable[[Callable[..., None]], Picture]:
    """Make a function a picture, whose name is that of the function, with hyphens.

    group: of `nearflat portrait`, which draws it of the disk unless `portraits` says of what.
    """

    def mark(draw: Callable[..., None]) -> Picture:
        name = draw.__name__.replace("_", "-")
        of_disk: Portraits = portraits or (lambda asked: [(name, (asked.disk,))])
        PICTURES[name] = made = Picture(name, Caption(question, text), draw, size, group, of_disk)
        return made

    return mark


# Captions of figures, and in files

_on_figures: WeakKeyDictionary[Figure, list[Caption]] = WeakKeyDictionary()


def whole_figure(drawn: Axes | Figure | SubFigure) -> Figure:
    """The figure that Axes are on, also where they are in a part of it."""
    figure = drawn.figure.figure
    assert isinstance(figure, Figure)
    return figure


def add_caption(figure: Figure, caption: Caption) -> None:
    """Add a caption to those that a figure has, once."""
    there = _on_figures.setdefault(figure, [])
    if caption not in there:
        there.append(caption)


def caption_of(figure: Figure) -> Caption | None:
    """What a figure shows: the captions of all that was drawn on it, in order; None where there is none."""
    there = _on_figures.get(figure, [])
    return Caption(there[0].question, " ".join(each.text for each in there)) if there else None


def save(figure: Figure, path: Path, dpi: int = DPI) -> None:
    """Write a figure as .png, .svg or .pdf with its caption inside, where pages find it."""
    caption, kind = caption_of(figure), path.suffix.lower()
    metadata: dict[str, Any] = {"Date": None} if kind == ".svg" else {}  # the same picture is the same file
    if caption is not None:
        metadata["Subject" if kind == ".pdf" else "Description"] = "\n".join(caption)
    figure.draw_without_rendering()  # what room tick labels need is known only then
    with on_disk(path):
        figure.savefig(path, dpi=dpi, metadata=metadata)
        if kind == ".png" and not figure.findobj(QuadMesh):  # maps would have steps
            _use_palette(path)


def _use_palette(path: Path) -> None:
    """Give a PNG file a palette, which makes it a third: lines and grounds keep their colours."""
    about = PngInfo()
    with Image.open(path) as drawn:
        whole, dpi = drawn.convert("RGB"), drawn.info.get("dpi")
        if text := drawn.info.get("Description"):
            about.add_itxt("Description", text)
    whole.quantize().save(path, pnginfo=about, optimize=True, dpi=dpi)
