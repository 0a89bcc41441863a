"""Integrals over boxes against closed forms and against scipy."""

import math

import numpy as np
import pytest
from conftest import BODIES
from scipy.integrate import nquad, quad

from explorer.measure.box_integrals import NODES, Integral, Integrator, panels_between
from explorer.measure.density import Density

UNIFORM, COIN = BODIES["uniform"], BODIES["coin"]


def over_tilts(f, pieces):
    return Integrator(UNIFORM, Density.of(UNIFORM)).over_tilts(lambda phi: np.stack([f(phi), f(phi)]), pieces)


def test_an_integral_over_tilts_is_that_of_its_pieces():
    found = over_tilts(lambda phi: np.cos(phi) ** 3, [(-1.0, 0.3), (0.3, 1.2)])
    exact = quad(lambda phi: math.cos(phi) ** 3, -1.0, 1.2)[0]
    assert found.value == pytest.approx(exact, rel=1e-9)
    assert abs(found.value - exact) <= found.error + 1e-15
    assert over_tilts(np.cos, [(0.5, 0.5)]).value == math.cos(0.5)


@pytest.mark.parametrize("count", NODES)
def test_nodes_integrate_a_square_root_that_ends_at_an_end(count):
    nodes, weights = panels_between([np.array([0.0]), np.array([0.5]), np.array([2.0])], count)
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
    assert Integrator(disk, density.seen_from(disk, 1)).mass().value == pytest.approx(exact, rel=1e-6)


def test_a_box_alone_has_the_mass_of_its_sides():
    density = Density.of(UNIFORM, "phi=0,phidot=-1:2,sigma3=0:1,sigma4=-2:2")
    assert Integrator(UNIFORM, density).mass() == Integral(pytest.approx(12.0), 0.0)
    assert density.factor_mass("sigma4") == 4.0


def test_a_density_that_is_never_smooth_ends_and_its_error_says_so():
    density = Density.of(
        UNIFORM, "phi=-1:1,phidot=0,sigma3=0,sigma4=1", density=lambda phi, *_: abs(np.sin(1e9 * phi))
    )
    found = Integrator(UNIFORM, density).mass()
    assert found.error > 0.01 * found.value
    assert abs(found.value - 4.0 / math.pi) < 5.0 * found.error


def test_a_long_integral_looks_at_few_points_at_a_time_and_ends_where_it_is_interrupted():
    """Python hears Ctrl-C between two looks, of which this integral would take a thousand."""
    sizes = []

    def noise(phi, phidot, sigma3, sigma4):
        sizes.append(phi.size)
        if len(sizes) == 20:
            raise KeyboardInterrupt
        return abs(np.sin(1e8 * (phi + phidot + sigma3 + sigma4)))

    integrator = Integrator(UNIFORM, Density.of(UNIFORM, "phi=-1:1", density=noise))
    sizes.clear()
    with pytest.raises(KeyboardInterrupt):
        integrator.mass()
    assert len(sizes) == 20
    assert max(sizes) <= 1 << 16
