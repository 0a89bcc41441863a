"""Section 5 of the paper as code: the recessive solution, Lemmas 1 and 2, and what is entire in c.

Four ways check each other: the power series about z = -1, a series about the vertical
(`equations.basis`), integration, and SciPy's gamma functions.
"""

from collections.abc import Iterator
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp

import explorer as ex
from explorer.paper import eight_dimensions as plain
from explorer.paper.equations import (
    BODIES,
    OF_BODIES,
    ROUNDING,
    at_vertical,
    basis,
    coefficients,
    far,
    largest,
    parameters,
    recessive,
    sample,
    worst,
)
from explorer.paper.statement import Finding, statement
from explorer.phase.lines import line_chart

_Array = NDArray[np.float64]
OF_PAPER = {"uniform": Fraction(4, 3), "hoop": Fraction(1), "m r^2/I1 = 3": Fraction(6, 5)}
LETTER = "uniform disk, hoop and m r^2/I1 = 3"


def _sum_to(c: float, z: float) -> tuple[int, int]:
    """Terms that leave a relative remainder below 1e-16, and the same by the law C x^n/n^2, x = (1 + z)/2."""
    n = np.arange(1, 20_001)
    terms = coefficients(c, 20_000)[1:] * (0.5 * (1.0 + z)) ** n
    law = 2.0 / np.pi * np.cosh(0.5 * np.pi * np.sqrt(4.0 * c - 1.0)) * (0.5 * (1.0 + z)) ** n / n**2
    left = [np.cumsum(row[::-1])[::-1] for row in (terms, law)]
    return int(np.argmax(left[0] < 1e-16 * left[0][0])), int(np.argmax(left[1] < 1e-16 * left[0][0]))


@statement(
    19,
    "EQ-5.2",
    "(5.1)-(5.3): the recessive series has radius 2, r_n 2^n ~ n^-2, and gains ln 2/ln 10 digits a term at z = 0",
)
def recessive_series() -> Iterator[Finding]:
    doubling = 2 ** np.arange(4, 17)
    for name, exact in OF_PAPER.items():
        c = float(exact)
        scaled = coefficients(c, int(doubling[-1]))[doubling]
        slopes = np.diff(np.log(scaled)) / np.log(2.0)
        text = f"exponent of r_n 2^n, {name}: slopes from n = 16 to 65536, the last"
        yield Finding(text, float(slopes[-1]), -2, abs(slopes[-1] + 2.0), 2e-5, "(1 - c)/(n ln 4) is left")
        limit = 2.0 / np.pi * np.cosh(0.5 * np.pi * np.sqrt(4.0 * c - 1.0))
        values = scaled * doubling.astype(float) ** 2
        limit_of = 2.0 * values[-1] - values[-2]
        text = "n^2 2^n r_n, extrapolated, over (2/pi) cosh(pi sqrt(4c - 1)/2)"
        yield Finding(text, limit_of / limit, 1, abs(limit_of / limit - 1.0), 1e-8, "1/n^2 is left at n = 65536")
        bend = doubling[:8] * np.log(values / limit)[:8]
        bend = 2.0 * bend[1:] - bend[:-1]
        text = "n ln(n^2 2^n r_n) above its limit, n = 16 to 2048, extrapolated: r_n 2^n = C n^-2 (1 + (1 - c)/n)"
        yield Finding(text, float(bend[-1]), 1 - c, abs(bend[-1] - 1.0 + c), 1e-6, "1/n^2 is left")
        n = np.arange(8, 29)
        partial = np.cumsum(coefficients(c, 60) * 0.5 ** np.arange(61))[n]
        lost = np.log10(at_vertical(c)[0].real - partial) + 2.0 * np.log10(n)
        digits = -np.linalg.lstsq(np.stack([n, 1.0 + 0 * n, 1.0 / n], axis=1), lost, rcond=None)[0][0]
        text = f"digits per term at z = 0, {name}: partial sums less (5.11), n^-2 taken out"
        yield Finding(
            text, float(digits), float(np.log10(2.0)), abs(digits - np.log10(2.0)), 1e-3, "1/n^2, and rounding"
        )
    for z in (0.0, 0.5, 0.9, 0.99):
        count, law = _sum_to(4.0 / 3.0, z)
        text = f"terms to a relative 1e-16 at z = {z}, uniform; expected by the law above"
        yield Finding(text, count, law, abs(count - law), 1, "whole numbers")


