"""The hero and the film: recorded from the page in a headless browser, as the page's own buttons save them."""

import base64
import io
import tempfile
from itertools import cycle, islice
from pathlib import Path

from PIL import ExifTags, Image
from PIL.PngImagePlugin import PngInfo

from explorer.phase.disk import Disk
from explorer.pictures.register import Caption, Question
from explorer.view.browser import Browser, find
from explorer.view.page import view

# A flat body whose mass lies near its middle: kappa = 2.5, and the two rises are in opposite places.
OPPOSITE = Disk(I1=1.0 / 5.25, I3=2.0 / 5.25, name="kappa = 2.5")
_ETA_HAT = 0.004  # natural units: the disk looks flat, and its race still takes time
_STILL = (1920, 1080)  # pixels, for print
_MOVING, _SMALL = (1200, 675), (800, 450)  # of the hero for pages, and of the film as GIF
_FRAMES, _GIF_FRAMES = 60, 90  # 15 a second: of the hero four seconds, of the film all six
_MS = (70, 70, 60)  # of one frame after another, since a GIF counts hundredths of a second
_REST_MS = 2500  # for which the hero shows all of it before it begins anew
_COLOURS = 256  # all that a palette holds
_SHARED = 3  # frames of the GIF with one palette: one for all has colours far off, one for each twice the size
_PATIENCE = 900.0  # s: the film is 180 frames of 1080 lines, encoded without a graphics card

CAPTIONS = {
    "hero": Caption(
        Question.HAPPENS,
        "A disk falls (thin outlines) and lies almost flat (gold). From two starts that hardly differ, its "
        "contact point races round the rim, one way (blue) or the other (vermilion), by κ half turns, and the "
        "disk rises in one of two places. κ depends on how the mass is distributed; here it is 2.5, and the two "
        "places are opposite.",
    ),
    "film": Caption(
        Question.HAPPENS,
        "One fall in six seconds, slowed near flat by the factor shown: the contact point races round the rim by "
        "½κ turns, one way (blue) or the other (vermilion), and the disk rises in one of two places. The smallest "
        "difference between the two starts decides.",
    ),
}


def record(name: str, folder: Path, disk: Disk | None = None) -> Path:
    """Record the hero (WebP that moves, PNG for print) or the film (GIF, and WebM of 1080 lines).

    Returns the one for pages; the other has the same name, and stands beside it.

    disk: by default one whose two rises are opposite. Raises InputError where there is no Chromium.
    """
    program, disk = find(), disk or OPPOSITE
    unit = disk.rate_unit
    page = view(disk, sigma3_bar=0.0, eta_hat=_ETA_HAT * unit, phidot=unit)
    with tempfile.TemporaryDirectory() as there, Browser(program, _PATIENCE) as browser:
        browser.open(page.save(Path(there) / "page.html"))
        write = _hero if name == "hero" else _film
        return write(browser, folder)


def _hero(browser: Browser, folder: Path) -> Path:
    moving, still = folder / "hero.webp", folder / "hero.png"
    caption = "\n".join(CAPTIONS["hero"])
    about = PngInfo()
    about.add_itxt("Description", caption)
    _picture(browser, _STILL).quantize(_COLOURS).save(still, pnginfo=about, optimize=True)
    frames = [_picture(browser, _MOVING, n / (_FRAMES - 1)) for n in range(_FRAMES)]
    exif = Image.Exif()
    exif[ExifTags.Base.ImageDescription] = caption.encode()  # where WebP carries it
    durations = [*islice(cycle(_MS), _FRAMES - 1), _REST_MS]
    frames[0].save(
        moving,
        save_all=True,
        append_images=frames[1:],
        duration=durations,
        loop=0,
        quality=80,
        method=4,
        exif=exif,
    )
    return moving


def _film(browser: Browser, folder: Path) -> Path:
    small, large = folder / "film.gif", folder / "film.webm"
    frames = [_picture(browser, _SMALL, n / (_GIF_FRAMES - 1), film=True) for n in range(_GIF_FRAMES)]
    drawn = [each for begin in range(0, _GIF_FRAMES, _SHARED) for each in _alike(frames[begin : begin + _SHARED])]
    comment = "\n".join(CAPTIONS["film"]).encode()
    durations = [*islice(cycle(_MS), _GIF_FRAMES)]
    drawn[0].save(small, save_all=True, append_images=drawn[1:], duration=durations, loop=0, comment=comment)
    code = """modules.saving.film(nearflat.store).then(film => new Promise(done => {
        const reader = new FileReader();
        reader.onload = () => done(reader.result);
        reader.readAsDataURL(film);
    }))"""
    large.write_bytes(_bytes(browser.evaluate(code)))
    return small


def _alike(frames: list[Image.Image]) -> list[Image.Image]:
    """Frames with one palette, which is made of them side by side."""
    several = Image.new("RGB", (len(frames) * _SMALL[0], _SMALL[1]))
    for n, frame in enumerate(frames):
        several.paste(frame, (n * _SMALL[0], 0))
    palette = several.quantize(_COLOURS)
    return [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]


def _picture(browser: Browser, size: tuple[int, int], share: float = 1.0, film: bool = False) -> Image.Image:
    """What the page draws at a share of the time."""
    drawn = f"modules.saving.picture(nearflat.store, {size[0]}, {size[1]}, {share}, {str(film).lower()})"
    return Image.open(io.BytesIO(_bytes(browser.evaluate(f"{drawn}.toDataURL()")))).convert("RGB")


def _bytes(address: str) -> bytes:
    """The content of a data address."""
    return base64.b64decode(address.partition(",")[2])
