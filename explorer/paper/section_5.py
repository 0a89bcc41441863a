"""Section 5 of the paper: the recessive solution, Lemmas 1 and 2, and what is entire in c.

Four ways check each other: the power series about z = -1, a series about the vertical
(`closed_forms.basis`), integration, and SciPy's gamma functions.
"""

from collections.abc import Callable, Iterator
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval
from scipy.integrate import quad

from explorer.paper import eight_dimensions as plain
from explorer.paper.checks import OF_BODIES, ROUNDING, at_least, distance, largest, near, sample, worst
from explorer.paper.closed_forms import at_vertical, coefficients, parameters, recessive, scaled
from explorer.paper.four_dimensions import solved
from explorer.paper.statement import Finding, statement
from explorer.phase.constants import constants
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import line_chart
from explorer.phase.states import Array, phi_to_states

OF_PAPER = {"uniform": Fraction(4, 3), "hoop": Fraction(1), "mr²/I₁ = 3": Fraction(6, 5)}


def second_order(c: float) -> Callable[[float, Array], list[float]]:
    """Eq. (4.4) as two equations of first order, for `solved`."""
    return lambda z, x: [x[1], c * x[0] / (1.0 - z * z)]


def in_the_logarithm(c: float, k: float = 1.0) -> Callable[[float, Array], list[float]]:
    """Chaplygin's equations in l = ln(1 -+ z), in which they stay regular; k scales the two variables apart."""
    return lambda log, x: [np.exp(log) * k * x[1], c / k * x[0] / (2.0 - np.exp(log))]


def of_coefficients(c: float) -> float:
    """The limit of n^2 2^n r_n."""
    return float(2.0 / np.pi * np.cosh(0.5 * np.pi * np.sqrt(4.0 * c - 1.0)))


@statement(19, "EQ-5.2")
def recessive_series() -> Iterator[Finding]:
    """(5.1)–(5.3): the recessive series has radius 2, rₙ2ⁿ ~ n⁻², and gains ln 2/ln 10 digits a term at z = 0."""
    doubling = 2 ** np.arange(4, 17)
    for name, exact in OF_PAPER.items():
        c = float(exact)
        terms, limit = coefficients(c, int(doubling[-1]))[doubling], of_coefficients(c)
        slope = np.diff(np.log(terms))[-1] / np.log(2.0)
        text = f"exponent of rₙ2ⁿ, {name}: slopes from n = 16 to 65536, the last"
        yield near(text, slope, -2.0, 2e-5, "(1 − c)/(n ln 4) is left")
        values = terms * doubling.astype(float) ** 2
        text = "n²2ⁿrₙ, extrapolated, over (2/π) cosh(π√(4c − 1)/2)"
        yield near(text, (2.0 * values[-1] - values[-2]) / limit, 1.0, 1e-8, "1/n² is left at n = 65536")
        n = np.arange(8, 29)
        partial = np.cumsum(coefficients(c, 60) * 0.5 ** np.arange(61))[n]
        lost = np.log10(at_vertical(c)[0].real - partial) + 2.0 * np.log10(n)
        digits = -np.linalg.lstsq(np.stack([n, 1.0 + 0 * n, 1.0 / n], axis=1), lost, rcond=None)[0][0]
        text = f"digits per term at z = 0, {name}: partial sums less (5.11), n⁻² taken out"
        yield near(text, digits, np.log10(2.0), 1e-3, "1/n², and rounding")


@statement(20, "POSITIVE")
def positive() -> Iterator[Finding]:
    """5.1: r(z) > 0 and r′(z) > 0 on ]−1, 1[."""
    z, S = np.linspace(-0.99, 0.99, 199), 1e-4
    least, apart = [], []
    for c in (*np.linspace(0.05, 2.0, 14), 0.25):
        start = [S + c / 4 * S**2 + c * (c + 2) / 48 * S**3, 1 + c / 2 * S + c * (c + 2) / 16 * S**2]
        r, dr = solved(second_order(c), start, z, S - 1.0, 1e-12)
        least.append(np.min([r / (1.0 + z), dr]))
        r0, dr0 = (value.real for value in at_vertical(c))
        apart.append(distance(scaled(c, 0.0, r0, dr0, z[20:])[:2], [r[20:], dr[20:]]))
    text = "least of r/(1 + z) and r′ on [−0.99, 0.99], 15 values of c in ]0, 2], integrated from z = −0.9999"
    yield at_least(text, np.min(least), 1.0, "all rₙ are positive")
    text = "these solutions less r(0), r′(0) of (5.11), (5.12) continued from the vertical"
    yield near(text, np.max(apart), 0.0, 1e-9, "start to 1e-12, grown as r′ does")


