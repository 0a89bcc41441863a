"""`nearflat view`: the page with the article and its laboratory, written to a file."""

import argparse
import webbrowser
from pathlib import Path

from explorer.commands import Answer
from explorer.errors import sign
from explorer.paths import path_of
from explorer.phase.disk import Disk
from explorer.scenes.options import DISK, NUMBER, TRUTH, Options, Reader, option
from explorer.view.page import view


class Page(Options):
    """What the page shows, and where it is written. If you name a motion, it opens at its laboratory."""

    disk: Disk | None = option(DISK, "as for run", words="uniform")
    sigma3_bar: float | None = option(
        NUMBER, "sigma3 at the vertical, in the units of the disk", words="1 sqrt(g/r)"
    )
    eta_hat: float | None = option(
        NUMBER, "distance from the falling set, not 0; its sign is the side", words="0.001 sqrt(g/r)"
    )
    phidot: float | None = option(NUMBER, "speed at the vertical towards the flat state", words="1 sqrt(g/r)")
    face: int | None = option(Reader(sign, "X", "int | str"), "flat state, 1 or -1", words="1")
    out: Path = option(Reader(path_of, "FILE", "Path | str"), "the file", default=Path("view.html"))
    open: bool = option(TRUTH, "open the page in the browser", default=False)


add_arguments = Page.add_to


def call(options: argparse.Namespace) -> Answer:
    """Write the page."""
    asked = Page.of(Page.said(options))
    page = view(asked.disk, asked.sigma3_bar, asked.eta_hat, asked.phidot, asked.face)
    where = page.save(asked.out)
    size = where.stat().st_size
    if asked.open:
        webbrowser.open(where.resolve().as_uri())
    record = {"page": str(where), "bytes": size, "disk": page.disk.name}
    return Answer(record, f"{where} ({size / 1000:.0f} kB): open it in any browser.")
