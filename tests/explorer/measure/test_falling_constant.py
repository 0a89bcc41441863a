"""The constant C against grids of states, limits of boxes, and its own symmetries."""

import math
import warnings

import numpy as np
import pytest
from conftest import BODIES
from scipy.integrate import nquad
from scipy.stats import truncnorm

import explorer as ex
from explorer.measure.distributions import Distribution
from explorer.measure.falling_constant import constant_of, falling_constant
from explorer.phase.falling_set import impact_speed
from explorer.phase.states import phi_to_states


def bell(mean, deviation, low=-2.0, high=2.0):
    """A normal law, cut off at the ends of a box."""
    return f"truncnorm:{(low - mean) / deviation}:{(high - mean) / deviation}:{mean}:{deviation}"


FULL = f"phi={-0.5 * math.pi!r}:{0.5 * math.pi!r}"


def by_grid(disk, box, points, energy=math.inf):
    """The same integral the slow way: midpoints of the box without sigma4, which the line itself sets."""
    names = ("phi", "phidot", "sigma3")
    axes, volume = [], 1.0
    for name in names:
        low, high = box[name]
        # The ends of sigma4 cut the line at some sigma3, in the middle of a cell: that is where errors come from.
        count = (8 * points if name == "sigma3" else points) if low < high else 1
        axes.append(low + (high - low) * (np.arange(count) + 0.5) / count)
        volume *= (high - low) if low < high else 1.0
    phi, phidot, sigma3 = (a.ravel() for a in np.meshgrid(*axes, indexing="ij"))
    low, high = box["sigma4"]
    total, b = 0.0, disk.body
    for face in (1, -1):
        # eta is linear in sigma4: two states give the line.
        row = 1 if face > 0 else 2
        etas = [phi_to_states(disk, phi, phidot, sigma3, s4).motion[row] for s4 in (0.0, 1.0)]
        slope = etas[1] - etas[0]
        sigma4 = -etas[0] / slope
        states = phi_to_states(disk, phi, phidot, sigma3, sigma4)
        natural = states.motion
        fall = ex.falls(states)
        member = fall.could_fall_plus if face > 0 else fall.could_fall_minus
        member &= (sigma4 >= low) & (sigma4 <= high) & (natural.energy <= energy)
        A = np.where(member, impact_speed(disk, natural.sigma3_bar, natural.energy), 0.0)
        total += (2.0 * A * math.sqrt(b.I1 * b.M) / abs(slope)).mean() * volume
    return total


# By adaptive Gauss quadrature, to 1e-12
KNOWN = {"uniform": 1.469270773946, "hoop": 1.212979973006, "matching": 1.349055411161}


def same(one, other):
    """Whether two constants agree within three of their standard errors."""
    return abs(one.value - other.value) <= 3.0 * math.hypot(one.error, other.error)


@pytest.mark.parametrize(("name", "value"), KNOWN.items())
def test_the_default_box_gives_the_known_constant(name, value):
    """The first stands in the mathematics to six digits, the others are ours, checked by the grids below."""
    found = falling_constant(BODIES[name])
    assert found.value == pytest.approx(value, rel=1e-9)
    assert found.error < 1e-9
    assert found.plus == pytest.approx(found.minus, rel=1e-12)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
@pytest.mark.parametrize(
    "box",
    [
        "phi=0.4",
        "phi=-0.9,phidot=-1:2",
        "phi=-1.1:0.2,sigma3=-0.5:1",
        "phi=-1:1,phidot=0.3",
        "phi=-0.6:1.2,sigma3=0.2:0.4,sigma4=-0.3:1",
    ],
)
def test_points_agree_with_a_grid_of_states_on_the_line(name, box):
    """Membership by `could_fall`, A by `impact_speed`, the line from two states: nothing in common but F."""
    disk = BODIES[name]
    density = Distribution.invariant(disk, box)
    found = constant_of(density)
    tilted, moving = (density.coordinates[name].free for name in ("phi", "phidot"))
    points = (20 if moving else 80) if tilted else 200
    slow = by_grid(disk, density.describe(), points) / density.volume
    assert found.value == pytest.approx(slow, rel=1e-2 if tilted else 4e-3)
    assert found.error < 1e-4 * found.value