def inverse_square(c: Any, terms: int) -> list[Any]:
    """Coefficients t_n of (1 + z)^2 r^-2 in powers of 1 + z; exact if c is a Fraction."""
    one = c / c
    s = [one]
    for n in range(1, terms):
        s.append(s[-1] * (c + n * (n - 1)) / (2 * n * (n + 1)))
    square = [sum((s[i] * s[n - i] for i in range(n + 1)), 0 * one) for n in range(terms)]
    t = [one]
    for n in range(1, terms):
        t.append(-sum((square[i] * t[n - i] for i in range(1, n + 1)), 0 * one))
    return t


@statement(21, "LEMMA-1")
def lemma_1() -> Iterator[Finding]:
    """Lemma 1 (5.4): r⁻² = (1+z)⁻² − (c/2)(1+z)⁻¹ + u(z), u analytic at z = −1."""
    for name, c in OF_PAPER.items():
        t = inverse_square(c, 8)
        gap = abs(t[0] - 1) + abs(t[1] + c / 2)
        text = f"first two coefficients of (1+z)²r⁻², {name}, in fractions"
        yield Finding(text, f"{t[0]}, {t[1]}", f"1, {-c / 2}", float(gap), 0.0, "exact")
        tail = np.abs(np.array(inverse_square(float(c), 80)[40:]))
        text = "radius of convergence of u by the root test, n = 40 to 79; u is integrated to 1 + z = 1"
        yield at_least(text, np.min(tail ** (-1.0 / np.arange(40, 80))), 1.0, "a bound")


def lemma_2(c: float, X: float, Y: float, z: Any, constant: float = 1.0) -> Any:
    """x(z) by eq. (5.5), -1 < z <= 0; constant: that of u~ = 1 + int_0^z u (the paper prints 0)."""
    r0, dr0 = recessive(c, 0.0)
    u = np.array(inverse_square(c, 100)[2:])
    primitive = np.concatenate([[0.0], u / np.arange(1, u.size + 1)])
    S, r = 1.0 + z, recessive(c, z)[0]
    tilde = constant + polyval(S, primitive) - polyval(1.0, primitive)
    v = r * (1.0 / S - tilde)
    return X / r0 * r + (X * dr0 - Y * r0) * (0.5 * c * r * np.log(S) + v)


def _about_the_vertical(c: float, X: float, Y: float, z: Any) -> Any:
    return scaled(c, 0.0, X, Y, z)[0]


@statement(22, "LEMMA-2")
def lemma_2_holds() -> Iterator[Finding]:
    """Lemma 2 (5.5), (5.7), (5.9) [corrected: ũ = 1 + ∫u]: every solution is r, r ln and v."""
    z, rng = np.linspace(-0.98, 0.0, 50), np.random.default_rng(22)
    cs = [float(c) for c in OF_PAPER.values()] + [0.25, *rng.uniform(0.1, 2.0, 3)]
    rows = [(c, X, Y) for c, (X, Y) in zip(cs, rng.uniform(-1.5, 1.5, (len(cs), 2)), strict=True)]
    gap = largest(distance(lemma_2(*row, z), _about_the_vertical(*row, z)) for row in rows)
    text = "(5.5) less the series about the vertical, z in [−0.98, 0], 7 values of c"
    yield near(text, gap, 0.0, 1e-12, ROUNDING)
    gap = largest(distance(lemma_2(c, X, -Y, z), _about_the_vertical(c, X, Y, -z)) for c, X, Y in rows)
    yield near("(5.9), its mirror image, on [0, 0.98]", gap, 0.0, 1e-12, ROUNDING)
    c, X, Y = rows[0]
    gap = distance(lemma_2(c, X, Y, z[::-1]), solved(second_order(c), [X, Y], z[::-1], 0.0, 1e-13)[0])
    yield near("(5.5) less (4.4) integrated", gap, 0.0, 1e-11, "rtol 1e-13")
    r0, dr0 = recessive(c, 0.0)
    apart = []
    for s in (-0.9, -0.5, 0.3):
        area = quad(lambda x: recessive(c, x)[0] ** -2.0, 0.0, s, epsabs=1e-13, epsrel=1e-13)[0]
        x = recessive(c, s)[0] * (X / r0 + (Y * r0 - X * dr0) * area)
        apart.append(distance(x, _about_the_vertical(c, X, Y, s)))
    text = "(5.7) by SciPy's quad less the series, z = −0.9, −0.5, 0.3"
    yield near(text, np.max(apart), 0.0, 1e-12, "quad's 1e-13")
    value, printed = (float(lemma_2(4.0 / 3.0, 0.7, 0.4, -0.6, constant)) for constant in (1.0, 0.0))
    text = f"x(−0.6) for c = 4/3, X = 0.7, Y = 0.4, with ũ = 1 + ∫u; as printed {printed:.4f}"
    yield near(text, value, 0.6259, 5e-5, "four decimals are given", {"Lemma 2, proof": printed})


