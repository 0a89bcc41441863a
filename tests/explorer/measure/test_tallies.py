"""Counts that add up: in any order and any parts they are those of all samples, also as JSON."""

import json
import math

import numpy as np
import pytest

from explorer.measure.tallies import ByName, Histogram, Least, LogHistogram, Tally


class Everything(Tally):
    many: int
    sums: ByName[float]
    angles: ByName[Histogram]
    sizes: LogHistogram
    plane: Least
    rows: list


def counted(values):
    tally = Everything(many=values.size)
    for name, side in (("plus", 1), ("minus", -1)):
        chosen = values[side * values > 0.0]
        tally.sums[name] += float(chosen.sum())
        tally.angles[name] += Histogram([*np.histogram(chosen, 7, (-1.0, 1.0))[0], 0])
    tally.sizes.count(values, np.floor(3.0 * abs(values)))
    tally.plane = Least(np.where(np.arange(9) < values.size, 7, Least.NONE))
    tally.rows += [float(values[0])]
    return tally


@pytest.fixture
def values():
    random = np.random.default_rng(1)
    return random.choice([-1.0, 1.0], 5000) * 10.0 ** random.uniform(-300.0, 0.0, 5000)


@pytest.mark.parametrize("parts", [1, 2, 7])
def test_parts_in_any_order_say_what_all_say_also_after_json(values, parts):
    tallies = [counted(part) for part in np.array_split(values, parts)]
    stored = [Everything.of_state(json.loads(json.dumps(each.state(), allow_nan=False))) for each in tallies]
    total, whole = sum(reversed(stored[:-1]), stored[-1]), counted(values)
    assert total.many == whole.many
    for name in ("plus", "minus"):
        exact = math.fsum(values[(values > 0.0) == (name == "plus")])
        assert total.sums[name] == pytest.approx(exact, rel=1e-13)
        assert (total.angles[name].counts == whole.angles[name].counts).all()
    assert total.sizes.groups == whole.sizes.groups
    for group in total.sizes.groups:
        for q in (0.0, 0.1, 0.5, 1.0):
            assert total.sizes.part([group]).quantile(q) == whole.sizes.part([group]).quantile(q)
    assert (total.plane.counts == whole.plane.counts).all()
    assert sorted(total.rows) == sorted(float(part[0]) for part in np.array_split(values, parts))


def test_an_empty_tally_changes_none(values):
    whole = counted(values)
    for sum_of in (Everything() + whole, whole + Everything()):
        assert sum_of.state() == whole.state()
    assert Everything.of_state(Everything().state()).state() == Everything().state()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_quantiles_are_right_to_half_a_bin_and_ends_exact(values, sign):
    sizes = LogHistogram()
    sizes.count(sign * abs(values))
    for q in (0.001, 0.25, 0.5, 0.99):
        assert sizes.quantile(q) == pytest.approx(np.quantile(sign * abs(values), q), rel=0.05)
        assert sizes.row().quantile(q) == pytest.approx(np.quantile(abs(values), q), rel=0.05)
    assert sizes.row().smallest == abs(values).min()
    assert sizes.row().quantile(1.0) == abs(values).max()


def test_zeros_count_and_what_is_not_finite_does_not():
    sizes = LogHistogram()
    sizes.count(np.array([0.0, 0.0, 0.0, 1.0, np.nan, np.inf, -np.inf]))
    assert sizes.total == 4
    assert sizes.quantile(0.5) == 0.0
    assert math.isnan(LogHistogram().quantile(0.5))
    grouped = LogHistogram()
    grouped.count(np.ones(3), np.array([np.nan, 2.0, -4.0]))
    assert [group for group in grouped.groups if grouped.part([group]).total] == [-4, 2]


@pytest.mark.parametrize("exponent", [-305, 0, 305])
def test_the_half_width_of_normal_numbers_is_their_deviation(exponent):
    values = np.random.default_rng(2).normal(size=20_000)
    sizes = LogHistogram()
    sizes.count(values * 10.0**exponent)
    assert sizes.half_width() == pytest.approx(10.0**exponent, rel=0.03)
