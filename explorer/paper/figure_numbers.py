"""Statement 58: the numbers behind the paper's nine figures, by quadrature and by integration."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from explorer.motion.passages import passages
from explorer.motion.periods import periods
from explorer.paper.checks import HOOP, UNIFORM, followed, near
from explorer.paper.closed_forms import impact_speed, line_ratio
from explorer.paper.eight_dimensions import integrate
from explorer.paper.figures import PHIDOT, SIGMA3, start
from explorer.paper.four_dimensions import sigma_at, sigma_energy
from explorer.paper.statement import ETA_HAT, Finding, statement
from explorer.phase.constants import constants
from explorer.phase.disk import Disk
from explorer.phase.states import Array, phi_to_states

_ACCURACY = 1e-10


class FigureNumbers(NamedTuple):
    """Numbers of one figure's motion, units m = r = g = 1; chi, psi: rad per period; travel: |a(tau) - a(0)|."""

    energy: float
    impact_speed: float
    tau: float
    chi: float
    psi: float
    theta_min: float
    travel: float


# Digits as they were worked out beforehand, all of them right; the paper itself prints no numbers.
TABLE = {
    ("uniform", 0.01): "2.1372811875 1.81125426 3.5309125568 10.16442885 4.88619430 0.00719310 1.62355",
    ("uniform", -0.01): "2.1591389570 1.82088287 3.5069444328 -3.87572184 -9.14592890 0.00732892 2.16059",
    ("hoop", 0.01): "2.4437778242 1.75291954 3.5443368831 8.57037740 3.49347084 0.00876068 2.14376",
    ("hoop", -0.01): "2.4708244847 1.76317587 3.5168724512 -2.31358306 -7.37252693 0.00889163 1.61133",
}
BODIES = {disk.name: disk for disk in (UNIFORM, HOOP)}
_WORDS = ("E", "A", "τ", "χ(τ) − χ(0)", "ψ(τ) − ψ(0)", "θ_min", "|a(τ) − a(0)|")


def by_quadrature(disk: Disk, eta_hat: float) -> FigureNumbers:
    """Eq. (3.13) and its like for the angles; the travel, which has no quadrature here, by the plain equations."""
    state = start(disk, eta_hat)
    whole = periods(state, accuracy=_ACCURACY)
    falling = passages(disk, SIGMA3, eta_hat, PHIDOT, accuracy=_ACCURACY)
    tau = float(whole.period)
    sigma4 = float(state.rows.sigma4[0])
    plain = integrate(disk, (0.0, PHIDOT, SIGMA3, sigma4), np.array([0.0, tau]))
    return FigureNumbers(
        energy=float(whole.energy),
        impact_speed=float(falling.impact_speed),
        tau=tau,
        chi=float(whole.chi),
        psi=float(whole.psi),
        theta_min=float(whole.theta_min),
        travel=float(np.hypot(*(plain.a[-1] - plain.a[0])[:2])),
    )


def by_integration(disk: Disk, eta_hat: float) -> FigureNumbers:
    """The same from the motion, followed until it is upright again with phidot > 0."""

    def at(times: Any) -> Any:
        return followed(disk, start(disk, eta_hat), times, _ACCURACY)

    guess = np.atleast_1d(periods(start(disk, eta_hat), accuracy=1e-6).period)
    for _ in range(2):  # Newton's steps
        end = at(guess)
        guess = guess - end.phi / end.phidot
    times = np.linspace(0.0, 0.5 * guess[0], 601)
    flat, step = times[np.argmax(at(times).phi)], times[1]
    for _ in range(3):
        near_flat = np.linspace(flat - step, flat + step, 401)
        tilt: Array = 0.5 * np.pi - at(near_flat).phi
        flat, step = near_flat[np.argmin(tilt)], near_flat[1] - near_flat[0]
    energy = float(sigma_energy(disk, sigma_at(end.phi, end.phidot, end.sigma3, end.sigma4))[0])
    return FigureNumbers(
        energy=energy,
        impact_speed=impact_speed(disk, energy, SIGMA3),
        tau=float(guess[0]),
        chi=float(end.chi[0]),
        psi=float(end.psi[0]),
        theta_min=float(tilt.min()),
        travel=float(np.hypot(*end.path[0, :2])),
    )


@statement(58, "FIGURES")
def numbers_of_figures() -> Iterator[Finding]:
    """Figures 1 to 9: period, increase of angles, flattest tilt and travel of their motions."""
    for (name, eta_hat), digits in TABLE.items():
        one, other = by_quadrature(BODIES[name], eta_hat), by_integration(BODIES[name], eta_hat)
        for word, a, b, text in zip(_WORDS, one, other, digits.split(), strict=True):
            second = "plain 8-dimensional equations" if word == _WORDS[-1] else "quadrature or closed form"
            what = f"{word}, {name}, η̂ = {eta_hat:+g}: {second}"
            why = "both are asked for 1e-10 or better per passage, of which there is one"
            yield Finding(
                f"{what} against the regularised motion", f"{a:.9g}", f"{b:.9g}", abs(a - b) / abs(a), 1e-8, why
            )
            decimals = len(text.partition(".")[2])
            why = "in units of the table's last digit: half is rounding, the rest what quadrature is asked for"
            units = abs(a - float(text)) * 10.0**decimals
            yield Finding(f"{what} against the table", f"{a:.{decimals}f}", text, units, 0.55, why)
    starts = [
        constants(phi_to_states(disk, 0.0, PHIDOT, SIGMA3, line_ratio(disk) + ETA_HAT)) for disk in BODIES.values()
    ]
    text, off = "η̂₊ of the second start in the text; as printed 0.01", {"captions of Figs. 8 and 9": ETA_HAT}
    eta_hats = [given.eta_hat_plus for given in starts]
    yield near(text, eta_hats, -ETA_HAT, 1e-12, "rounding", off)
