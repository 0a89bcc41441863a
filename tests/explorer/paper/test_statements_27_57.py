"""Statements 27 to 57 of the paper hold, and their rows notice when something that they rest on is wrong."""

from dataclasses import replace

import numpy as np
import pytest

from explorer.paper import eight_dimensions as plain
from explorer.paper import fall, jump, membership, race
from explorer.paper.statement import STATEMENTS
from explorer.phase.disk import Disk

NUMBERS = range(27, 58)


def findings(number):
    return list(STATEMENTS[number].check())


@pytest.fixture
def fresh():
    """Nothing is remembered from undamaged runs, nor from damaged ones."""
    caches = (fall.shot_slope, fall.on_line, fall.ending, race.passage, race.beside, jump.risen)
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()


@pytest.mark.parametrize("number", NUMBERS)
def test_the_statement_holds(number):
    found = findings(number)
    assert found
    assert not [f for f in found if not f.passed]
    assert all(f.reason and f.computed for f in found)


def test_names_and_texts_are_those_of_rows():
    rows = [STATEMENTS[number] for number in NUMBERS]
    assert len({row.name for row in rows}) == len(rows)
    assert all(row.name == row.name.upper() and row.text.endswith(".") for row in rows)


def scaled(factor):
    """A damage: numbers, or the first of a pair, come out too large."""

    def damage(original):
        def wrong(*args, **kwargs):
            value = original(*args, **kwargs)
            return (value[0] * factor, *value[1:]) if isinstance(value, tuple) else value * factor

        return wrong

    return damage


def second(factor):
    def damage(original):
        def wrong(*args):
            first, other = original(*args)
            return first, other * factor

        return wrong

    return damage


def field(name, factor):
    """A damage: one field of a result comes out too large."""

    def damage(original):
        def wrong(*args, **kwargs):
            value = original(*args, **kwargs)
            return replace(value, **{name: getattr(value, name) * factor})

        return wrong

    return damage


def upwards(original):
    """Eq. (2.12) as printed: gravity pulls up."""

    def wrong(disk, u, omega):
        return original(Lifted(disk), u, omega)

    return wrong


class Lifted:
    def __init__(self, disk):
        self.m, self.r, self.g, self.I1, self.I3 = disk.m, disk.r, -disk.g, disk.I1, disk.I3


def weightless(original):
    """V without its last term."""
    return lambda disk, tilts, sigma: original(disk, tilts, sigma) - np.sin(tilts)


def slow_clock(original):
    return lambda disk, start, times, *names: original(disk, start, 1.0001 * times, *names)


def without_one(_original):
    """sqrt(m r^2/I1) instead of sqrt(1 + m r^2/I1)."""
    return property(lambda disk: float(np.sqrt(disk.m * disk.r**2 / disk.I1)))


def other_body(original):
    return lambda ratio: original(1.01 * ratio)


DAMAGES = [
    (27, fall, "closed_form", scaled(1 + 1e-9)),
    (28, fall, "closed_form", scaled(1.001)),
    (29, fall, "smallest_tilt", scaled(1.001)),
    (30, fall, "closed_form", scaled(1.01)),
    (31, fall, "closed_form", scaled(1 + 1e-9)),
    (32, fall, "potential", weightless),
    (33, membership, "well", second(0.3)),
    (34, membership, "well", second(1.02)),
    (35, fall, "falling_constant", field("value", 1.03)),
    (36, plain, "angular_acceleration", upwards),
    (37, fall, "closed_form", scaled(1 + 1e-6)),
    (38, plain, "angular_acceleration", upwards),
    (39, plain, "angular_acceleration", upwards),
    (40, race, "closed_form", scaled(1.001)),
    (41, race, "potential", scaled(1.001)),
    (42, race, "observed", slow_clock),
    (43, race, "closed_form", scaled(1.001)),
    (44, race, "passages", field("race_angle", 1 + 1e-8)),
    (45, Disk, "kappa", without_one),
    (46, Disk, "kappa", without_one),
    (47, race, "passages", field("race_angle", 1 + 1e-6)),
    (48, Disk, "kappa", without_one),
    (49, Disk, "kappa", without_one),
    (50, jump, "planar", other_body),
    (51, jump, "beside", field("B", 1.01)),
    (52, jump, "passages", field("energy", 0.5)),
    (53, jump, "closed_form", scaled(1.01)),
    (54, jump, "passages", field("race_angle", 1 + 1e-4)),
    (55, jump, "beside", field("arm", [1.0, -1.0, 1.0])),
    (56, jump, "closed_form", scaled(1.001)),
    (57, Disk, "kappa", without_one),
]


@pytest.mark.parametrize(("number", "home", "name", "damage"), DAMAGES, ids=[str(row[0]) for row in DAMAGES])
@pytest.mark.usefixtures("fresh")
def test_the_row_notices_damage(monkeypatch, number, home, name, damage):
    monkeypatch.setattr(home, name, damage(getattr(home, name)))
    assert [f for f in findings(number) if not f.passed]


def test_the_printed_period_is_not_the_measured_one():
    """After Lemma 5 the paper has M^(-1/2)."""
    for disk, found in zip((fall.UNIFORM, fall.HOOP), findings(41)[::3], strict=False):
        printed = 2.0**1.5 / np.sqrt(disk.I1 + 1.0)
        assert abs(found.measured - printed) > 0.1


def test_the_printed_angle_of_the_contact_point_is_wrong_on_the_upper_side():
    """Section 7.3 has χ ± π for both sides; p - a points along χ on face +1."""
    run = race.beside(fall.UNIFORM, 1, 1, 1e-8)
    assert complex(*run.arm[0, :2]) == pytest.approx(np.exp(1j * run.chi[0]), abs=1e-3)


def test_row_33_notices_a_layer_that_says_all_fall(monkeypatch):
    """Beside a well some do not: the row must see that."""
    original = membership.falls_of

    def all_fall(states):
        found = original(states)
        return replace(found, could_fall_minus=np.ones_like(found.could_fall_minus))

    monkeypatch.setattr(membership, "falls_of", all_fall)
    assert not all(finding.passed for finding in findings(33))