@statement(20, "POSITIVE", "5.1: r(z) > 0 and r'(z) > 0 on ]-1, 1[")
def positive() -> Iterator[Finding]:
    z = np.linspace(-0.99, 0.99, 199)
    least, apart = [], []
    for c in (*np.linspace(0.05, 2.0, 14), 0.25):
        S = 1e-4
        start = [S + c / 4 * S**2 + c * (c + 2) / 48 * S**3, 1 + c / 2 * S + c * (c + 2) / 16 * S**2]
        run = solve_ivp(
            lambda s, x, c=c: [x[1], c * x[0] / (1.0 - s * s)],
            (S - 1, 0.99),
            start,
            "DOP853",
            z,
            rtol=1e-12,
            atol=1e-14,
        )
        least.append(min(np.min(run.y[0] / (1.0 + z)), np.min(run.y[1])))
        even, deven, odd, dodd = basis(c, z[20:])
        r0, dr0 = (value.real for value in at_vertical(c))
        pair = [r0 * even + dr0 * odd, r0 * deven + dr0 * dodd]
        apart.append(far(pair, run.y[:, 20:]))
    low = float(np.min(least))
    text = "least of r/(1 + z) and r' on [-0.99, 0.99], 15 values of c in ]0, 2], integrated from z = -0.9999"
    yield Finding(text, low, ">= 1, all r_n being positive", 1.0 - low, 0.0, "strict")
    text = "these solutions less r(0), r'(0) of (5.11), (5.12) continued from the vertical"
    yield Finding(text, largest(apart), 0.0, largest(apart), 1e-9, "start to 1e-12, grown as r' does")


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


@statement(21, "LEMMA-1", "Lemma 1 (5.4): r^-2 = (1+z)^-2 - (c/2)(1+z)^-1 + u(z), u analytic at z = -1")
def lemma_1() -> Iterator[Finding]:
    h = 2.0 ** -np.arange(2, 13)
    for name, c in OF_PAPER.items():
        t = inverse_square(c, 8)
        gap = abs(t[0] - 1) + abs(t[1] + c / 2)
        text = f"first two coefficients of (1+z)^2 r^-2, {name}, in fractions"
        yield Finding(text, (str(t[0]), str(t[1])), ("1", str(-c / 2)), float(gap), 0.0, "exact")
        slopes = ((h / recessive(float(c), h - 1.0)[0]) ** 2 - 1.0) / h
        refined = 2.0 * slopes[1:] - slopes[:-1]
        refined = (4.0 * refined[1:] - refined[:-1]) / 3.0
        order = float(np.polyfit(np.log(h), np.log(abs(slopes + float(c) / 2)), 1)[0])
        text = "limit of ((1+z)^2 r^-2 - 1)/(1+z) for 1+z = 2^-2 .. 2^-12, extrapolated"
        yield Finding(
            text, float(refined[-1]), -float(c) / 2, abs(refined[-1] + float(c) / 2), 1e-9, "rounding over 2^-12"
        )
        yield Finding("order in 1+z at which it is reached", order, 1, abs(order - 1.0), 0.05, "next order at 1/4")
        tail = np.abs(np.array(inverse_square(float(c), 80)[40:]))
        radius = float(np.min(tail ** (-1.0 / np.arange(40, 80))))
        text = "radius of convergence of u by the root test, n = 40 to 79; u is integrated to 1 + z = 1"
        yield Finding(text, radius, "> 1", 1.0 - radius, 0.0, "strict")


def lemma_2(c: float, X: float, Y: float, z: Any, constant: float = 1.0) -> Any:
    """x(z) by eq. (5.5), -1 < z <= 0; constant: that of u~ = 1 + int_0^z u (the paper prints 0)."""
    r0, dr0 = recessive(c, 0.0)
    u = np.array(inverse_square(c, 100)[2:])
    primitive = np.concatenate([[0.0], u / np.arange(1, u.size + 1)])
    S, r = 1.0 + z, recessive(c, z)[0]
    tilde = constant + polyval(S, primitive) - polyval(1.0, primitive)
    v = r * (1.0 / S - tilde)
    return X / r0 * r + (X * dr0 - Y * r0) * (0.5 * c * r * np.log(S) + v)


def _both_solutions(c: float, X: float, Y: float, z: Any) -> Any:
    even, _deven, odd, _dodd = basis(c, z)
    return X * even + Y * odd


