"""Race angles counted for pictures."""

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer.measure.races import SIDES, binned, by_decade, race_law, race_ridges
from explorer.scenes.race_angles import RaceAngles

UNIFORM, COIN = BODIES["uniform"], BODIES["coin"]


def test_ridges_of_a_summary_are_coarser_and_no_passage_is_lost_or_changes_its_side():
    scene = RaceAngles.of({"samples": 500})
    total = computed(scene)
    summary = scene.summarise(total)
    assert [row["decade"] for row in summary["ridges"]] == sorted(by_decade(total.decades)) == [-6, -5, -4, -3]
    for row in summary["ridges"]:
        for name, side in SIDES.items():
            fine = total.decades.part([2 * row["decade"] + (side > 0)])
            for part, half in (("below", {"above": False}), ("above", {"below": False})):
                one, other = row[name][part], fine.row(**half)
                assert one["zeros"] + sum(one["counts"]) == other.total
                assert one["range"] == ([other.smallest, other.largest] if other.total else [])
    for name in SIDES:
        angles = summary["histogram"]
        counted = [sum(part["counts"]) for row in summary["ridges"] for part in row[name].values()]
        assert sum(angles[f"counts_{name}"]) + angles[f"outside_{name}"] == sum(counted)


def test_races_of_ones_own_are_counted_as_a_run_counts_them():
    scene = RaceAngles.of({"samples": 300, "keep": "all"})
    table, theirs = scene.chunk(0)[0], scene.summarise(computed(scene))
    ours = race_ridges(UNIFORM, table["eta_hat"], table["race_angle"])
    assert ours == {name: theirs[name] for name in ours}


def test_zeros_and_failures_belong_to_no_decade():
    (row,) = race_ridges(UNIFORM, [1e-3, 0.0, np.nan, -1e-3], [0.1, 0.2, 0.3, np.nan])["ridges"]
    assert row["decade"] == -3
    assert [sum(part["counts"]) for name in SIDES for part in row[name].values()] == [1, 0, 0, 0]


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
    limit = UNIFORM.race_limit
    (row,) = race_ridges(UNIFORM, 1e-3, limit + np.array([1e-3, 2e-3, 5e-2, 0.3]))["ridges"]
    part = row["plus"]["above"]
    assert binned(part, np.geomspace(1e-4, 1.0, 9)).sum() == pytest.approx(4.0)
    np.testing.assert_allclose(binned(part, np.array([1e-4, 1e-2, 1.0])), [2.0, 2.0])


def test_shapes_that_do_not_fit_are_named():
    with pytest.raises(ex.InputError, match="shapes"):
        race_ridges(UNIFORM, [1e-3, 1e-4], [1.0, 2.0, 3.0])
