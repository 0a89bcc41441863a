"""Events: when they count as met, and how fast they are approached."""

import numpy as np
import pytest

from kernels.steps import events


@pytest.mark.parametrize(
    ("before", "after", "met"),
    [
        (-1.0, 1.0, True),
        (1.0, -1.0, True),
        (-1.0, 0.0, True),
        (0.0, 1.0, False),
        (0.0, 0.0, False),
        (1.0, 2.0, False),
    ],
)
def test_a_value_counts_when_it_is_reached_and_not_when_a_step_starts_on_it(before, after, met):
    assert events.crossed(before + 0.5, after + 0.5, 0.5) == met


def test_a_motion_that_is_not_a_number_meets_no_event():
    assert not events.crossed(np.nan, 1.0, 0.5)
    assert not events.crossed(0.0, np.nan, 0.5)
