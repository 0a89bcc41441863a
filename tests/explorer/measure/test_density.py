"""Densities: their factors, their draws, and what users write."""

import math

import numpy as np
import pytest
from conftest import BODIES
from scipy.stats import kstest, truncnorm

import explorer as ex
from explorer.measure.density import ANY_ENERGY, Density
from explorer.measure.sampling import BLOCK, Box, numbered_stream
from explorer.phase.states import phi_to_states

UNIFORM = BODIES["uniform"]
BOX = "phi=-1:1,phidot=-1:3,sigma3=0.2:0.2"


@pytest.mark.parametrize(("mean", "deviation"), [(0.5, 0.3), (-2.0, 0.4), (9.0, 0.5), (1.0, 50.0)])
def test_a_truncated_gaussian_has_the_quantiles_of_scipy(mean, deviation):
    """Also where only a tail of it lies in the box."""
    density = Density.of(UNIFORM, BOX, gaussian=f"phidot={mean}:{deviation}")
    ends = (-1.0 - mean) / deviation, (3.0 - mean) / deviation
    share = np.linspace(0.0, 1.0, 41)
    expected = truncnorm.ppf(share, *ends, loc=mean, scale=deviation)
    np.testing.assert_allclose(density.quantile("phidot", share), expected, atol=1e-7)


def test_beyond_its_reach_a_gaussian_is_below_rounding():
    density = Density.of(UNIFORM, BOX, gaussian="phidot=0:0.05")
    low, high = density.reach("phidot")
    assert -1.0 < low < -0.4 < 0.4 < high < 3.0
    assert math.exp(-0.5 * (high / 0.05) ** 2) < 2.3e-16
    assert density.reach("phi") == (-1.0, 1.0)


def test_only_densities_that_do_not_vanish_at_flat_reach_it():
    flat = f"phi=0:{0.5 * math.pi!r}"
    assert Density.of(UNIFORM, flat).reaches_flat()
    assert not Density.of(UNIFORM, flat, ":3").reaches_flat()
    assert not Density.of(UNIFORM, "phi=0:1").reaches_flat()
    assert not Density.of(UNIFORM, flat, density=lambda phi, *_: np.cos(phi)).reaches_flat()


def test_a_wide_gaussian_may_lie_far_from_the_box():
    """What counts is the distance in its own deviations."""
    assert Density.of(UNIFORM, box=BOX, gaussian="phi=50:2").gaussian


def test_draws_follow_the_gaussian_and_the_function():
    bell = Density.of(UNIFORM, BOX, gaussian="phidot=0.5:0.3").draw(UNIFORM, numbered_stream(1, 0), 5000)
    ends = (-1.0 - 0.5) / 0.3, (3.0 - 0.5) / 0.3
    assert kstest(bell["phidot"], truncnorm(*ends, loc=0.5, scale=0.3).cdf).pvalue > 1e-3
    slope = Density.of(UNIFORM, BOX, density=lambda phi, *_: 1.0 + phi).draw(UNIFORM, numbered_stream(1, 1), 5000)
    assert kstest(slope["phi"], lambda phi: 0.25 * (1.0 + phi) ** 2).pvalue > 1e-3


def test_draws_stay_in_the_range_of_energy():
    density = Density.of(UNIFORM, "phi=-1:1", (1.5, 2.5))
    drawn = density.draw(UNIFORM, numbered_stream(2, 0), 3000)
    energy = phi_to_states(UNIFORM, **drawn).motion.energy
    assert ((energy >= 1.5) & (energy <= 2.5)).all()


def test_a_function_that_exceeds_its_looked_up_maximum_is_refused():
    drawn = Density.of(UNIFORM, BOX).box.draw(numbered_stream(3, 0), BLOCK)["phi"][0]

    def peak(phi, *_):
        return np.where(phi == drawn, 1e6, 1.0)

    with pytest.raises(ex.InputError, match=r"more than 1\.5 times"):
        Density.of(UNIFORM, BOX, density=peak).draw(UNIFORM, numbered_stream(3, 0), 10)


def test_a_function_of_another_shape_is_refused():
    density = Density.of(UNIFORM, BOX, density=lambda phi, *_: np.ones(phi.size + 1))
    with pytest.raises(ex.InputError, match=r"density: returned ndarray .* for 3 states"):
        density.shape(*np.full((4, 3), 0.1))


@pytest.mark.parametrize(
    ("given", "ends"),
    [("1:2", (1.0, 2.0)), (":3", (-math.inf, 3.0)), ("2:", (2.0, math.inf)), ((None, 4), (-math.inf, 4.0))],
)
def test_ranges_of_energy_may_be_open(given, ends):
    assert Density.of(UNIFORM, energy=given).energy == ends


def test_a_density_says_what_it_is_and_tells_functions_apart():
    def one(phi, *_):
        return 1.0 + phi**2

    def other(phi, *_):
        return 1.0 + phi**4

    described = [Density.of(UNIFORM, BOX, (1.0, None), "phi=0:1", f).describe() for f in (one, other)]
    assert described[0]["energy"] == [1.0, None]
    assert described[0]["gaussian"] == {"phi": [0.0, 1.0]}
    digests = [row["density"]["sha256_of_values"] for row in described]
    assert digests[0] != digests[1]
    assert Density(Box.default(UNIFORM)).describe() == {"box": Box.default(UNIFORM).describe()}
    assert Density.of(UNIFORM).energy == ANY_ENERGY


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"energy": (2.0, 1.0)}, "is empty"),
        ({"energy": "some"}, "is not a number or a range"),
        ({"gaussian": "sigma3=0:1"}, "box has no range for"),
        ({"gaussian": 0.5}, "is no text"),
        ({"gaussian": "phi=0:0"}, "MEAN:DEVIATION"),
        ({"gaussian": "phi=0:1e-9"}, "MEAN:DEVIATION"),
        ({"gaussian": "phi=50:1"}, "at most 37 deviations outside"),
        ({"gaussian": "phi=15:0.25"}, "at most 37 deviations outside"),
        ({"density": 3.0}, "cannot be called"),
        ({"box": "phidot=-1e9:1e9"}, "give a narrower range"),
        ({"disk": ex.Disk(I1=1e-6, I3=2e-6)}, "too steep"),
    ],
)
def test_bad_input_is_named(options, message):
    with pytest.raises(ex.InputError, match=message):
        Density.of(**{"disk": UNIFORM, "box": BOX, **options})


def test_what_a_density_of_the_user_raises_passes_through():
    density = Density.of(UNIFORM, BOX, density=lambda *state: {}["none"])
    with pytest.raises(KeyError, match="none"):
        density.describe()