@statement(
    22, "LEMMA-2", "Lemma 2 (5.5), (5.7), (5.9) [corrected: u~ = 1 + int u]: every solution is r, r ln and v"
)
def lemma_2_holds() -> Iterator[Finding]:
    z = np.linspace(-0.98, 0.0, 50)
    rng = np.random.default_rng(22)
    cs = [float(c) for c in OF_PAPER.values()] + [0.25, *rng.uniform(0.1, 2.0, 3)]
    data = rng.uniform(-1.5, 1.5, (len(cs), 2))
    rows = list(zip(cs, data, strict=True))
    gap = largest([far(lemma_2(c, X, Y, z), _both_solutions(c, X, Y, z)) for c, (X, Y) in rows])
    yield Finding(
        "(5.5) less the series about the vertical, z in [-0.98, 0], 7 values of c", gap, 0.0, gap, 1e-12, ROUNDING
    )
    gap = largest([far(lemma_2(c, X, -Y, z), _both_solutions(c, X, Y, -z)) for c, (X, Y) in rows])
    yield Finding("(5.9), its mirror image, on [0, 0.98]", gap, 0.0, gap, 1e-12, ROUNDING)
    c, (X, Y) = rows[0]
    run = solve_ivp(
        lambda s, x: [x[1], c * x[0] / (1.0 - s * s)],
        (0.0, -0.98),
        [X, Y],
        "DOP853",
        z[::-1],
        rtol=1e-13,
        atol=1e-14,
    )
    gap = far(lemma_2(c, X, Y, z[::-1]), run.y[0])
    yield Finding("(5.5) less (4.4) integrated", gap, 0.0, gap, 1e-11, "rtol 1e-13")
    r0, dr0 = recessive(c, 0.0)
    w = Y * r0 - X * dr0
    apart = []
    for s in (-0.9, -0.5, 0.3):
        area = quad(lambda x: recessive(c, x)[0] ** -2.0, 0.0, s, epsabs=1e-13, epsrel=1e-13)[0]
        r = recessive(c, s)[0]
        apart.append(far(X * r / r0 + w * r * area, _both_solutions(c, X, Y, s)))
    gap, text = largest(apart), "(5.7) by SciPy's quad less the series, z = -0.9, -0.5, 0.3"
    yield Finding(text, gap, 0.0, gap, 1e-12, "quad's 1e-13")
    printed, right = lemma_2(c, X, Y, z, constant=0.0), _both_solutions(c, X, Y, z)
    gap = far(printed - right, -w * recessive(c, z)[0])
    text = "largest error of (5.5) with the printed u~ = int u, which leaves out (X r'(0) - Y r(0)) r(z)"
    yield Finding(text, far(printed, right), far(w * recessive(c, z)[0], 0.0), gap, 1e-12, ROUNDING)
    pair = tuple(float(lemma_2(4.0 / 3.0, 0.7, 0.4, -0.6, constant)) for constant in (1.0, 0.0))
    text = "x(-0.6) for c = 4/3, X = 0.7, Y = 0.4: with u~ = 1 + int u, and as printed"
    yield Finding(text, pair, (0.6259, 1.0449), far(pair, (0.6259, 1.0449)), 5e-5, "four decimals are given")


@statement(23, "EQ-5.6", "(5.6): w = x' r - x r' = Y r(0) - X r'(0) is constant, and I3 b w = eta_-")
def wronskian() -> Iterator[Finding]:
    def gaps(disk: ex.Disk) -> tuple[float, float, float]:
        full = plain.integrate(disk, sample(disk), np.linspace(0.0, 2.0 * disk.time_unit, 21))
        c, _d, b = parameters(disk)
        z, s3, s4 = full.sigma[:, 0], full.sigma[:, 2], full.sigma[:, 3]
        r, dr = recessive(c, z, 2000)
        w = s4 / b * r + disk.I1 / (disk.I3 * b) * s3 * dr
        found = ex.constants(disk, *sample(disk))
        X, Y = -disk.I1 * found.sigma3_bar[0] / (disk.I3 * b), found.sigma4_bar[0] / b
        r0, dr0 = (value.real for value in at_vertical(c))
        return (
            far(w, w[0]),
            abs(float(w[0] - Y * r0 + X * dr0)),
            abs(float(disk.I3 * b * w[0] / found.eta_minus[0] - 1.0)),
        )

    found = np.array([gaps(disk) for disk in BODIES]).max(axis=0)
    text = f"change of w along the plain motion, r by (5.1): {OF_BODIES}"
    yield Finding(text, found[0], 0.0, found[0], 5e-10, "rtol 1e-12 over some hundred steps, times r'")
    text = "w less Y r(0) - X r'(0), X and Y by ex.constants, r(0), r'(0) by (5.11), (5.12)"
    yield Finding(text, found[1], 0.0, found[1], 1e-13, ROUNDING)
    yield Finding("I3 b w over eta_- of ex.constants, less 1", found[2], 0.0, found[2], 1e-13, ROUNDING)
    z = np.linspace(-0.95, 0.95, 39)
    gap = float(
        np.max([far(e * do - o * de, 1.0) for e, de, o, do in (basis(float(c), z) for c in OF_PAPER.values())])
    )
    yield Finding("Wronskian of the two series about the vertical, less 1", gap, 0.0, gap, 1e-13, ROUNDING)


