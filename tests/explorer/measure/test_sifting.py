"""The compiled pass over states of a box, against the same states drawn, judged and counted step by step."""

import math

import numpy as np
import pytest
from conftest import BODIES

from explorer.measure.sampling import Box, box_of, numbered_stream
from explorer.measure.sifting import in_lanes, sift
from explorer.scenes.falling_set import FallingSet

BOXES = {
    "the vertical": {},
    "tilts": {"box": "phi=-1:1"},
    "all tilts": {"box": f"phi={-0.5 * math.pi}:{0.5 * math.pi},sigma3=-1:2"},
    "from rest": {"box": "phi=-1:0.2,phidot=0"},
    "one tilt": {"box": "phi=0.3,sigma4=0.2"},
    "no gyration": {"box": "sigma3=0,sigma4=0"},
    "near F": {"box": "phidot=0.5:1,sigma3=1:1.0001,sigma4=0.7285:0.7286"},
}


def both(**options):
    """What a chunk gives in one pass, and step by step."""
    scene = FallingSet(theta_min="near", **options)
    fused = scene.chunk(0)
    vars(scene)["_in_lanes"] = False
    return fused, scene.chunk(0)


def same(fused, stepwise, unit=1.0):
    for name, values in stepwise[0].items():
        np.testing.assert_array_equal(fused[0][name], values)
    found, expected = fused[1].state(), stepwise[1].state()
    rows = [tally.distance.row() for _, tally in (fused, stepwise)]
    # Sums are rounded otherwise in lanes; a distance is one of rates of order one.
    for end in ("smallest", "largest"):
        assert getattr(rows[0], end) == pytest.approx(getattr(rows[1], end), rel=1e-14, abs=1e-15 * unit)
    assert rows[0].zeros == rows[1].zeros
    filled = [{row.first + k: row.counts[k] for k in np.flatnonzero(row.counts)} for row in rows]
    assert filled[0] == filled[1]
    assert {**found, "distance": 0} == {**expected, "distance": 0}


@pytest.mark.parametrize("name", ["uniform", "coin", "heavy-core", "thick"])
@pytest.mark.parametrize("box", BOXES)
def test_one_pass_gives_what_single_steps_give(name, box):
    disk = BODIES[name]
    same(*both(disk=disk, samples=5000, seed=2, **BOXES[box]), disk.rate_unit)


@pytest.mark.parametrize("samples", [1, 63, 257, 16_384 + 3, 40_000])
def test_blocks_and_lanes_that_are_not_full_count_what_they_hold(samples):
    fused, stepwise = both(samples=samples, box="phi=-0.5:0.5")
    assert sum(fused[1].faces.values()) == samples
    same(fused, stepwise)


def test_states_on_f_are_counted_apart_and_kept():
    """The pendulum without gyration lies on both lines: every distance is 0."""
    (kept, tally), _ = both(samples=2000, box="sigma3=0,sigma4=0")
    assert tally.distance.row().zeros == tally.could_fall == len(kept["phi"]) > 0
    assert tally.status["falls"] == tally.could_fall


def test_flat_states_are_no_states():
    """Of the tilts within a few units of rounding of -pi/2 one is flat itself."""
    flat = -0.5 * math.pi
    (_, tally), _ = both(samples=500, box=f"phi={flat!r}:{flat + 4.5e-16!r}")
    assert tally.status["bad_input"] == 500 - sum(tally.faces.values())
    assert 50 < tally.status["bad_input"] < 450


def test_distances_at_the_edges_of_bins_are_placed_as_the_librarys_logarithm_places_them():
    disk = BODIES["uniform"]
    for exponent in (-3, -2, -1):
        box = Box((0.0, 0.0), (1.0, 1.0), (0.0, 0.0), (10.0**exponent, 10.0**exponent))
        found = sift(disk, box, [numbered_stream(0, 0)], (64, 64), 1.0)
        distance = found.distance.row()
        assert distance.total == found.could_fall == 64
        (filled,) = np.flatnonzero(distance.counts)
        assert distance.first + filled == math.floor(400.0 * math.log10(distance.smallest))


def test_rates_whose_squares_overflow_are_left_to_single_steps():
    disk = BODIES["coin"]
    assert in_lanes(disk, Box.default(disk))
    assert not in_lanes(disk, box_of(disk, {"sigma3": (0.0, 1e120)}))
