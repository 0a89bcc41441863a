"""When the first bounce is, and on which side; the rest is tested through `explorer.bounces`."""

import math

import pytest

from kernels.integrals.bounces import first_approach

HERE, THERE, LEAD = 3.0, 2.0, 0.4


@pytest.mark.parametrize(
    ("rate", "there", "expected"),
    [
        (-1.0, THERE, (LEAD, 1.0)),  # on the way to flat
        (0.0, THERE, (LEAD, 1.0)),  # at rest: it falls
        (1.0, math.nan, (HERE - LEAD, 1.0)),  # rising, and barred from the vertical
        (1.0, THERE, (0.5 * HERE - LEAD + 0.5 * THERE, 0.0)),  # rising over the vertical
    ],
)
def test_the_first_approach_is_where_the_motion_leads(rate, there, expected):
    assert first_approach(rate, LEAD, HERE, there) == expected
