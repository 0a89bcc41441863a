"""`ex.view`: the article, and a motion in its laboratory, as a page that runs in any browser."""

import html
import math
from dataclasses import asdict, dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np

from explorer.errors import InputError, shown
from explorer.paths import writing_page
from explorer.phase.disk import Disk
from explorer.view.assembly import assemble
from explorer.view.start import AtVertical, Start, start_at_vertical, start_in

_HEIGHT = 820  # pixels of the frame in a notebook: all of the page on a laptop


@dataclass(frozen=True)
class View:
    """A page with the disk rolling in three dimensions, and the article about it: what `view` returns.

    In a notebook it shows itself. It is one file that needs neither a network nor a server.

    Attributes
    ----------
    disk : Disk
        The body that rolls.
    start : Start
        The motion with which the laboratory of the page begins, in natural units.
    laboratory : bool
        Whether the page opens there, on this motion; else it opens with its article.

    Examples
    --------
    >>> import explorer as ex
    >>> page = ex.view("hoop", sigma3_bar=0.5)
    >>> page.start.sigma3_bar, page.start.face
    (0.5, 1)
    """

    disk: Disk
    start: Start
    laboratory: bool = True

    @cached_property
    def html(self) -> str:
        """The page as text."""
        name, bodies = _bodies(self.disk)
        unit = self.disk.rate_unit
        note = "" if unit == 1.0 else f"√(g/r) is {unit:.4g} in the units of this disk"
        start = {"disk": name, **asdict(self.start)}
        return assemble({"bodies": bodies, "start": start, "note": note, "laboratory": self.laboratory})

    def save(self, path: str | Path) -> Path:
        """Write the page to a file.

        Parameters
        ----------
        path : str or Path
            A name that ends in .html, in a folder that exists.

        Returns
        -------
        Path
            The file, below 1 MB.

        Raises
        ------
        InputError
            If the name ends otherwise, if the file cannot be written, or if it is there and not such a page.
        """
        with writing_page("path", path) as where:
            where.write_text(self.html, encoding="utf-8")
        return where

    def __repr__(self) -> str:
        at = self.start
        return (
            f"View({self.disk.name}, face {at.face:+d}: sigma3_bar = {at.sigma3_bar:g}, "
            f"eta_hat = {at.eta_hat:g}, phidot = {at.phidot:g} √(g/r))"
        )

    def _repr_html_(self) -> str:
        """The page in a frame of its own, which notebooks show and keep."""
        page = html.escape(self.html, quote=True)
        return (
            f'<iframe srcdoc="{page}" width="100%" height="{_HEIGHT}" title="nearflat view" '
            'style="border:0" allow="clipboard-write"></iframe>'
        )


def view(
    motion: Any = None,
    sigma3_bar: float | None = None,
    eta_hat: float | None = None,
    phidot: float | None = None,
    face: int | None = None,
    *,
    row: int | None = None,
) -> View:
    """Make a page: an article on what the disk does, and at its end a laboratory in which you roll the disk.

    The laboratory shows both sides of F, and you can drag through the whole motion. The page opens there if you
    give a motion, a body or a number, and otherwise with the article.

    Parameters
    ----------
    motion : States, result, Disk or str, optional
        What the laboratory shows: one state, or one of the motions that `simulate`, `passages`, `bounces` or
        `limit_motion` returned, shown from its start. Or a body, or its name as on the command line (uniform,
        hoop, matching, annulus:RATIO), which starts at the vertical with the numbers that follow. By default the
        uniform disk.
    sigma3_bar : float, optional
        For a body: sigma3 at the vertical (units of the disk), by default sqrt(g/r).
    eta_hat : float, optional
        For a body: distance from F on `face` (units of the disk), not 0, by default sqrt(g/r)/1000. Its sign
        is the side; the motion at -eta_hat, which races the other way, is shown beside it.
    phidot : float, optional
        For a body: speed at the vertical towards the flat state of `face` (units of the disk), by default
        sqrt(g/r).
    face : int, optional
        For a body: the flat state that is meant, +1 (by default) or -1.
    row : int, optional
        Which motion to show if `motion` has several: the row of its table, counted from 0.

    Returns
    -------
    View
        Shows itself in a notebook; `.save("page.html")` writes a file for any browser.

    Raises
    ------
    InputError
        If `motion` is not a motion, or holds several and no row is given; if numbers are given together with a
        motion; if the motion falls; and if its side is lost in rounding.

    Notes
    -----
    If you give a bounce of a motion that crosses the vertical, the page starts where the disk was last upright
    before that bounce. For a limit motion, the page shows the motion at the distance eta_hat = 1e-12 sqrt(g/r) on
    its side of F: section 7 of Cushman and Duistermaat, Regul. Chaotic Dyn. 11 (2006) 31-60.

    Examples
    --------
    >>> import explorer as ex
    >>> states = ex.constants_to_states(ex.Disk.uniform(), 0.5, [1e-6, -1e-6], 1.0)
    >>> ex.view(states[1])
    View(uniform, face +1: sigma3_bar = 0.5, eta_hat = -1e-06, phidot = 1 √(g/r))
    >>> ex.view(ex.simulate(states, t_end=5.0), row=0)
    View(uniform, face +1: sigma3_bar = 0.5, eta_hat = 1e-06, phidot = 1 √(g/r))
    """
    given = AtVertical(sigma3_bar, eta_hat, phidot, face)
    if motion is None or isinstance(motion, Disk | str):
        _refuse({"row": row}, "a disk has no rows; leave it out, or give States or a result")
        body = motion if isinstance(motion, Disk) else Disk.parse(motion or "uniform")
        named = motion is not None or any(value is not None for value in given)
        return View(body, start_at_vertical(body, given), named)
    _refuse(given._asdict(), f"{type(motion).__name__} has its own; leave it out, or give a disk")
    return View(*start_in(motion, row))


def _refuse(given: dict[str, Any], why: str) -> None:
    """Say of the first value that was given that it would not be used."""
    for name, value in given.items():
        if value is not None:
            raise InputError(f"{name} = {shown(value)}: {why}")


def _bodies(disk: Disk) -> tuple[str, list[dict[str, Any]]]:
    """The name of the body that is shown, and all bodies with a button."""
    bodies = _presets()
    given = _body(disk, "given") | {"label": disk.name}
    for body in bodies:
        if all(math.isclose(body[key], given[key], rel_tol=1e-12) for key in ("I1", "I3")):
            return str(body["name"]), bodies
    return "given", [*bodies, given]


@cache
def _presets() -> list[dict[str, Any]]:
    return [_body(disk, disk.name) for disk in (Disk.uniform(), Disk.hoop(), Disk.matching())]


def _body(disk: Disk, name: str) -> dict[str, Any]:
    """What the page needs to know about a body, natural units, with the series that Python computed.

    inner: inner over outer radius of the flat ring with these moments of inertia; null for other bodies.
    """
    b = disk.body
    ring = math.isclose(b.I3, 2.0 * b.I1, rel_tol=1e-9) and 0.25 <= b.I1 <= 0.5
    inner = math.sqrt(max(0.0, 4.0 * b.I1 - 1.0)) if ring else None
    series = {"rows": np.asarray(disk.natural.series).tolist(), "r0": b.r0, "dr0": b.dr0}
    return {"name": name, "label": name, "ring": ring, "inner": inner, "I1": b.I1, "I3": b.I3, "series": series}
