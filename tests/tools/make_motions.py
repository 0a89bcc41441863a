"""Makes motions.csv: some 650 motions in 40 digits, one a line, by `many_digits`.

    python tests/tools/make_motions.py     # some ten minutes; needs python-flint

A line is a body, a start and what becomes of it (m = r = g = 1). Starts are exact doubles: a state, or constants
with the tilt and its rate. Answers: the time to the first flattest moment, the fall angle, the face that comes
down first, and the smallest tilt, chi, psi and time of this stretch and of the next one, left out where the
motion does not cross the vertical. eta_hat = 0 is a fall, to flat and back. Every sixth period that comes not very
near to flat is found a second time, from the equations of motion by Taylor series.
"""

import csv
import itertools
from pathlib import Path

import many_digits
import numpy as np
from flint import arb

OUT = Path(__file__).parents[1] / "reference" / "motions.csv"
GIVEN = ("kind", "I1", "I3", "phi", "phidot", "sigma3", "sigma4", "sigma3_bar", "eta_hat", "face")
ANSWERS = ("time", "fall_angle", "first_face")
STRETCH = ("theta_min", "chi", "psi", "duration")
UNIFORM, HOOP, HEAVY, THICK, SLIM = (0.25, 0.5), (0.5, 1.0), (0.02, 0.04), (0.5, 0.3), (0.25, 1e-3)
BODIES = (  # I1, I3
    *(UNIFORM, HOOP, HEAVY, THICK, SLIM, (1.0, 2.0), (1e-6, 2e-6), (1e-3, 2e-3), (1e-3, 2e-4), (1e-4, 1e-6)),
    *((0.25, 0.02), (0.25, 1e-4), (0.25, 2.5e-7), (1.5, 1e-5), (10.0, 20.0), (10.0, 3.0)),
)
WELL_KNOWN = BODIES[:6]
ON_LINE = 0.29143692640757906  # eta_hat on face -1 of the uniform disk with sigma3_bar = 0.2 on l_+


def sign(rng):
    return rng.choice([-1.0, 1.0])


def power(rng, low, high):
    return 10.0 ** rng.uniform(low, high)


def by_constants(kind, inertia, sigma3_bar, eta_hat, phidot, face=1, phi=0.0):
    """A start with constants of motion, at the vertical towards the face with a speed."""
    rate = phidot if phi else face * phidot
    given = {"phi": phi, "phidot": float(rate), "sigma3_bar": float(sigma3_bar), "eta_hat": float(eta_hat)}
    return {"kind": kind, "I1": inertia[0], "I3": inertia[1], "face": int(face), **given}


def by_state(kind, inertia, *state):
    """A start with phi, phidot, sigma3 and sigma4."""
    return {"kind": kind, **dict(zip(GIVEN[1:7], (*inertia, *map(float, state)), strict=True))}


def passages(rng):
    """Starts at the vertical, at every distance from F, of every speed and spin."""
    for inertia in BODIES:
        for low, high in ((-300, -16), (-16, -6), (-6, -3), (-3, -1), (-1, 0)):
            start = rng.normal(), sign(rng) * power(rng, low, high), rng.uniform(0.3, 2.0)
            yield by_constants("passage", inertia, *start, sign(rng))
    for inertia, eta_hat in itertools.product(WELL_KNOWN[:2], (1e-300, -1e-100, 1e-12, -1e-3, 0.1, -1.0)):
        yield by_constants("passage", inertia, 1.0, eta_hat, 1.0)
    for inertia, bar in itertools.product(WELL_KNOWN[:4], (0.0, 1e-9, -1e-3, 3.0, -10.0)):
        yield by_constants("spin", inertia, bar, sign(rng) * power(rng, -6, -1), rng.uniform(0.3, 2.0), sign(rng))
    for inertia, speed in itertools.product(WELL_KNOWN[:4], (3.0, 10.0, 100.0)):
        yield by_constants("fast", inertia, rng.normal(), sign(rng) * power(rng, -6, -1), speed, sign(rng))
    for inertia in BODIES:
        for low in (-9, -6, -3):
            start = rng.normal(), sign(rng) * power(rng, -8, 0), power(rng, low, low + 3)
            yield by_constants("slow", inertia, *start, sign(rng))
    for speed, bar in itertools.product((1e-2, 1e-4, 1e-6, 1e-9), (0.0, 1e-6, 0.01)):
        yield by_constants("upright", WELL_KNOWN[int(rng.integers(4))], bar, sign(rng) * power(rng, -7, -1), speed)


