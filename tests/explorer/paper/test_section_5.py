"""Section 5 of the paper holds, and every row fails once something in it is damaged."""

import numpy as np
from paper_rows import Statements, findings, scaled

from explorer.paper import section_5

NUMBERS = range(19, 27)
SLIGHTLY = scaled(1.0 + 1e-6)


def other_c(factor):
    """A damage: the function is that of another body."""
    return lambda original: lambda c, *arguments: original(factor * c, *arguments)


def printed_lemma(original):
    """Lemma 2 with the printed integral of u."""
    return lambda c, X, Y, z, constant=0.0: original(c, X, Y, z, constant=0.0)


def shifted(original):
    return lambda c: original(np.asarray(c) + 1e-9)


def real_root(original):
    """(5.11), (5.12) with |1 - 4c|, as a square root of real numbers might give."""

    def wrong(c):
        value = np.asarray(c, dtype=complex)
        return original(np.where(value.real > 0.25, 0.5 - value, value))

    return wrong


DAMAGES = [
    (19, section_5, "coefficients", other_c(1.01)),
    (20, section_5, "at_vertical", SLIGHTLY),
    (21, section_5, "inverse_square", other_c(2)),
    (22, section_5, "lemma_2", printed_lemma),
    (23, section_5, "recessive", other_c(1.0 + 1e-6)),
    (24, section_5, "at_vertical", SLIGHTLY),
    (25, section_5, "at_vertical", shifted),
    (26, section_5, "at_vertical", real_root),
]


class TestStatements(Statements):
    """Those of NUMBERS, each with its damage."""


def test_lemma_2_gives_the_known_numbers():
    right, printed = (section_5.lemma_2(4.0 / 3.0, 0.7, 0.4, -0.6, constant) for constant in (1.0, 0.0))
    assert (f"{printed:.4f}", f"{right:.4f}") == ("1.0449", "0.6259")
    assert "1.0449" in findings(22)[-1].computed
