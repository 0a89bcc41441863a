"""Section 6.1 of the paper and Lemma 4 hold, and every row fails once something it rests on is damaged."""

import numpy as np
import pytest
from paper_rows import Statements, findings, first

from explorer.paper import closed_forms, section_6_1

NUMBERS = range(27, 33)


def weightless(original):
    """V without its last term."""
    return lambda disk, tilts, sigma: original(disk, tilts, sigma) - np.sin(tilts)


DAMAGES = [
    (27, closed_forms, "at_vertical", first(1.0 + 1e-9)),
    (28, closed_forms, "at_vertical", first(1.001)),
    (29, section_6_1, "smallest_tilt", first(1.001)),
    (30, closed_forms, "at_vertical", first(1.01)),
    (31, closed_forms, "at_vertical", first(1.0 + 1e-9)),
    (32, section_6_1, "potential", weightless),
]


class TestStatements(Statements):
    """Those of NUMBERS, each with its damage."""


@pytest.mark.usefixtures("fresh")
def test_what_is_left_of_the_potential_notices_a_wrong_parameter(monkeypatch):
    """Eq. (6.7) beyond its first two terms: the coefficient of the logarithm rests on c."""
    original = section_6_1.parameters
    monkeypatch.setattr(section_6_1, "parameters", lambda disk: original(disk)._replace(c=1.02 * original(disk).c))
    left = [finding for finding in findings(28) if "(6.7)" in finding.printed]
    assert len(left) == 4
    assert not any(finding.passed for finding in left)
