"""What each picture shows, said once: beside its function, and from there in every file, page and gallery.

A function of pictures is marked with `captioned`: its caption goes onto each figure that it draws on, `save`
writes it into the file, and `caption_in` reads it there. So a picture keeps its sentence wherever the file goes.
"""

from collections.abc import Callable
from enum import StrEnum
from functools import wraps
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image, ImageChops, UnidentifiedImageError
from PIL.PngImagePlugin import PngInfo

from explorer.errors import whole
from explorer.phase.paths import writing
from explorer.plot.style import whole_figure

P = ParamSpec("P")
R = TypeVar("R")

DPI, _FINEST = 150, 2400
_EXIF_DESCRIPTION = 0x010E  # ImageDescription, where films other than GIF carry their caption
_SEEN = 2  # of 255, in any channel: more makes steps of a smooth change of colour
_MANY = 0.008  # of all pixels; of our pictures of lines 0.0066 at most move by more, of maps 0.009 at least
_PACKED = 8  # of 9, which takes off 2 % more in three times the time
_PARTS = "\n"  # between question and caption in a file


class Question(StrEnum):
    """What pictures answer, in the order of a gallery."""

    HAPPENS = "What happens?"
    FROM_WHERE = "From where does the disk fall?"
    HOW_RARELY = "How rarely does it nearly fall?"
    EACH_SIDE = "What is the limit from each side?"
    HOW_FAR = "How far does the contact point race?"
    WHICH_MOTIONS = "Which motions are there?"
    WHERE_TO = "Where does the disk go in the long run?"
    REAL = "Would a real disk do it?"
    PAPER = "What do the figures of the paper show?"
    HOW_GOOD = "How accurate is it, and how fast?"


class Caption(NamedTuple):
    """What a picture shows, and which question it answers.

    Attributes
    ----------
    question : Question
        Pictures stand in the gallery by their question.
    text : str
        What is seen and what to look at, in whole sentences.

    Examples
    --------
    >>> from explorer.plot import race_number
    >>> from explorer.plot.captions import CAPTIONS
    >>> CAPTIONS[race_number.__name__].question.name
    'HOW_FAR'
    """

    question: Question
    text: str


CAPTIONS: dict[str, Caption] = {}  # of the files of pictures that are loaded
_on_figures: WeakKeyDictionary[Figure, list[Caption]] = WeakKeyDictionary()


