"""Integrals over boxes against closed forms and against scipy."""

import math
import signal
import time

import numpy as np
import pytest
from conftest import BODIES
from scipy.integrate import nquad, quad

from explorer.measure.box_integrals import (
    Integral,
    NaturalDensity,
    Work,
    over_tilts,
    panels_between,
)
from explorer.measure.density import Density

UNIFORM, COIN = BODIES["uniform"], BODIES["coin"]


def test_an_integral_over_tilts_is_that_of_its_pieces():
    found = over_tilts(lambda phi: np.cos(phi) ** 3, [(-1.0, 0.3), (0.3, 1.2)], 16, 1e-9)
    exact = quad(lambda phi: math.cos(phi) ** 3, -1.0, 1.2)[0]
    assert found.value == pytest.approx(exact, rel=1e-9)
    assert abs(found.value - exact) <= found.error + 1e-15
    assert over_tilts(np.cos, [(0.5, 0.5)], 16, 1e-9).value == math.cos(0.5)


@pytest.mark.parametrize("panels", [1, 2, 4])
def test_nodes_integrate_a_square_root_that_ends_at_an_end(panels):
    nodes, weights = panels_between([np.array([0.0]), np.array([0.5]), np.array([2.0])], panels)
    kinked = np.sqrt(2.0 - nodes) * abs(nodes - 0.5)
    exact = quad(lambda x: math.sqrt(2.0 - x) * abs(x - 0.5), 0.0, 2.0, points=[0.5], epsabs=1e-13)[0]
    assert (kinked * weights).sum() == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("disk", [UNIFORM, COIN], ids=["natural", "SI"])
def test_the_mass_is_the_integral_of_the_density(disk):
    """A Gaussian and a function, against nested quadrature by scipy in the units of the disk."""
    u = disk.rate_unit
    box = f"phi=-1:0.5,phidot={-u}:{2 * u},sigma3={0.3 * u},sigma4={-u}:{u}"

    def tilted(phi, phidot, sigma3, sigma4):
        return 1.0 + phi**2 * (sigma4 / u) ** 2

    density = Density.of(disk, box, None, f"phidot={0.5 * u}:{0.4 * u}", tilted)

    def value(phi, phidot, sigma4):
        bell = math.exp(-0.5 * ((phidot - 0.5) / 0.4) ** 2)
        return bell * (1.0 + phi**2 * sigma4**2)

    exact = nquad(value, [(-1.0, 0.5), (-1.0, 2.0), (-1.0, 1.0)])[0]
    assert NaturalDensity(disk, density).mass().value == pytest.approx(exact, rel=1e-6)


def test_a_box_alone_has_the_mass_of_its_sides():
    natural = NaturalDensity(UNIFORM, Density.of(UNIFORM, "phi=0,phidot=-1:2,sigma3=0:1,sigma4=-2:2"))
    assert natural.mass() == Integral(pytest.approx(12.0), 0.0)
    assert natural.factor_mass("sigma4") == 4.0


def test_only_densities_that_do_not_vanish_at_flat_reach_it():
    flat = f"phi=0:{0.5 * math.pi!r}"
    assert NaturalDensity(UNIFORM, Density.of(UNIFORM, flat)).reaches_flat()
    assert not NaturalDensity(UNIFORM, Density.of(UNIFORM, flat, ":3")).reaches_flat()
    assert not NaturalDensity(UNIFORM, Density.of(UNIFORM, "phi=0:1")).reaches_flat()
    vanishing = Density.of(UNIFORM, flat, density=lambda phi, *_: np.cos(phi))
    assert not NaturalDensity(UNIFORM, vanishing).reaches_flat()


@pytest.mark.parametrize("spent", [0, 299_000_000])
def test_an_integrand_that_is_never_smooth_ends_and_its_error_says_so(spent):
    work = Work(spent)

    def noise(phi):
        work.points += 100_000 * phi.size
        return abs(np.sin(1e9 * phi))

    found = over_tilts(noise, [(-1.0, 0.0), (0.0, 1.0)], 4, 1e-7, work)
    assert work.points - spent < (40_000_000 if spent else 300_000_000)
    assert found.error > 0.01 * found.value
    assert abs(found.value - 4.0 / math.pi) < 5.0 * found.error


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there are no such timers")
def test_a_long_integral_is_interrupted_within_a_second():
    begun = []

    def ring(number, frame):
        begun.append(time.process_time())  # its own: others may share the machine
        raise KeyboardInterrupt

    def noise(phi, phidot, sigma3, sigma4):
        return abs(np.sin(1e8 * (phi + phidot + sigma3 + sigma4)))

    natural = NaturalDensity(UNIFORM, Density.of(UNIFORM, "phi=-1:1", density=noise))
    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(KeyboardInterrupt):
            natural.mass()  # some ten seconds
        assert time.process_time() - begun[0] < 1.0
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
