"""Section 6.2 of the paper holds, and every row fails once something it rests on is damaged."""

from dataclasses import replace

import numpy as np
from paper_rows import Statements, fails, field, second

from explorer.paper import section_6_2

NUMBERS = range(33, 36)
DAMAGES = [
    (33, section_6_2, "well", second(0.3)),
    (34, section_6_2, "well", second(1.02)),
    (35, section_6_2, "falling_constant", field("value", 1.03)),
]


class TestStatements(Statements):
    """Those of NUMBERS, each with its damage."""


def test_row_33_notices_a_layer_that_says_all_fall(monkeypatch):
    """Beside a well some do not: the row must see that."""
    original = section_6_2.falls_of

    def all_fall(states):
        falls = original(states)
        return replace(falls, could_fall_minus=np.ones_like(falls.could_fall_minus))

    monkeypatch.setattr(section_6_2, "falls_of", all_fall)
    assert fails(33)
