"""Distributions of initial states: laws of coordinates, weights, energies, their draws, and what users write."""

import math

import numpy as np
import pytest
from conftest import BODIES
from scipy import stats
from scipy.stats import kstest, truncnorm

import explorer as ex
from explorer.measure.distributions import ANY_ENERGY, Coordinate, Distribution
from explorer.measure.sampling import BLOCK, numbered_stream
from explorer.phase.states import phi_to_states

UNIFORM = BODIES["uniform"]
BOX = "phi=-1:1,phidot=-1:3,sigma3=0.2:0.2"
WIDE = Distribution.box(UNIFORM, "phi=-1:1.2,phidot=-2:2,sigma3=0.5,sigma4=-1:3")
invariant = Distribution.invariant


def test_draws_are_uniform_in_the_box_and_fixed_coordinates_are_fixed():
    columns = WIDE.draw(numbered_stream(0, 0), 20_000)
    assert (columns["sigma3"] == 0.5).all()
    for name in ("phi", "phidot", "sigma4"):
        low, high = WIDE.coordinates[name].ends
        assert kstest(columns[name], "uniform", args=(low, high - low)).pvalue > 1e-4


def test_a_chunk_depends_on_seed_and_place_alone():
    again = [WIDE.draw(numbered_stream(7, 3), 5)["phi"] for _ in range(2)]
    np.testing.assert_array_equal(*again)
    assert not np.array_equal(again[0], WIDE.draw(numbered_stream(7, 4), 5)["phi"])
    assert not np.array_equal(again[0], WIDE.draw(numbered_stream(8, 3), 5)["phi"])


LAWS = {
    "norm:0.5:0.3": stats.norm(0.5, 0.3),
    "beta:3:2:-1:2": stats.beta(3, 2, loc=-1, scale=2),
    "t:3:0:0.1": stats.t(df=3, scale=0.1),
    "truncnorm:-4:2:0.5:0.3": stats.truncnorm(b=2, a=-4, loc=0.5, scale=0.3),
    "norm:0:0.3333333333333333": stats.norm(0, 1 / 3),
}


@pytest.mark.parametrize("text", LAWS)
def test_a_law_in_words_is_the_one_of_scipy_and_comes_back_from_its_record(text):
    mine, frozen = Coordinate.of("phidot", text), Coordinate.of("phidot", LAWS[text])
    again = Coordinate.of("phidot", frozen.describe())
    assert mine == frozen == again
    share = np.linspace(0.001, 0.999, 41)
    for each in (mine, frozen, again):
        np.testing.assert_array_equal(each.quantile(share), LAWS[text].ppf(share))


def test_a_law_in_degrees_comes_back_to_the_last_digit():
    given = {"tilt": stats.norm(25, 3), "precession": (-100 / 3, 300), "spin": "uniform:0:60"}
    box = Distribution.box(UNIFORM, given, degrees=True)
    again = Distribution.box(UNIFORM, box.describe(), degrees=True)
    assert again == box
    for name, values in box.draw(numbered_stream(1, 0), 100).items():
        np.testing.assert_array_equal(values, again.draw(numbered_stream(1, 0), 100)[name])


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (stats.gaussian_kde([0.0, 1.0, 2.0]), "phidot = .* has no ppf"),
        (stats.norm([0.0, 1.0], 1.0), "phidot = .*: its parameters are arrays; give numbers"),
        (stats.uniform_direction(3), "phidot = .* has no ppf"),
        (stats.norm, "continuous frozen distribution"),
        (stats.poisson(3), "continuous frozen distribution"),
        ("norml:1:2", "did you mean 'norm'"),
    ],
)
def test_what_is_no_law_of_one_number_is_refused_by_name(law, message):
    with pytest.raises(ex.InputError, match=message):
        Distribution.box(UNIFORM, {"phidot": law})


def test_a_law_that_no_record_can_hold_is_drawn_but_not_stored():
    law = stats.rv_histogram(np.histogram([0.1, 0.2, 0.4], 3), density=True).freeze()
    box = Distribution.box(UNIFORM, {"phidot": law})
    assert (box.draw(numbered_stream(1, 0), 10)["phidot"] < 0.4).all()
    with pytest.raises(ex.InputError, match=r"phidot = .* does not know it by name"):
        box.describe()


def test_only_densities_that_do_not_vanish_at_flat_reach_it():
    flat = f"phi=0:{0.5 * math.pi!r}"
    assert invariant(UNIFORM, flat).reaches_flat()
    assert not invariant(UNIFORM, flat, ":3").reaches_flat()
    assert not invariant(UNIFORM, "phi=0:1").reaches_flat()
    assert not invariant(UNIFORM, flat, density=lambda phi, *_: np.cos(phi)).reaches_flat()
    assert invariant(UNIFORM, f"phi=uniform:0:{0.5 * math.pi!r}").reaches_flat()
    assert not invariant(UNIFORM, f"phi=cosine:0:{0.5!r}").reaches_flat()


def test_draws_follow_the_law_and_the_weight():
    ends = (-1.0 - 0.5) / 0.3, (3.0 - 0.5) / 0.3
    law = truncnorm(*ends, loc=0.5, scale=0.3)
    drawn = Distribution.box(UNIFORM, {"phidot": law}).draw(numbered_stream(1, 0), 5000)
    assert kstest(drawn["phidot"], law.cdf).pvalue > 1e-3
    slope = invariant(UNIFORM, BOX, density=lambda phi, *_: 1.0 + phi).draw(numbered_stream(1, 1), 5000)
    assert kstest(slope["phi"], lambda phi: 0.25 * (1.0 + phi) ** 2).pvalue > 1e-3