@statement(24, "EQ-5.8", "(5.8), (5.10): x tends to w_-+ at z = -+1, and y ~ +-w_+- (c/2) ln(1 -+ z) diverges")
def logarithm() -> Iterator[Finding]:
    depth = -np.log(10.0) * np.arange(1, 13)
    for name, exact in OF_PAPER.items():
        c, X, Y = float(exact), 0.8, -0.3
        r0, dr0 = (value.real for value in at_vertical(c))
        for face in (-1, 1):
            # With l = ln(1 -+ z) the equations stay regular; the mirror image turns +1 into -1.
            run = solve_ivp(
                lambda s, x, c=c: [np.exp(s) * x[1], c * x[0] / (2.0 - np.exp(s))],
                (0.0, depth[-1]),
                [X, -face * Y],
                "DOP853",
                depth,
                rtol=1e-12,
                atol=1e-14,
            )
            x, y = run.y[0], -face * run.y[1]
            w = X * dr0 + face * Y * r0
            slope = -face * w * c / 2.0
            text = f"x at 1 - |z| = 1e-12, z -> {face}, {name}"
            yield Finding(text, float(x[-1]), w, abs(x[-1] - w), 1e-9, "rtol 1e-12; z ln is left")
            steps = np.diff(y) / np.diff(depth)
            text = "slope of y in ln(1 - |z|) from 1e-11 to 1e-12"
            yield Finding(text, float(steps[-1]), slope, abs(steps[-1] - slope), 1e-9, "rtol 1e-12")
            order = float(np.polyfit(depth[1:7], np.log(abs(steps[:6] - slope) / -depth[1:7]), 1)[0])
            yield Finding(
                "order of the slope in 1 - |z|, ln taken out", order, 1, abs(order - 1.0), 0.1, "1 beside ln"
            )
            ratio = np.polyfit(1.0 / depth[6:], y[6:] / depth[6:], 1)
            off = abs(y[-1] / depth[-1] - slope)
            text = f"y/ln(1 - |z|), which is off by {off:.2f} at 1e-12, extrapolated in 1/ln"
            yield Finding(
                text, float(ratio[1]), slope, abs(ratio[1] - slope), 1e-4, "(1 - |z|) ln is left at 1e-7"
            )
    yield from _near_flat_of_the_explorer(depth)


def _near_flat_of_the_explorer(depth: _Array) -> Iterator[Finding]:
    """sigma_3, sigma_4 beside flat by the compiled tables: 1 - sigma_1 from 0.1 to 1e-12."""

    def gap(disk: ex.Disk) -> float:
        c, _d, _b = parameters(disk)
        S = np.exp(depth)
        chart = np.array(line_chart(disk, np.sqrt(S * (2.0 - S)), 1.0 - S))
        r0, k = float(at_vertical(c)[0].real), disk.I3 / disk.I1
        run = solve_ivp(
            lambda s, x: [np.exp(s) * k * x[1], c / k * x[0] / (2.0 - np.exp(s))],
            (0.0, depth[-1]),
            [0.0, -1.0],
            "DOP853",
            depth,
            rtol=1e-12,
            atol=1e-14,
        )
        # sigma3_bar = 0, eta_hat = 1: sigma4_bar = -1, and w_+ makes the slope r(0) c/2.
        slope = np.diff(chart[3])[-1] / np.diff(depth)[-1]
        return largest([far(chart[[1, 3]], run.y), abs(slope - 0.5 * c * r0)])

    found = worst(gap)
    text = f"sigma_3, sigma_4 of the explorer beside flat less (3.1) integrated in the logarithm: {OF_BODIES}"
    yield Finding(text, found, 0.0, found, 1e-9, "rtol 1e-12; ln(1e-12) = -28")


_GAMMA = "two of SciPy's complex gammas, each to some units of rounding"
_DIGITS = {
    "uniform": ("1.4690645964539924", "2.1406983534237100"),
    "hoop": ("1.3399836124079462", "1.8121040956130957"),
    "m r^2/I1 = 3": ("1.4164294327681471", "2.0055031816314819"),
}