def falls(rng):
    """Motions on F."""
    for inertia in BODIES:
        yield by_constants("fall", inertia, rng.normal(), 0.0, rng.uniform(0.3, 2.0), sign(rng))
    for inertia, speed in itertools.product(WELL_KNOWN, (1e-6, 1e-3, 10.0)):
        yield by_constants("fall", inertia, rng.normal(), 0.0, speed, sign(rng))


def anywhere(rng):
    """States all over the phase space, near flat, from rest, at the vertical."""
    for inertia in BODIES:
        for _ in range(6):
            yield by_state("state", inertia, rng.uniform(-1.4, 1.4), *rng.normal(0.0, 1.0, 3))
        for _ in range(3):
            tilt = power(rng, -7, 0)
            rates = 0.3 * rng.normal(), np.sin(tilt) * power(rng, -2, 1) * rng.normal(), 2.0 * rng.normal()
            yield by_state("near flat", inertia, sign(rng) * (0.5 * np.pi - tilt), *rates)
        for _ in range(3):
            yield by_state("rest", inertia, rng.uniform(-1.5, 1.5), 0.0, *rng.normal(0.0, 1.0, 2))
        yield by_state("vertical", inertia, 0.0, *rng.normal(0.0, 1.0, 3))
        yield by_state("vertical", inertia, 0.0, 0.0, *rng.normal(0.0, 1.0, 2))
        yield by_state(
            "beside",
            inertia,
            *(
                sign(rng)
                * power(
                    rng,
                    -9,
                    -3,
                )
                for _ in range(2)
            ),
            *rng.normal(0, 1, 2),
        )


def steady(inertia, theta, precession):
    """sigma3, sigma4 and d2V/dtheta2 of the steady motion with this tilt from face +1."""
    I1, I3 = inertia
    q, z = np.sin(theta), np.cos(theta)
    sigma4 = z * (I1 * precession**2 * q - 1.0) / ((I3 + 1.0) * precession * q)
    ratio, J = precession * q, I3 + 1.0
    bend = ((I1 + 1.0) * q**2 + 2.0 * I1 * z**2) * ratio**2 - 2.0 * I3 * z * q * ratio * sigma4
    return precession * q * q, sigma4, (bend + J * I3 / I1 * (q * sigma4) ** 2 + q * (z * z - q * q)) / q**2


def wobbles(_rng):
    """Motions that are this wide about steady ones, and on the crests between wells."""
    wells = (
        *((UNIFORM, 0.17, 3.0), (UNIFORM, 1.2, -2.0), (UNIFORM, 1e-4, 150.0), (HOOP, 0.6, 1.5), (HOOP, 1.57, 1.5)),
        *((HEAVY, 0.3, -4.0), (SLIM, 0.5, 2.5), ((1e-3, 2e-3), 0.4, 5.0), ((0.25, 2.5e-7), 0.7, 2.0)),
    )
    for (inertia, theta, turn), width in itertools.product(wells, (1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10)):
        sigma3, sigma4, bend = steady(inertia, theta, turn)
        rate = width * min(theta, 1.0) * np.sqrt(bend / (inertia[0] + 1.0))
        yield by_state("wobble", inertia, 0.5 * np.pi - theta, rate, sigma3, sigma4)
    for inertia, theta, turn in wells:
        yield by_state("steady", inertia, 0.5 * np.pi - theta, 0.0, *steady(inertia, theta, turn)[:2])
    for width in (1e-1, 1e-3, 1e-6, 1e-10):
        yield by_state("wobble", HOOP, 0.0, width, 2.0, 0.0)
        yield by_state("wobble", UNIFORM, 0.0, width, 0.0, 1.5)


