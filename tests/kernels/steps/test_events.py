"""Events: when they count as met, and how fast they are approached."""

import numpy as np
import pytest
from conftest import BODIES
from steppers import start

from kernels.disk.field import field
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


@pytest.mark.parametrize(
    "event", [events.TURNING_POINT, events.VERTICAL, events.TIME, events.Event(0.3, -1.0, 2.0, 0.7)]
)
def test_the_rate_of_an_event_is_its_form_in_the_rates_of_the_state(event):
    b, x = BODIES["hoop"].body, start(sigma4=0.2)
    assert events.level_rate(x, event, b) == pytest.approx(events.level(field(x, b), event), rel=1e-15)


def test_what_is_watched_is_the_speed_of_tilting_the_height_and_the_time():
    x = start(sigma4=0.2)._replace(t=0.7)
    watched = (events.TURNING_POINT, events.VERTICAL, events.TIME)
    assert [events.level(x, event) for event in watched] == [x.p, x.z, x.t]
    mixed = events.Event(0.3, -1.0, 2.0, 0.7)
    assert events.level(x, mixed) == pytest.approx(0.3 * x.q - x.z + 2.0 * x.p + 0.7 * x.t, rel=1e-15)