@statement(23, "EQ-5.6")
def wronskian() -> Iterator[Finding]:
    """(5.6): w = x′r − xr′ = Y r(0) − X r′(0) is constant, and I₃bw = η₋."""

    def gaps(disk: Disk) -> tuple[float, float, float]:
        full = plain.integrate(disk, sample(disk), np.linspace(0.0, 2.0 * disk.time_unit, 21))
        c, _d, b = parameters(disk)
        z, _, s3, s4 = full.sigma.T
        r, dr = recessive(c, z, 2000)
        w = s4 / b * r + disk.I1 / (disk.I3 * b) * s3 * dr
        given = constants(phi_to_states(disk, *sample(disk)))
        X, Y = -disk.I1 * given.sigma3_bar / (disk.I3 * b), given.sigma4_bar / b
        r0, dr0 = (value.real for value in at_vertical(c))
        start, unit = Y * r0 - X * dr0, given.eta_minus / (disk.I3 * b)
        return distance(w, w[0]), distance(w[0], start), distance(w[0] / unit, 1.0)

    change, apart, ratio = worst(gaps)
    text = f"change of w along the motion in 8 dimensions, r by (5.1), {OF_BODIES}"
    yield near(text, change, 0.0, 5e-10, "rtol 1e-12 over some hundred steps, times r′")
    text = "w less Y r(0) − X r′(0), X and Y by the explorer, r(0), r′(0) by (5.11), (5.12)"
    yield near(text, apart, 0.0, 1e-13, ROUNDING)
    yield near("I₃bw over η₋ of the explorer, less 1", ratio, 0.0, 1e-13, ROUNDING)


@statement(24, "EQ-5.8")
def logarithm() -> Iterator[Finding]:
    """(5.8), (5.10): x tends to w∓ at z = ∓1, and y ~ ±w±(c/2) ln(1∓z) diverges."""
    depth = -np.log(10.0) * np.arange(1, 13)
    for name, exact in OF_PAPER.items():
        c, X, Y = float(exact), 0.8, -0.3
        r0, dr0 = (value.real for value in at_vertical(c))
        for face in (-1, 1):
            # The mirror image turns the end z = +1 into the end z = -1.
            x, y = solved(in_the_logarithm(c), [X, -face * Y], depth, 0.0, 1e-12)
            y, w = -face * y, X * dr0 + face * Y * r0
            slope = -face * w * c / 2.0
            yield near(f"x at 1 − |z| = 1e-12, z → {face}, {name}", x[-1], w, 1e-9, "rtol 1e-12; z ln is left")
            steps = np.diff(y) / np.diff(depth)
            yield near("slope of y in ln(1 − |z|) from 1e-11 to 1e-12", steps[-1], slope, 1e-9, "rtol 1e-12")

    def gap(disk: Disk) -> float:
        """sigma_3, sigma_4 beside flat by the compiled tables: 1 - sigma_1 from 0.1 to 1e-12."""
        S, c = np.exp(depth), parameters(disk).c
        ours = line_chart(disk, np.sqrt(S * (2.0 - S)), 1.0 - S).rates(0.0, 1.0)
        wanted = solved(in_the_logarithm(c, disk.I3 / disk.I1), [0.0, -1.0], depth, 0.0, 1e-12)
        # sigma3_bar = 0, eta_hat = 1: sigma4_bar = -1, and w_+ makes the slope r(0) c/2.
        slope = np.diff(ours[1])[-1] / np.diff(depth)[-1]
        return largest([distance(ours, wanted), abs(slope - 0.5 * c * at_vertical(c)[0].real)])

    text = f"σ₃, σ₄ of the explorer beside flat less (3.1) integrated in the logarithm, {OF_BODIES}"
    yield near(text, worst(gap), 0.0, 1e-9, "rtol 1e-12; ln(1e-12) = −28")