def test_draws_stay_in_the_range_of_energy():
    drawn = invariant(UNIFORM, "phi=-1:1", (1.5, 2.5)).draw(numbered_stream(2, 0), 3000)
    energy = phi_to_states(UNIFORM, **drawn).motion.energy
    assert ((energy >= 1.5) & (energy <= 2.5)).all()


def test_an_energy_cut_keeps_the_measure_below_it():
    columns = Distribution(UNIFORM, WIDE.coordinates, (-np.inf, 2.0)).draw(numbered_stream(1, 0), 5_000)
    states = phi_to_states(UNIFORM, **columns)
    assert len(states) == 5_000
    assert (states.motion.energy <= 2.0).all()
    plain = WIDE.draw(numbered_stream(2, 0), 60_000)
    below = phi_to_states(UNIFORM, **plain).motion.energy <= 2.0
    low, high = np.quantile(plain["sigma4"][below], [0.2, 0.8])
    inside = (columns["sigma4"] > low) & (columns["sigma4"] < high)
    assert inside.mean() == pytest.approx(0.6, abs=0.03)


def test_an_energy_below_the_whole_box_is_refused_in_words():
    with pytest.raises(ex.InputError, match="widen it or shrink the box"):
        Distribution(UNIFORM, WIDE.coordinates, (-np.inf, 0.1)).draw(numbered_stream(1, 0), 10)


def test_a_weight_that_exceeds_its_looked_up_maximum_is_refused():
    drawn = invariant(UNIFORM, BOX).draw(numbered_stream(3, 0), BLOCK)["phi"][0]

    def peak(phi, *_):
        return np.where(phi == drawn, 1e6, 1.0)

    with pytest.raises(ex.InputError, match=r"more than 1\.5 times"):
        invariant(UNIFORM, BOX, density=peak).draw(numbered_stream(3, 0), 10)


def test_a_weight_of_another_shape_is_refused():
    density = invariant(UNIFORM, BOX, density=lambda phi, *_: np.ones(phi.size + 1))
    with pytest.raises(ex.InputError, match=r"density: returned ndarray .* for 3 states"):
        density.called(dict.fromkeys(("phi", "phidot", "sigma3", "sigma4"), np.full(3, 0.1)))


@pytest.mark.parametrize(
    ("given", "ends"),
    [("1:2", (1.0, 2.0)), (":3", (-math.inf, 3.0)), ("2:", (2.0, math.inf)), ((None, 4), (-math.inf, 4.0))],
)
def test_ranges_of_energy_may_be_open(given, ends):
    assert invariant(UNIFORM, energy=given).energy == ends


def test_a_distribution_says_what_it_is_and_tells_weights_apart():
    def one(phi, *_):
        return 1.0 + phi**2

    def other(phi, *_):
        return 1.0 + phi**4

    digests = [invariant(UNIFORM, BOX, density=f).describe_weight()["sha256_of_values"] for f in (one, other)]
    assert digests[0] != digests[1]
    plain = invariant(UNIFORM)
    assert plain.describe_weight() is None
    assert plain.describe()["phidot"] == [-2.0, 2.0]
    assert plain.energy == ANY_ENERGY


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"energy": (2.0, 1.0)}, "is empty"),
        ({"energy": "some"}, "is not a number or a range"),
        ({"box": 0.5}, "is no text"),
        ({"box": "phi=norm:0:0"}, "not the parameters of norm"),
        ({"box": "phi=norm:0:1"}, "goes beyond flat, .* cut it off"),
        ({"density": 3.0}, "cannot be called"),
        ({"box": "phidot=-1e9:1e9"}, "give a narrower range"),
        ({"box": "phidot=norm:0:1e9"}, "give a narrower range"),
        ({"box": "phi=0:3"}, "between -pi/2 and pi/2"),
        ({"box": "phidot=2:1"}, "smaller number first"),
        ({"box": "sigm3=1"}, "did you mean 'sigma3'"),
        ({"box": "sigma3=a:b"}, "box sigma3 .* is no distribution"),
        ({"box": "sigma3=1,sigma3=2"}, "once"),
        ({"box": "sigma4=-inf:1"}, "finite numbers"),
        ({"box": "phi"}, "is not a number or a range LOW:HIGH"),
        ({"disk": ex.Disk(I1=1e-6, I3=2e-6)}, "too steep"),
    ],
)
def test_bad_input_is_named(options, message):
    with pytest.raises(ex.InputError, match=message):
        invariant(**{"disk": UNIFORM, "box": BOX, **options})


def test_what_a_weight_of_the_user_raises_passes_through():
    density = invariant(UNIFORM, BOX, density=lambda *state: {}["none"])
    with pytest.raises(KeyError, match="none"):
        density.describe_weight()


def test_what_a_box_leaves_out_keeps_its_default():
    box = Distribution.box(UNIFORM, "phidot=1")
    assert box.coordinates["phidot"].ends == (1.0, 1.0)
    assert box.coordinates["sigma3"].ends == (-2.0, 2.0)
    coin = BODIES["coin"]
    assert Distribution.box(coin).coordinates["sigma3"].ends[1] == 2.0 * coin.rate_unit
