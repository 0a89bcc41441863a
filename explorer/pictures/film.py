"""A film of the disk nearly falling flat, both sides of F next to each other."""

from pathlib import Path
from typing import Any

from PIL import Image

from explorer.phase.arguments import known_keywords
from explorer.phase.disk import Disk
from explorer.phase.paths import writing
from explorer.pictures.film_motions import Film, film
from explorer.pictures.register import Caption, Question
from explorer.pictures.stage import Stage

FRAMES = 360
_BOUNCES = 3  # after which the paths of both sides are far apart
_ETA_HAT = 0.02  # natural units: the disk looks flat, and its race still takes time
# 30 frames a second. A GIF for a page has half the size, every second frame, and the palette of one of them.
_WEBP_MS, _WEBP_QUALITY, _WEBP_METHOD, _WEBP_KEY = 100.0 / 3.0, 60, 2, 300
_GIF_DPI, _GIF_STEP, _GIF_MS, _COLOURS = 50, 2, 70, 64
_OF_PALETTE = 5  # frames from which the palette is taken
_FADE = 12  # frames in which the end becomes the start, so that it loops
_FORMATS = (".webp", ".gif")
_OPTIONS = ("eta_hat", "sigma3_bar", "phidot", "bounces")


class _Frames(Image.Image):
    """A picture of many frames, each drawn when it is sought: all of them would take a gigabyte of memory."""

    def __init__(self, stage: Stage, rows: list[int]) -> None:
        super().__init__()
        self._stage, self._rows, self._at = stage, rows, 0
        self.n_frames, self.is_animated = len(rows), True
        self._first = stage.image(rows[0])
        self.seek(0)

    def seek(self, frame: int) -> None:
        """Draw a frame."""
        if not 0 <= frame < self.n_frames:
            raise EOFError("no such frame")
        self._at = frame
        shown = self.drawn(frame)
        self.im, self._mode, self._size = shown.im, shown.mode, shown.size

    def tell(self) -> int:
        """The frame that is drawn."""
        return self._at

    def drawn(self, frame: int) -> Image.Image:
        """A frame as a picture of its own; the last ones fade into the first."""
        shown = self._stage.image(self._rows[frame])
        fading = min(_FADE, self.n_frames // 3)
        share = (frame - (self.n_frames - 1 - fading)) / (fading + 1)
        return Image.blend(shown, self._first, share) if share > 0.0 else shown


def _palette(pictures: _Frames) -> Image.Image:
    """One palette for all frames, from some of them one above another: colours must not flicker."""
    width, height = pictures.size
    several = Image.new("RGB", (width, height * _OF_PALETTE))
    for part in range(_OF_PALETTE):
        several.paste(pictures.drawn(part * (pictures.n_frames - 1) // _OF_PALETTE), (0, part * height))
    return several.quantize(_COLOURS)


CAPTION = Caption(
    Question.HAPPENS,
    "A disk rolls and three times nearly falls flat, on both sides of F. Near flat the film says by how much it "
    "is slowed: the contact point races round the rim, one way on the left, the other way on the right, and the "
    "two motions part. Below, the tilt, on a logarithmic axis, and the turns of the contact point: each race adds "
    "±κπ.",
)
_EXIF_DESCRIPTION = 0x010E  # ImageDescription, where films other than GIF carry their caption


def animate(path: Path | str, disk: Disk, *, frames: int = FRAMES, **options: Any) -> Film:
    """Write a film of the disk that three times nearly falls flat, eta_hat > 0 and < 0 side by side; it loops.

    Parameters
    ----------
    path : Path or str
        File to write. Its name ends in .webp, for 1280 by 720 pixels and 30 frames a second, or in .gif, for
        half the size and some 14 frames a second.
    disk : Disk
    frames : int
        Between frames time goes on in proportion to cos(phi), so that the race fills many of them.
    **options
        eta_hat, sigma3_bar, phidot and bounces as for `film_motions.film`.

    Returns
    -------
    Film
        The data that were drawn.

    Raises
    ------
    InputError
        Where the path or an option cannot be used.

    References
    ----------
    Section 7 of the paper.

    Examples
    --------
    >>> from explorer import Disk
    >>> from explorer.pictures.film import animate
    >>> shown = animate("fall.gif", Disk.uniform())  # doctest: +SKIP
    """
    known_keywords("animate", options, _OPTIONS)
    with writing("path", path, _FORMATS, "the film is WebP or GIF; ") as where:
        unit = disk.rate_unit
        given = {"eta_hat": _ETA_HAT * unit, "sigma3_bar": unit, "phidot": unit, "bounces": _BOUNCES, **options}
        shown = film(disk, frames=frames, **given)
        _write(shown, where)
    return shown


def _write(shown: Film, where: Path) -> None:
    rows = [int(row) for row in shown.frames]
    caption = "\n".join(CAPTION).encode("utf-8")
    if where.suffix.lower() == ".webp":
        exif = Image.Exif()
        exif[_EXIF_DESCRIPTION] = caption
        how: dict[str, Any] = {"quality": _WEBP_QUALITY, "method": _WEBP_METHOD, "exif": exif}
        how |= {"kmin": _WEBP_KEY - 1, "kmax": _WEBP_KEY}
        _Frames(Stage(shown), rows).save(where, save_all=True, duration=_WEBP_MS, loop=0, **how)
        return
    pictures = _Frames(Stage(shown, _GIF_DPI), rows[::_GIF_STEP])
    palette = _palette(pictures)
    small = [
        pictures.drawn(frame).quantize(palette=palette, dither=Image.Dither.NONE)
        for frame in range(pictures.n_frames)
    ]
    how = {"duration": _GIF_MS, "loop": 0, "optimize": False, "comment": caption}
    small[0].save(where, save_all=True, append_images=small[1:], **how)