def captioned(question: Question, text: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Give a function of pictures its caption, which its name finds in CAPTIONS.

    Where the function returns Axes or a Figure, that figure has the caption from then on.
    """

    def mark(draw: Callable[P, R]) -> Callable[P, R]:
        caption = CAPTIONS[draw.__name__] = Caption(question, text)

        @wraps(draw)
        def drawn(*arguments: P.args, **keywords: P.kwargs) -> R:
            made = draw(*arguments, **keywords)
            if isinstance(made, Axes | Figure):
                add_caption(whole_figure(made), caption)
            return made

        return drawn

    return mark


def add_caption(figure: Figure, caption: Caption) -> None:
    """Add a caption to those that a figure has, once."""
    there = _on_figures.setdefault(figure, [])
    if caption not in there:
        there.append(caption)


def replace_caption(figure: Figure, caption: Caption) -> None:
    """Say of a figure as a whole what its parts do not say."""
    _on_figures[figure] = [caption]


def caption_of(figure: Figure) -> Caption | None:
    """What a figure shows: the captions of all that was drawn on it, in order.

    Parameters
    ----------
    figure : Figure
        That functions of `explorer.plot` have drawn on.

    Returns
    -------
    Caption or None
        Its question and its text, which serves as alt text; None where nothing captioned was drawn.

    Examples
    --------
    >>> from explorer import plot
    >>> from explorer.portrait import race_numbers
    >>> figure = plot.figure_of(plot.race_number, race_numbers())
    >>> str(plot.caption_of(figure).question)
    'How far does the contact point race?'
    """
    there = _on_figures.get(figure, [])
    return Caption(there[0].question, " ".join(each.text for each in there)) if there else None


def save(figure: Figure, path: Path | str, dpi: int = DPI) -> None:
    """Write a figure with its caption inside the file; a PNG with few colours where that cannot be seen.

    Parameters
    ----------
    figure : Figure
        From a function of `explorer.plot`.
    path : Path or str
        Its ending says the format: .png, .svg or .pdf.
    dpi : int
        Pixels per inch.

    Returns
    -------
    None

    Raises
    ------
    InputError
        Where the name ends otherwise, or the file cannot be written.

    Examples
    --------
    >>> from explorer import plot
    >>> from explorer.portrait import race_numbers
    >>> plot.save(plot.figure_of(plot.race_number, race_numbers()), "bodies.png")  # doctest: +SKIP
    """
    dpi = whole("dpi", dpi, 1, _FINEST)
    with writing("path", path, (".png", ".svg", ".pdf")) as file:
        write_figure(figure, file, dpi)


def write_figure(figure: Figure, path: Path, dpi: int = DPI) -> None:
    """As `save`, for a run, which judges for itself what the system says against a file."""
    caption, kind = caption_of(figure), path.suffix.lower()
    metadata: dict[str, Any] = {}
    if kind == ".svg":
        metadata["Date"] = None  # the same picture is the same file
    if caption is not None:
        key = "Subject" if kind == ".pdf" else "Description"
        metadata[key] = packed(caption)
    figure.savefig(path, dpi=dpi, metadata=metadata)
    if kind == ".png":
        few_colours(path)


def few_colours(path: Path) -> None:
    """Write a PNG again with a palette of 256 colours, a third of its size, where the eye sees no difference.

    A picture of lines has few colours, and the shades between them at edges. A map, whose colours change smoothly,
    would get steps: where too many pixels would move by more than _SEEN all colours are kept, as in transparent
    pictures. What is no picture is left alone.
    """
    try:
        with Image.open(path) as picture:
            full, found = picture.convert("RGBA"), dict(picture.info)
    except (OSError, UnidentifiedImageError):
        return
    plain = full.convert("RGB")
    few = plain.quantize(256, method=Image.Quantize.MEDIANCUT, kmeans=1, dither=Image.Dither.NONE)
    red, green, blue = ImageChops.difference(few.convert("RGB"), plain).split()
    moved = ImageChops.lighter(ImageChops.lighter(red, green), blue).histogram()
    clear = full.getchannel("A").histogram()[255] < full.width * full.height
    if clear or sum(moved[_SEEN + 1 :]) > _MANY * full.width * full.height:
        return
    inside = PngInfo()
    for key, text in found.items():
        if isinstance(text, str):
            inside.add_itxt(str(key), text)
    small, dots = BytesIO(), found.get("dpi")
    few.save(small, format="PNG", compress_level=_PACKED, pnginfo=inside, **({"dpi": dots} if dots else {}))
    path.write_bytes(small.getvalue())


def packed(caption: Caption) -> str:
    """A caption as one string, for a file."""
    return _PARTS.join(caption)


def exif_of(caption: Caption) -> Image.Exif:
    """The caption for films other than GIF: `exif=` of Pillow's `Image.save`."""
    exif = Image.Exif()
    exif[_EXIF_DESCRIPTION] = packed(caption).encode("utf-8")
    return exif


def caption_in(path: Path) -> Caption | None:
    """The caption that a picture or a film carries; None where it has none or is no picture."""
    try:
        with Image.open(path) as picture:
            found = picture.info.get("Description") or picture.info.get("comment")
            # Pillow reads these bytes, UTF-8, as Latin-1.
            found = found or picture.getexif().get(_EXIF_DESCRIPTION, "").encode("latin-1")
    except (OSError, UnidentifiedImageError, UnicodeError):
        return None
    text = found.decode("utf-8", "replace") if isinstance(found, bytes) else str(found)
    question, _, said = text.partition(_PARTS)
    return Caption(Question(question), said) if question in set(Question) and said else None
