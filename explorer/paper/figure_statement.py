"""Statement 58: the numbers behind the paper's nine figures, by quadrature and by integration."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.special import gamma

from explorer.motion.passages import passages
from explorer.motion.periods import periods
from explorer.motion.trajectories import simulate
from explorer.paper.eight_dimensions import integrate
from explorer.paper.figures import PHIDOT, SIGMA3, start
from explorer.paper.statement import Finding, statement
from explorer.phase.disk import Disk

_ACCURACY = 1e-10


class Row(NamedTuple):
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
BODIES = {"uniform": Disk.uniform(), "hoop": Disk.hoop()}
_WORDS = ("E", "A", "tau", "chi(tau) - chi(0)", "psi(tau) - psi(0)", "theta_min", "|a(tau) - a(0)|")


def by_quadrature(disk: Disk, eta_hat: float) -> Row:
    """Eq. (3.13) and its like for the angles; the travel, which has no quadrature here, by the plain equations."""
    state = start(disk, eta_hat)
    whole = periods(state, _ACCURACY)
    falling = passages(disk, SIGMA3, eta_hat, PHIDOT, accuracy=_ACCURACY)
    tau = float(whole.period[0])
    sigma4 = float(state.natural[4, 0])
    plain = integrate(disk, (0.0, PHIDOT, SIGMA3, sigma4), np.array([0.0, tau]))
    return Row(
        energy=float(whole.energy[0]),
        impact_speed=float(falling.impact_speed[0]),
        tau=tau,
        chi=float(whole.chi[0]),
        psi=float(whole.psi[0]),
        theta_min=float(whole.theta_min[0]),
        travel=float(np.hypot(*(plain.a[-1] - plain.a[0])[:2])),
    )


def by_integration(disk: Disk, eta_hat: float) -> Row:
    """The same from the motion, followed until it is upright again with phidot > 0."""

    def at(times: ArrayLike) -> dict[str, np.ndarray]:
        keys = ("phi", "phidot", "sigma3", "sigma4", "chi", "psi", "path")
        found = simulate(disk, start(disk, eta_hat), t_eval=times, observables=keys, accuracy=_ACCURACY)
        return {key: getattr(found, key)[0] for key in keys}

    times = np.linspace(0.0, 6.0, 1201)
    phi = at(times)["phi"]
    upright = np.flatnonzero((phi[1:-1] < 0.0) & (phi[2:] >= 0.0))[0] + 1
    tau = float(brentq(lambda t: float(at([t])["phi"][0]), times[upright], times[upright + 1], xtol=1e-13))
    flat, step = times[: upright + 1][np.argmax(phi[: upright + 1])], times[1]
    for _ in range(3):
        near = np.linspace(flat - step, flat + step, 401)
        tilt = 0.5 * np.pi - at(near)["phi"]
        flat, step = near[np.argmin(tilt)], near[1] - near[0]
    end = {key: value[0] for key, value in at([tau]).items()}
    energy = _energy(disk, end)
    return Row(
        energy=energy,
        impact_speed=_impact_speed(disk, energy),
        tau=tau,
        chi=float(end["chi"]),
        psi=float(end["psi"]),
        theta_min=float(tilt.min()),
        travel=float(np.hypot(*end["path"][:2])),
    )


def _energy(disk: Disk, end: dict[str, np.ndarray]) -> float:
    """Eq. (2.19)."""
    q, rim = np.cos(end["phi"]), disk.m * disk.r**2
    kinetic = (disk.I1 + rim) * end["phidot"] ** 2 + disk.I1 * (end["sigma3"] / q) ** 2
    return float(0.5 * (kinetic + (disk.I3 + rim) * end["sigma4"] ** 2) + disk.energy_unit * q)


def _impact_speed(disk: Disk, energy: float) -> float:
    """Eqs (6.9), (7.1), with r(0) from its gamma functions, eq. (5.11)."""
    rim = disk.m * disk.r**2
    c = rim * disk.I3 / ((disk.I3 + rim) * disk.I1)
    root = np.emath.sqrt(1.0 - 4.0 * c) / 4.0
    r0 = float(np.real(gamma(1.5) / (gamma(1.25 - root) * gamma(1.25 + root))))
    flat = 0.5 * (disk.I3 + rim) * (disk.I1 * SIGMA3 / (disk.I3 * r0)) ** 2
    return float(np.sqrt(2.0 * (energy - flat) / (disk.I1 + rim)))


@statement(58, "FIGURES", "Figures 1 to 9: period, increase of angles, flattest tilt and travel of their motions.")
def _figures() -> Iterator[Finding]:
    for (name, eta_hat), printed in TABLE.items():
        one, other = by_quadrature(BODIES[name], eta_hat), by_integration(BODIES[name], eta_hat)
        for word, a, b, digits in zip(_WORDS, one, other, printed.split(), strict=True):
            what = f"{word}, {name}, eta_hat = {eta_hat:+g}"
            second = "plain 8-D equations" if word == _WORDS[-1] else "quadrature or closed form"
            yield Finding(
                f"{what}: {second} against the regularised motion",
                f"{a:.9g}",
                f"{b:.9g}",
                abs(a - b) / abs(a),
                1e-8,
                "both are asked for 1e-10 or better per passage, of which there is one",
            )
            unit = 10.0 ** -len(digits.partition(".")[2])
            yield Finding(
                f"{what}: {second} against the table",
                f"{a:.{len(digits.partition('.')[2])}f}",
                digits,
                abs(a - float(digits)) / unit,
                0.55,
                "in units of the table's last digit: half is rounding, the rest what quadrature is asked for",
            )