def test_an_energy_cut_agrees_with_a_grid():
    disk = ex.Disk.uniform()
    density = Distribution.invariant(disk, "phi=-1:1", (None, 2.0))
    found = constant_of(density)
    slow = by_grid(disk, density.describe(), 20, energy=2.0) / found.mass
    assert found.value == pytest.approx(slow, rel=1e-2)


def test_the_mass_of_an_energy_cut_is_the_volume_of_its_ellipsoids():
    """A box that holds all states of an energy: 4/3 pi times the axes, integrated over phi in closed form."""
    disk = ex.Disk.uniform()
    b, E = disk.body, 1.8
    found = falling_constant(disk, FULL + ",phidot=-9:9,sigma3=-9:9,sigma4=-9:9", energy=(None, E))
    phi = 0.5 * math.pi * np.sin(0.5 * math.pi * (np.arange(20_000) + 0.5) / 10_000 - 0.5 * math.pi)
    step = 0.25 * math.pi**2 * np.cos(0.5 * math.pi * (np.arange(20_000) + 0.5) / 10_000 - 0.5 * math.pi) / 10_000
    axes = (2.0 * (E - np.cos(phi))) ** 1.5 * np.cos(phi) / math.sqrt(b.M * b.J * b.I1)
    assert found.mass == pytest.approx(float((4.0 / 3.0 * math.pi * axes * step).sum()), rel=1e-5)


@pytest.mark.parametrize("name", ["uniform", "coin"])
def test_the_mass_is_the_integral_of_the_density(name):
    """A Gaussian and a function, against nested quadrature by scipy; natural units and SI."""
    disk = BODIES[name]
    u = disk.rate_unit
    box = f"phi=-1:0.5,phidot={bell(0.5 * u, 0.4 * u, -u, 2 * u)},sigma3={0.3 * u},sigma4={-u}:{u}"
    found = falling_constant(
        disk,
        box,
        density=lambda phi, phidot, sigma3, sigma4: 1.0 + phi**2 * (sigma4 / u) ** 2,
    )

    def value(phi, phidot, sigma4):
        return law.pdf(phidot) * (1.0 + phi**2 * sigma4**2)

    law = truncnorm(-1.5 / 0.4, 1.5 / 0.4, 0.5, 0.4)
    exact = nquad(value, [(-1.0, 0.5), (-1.0, 2.0), (-1.0, 1.0)])[0]
    assert found.mass == pytest.approx(exact, rel=1e-6)


def test_a_box_alone_has_the_mass_of_its_sides():
    density = Distribution.invariant(ex.Disk.uniform(), "phi=0,phidot=-1:2,sigma3=0:1,sigma4=-2:2")
    assert constant_of(density).mass == pytest.approx(12.0, rel=1e-13)


# Constants by adaptive Gauss quadrature, to 1e-7 of their value or better; of the narrow functions as Gaussians.
CASES = {
    "a tilt": ({"box": "phi=0.4"}, 1.8388477686),
    "a corner of the box": ({"box": "phi=-1:1,sigma3=0.5:0.501,sigma4=0.6:0.601"}, 3.7574240217),
    "energies": ({"box": "phi=-1:1", "energy": (None, 2.0)}, 1.7666307855),
    "Gaussians": ({"box": f"sigma3={bell(0.3, 0.5)},phidot={bell(0, 1)}"}, 1.2115058783),
    "a line": ({"density": lambda _, phidot, *__: np.exp(-0.5 * ((phidot - 0.377) / 1e-3) ** 2)}, 1.2298361656),
    "a band": ({"density": lambda *columns: np.exp(-0.5 * ((columns[2] - 0.377) / 1e-2) ** 2)}, 1.3008081446),
}


def test_the_stated_error_holds_neither_too_small_nor_too_large():
    """Of 24 constants 67 % lie within one error of 16 scrambles, 94 % within two, give or take four deviations."""
    disk, off = ex.Disk.uniform(), []
    for i, (given, truth) in enumerate(CASES.values()):
        density = Distribution.invariant(disk, **given)
        found = [constant_of(density, seed) for seed in range(4 * i, 4 * i + 4)]
        off += [abs(each.value - truth) / each.error for each in found]
    assert 7 <= np.sum(np.array(off) < 1.0) <= 23
    assert np.sum(np.array(off) < 2.0) >= 18