_GAMMA = "two of SciPy's complex gammas, each to some units of rounding"
_DIGITS = {
    "uniform": ("1.4690645964539924", "2.1406983534237100"),
    "hoop": ("1.3399836124079462", "1.8121040956130957"),
    "mr²/I₁ = 3": ("1.4164294327681471", "2.0055031816314819"),
}


def in_fractions(c: Fraction) -> list[Decimal]:
    """r(0), r'(0) from 120 terms of (5.1), to 40 digits."""
    term, sums = Fraction(1), [Fraction(0), Fraction(0)]
    for n in range(1, 121):
        sums = [sums[0] + term, sums[1] + n * term]
        term = term * (c + n * (n - 1)) / (2 * n * (n + 1))
    with localcontext() as context:
        context.prec = 40
        return [Decimal(s.numerator) / Decimal(s.denominator) for s in sums]


@statement(25, "EQ-5.11")
def gammas() -> Iterator[Finding]:
    """(5.11), (5.12): r(0) and r′(0) are quotients of gamma functions."""
    for name, c in OF_PAPER.items():
        exact = in_fractions(c)
        gap = largest(abs(float(a - Decimal(b))) for a, b in zip(exact, _DIGITS[name], strict=True))
        text, shown = f"r(0), r′(0) of {name}: 120 terms of (5.1) in fractions", [f"{x:.16f}" for x in exact]
        yield Finding(text, shown, _DIGITS[name], gap, 5e-17, "half a unit of the last digit given")
        gap = distance(np.real(at_vertical(float(c))) / np.array(exact, dtype=float), 1.0)
        yield near("(5.11), (5.12) by SciPy's complex gamma over these, less 1", gap, 0.0, 1e-14, _GAMMA)

    def gap_of(disk: Disk) -> float:
        return distance([disk.body.r0, disk.body.dr0] / np.real(at_vertical(parameters(disk).c)), 1.0)

    text = f"r(0), r′(0) that the explorer uses over (5.11), (5.12), less 1, {OF_BODIES}"
    yield near(text, worst(gap_of), 0.0, 1e-14, _GAMMA)


def in_powers_of_c(orders: int, terms: int = 400) -> Array:
    """Taylor coefficients of r(0) and r'(0) in c, (2, orders), from (5.2): sums of positive terms."""
    term, sums = np.zeros(orders), np.zeros((2, orders))
    term[0] = 1.0
    for n in range(1, terms + 1):
        sums += np.array([term, n * term])
        term = (np.concatenate([[0.0], term[:-1]]) + n * (n - 1) * term) / (2 * n * (n + 1))
    return sums


def around(centre: complex, radius: float, orders: int) -> Any:
    """The same about any centre by Cauchy's integral of the gamma formulas over a circle, (2, orders), complex."""
    points = 64
    circle = radius * np.exp(2j * np.pi * np.arange(points) / points)
    values = np.array(at_vertical(centre + circle))
    return np.fft.fft(values, axis=1)[:, :orders] / points / radius ** np.arange(orders)


@statement(26, "ENTIRE")
def entire() -> Iterator[Finding]:
    """5.2: r(0) and r′(0) are entire functions of c, real and smooth through c = 1/4."""
    gap = np.max(abs(around(0.0, 1.0, 12) - in_powers_of_c(12)))
    text = "Taylor coefficients at c = 0: the gamma formulas on a circle less (5.2)"
    yield near(text, gap, 0.0, 1e-14, ROUNDING)
    gap = np.max(abs(around(0.25, 0.5, 8) - around(0.25, 4.0, 8)))
    text = "Taylor coefficients at c = 1/4 from circles of radius 1/2 and 4: no singularity between"
    yield near(text, gap, 0.0, 1e-12, "rounding over 2⁻⁸")
    gap = distance(np.imag(at_vertical(np.linspace(0.01, 2.0, 400))), 0.0)
    yield near("imaginary part of (5.11), (5.12) for 400 values of c in ]0, 2]", gap, 0.0, 1e-14, ROUNDING)
    k = np.arange(8, 47)
    growth = []
    for row in in_powers_of_c(50):
        slopes = np.diff(np.log(row[k] / row[k + 1])) / np.diff(np.log(k))
        growth.append(float(np.polyfit(1.0 / k[1:], slopes, 3)[-1]))
    text = "exponent of aₖ/aₖ₊₁ in k to 46, extrapolated in 1/k; positive: radius infinite; 2: order 1/2"
    yield near(text, growth, 2.0, 0.05, "higher powers of 1/k")