def crests(rng):
    """Motions whose energy is beside that of a highest point of V on the way."""
    for speed in (0.13428816308909913, 0.043585614189378945, 0.04169376109742993, 0.04165465640611945):
        yield by_constants("crest", UNIFORM, 0.2, ON_LINE, speed)
    yield by_constants("crest", UNIFORM, 0.2, ON_LINE, 0.04167421335802686)
    found = 0
    while found < 30:
        inertia = WELL_KNOWN[int(rng.integers(len(WELL_KNOWN)))]
        bar, eta_hat = 0.5 * rng.normal(), sign(rng) * power(rng, -1.5, 0)
        of, share = many_digits.body(*inertia), sign(rng) * power(rng, -10, -1)
        x, constants = np.linspace(-2.0, 0.0, 80), (arb(bar) / of.r0, of.k * of.r0 * arb(eta_hat))
        V = np.array([float(of.at(arb(y), *constants).V) for y in x])
        if 0 < V.argmax() < V.size - 1:
            found += 1
            left = V.max() - V[-1] + share * V.max()
            speed = np.sqrt(2.0 * left / (inertia[0] + 1.0)) if left > 0 else power(rng, -9, -2)
            yield by_constants("crest", inertia, bar, eta_hat, speed, sign(rng))


def hard(_rng):
    """Motions that answers once missed: at extremes, where rules agree by chance, where sides are doubtful."""
    inertias = *((0.4, 0.4 * c / (0.6 + 0.4 * (1.0 - c))) for c in (0.249, 0.25, 0.251)), (1e6, 2e6), (0.4, 4e-7)
    for inertia in inertias:
        yield by_constants("hard", inertia, 0.5, 1e-3, 0.8)
    for inertia, *start in (
        *((HOOP, 1.0, -1e-4, 1e6), (HOOP, 1e6, 1e2, 1e6), (UNIFORM, 5.0, 1e-8, 5e-4), (UNIFORM, 20.0, 1e-8, 5e-4)),
        ((1e-4, 1e-6), 1.2752072293387782, 0.8404071685809366, 9.769831818404523),
        ((1e-5, 2e-5), 1.302064474326873, 5.132887124718588e-08, 0.001513399969955084),
        (UNIFORM, 1.5203067953112497, 4.1155149013182496e-07, 2.794852785676193e-08),
    ):
        yield by_constants("hard", inertia, *start)
    for phi, phidot, *constants in (
        (1.2160314138285346, 0.8529705878301934, -1.437574979531596, 2.2906818910883208e-07),
        (1.0279633459271103, -0.28975126806611257, 1.4846509393697693, -1.495576745787576e-06),
        (1.3, 0.2, 0.8, -1e-100),
        (-0.5, 0.3, 1.1, 1e-12),
    ):
        yield by_constants("hard", UNIFORM, *constants, phidot, int(np.sign(phi)), phi)
    for inertia, *state in (
        ((8.0, 16.0), 1.5707862030670934, 1.2226573119762036, 0.0, -3990.1351396677123),
        ((8.0, 16.0), 1.5707955642235067, -1.0386056648674165, -7.6e-10, -38825.8),
        ((2.336977151693502, 4.673954303387004), 1.570790889801188, 0.0, 1.6488613567037726e-9, 0.0),
        ((1e-3, 2e-3), -1.5707906252281716, -0.02904338277806045, -4.532019401836573e-06, -0.7215187925332736),
        (HEAVY, 1.5707948120968493, 0.006267590395293759, -7.060020062884379e-07, 3.1147386410891094),
        (UNIFORM, 1.570768813735574, -0.03535851518848946, -1.5925156534268506e-05, 3.9344529774391948),
        ((5e-3, 1e-2), 1.5707956359263215, 0.07225368945545102, 1.21874569985784e-08, -1.5326112933313323),
        (UNIFORM, 0.0, -0.0009896465132408832, 0.47235129142488114, -1.9595817168958976),
        (UNIFORM, 1.5693424333744794, -1.4770374080039275, 1.2415135732670817e-09, 14.157380516772877),
        (UNIFORM, -1.2543, -0.0647, 1.056, -2.2335),
        ((1 / 48, 0.0007854637296675545), 7.678612032992706e-07, 3.371589902485747e-07, -2.2604129726315185e-07,
         3.0132185173704737),
        ((4.468589021312591, 8.937178042625183), 4.1359975031821563e-10, 7.955398412493051e-07,
         -0.000128210328129765, 9.954566627099726e-05),
        ((1 / 63, 0.00024552115271746244), -3.7e-12, 2.22e-7, -1.05e-6, -0.0017),
        ((0.060801369665406634, 0.01844140856472576), 1.5666307999110276, 6.365222705782919e-08,
         -1.308038134858126e-05, 312.64101447731525),
        ((0.051970895335219765, 0.09276999869251075), 1.567376823682341, -1.0225527623772147e-08,
         -3.5621534540882827e-05, 87.70033850545617),
        ((0.26812852174616786, 0.5362570434923357), 0.5420545400854047, -2.4800809040688114, -0.19191856914842897,
         0.02741522460081024),
        ((0.8005076390665606, 1.6010152781331213), -0.5668935809807444, -3.4224476074112287, 0.18109640729751547,
         -0.427751482508165),
    ):  # fmt: skip
        yield by_state("hard", inertia, *state)


