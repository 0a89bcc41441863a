"""`ex.view`: a motion as a page that runs in any browser."""

import html
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from explorer import compiled
from explorer.errors import InputError, number, whole
from explorer.motion.trajectories import hold
from explorer.phase.constants import natural_constants
from explorer.phase.disk import PRESETS, Disk
from explorer.phase.states import States, require_axial_inertia
from explorer.view.assembly import assemble

_HEIGHT = 820  # pixels of the frame in a notebook: all of the page on a laptop
_UPRIGHT = 0.5 * math.pi
# The page computes steps in proportion to ln(1/|eta_hat|); down to here it keeps up with the hand.
_SMALLEST = 1e-30
_LARGEST = 1e3


@dataclass(frozen=True)
class Start:
    """The motion with which a page begins, natural units: see `view` for the words.

    theta: tilt (rad) at the start from the flat state of `face`; phidot: speed towards it.
    """

    sigma3_bar: float
    eta_hat: float
    phidot: float
    face: int = 1
    theta: float = _UPRIGHT


@dataclass(frozen=True)
class View:
    """A page with the disk rolling in three dimensions; made by `explorer.view`.

    In a notebook it shows itself. It is one file that needs no network and no server.

    Parameters
    ----------
    disk : Disk
        The body that rolls.
    start : Start
        The motion with which the page begins.
    """

    disk: Disk
    start: Start

    @cached_property
    def html(self) -> str:
        """The page as text."""
        name, bodies = _bodies(self.disk)
        begin = {"disk": name, **vars(self.start)}
        unit = self.disk.rate_unit
        note = "" if unit == 1.0 else f"1 √(g/r) is {unit:.4g} rad per unit of time of this disk"
        return assemble({"bodies": bodies, "start": begin, "note": note})

    def save(self, path: str | Path) -> Path:
        """Write the page to a file, below 1 MB, and return its path.

        Parameters
        ----------
        path : str or Path
            A name that ends in .html; its folder must exist.

        Raises
        ------
        InputError
            Where the name ends otherwise or the file cannot be written.
        """
        where = Path(path)
        if where.suffix.lower() not in (".html", ".htm"):
            raise InputError(f"path = {str(path)!r}: the page is HTML; give a name that ends in .html")
        try:
            where.write_text(self.html, encoding="utf-8")
        except OSError as error:
            raise InputError(f"path = {str(path)!r}: cannot be written ({error.strerror})") from None
        return where

    def __repr__(self) -> str:
        at = self.start
        return (
            f"View({self.disk.name}, face {at.face:+d}: sigma3_bar = {at.sigma3_bar:g}, "
            f"eta_hat = {at.eta_hat:g}, phidot = {at.phidot:g} √(g/r)); .save('page.html') writes the page"
        )

    def _repr_html_(self) -> str:
        page = html.escape(self.html, quote=True)
        return (
            f'<iframe srcdoc="{page}" width="100%" height="{_HEIGHT}" title="nearflat view" '
            'style="border:0" allow="clipboard-write"></iframe>'
        )


def view(
    disk: Disk | str = "uniform",
    sigma3_bar: float = 1.0,
    eta_hat: float = 1e-3,
    phidot: float = 1.0,
    face: int = 1,
    states: Any = None,
    row: int = 0,
) -> View:
    """A page in which the disk rolls in three dimensions, live, on both sides of F.

    The page computes the motion itself, by the regularised equations with eta carried as a number of its own,
    and starts at the vertical or with a state that is given. Everything in it can be dragged: the distance to
    F over twelve decades, both constants of motion, speed, tilt, body and time.

    Parameters
    ----------
    disk : Disk or str
        The body, or its name as on the command line: uniform, hoop, matching, annulus:RATIO.
    sigma3_bar : float
        Constant of motion, sigma3 at the vertical (rad per unit of time).
    eta_hat : float
        Distance beside F on `face` (rad per unit of time), not 0; its sign is the side, on which the point of
        contact races by +kappa pi or -kappa pi. The other side is shown beside it.
    phidot : float
        Speed at the vertical towards the flat state of `face` (rad per unit of time).
    face : int
        The flat state that is meant, +1 or -1.
    states : States or result, optional
        Where to start instead: states, or a result that knows them (trajectories: `.states`) or its own
        arguments (passages: `.disk`, `.sigma3_bar`, `.eta_hat`, `.phidot`, `.face`). The arguments above are
        then ignored.
    row : int
        Which of the states.

    Returns
    -------
    View
        Shows itself in a notebook; `.save("page.html")` writes one file that opens in any browser.

    Raises
    ------
    InputError
        Where the motion falls flat (eta_hat = 0), or the side of F of a state is lost in its rounding.

    Examples
    --------
    >>> import explorer as ex
    >>> page = ex.view("hoop", eta_hat=-1e-12)
    >>> page
    View(hoop, face +1: sigma3_bar = 1, eta_hat = -1e-12, phidot = 1 √(g/r)); .save('page.html') writes the page
    >>> len(page.html) < 1_000_000
    True

    Notes
    -----
    The motion is that of section 7 of Cushman and Duistermaat, Regul. Chaotic Dyn. 11 (2006) 31-60.
    """
    if states is not None:
        body, start = _start_of(states, row)
        return View(body, start)
    body = Disk.parse(disk) if isinstance(disk, str) else disk
    require_axial_inertia(body)
    unit = body.rate_unit
    rates = {"sigma3_bar": sigma3_bar, "eta_hat": eta_hat, "phidot": phidot}
    s3, eta, speed = (
        number(name, value, -_LARGEST * unit, _LARGEST * unit) / unit for name, value in rates.items()
    )
    facing = whole("face", face, -1, 1)
    if facing == 0:
        raise InputError(f"face = {face!r} must be 1 or -1")
    return View(body, Start(s3, _usable(eta, "eta_hat"), speed, facing))


