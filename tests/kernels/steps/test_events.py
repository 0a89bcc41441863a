"""Events: when they count as met, and where within a step they are."""

import numpy as np
import pytest
from steppers import UNIFORM, random_states, start

from kernels.disk.field import State
from kernels.steps import events
from kernels.steps.attempt import DOPRI5, RK4, RK8
from kernels.steps.events import Stop
from kernels.steps.fixed import rk4_step


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


def locate(method, x, h, stop):
    """The event within a step of rk4, from the first guess on."""
    b, end = UNIFORM.body, rk4_step(x, h, UNIFORM.body)
    return events.settle(method, x, h, events.first_guess(x, end, h, stop, b), stop, b)


@pytest.mark.parametrize("method", [RK4, DOPRI5, RK8])
@pytest.mark.parametrize(
    ("event", "target"),
    [
        (events.Event(0.0, 1.0, 0.0, 0.0), 0.05),
        (events.Event(1.0, 0.0, 0.0, 0.0), 0.9),
        (events.TURNING_POINT, -1.05),
        (events.TIME, 0.11),
    ],
    ids=["vertical", "window", "p", "time"],
)
def test_events_are_located_to_rounding(method, event, target):
    x, h = start(sigma4=0.2), 0.2
    low, high = sorted((events.level(x, event), events.level(rk4_step(x, h, UNIFORM.body), event)))
    if not low < target < high:
        target = 0.5 * (low + high)
    y = locate(method, x, h, Stop(event, target))
    assert events.level(y, event) == pytest.approx(target, abs=5e-16)


def test_an_event_is_located_also_where_the_first_guess_leads_away_from_it():
    """A step so long that the cubic through its ends misses the event, and short steps do not find it."""
    x = State(*random_states(60, seed=5)[:, 34])
    assert abs(locate(RK4, x, 1.0, Stop(events.TURNING_POINT, 0.0)).p) <= 5e-16
