"""Race angles counted for pictures."""

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer.measure.races import RaceRidges, binned, by_decade, race_law, race_ridges, ridge_rows
from explorer.measure.tallies import LogHistogram
from explorer.scenes.race_angles import RaceAngles

UNIFORM, COIN = BODIES["uniform"], BODIES["coin"]


def test_ridges_come_back_from_a_summary():
    """Counts of a summary are coarser, and no passage is lost or changes its side."""
    scene = RaceAngles(samples=500)
    total = computed(scene)
    summary = scene.summarise(total)
    found = RaceRidges.of_summary(summary)
    assert sorted(found.ridges) == sorted(by_decade(total.decades)) == [-6, -5, -4, -3]
    for decade, sides in found.ridges.items():
        for side, counts in sides.items():
            fine = total.decades.part([2 * decade + (side > 0)])
            for half in ({"above": False}, {"below": False}):
                (one, other) = counts.row(**half), fine.row(**half)
                assert (one.total, one.smallest, one.largest) == (other.total, other.smallest, other.largest)
            assert counts.quantile(0.5) == pytest.approx(fine.quantile(0.5), rel=0.06)
    assert sum(found.angles[1][0]) + found.angles[1][1] == sum(sides[1].total for sides in found.ridges.values())


def test_races_of_ones_own_are_counted_as_a_run_counts_them():
    scene = RaceAngles(samples=300, keep="all")
    table = scene.chunk(0)[0]
    ours = race_ridges(UNIFORM, table["eta_hat"], table["race_angle"])
    theirs = RaceRidges.of_summary(scene.summarise(computed(scene)))
    assert ridge_rows(ours.ridges) == ridge_rows(theirs.ridges)
    for side in (1, -1):
        np.testing.assert_array_equal(ours.angles[side][0], theirs.angles[side][0])


def test_zeros_and_failures_belong_to_no_decade():
    found = race_ridges(UNIFORM, [1e-3, 0.0, np.nan, -1e-3], [0.1, 0.2, 0.3, np.nan])
    assert list(found.ridges) == [-3]
    assert (found.ridges[-3][1].total, found.ridges[-3][-1].total) == (1, 0)


def test_the_constant_of_the_law_does_not_depend_on_the_units():
    constants = []
    for disk in (UNIFORM, COIN):
        unit = disk.rate_unit
        found = ex.passages(disk, unit, 1e-5 * unit, unit, accuracy=1e-9)
        (row,) = race_law(disk, 1e-5 * unit, found.race_angle, found.impact_speed)
        constants.append(row["constant"]["0.5"])
        assert 0.4 < row["eta_hat"] / (1e-5 * unit) < 2.5
    assert constants[0] == pytest.approx(constants[1], rel=1e-5)


@pytest.mark.parametrize("side", [1, -1])
def test_races_made_by_the_law_give_its_constant_back(side):
    """Beyond its limit the contact point races K eta (ln(1/eta) - c) further, towards the same side."""
    eta_hat = side * np.geomspace(1e-6, 1e-3, 30)
    eta, b = abs(UNIFORM.eta_hat_to_eta(eta_hat)), UNIFORM.body
    scale = 2.0 / (b.I1 * b.M) * eta
    race_angle = side * (UNIFORM.race_limit + scale * (np.log(1.0 / eta) - 9.5))
    for row in race_law(UNIFORM, eta_hat, race_angle, 1.0):
        assert row["constant"]["0.5"] == pytest.approx(9.5, rel=0.01)


def test_counts_are_shared_out_between_edges_and_none_is_lost():
    values = np.array([1e-3, 2e-3, 5e-2, 0.3])
    sizes = LogHistogram()
    sizes.count(values)
    counts = sizes.row()
    edges = np.geomspace(1e-4, 1.0, 9)
    assert binned(counts, edges).sum() == pytest.approx(4.0)
    np.testing.assert_allclose(binned(counts, np.array([1e-4, 1e-2, 1.0])), [2.0, 2.0])


def test_shapes_that_do_not_fit_are_named():
    with pytest.raises(ex.InputError, match="shapes"):
        race_ridges(UNIFORM, [1e-3, 1e-4], [1.0, 2.0, 3.0])