def _usable(eta_hat: float, name: str) -> float:
    """eta_hat (natural units) if a page can show a motion that far beside F."""
    if abs(eta_hat) < _SMALLEST:
        raise InputError(
            f"{name}: at eta_hat = {eta_hat:g} the disk falls flat, and what comes next depends on the side of F; "
            "give a small number with its sign, such as 1e-12 or -1e-12"
        )
    return eta_hat


def _start_of(source: Any, row: int) -> tuple[Disk, Start]:
    """The motion of one row of states or of a result."""
    states = source if isinstance(source, States) else getattr(source, "states", None)
    if isinstance(states, States):
        return states.disk, _start_of_state(states, whole("row", row, 0, len(states) - 1))
    try:
        named = {key: np.ravel(getattr(source, key)) for key in ("sigma3_bar", "eta_hat", "phidot", "face")}
        disk = source.disk
    except AttributeError:
        raise InputError(
            f"states = {source!r} is neither States nor a result that knows its states or arguments"
        ) from None
    at = whole("row", row, 0, max(column.size for column in named.values()) - 1)
    values = {key: float(column[min(at, column.size - 1)]) for key, column in named.items()}
    return disk, view(disk, values["sigma3_bar"], values["eta_hat"], values["phidot"], int(values["face"])).start


def _start_of_state(states: States, row: int) -> Start:
    """The motion through one state: its constants, and its tilt from the face whose line is nearer."""
    require_axial_inertia(states.disk)
    one = states.at(np.array([row]))
    code = compiled.status.Status
    status, pinned = hold(one, natural_constants(one))
    if status[0] not in (code.OK, code.FALLS):
        verdict = code(int(status[0]))
        raise InputError(f"states, row {row}: {verdict.sentence} {verdict.remedy}")
    b = states.disk.body
    sigma3_bar, plus, minus = (float(value) for value in pinned[:, 0])
    face = -1 if abs(minus) < abs(plus) else 1
    eta_hat = _usable((plus if face > 0 else minus) / (b.I3 * b.r0), f"states, row {row}")
    q, z, p = (float(value) for value in one.natural[:3, 0])
    theta = _UPRIGHT if z == 0.0 else math.atan2(q, face * z)
    return Start(sigma3_bar, eta_hat, -face * p, face, theta)


def _bodies(disk: Disk) -> tuple[str, list[dict[str, Any]]]:
    """The name of the body shown and all bodies with a button, with the series that Python computed."""
    bodies = [_body(getattr(Disk, name)(), name) for name in PRESETS]
    b = disk.body
    for body in bodies:
        if math.isclose(body["I1"], b.I1, rel_tol=1e-12) and math.isclose(body["I3"], b.I3, rel_tol=1e-12):
            return body["name"], bodies
    return "given", [*bodies, {**_body(disk, "given"), "label": disk.name}]


def _body(disk: Disk, name: str) -> dict[str, Any]:
    """What the page needs to know about a body, natural units.

    inner: inner over outer radius of the flat ring with these moments of inertia, null for other bodies.
    """
    b = disk.body
    flat = math.isclose(b.I3, 2.0 * b.I1, rel_tol=1e-9) and 0.25 <= b.I1 <= 0.5
    inner = math.sqrt(max(0.0, min(1.0, 4.0 * b.I1 - 1.0))) if flat else None
    return {
        "name": name,
        "label": name,
        "ring": flat,
        "inner": inner,
        "I1": b.I1,
        "I3": b.I3,
        "series": {"rows": np.asarray(disk.series).tolist(), "r0": b.r0, "dr0": b.dr0},
    }