def fast_spins(rng):
    """Small wobbles about the vertical of disks that spin fast."""
    for inertia, spin, width in itertools.product(
        (*WELL_KNOWN[:4], (0.0039, 0.0051)), (5.0, 100.0, 1000.0), (1e-2, 1e-5, 1e-8)
    ):
        sigma3 = sign(rng) * power(rng, -3, 0) if rng.random() < 0.5 else 0.0
        yield by_state("fast spin", inertia, 0.0, width * power(rng, -1, 1), sigma3, sign(rng) * spin)


def line(given):
    """The line of a start, with its answers."""
    inertia = given["I1"], given["I3"]
    if "eta_hat" in given:
        names = "phi", "phidot", "sigma3_bar", "eta_hat", "face"
        found = many_digits.from_constants(inertia, *(given[name] for name in names))
    else:
        found = many_digits.from_state(inertia, *(given[name] for name in GIVEN[3:7]))
    time = "" if given["kind"] == "steady" else number(found.time)  # of which every moment is the flattest
    fall = "" if found.fall_angle is None else number(found.fall_angle)
    numbers = [number(x) for stretch in found.stretches for x in stretch]
    return [*(given.get(name, "") for name in GIVEN), time, fall, found.faces[0], *numbers], found


def number(x):
    """The shortest decimals of the nearest double."""
    return repr(float(x.mid())).removesuffix(".0")


def check(given, found):
    """Raise ArithmeticError where the equations of motion have another period."""
    start = given["phi"], given["phidot"], *found.state
    again = many_digits.by_taylor((given["I1"], given["I3"]), *start)
    chi, psi, time = (sum(column, arb(0)) for column in list(zip(*found.stretches, strict=True))[1:])
    for one, other in zip(again, (found.time, found.stretches[0].theta_min, chi, psi, time), strict=True):
        if not abs(one - other) < 1e-38 * (1 + abs(other)):
            raise ArithmeticError(f"{float(one)} by Taylor series, {float(other)} by quadrature")


def main():
    draws = passages, falls, anywhere, wobbles, crests, hard, fast_spins
    starts = [start for draw in draws for start in draw(np.random.default_rng(7))]
    number_of, checked = 0, 0
    with OUT.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow([*GIVEN, *ANSWERS, *(f"{name}_{stretch}" for stretch in (0, 1) for name in STRETCH)])
        for given in starts:
            try:
                row, found = line(given)
                known = found.time > 0 and min(s.theta_min for s in found.stretches) > 1e-12
                if known and given["kind"] != "steady" and number_of % 6 == 0:
                    check(given, found)
                    checked += 1
            except ArithmeticError as error:
                print(error, given, flush=True)
                continue
            rows.writerow(row + [""] * (len(GIVEN) + len(ANSWERS) + 2 * len(STRETCH) - len(row)))
            number_of += 1
    print(f"{number_of} motions, {checked} of them found twice")


if __name__ == "__main__":
    main()