@pytest.mark.parametrize("name", ["a tilt", "a band"])
def test_a_call_gives_the_same_number_every_time_and_that_is_known(name):
    given, truth = CASES[name]
    one, other = (falling_constant(ex.Disk.uniform(), **given) for _ in range(2))
    assert one.value == other.value
    assert one.value == pytest.approx(truth, rel=1e-3)


def test_a_density_that_is_finer_than_any_points_has_the_constant_of_its_mean():
    flat = falling_constant(ex.Disk.uniform(), "phi=-1:1")
    fine = falling_constant(ex.Disk.uniform(), "phi=-1:1", density=lambda phi, *_: abs(np.sin(1e9 * phi)))
    assert abs(fine.value - flat.value) <= 4.0 * fine.error < 0.01


def test_a_long_integral_looks_at_few_points_at_a_time_and_ends_where_it_is_interrupted():
    """Python hears Ctrl-C between two looks."""
    sizes = []

    def noise(phi, phidot, sigma3, sigma4):
        sizes.append(phi.size)
        if len(sizes) == 20:
            raise KeyboardInterrupt
        return abs(np.sin(1e8 * (phi + phidot + sigma3 + sigma4)))

    with pytest.raises(KeyboardInterrupt):
        falling_constant(ex.Disk.uniform(), "phi=-1:1", density=noise)
    assert len(sizes) == 20
    assert max(sizes) <= 1 << 16


def test_energy_shells_add_up():
    disk = ex.Disk.hoop()
    shells = [falling_constant(disk, "phi=-0.8:0.8", energy=e) for e in ((None, 2.0), (2.0, 3.0), (3.0, None))]
    whole = falling_constant(disk, "phi=-0.8:0.8")
    assert sum(s.mass for s in shells) == pytest.approx(whole.mass, rel=1e-4)
    assert sum(s.mass * s.value for s in shells) == pytest.approx(whole.mass * whole.value, rel=1e-4)


def test_units_do_not_matter():
    natural = falling_constant(ex.Disk.hoop(), "phi=-0.5:0.7,sigma3=-1:2")
    disk = ex.Disk.hoop(m=3.0, r=0.2, g=9.81)
    u = disk.rate_unit
    scaled = f"phi=-0.5:0.7,phidot={-2 * u}:{2 * u},sigma3={-u}:{2 * u},sigma4={-2 * u}:{2 * u}"
    assert falling_constant(disk, scaled).value == pytest.approx(natural.value, rel=1e-6)


def test_a_density_and_its_mirror_image_change_faces():
    """Eq. (3.2): (phi, sigma4) -> (-phi, -sigma4)."""
    one = falling_constant(ex.Disk.uniform(), "phi=-0.2:0.9,sigma4=-0.5:1.5,phidot=-1:2")
    other = falling_constant(ex.Disk.uniform(), "phi=-0.9:0.2,sigma4=-1.5:0.5,phidot=-2:1")
    assert one.plus == pytest.approx(other.minus, rel=1e-6)
    assert one.plus != pytest.approx(one.minus, rel=1e-2)


def test_laws_in_words_and_weights_in_python_agree():
    disk = ex.Disk.uniform()
    words = falling_constant(disk, f"sigma3={bell(0.3, 0.5)},phidot={bell(0, 1)}")

    def weight(phi, phidot, sigma3, sigma4):
        return 7.0 * np.exp(-0.5 * ((sigma3 - 0.3) / 0.5) ** 2 - 0.5 * phidot**2)

    assert same(falling_constant(disk, density=weight), words)
    assert words.value != pytest.approx(falling_constant(disk).value, rel=1e-2)


def test_a_narrow_gaussian_is_not_missed():
    disk = ex.Disk.uniform()
    found = falling_constant(disk, "sigma3=norm:1:1e-4,phidot=norm:1:1e-4")
    at = falling_constant(disk, "phidot=0.9999:1.0001,sigma3=0.9999:1.0001")
    assert found.value == pytest.approx(at.value, rel=1e-5)


