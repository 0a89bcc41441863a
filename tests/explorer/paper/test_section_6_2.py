"""Section 6.2 of the paper holds, and every row fails once something it rests on is damaged."""

from dataclasses import replace

import numpy as np
import pytest
from paper_rows import assert_holds, fails, field, second

from explorer.paper import section_6_2

NUMBERS = range(33, 36)
DAMAGES = [
    (33, section_6_2, "well", second(0.3)),
    (34, section_6_2, "well", second(1.02)),
    (35, section_6_2, "falling_constant", field("value", 1.03)),
]


@pytest.mark.parametrize("number", NUMBERS)
def test_the_statement_holds(number, checked):
    assert_holds(checked(number))


def test_every_statement_has_a_damage():
    assert [row[0] for row in DAMAGES] == list(NUMBERS)


@pytest.mark.parametrize(("number", "home", "name", "damage"), DAMAGES, ids=[str(row[0]) for row in DAMAGES])
@pytest.mark.usefixtures("fresh")
def test_the_row_notices_damage(monkeypatch, number, home, name, damage):
    monkeypatch.setattr(home, name, damage(getattr(home, name)))
    assert fails(number)


def test_row_33_notices_a_layer_that_says_all_fall(monkeypatch):
    """Beside a well some do not: the row must see that."""
    original = section_6_2.falls_of

    def all_fall(states):
        falls = original(states)
        return replace(falls, could_fall_minus=np.ones_like(falls.could_fall_minus))

    monkeypatch.setattr(section_6_2, "falls_of", all_fall)
    assert fails(33)
