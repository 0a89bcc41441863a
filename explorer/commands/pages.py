"""The README.md that a command leaves in a folder of pictures; their captions are in the files."""

import html
import os
import re
from collections.abc import Iterable
from pathlib import Path
from urllib.parse import quote

from PIL import ExifTags, Image

from explorer.pictures.register import Caption, Question


def full_size(picture: Path) -> Path:
    """The file that shows a picture in its full size: of a film its WebM, of a picture that moves its still."""
    larger = {".gif": ".webm", ".webp": ".png"}.get(picture.suffix, picture.suffix)
    return there if (there := picture.with_suffix(larger)).exists() else picture


def caption_in(path: Path) -> Caption | None:
    """The caption inside a picture or a film, a question and a text; None where there is none."""
    try:
        with Image.open(path) as picture:
            found = picture.info.get("Description") or picture.info.get("comment")
            # Pillow reads what EXIF holds as Latin-1.
            found = found or picture.getexif().get(ExifTags.Base.ImageDescription, "").encode("latin-1")
    except (OSError, ValueError, Image.DecompressionBombError):  # it is no picture, or one that fills the memory
        return None
    question, _, text = (found.decode("utf-8") if isinstance(found, bytes) else str(found)).partition("\n")
    return Caption(Question(question), text) if question in set(Question) else None


def picture_lines(picture: Path, root: Path) -> list[str]:
    """A picture with its caption for the page of `root`."""
    caption = caption_in(picture)
    return [image_of(picture, root, caption, 600), "", text_of(picture, caption)]


def write_page(folder: Path, title: str, made_by: str, parts: Iterable[tuple[str, list[str], list[Path]]]) -> None:
    """Write the README.md of a folder. parts: heading, lines of text, and pictures, which bring their captions."""
    lines = [f"# {title}", "", f"Made by {made_by}"]
    for heading, text, pictures in parts:
        lines += ["", f"## {heading}", *([""] if text else []), *text]
        lines += [line for picture in pictures for line in ("", *picture_lines(picture, folder))]
    (folder / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def image_of(picture: Path, root: Path, caption: Caption | None, width: int) -> str:
    """The HTML of a picture for the page of `root`, which leads to its full size."""
    files = picture.relative_to(root), full_size(picture).relative_to(root)
    source, full = (quote(os.fsencode(each.as_posix())) for each in files)
    return f'<a href="{full}"><img src="{source}" width="{width}" alt="{text_of(picture, caption)}"></a>'


def text_of(picture: Path, caption: Caption | None) -> str:
    """What is said of a picture: its caption, or its own name with its folder's."""
    above = picture.parent.parent if picture.parent.name == "figures" else picture.parent
    return escaped(caption.text if caption else f"{above.name}, {picture.stem.replace('-', ' ')}")


def escaped(text: str) -> str:
    """Text for a page, of which nothing is read as HTML or Markdown."""
    known = html.escape(text.encode(errors="replace").decode())  # the name of a file may be no text
    return re.sub(r"[`|\[\]\\*~\n\r]", lambda mark: f"&#{ord(mark[0])};", known)