@statement(25, "EQ-5.11", "(5.11), (5.12): r(0) and r'(0) are quotients of gamma functions")
def gammas() -> Iterator[Finding]:
    for name, c in OF_PAPER.items():
        term, sums = Fraction(1), [Fraction(0), Fraction(0)]
        for n in range(1, 121):
            sums = [sums[0] + term, sums[1] + n * term]
            term = term * (c + n * (n - 1)) / (2 * n * (n + 1))
        with localcontext() as context:
            context.prec = 40
            exact = [Decimal(s.numerator) / Decimal(s.denominator) for s in sums]
            gap = largest([abs(float(a - Decimal(b))) for a, b in zip(exact, _DIGITS[name], strict=True)])
        text = f"r(0), r'(0) of {name}: 120 terms of (5.1) in fractions"
        shown = tuple(f"{value:.16f}" for value in exact)
        yield Finding(text, shown, _DIGITS[name], gap, 5e-17, "half a unit of the last digit given")
        values = [value.real for value in at_vertical(float(c))]
        gap = far(np.divide(values, [float(value) for value in exact]), 1.0)
        yield Finding("(5.11), (5.12) by SciPy's complex gamma over these, less 1", gap, 0.0, gap, 1e-14, _GAMMA)
        product = np.cosh(0.5 * np.pi * np.sqrt(4.0 * float(c) - 1.0)) / (np.pi * float(c))
        gap = abs(float(exact[0] * exact[1]) / product - 1.0)
        yield Finding(
            "r(0) r'(0) over cosh(pi sqrt(4c - 1)/2)/(pi c)", 1.0 + gap, 1.0, gap, 2e-15, "rounding of cosh"
        )

    def gap_of(disk: ex.Disk) -> float:
        wanted = [value.real for value in at_vertical(parameters(disk)[0])]
        return far(np.divide([disk.body.r0, disk.body.dr0], wanted), 1.0)

    found = worst(gap_of)
    yield Finding(
        f"r(0), r'(0) that the explorer uses over (5.11), (5.12): {OF_BODIES}", found, 0.0, found, 1e-14, _GAMMA
    )


def in_powers_of_c(orders: int, terms: int = 400) -> _Array:
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


@statement(26, "ENTIRE", "5.2: r(0) and r'(0) are entire functions of c, real and smooth through c = 1/4")
def entire() -> Iterator[Finding]:
    series = in_powers_of_c(12)
    gap = far(around(0.0, 1.0, 12), series)
    yield Finding(
        "Taylor coefficients at c = 0: the gamma formulas on a circle less (5.2)", gap, 0.0, gap, 1e-14, ROUNDING
    )
    gap = far(around(0.25, 0.5, 8), around(0.25, 4.0, 8))
    text = "Taylor coefficients at c = 1/4 from circles of radius 1/2 and 4: no singularity between"
    yield Finding(text, gap, 0.0, gap, 1e-12, "rounding over 2^-8")
    c = np.linspace(0.01, 2.0, 400)
    gap = far(np.imag(at_vertical(c)), 0.0)
    yield Finding("imaginary part of (5.11), (5.12) for 400 values of c in ]0, 2]", gap, 0.0, gap, 1e-14, ROUNDING)
    h = 10.0 ** -np.arange(1, 5)
    here = np.real(at_vertical(0.25))
    right = (np.real(at_vertical(0.25 + h)) - here[:, None]) / h
    left = (here[:, None] - np.real(at_vertical(0.25 - h))) / h
    order = float(np.polyfit(np.log(h), np.log(abs(right - left)[0]), 1)[0])
    text = "order in h at which slopes of r(0) on both sides of c = 1/4 meet, h = 1e-1 to 1e-4"
    yield Finding(text, order, 1, abs(order - 1.0), 0.01, "h^3 beside h, rounding over h")
    k = np.arange(8, 47)
    growth = []
    for row in in_powers_of_c(50):
        slopes = np.diff(np.log(row[k] / row[k + 1])) / np.diff(np.log(k))
        growth.append(float(np.polyfit(1.0 / k[1:], slopes, 3)[-1]))
    text = "exponent of a_k/a_(k+1) in k to 46, extrapolated in 1/k; positive: radius infinite; 2: order 1/2"
    yield Finding(text, tuple(growth), 2, far(growth, 2.0), 0.05, "higher powers of 1/k")