def test_a_box_beside_the_lines_has_no_constant():
    assert falling_constant(ex.Disk.uniform(), "sigma3=1:2,sigma4=-0.1:0.1").value == 0.0


def test_a_density_that_does_not_vanish_at_flat_has_none_unless_the_energy_is_bounded():
    disk = ex.Disk.uniform()
    assert falling_constant(disk, FULL).value == math.inf
    vanishing = Distribution.invariant(disk, FULL, density=lambda phi, *_: np.cos(phi) ** 2)
    assert constant_of(vanishing).value < math.inf
    bounded = falling_constant(disk, FULL, energy=":3")
    assert bounded.value == pytest.approx(2.1468058, abs=3.0 * bounded.error)
    assert bounded.error < 1e-4


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"box": "sigma3=2:1"}, "is empty"),
        ({"energy": (3.0, 2.0)}, "is empty"),
        ({"energy": "some"}, "is not a number or a range"),
        ({"energy": (None, 0.5)}, "zero in all of the box"),
        ({"box": "phi=norm:0:1"}, "goes beyond flat"),
        ({"box": "phi=-1:1,sigma3=0.8,sigma4=1.2"}, "both fixed"),
        ({"box": "sigma3=norm:0:-1"}, "MEAN:DEVIATION"),
        ({"density": 3.0}, "cannot be called"),
        ({"density": lambda *_: np.nan}, "is nan at phi = 0"),
        ({"density": lambda phi, phidot, s3, s4: s3}, "not negative"),
        ({"density": lambda *_: 0.0}, "zero in all of the box"),
        ({"density": lambda *_: np.ones(3)}, "return one number for each"),
    ],
)
def test_bad_input_is_named(options, message):
    with pytest.raises(ex.InputError, match=message):
        falling_constant(ex.Disk.uniform(), **options)


@pytest.mark.parametrize(
    ("density", "words"),
    [
        (lambda phi, *_: np.full_like(phi, 1e308), "overflows doubles; divide the density by its largest value"),
        (lambda phi, *_: np.full_like(phi, 1e-320), "too small for doubles; multiply the density by 1e300"),
        (lambda *columns: np.exp(-sum((column / 0.02) ** 2 for column in columns)), "shrink the box to where"),
        (
            lambda *columns: np.exp(-sum((column / 1e-6) ** 2 for column in columns[1:])),
            "is zero in all of the box",
        ),
    ],
    ids=["huge", "tiny", "a needle", "a thinner needle"],
)
def test_no_constant_is_given_of_a_density_whose_integral_is_not_known(density, words):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ex.InputError, match=words):
            falling_constant(ex.Disk.uniform(), "phi=-1:1", density=density)


def test_a_density_that_nearly_overflows_or_vanishes_has_the_constant_of_its_shape():
    for scale in (1e300, 1e-285):
        found = falling_constant(ex.Disk.uniform(), density=lambda phi, *_, scale=scale: np.full_like(phi, scale))
        assert found.value == pytest.approx(KNOWN["uniform"], rel=1e-6)


def test_a_box_that_is_shrunk_to_a_narrow_density_gives_more_digits():
    """The remedy of the message: a Gaussian factor by hand, and as a law, whose width is known."""
    disk, box = ex.Disk.uniform(), "phidot=0.327:0.427"
    found = falling_constant(
        disk, box, density=lambda _, phidot, *__: np.exp(-0.5 * ((phidot - 0.377) / 1e-2) ** 2)
    )
    known = falling_constant(disk, "phidot=norm:0.377:0.01")
    assert same(found, known)
    assert found.error < 1e-4


def test_a_density_is_asked_in_its_box_alone():
    """Here it would be negative outside, where face -1 sees the other half of the speeds."""
    disk, box = ex.Disk.uniform(), {"phi": 0.3, "sigma3": (-1, 1), "sigma4": (-1, 1)}
    whole = falling_constant(disk, {**box, "phidot": (-2, 2)}, density=lambda _, phidot, *__: abs(phidot))
    half = falling_constant(disk, {**box, "phidot": (0, 2)}, density=lambda _, phidot, *__: phidot)
    assert same(half, whole)
    assert whole.error < 1e-6
