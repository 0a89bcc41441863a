"""Counts of race angles: what adds up, and means by decade."""

import json

import numpy as np
import pytest
from conftest import BODIES

from explorer.scenes.race_counts import RaceCounter, RaceCounts, count_bounces, count_races

UNIFORM = BODIES["uniform"]
LIMIT = UNIFORM.race_limit


def bounces_of(seed, count=500):
    random = np.random.default_rng(seed)
    eta_hat = 10.0 ** random.uniform(-4, -1, count) * random.choice([1.0, -1.0], count)
    race = np.sign(eta_hat) * LIMIT + eta_hat
    race[::50], eta_hat[::100] = np.nan, np.nan
    ones = np.ones(count)
    return {
        "race_angle": race,
        "eta_hat": eta_hat,
        "delta_chi": ones,
        "wrong_way": np.zeros(count, bool),
        "impact_speed": ones,
        "energy": ones,
        "error_estimate": ones,
    }


def counted(tables):
    total = RaceCounts()
    for table in tables:
        tally = {"status": {"ok": 500}, **count_races(table, UNIFORM), **count_bounces(table)}
        total.add(json.loads(json.dumps(tally, allow_nan=False)))
    return total


def test_chunks_add_up_to_the_whole():
    one, two = bounces_of(1), bounces_of(2)
    whole = {name: np.concatenate([one[name], two[name]]) for name in one}
    parts, together = counted([one, two]), counted([whole])
    assert parts.bounces == together.bounces == 1000
    assert parts.without_race == together.without_race == 20
    for a, b in zip(parts.by_decade(), together.by_decade(), strict=True):
        assert a == pytest.approx(b, rel=1e-14)


def test_blocks_are_counted_as_the_whole_is():
    """To the last digit, with motions on F and races that nobody knows among them."""
    table = bounces_of(5)
    table["eta_hat"][1::100], table["impact_speed"][::7] = 0.0, 0.5
    table["error_estimate"] = np.random.default_rng(6).uniform(1e-12, 1e-6, 500)
    whole, parts = RaceCounter(UNIFORM, 500), RaceCounter(UNIFORM, 500)
    whole.add(table)
    for first in (0, 1, 300):
        last = {0: 1, 1: 300, 300: 500}[first]
        parts.add({name: values[first:last] for name, values in table.items()})
    assert json.dumps(parts.tally()) == json.dumps(whole.tally()) == json.dumps(count_races(table, UNIFORM))


def test_means_by_decade_are_those_of_the_races():
    table = bounces_of(3)
    for row in counted([table]).by_decade():
        low = row["eta_hat_from"]
        chosen = (table["eta_hat"] >= low) & (table["eta_hat"] < 10 * low) & np.isfinite(table["race_angle"])
        assert row["mean_plus"] == pytest.approx(table["race_angle"][chosen].mean(), rel=1e-12)


def test_the_deviations_of_both_sides_add_up_by_decade():
    """One count for each resolved race off F: sides, decades and the rows of the summary hold the same."""
    table = bounces_of(4)
    total = counted([table])
    known = np.isfinite(table["race_angle"]) & np.isfinite(table["eta_hat"])
    assert total.races("plus") + total.races("minus") == known.sum()
    assert sum(row["passages"] for row in total.by_decade()) == known.sum()
    assert total.races("plus") == (known & (table["eta_hat"] > 0)).sum()
