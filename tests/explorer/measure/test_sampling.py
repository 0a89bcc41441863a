"""Boxes, streams and draws: that they are uniform, repeatable, and refuse nonsense."""

import numpy as np
import pytest
from conftest import BODIES
from scipy.stats import kstest

import explorer as ex
from explorer.measure.density import Density
from explorer.measure.sampling import Box, box_of, log_uniform, numbered_stream, read_ranges
from explorer.phase.states import phi_to_states

UNIFORM = BODIES["uniform"]
WIDE = Box((-1.0, 1.2), (-2.0, 2.0), (0.5, 0.5), (-1.0, 3.0))


def test_draws_are_uniform_in_the_box_and_fixed_coordinates_are_fixed():
    columns = WIDE.draw(numbered_stream(0, 0), 20_000)
    assert (columns["sigma3"] == 0.5).all()
    for name in WIDE.free:
        low, high = WIDE.ranges[name]
        assert kstest(columns[name], "uniform", args=(low, high - low)).pvalue > 1e-4


def test_a_chunk_depends_on_seed_and_place_alone():
    again = [WIDE.draw(numbered_stream(7, 3), 5)["phi"] for _ in range(2)]
    np.testing.assert_array_equal(*again)
    assert not np.array_equal(again[0], WIDE.draw(numbered_stream(7, 4), 5)["phi"])
    assert not np.array_equal(again[0], WIDE.draw(numbered_stream(8, 3), 5)["phi"])


# The first doubles of Philox, seed 0, chunk 0.
STREAM = ["0x1.7140b364494fdp-1", "0x1.b924c9003caa0p-6", "0x1.9c32fa6c393e4p-2"]


def test_the_first_draws_of_a_stream_never_change():
    """A run must be repeatable with later releases: these bits are part of the format."""
    got = numbered_stream(0, 0).random(3)
    assert [x.hex() for x in got] == STREAM


def test_an_energy_cut_keeps_the_measure_below_it():
    columns = Density(WIDE, (-np.inf, 2.0)).draw(UNIFORM, numbered_stream(1, 0), 5_000)
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
        Density(WIDE, (-np.inf, 0.1)).draw(UNIFORM, numbered_stream(1, 0), 10)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("phi=0:3", "between -pi/2 and pi/2"),
        ("phidot=2:1", "smaller number first"),
        ("sigm3=1", "did you mean 'sigma3'"),
        ("sigma3=a:b", "finite numbers"),
        ("sigma3=1,sigma3=2", "once"),
        ("sigma4=-inf:1", "finite numbers"),
        ("phi", "is not a number or a range LOW:HIGH"),
    ],
)
def test_boxes_that_make_no_sense_are_refused_by_name(text, message):
    with pytest.raises(ex.InputError, match=message):
        box_of(UNIFORM, read_ranges("box", text))


def test_what_a_box_leaves_out_keeps_its_default():
    box = box_of(UNIFORM, read_ranges("box", "phidot=1"))
    assert box.ranges["phidot"] == (1.0, 1.0)
    assert box.ranges["sigma3"] == (-2.0, 2.0)
    coin = BODIES["coin"]
    assert Box.default(coin).ranges["sigma3"][1] == 2.0 * coin.rate_unit


def test_log_uniform_covers_its_decades_evenly():
    values = np.log10(log_uniform(numbered_stream(3, 0).random(20_000), 1e-6, 1e-2))
    assert kstest(values, "uniform", args=(-6, 4)).pvalue > 1e-4


def test_the_reduced_flow_preserves_the_measure():
    """The field in (phi, phidot, sigma3, sigma4) has no divergence: by central differences."""
    from kernels.disk.field import State, reduced

    b = UNIFORM.body

    def rates(y):
        phi, phidot, s3, s4 = y
        q = np.cos(phi)
        _q, _z, dp, drho, ds4 = reduced(State(q, np.sin(phi), -phidot, s3 / q, s4, 0, 0, 0, 0, 0), b)
        ds3 = (-q * np.sin(phi) * phidot) * s3 / q + q * drho  # sigma3 = q rho, q' = z q p
        return np.array([q * phidot, -dp, ds3, ds4]) / q

    rng = np.random.default_rng(0)
    for y in np.column_stack([rng.uniform(-1.2, 1.2, 20), rng.uniform(-2, 2, (20, 3))]):
        step = 1e-5 * np.eye(4)
        divergence = sum((rates(y + step[i])[i] - rates(y - step[i])[i]) / 2e-5 for i in range(4))
        assert abs(divergence) < 1e-6


def test_a_face_is_one_of_two_and_no_range():
    for face in ("-1:1", "0.5"):
        with pytest.raises(ex.InputError, match=r"face = .*: give 1 or -1"):
            ex.slice_map(ex.Disk.uniform(), f"phi=0:1,phidot=1,sigma3_bar=-2:2,eta_hat=1,face={face}", points=3)
