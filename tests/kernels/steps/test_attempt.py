"""What all integrators share: depths, events within a step, and the verdict."""

import numpy as np
import pytest
from steppers import UNIFORM, march, random_states, start

from kernels.disk.field import ANGLES, PATH, REDUCED, State, energy
from kernels.status import Status
from kernels.steps import events
from kernels.steps.attempt import (
    DOPRI5,
    RESOLVED_SHARE,
    RK4,
    RK8,
    ConstantsError,
    all_finite,
    locate,
    verdict,
)
from kernels.steps.events import Stop
from kernels.steps.fixed import rk4_step


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
    b, x = UNIFORM.body, start(sigma4=0.2)
    h = 0.2
    end = rk4_step(x, h, b)
    low, high = sorted((events.level(x, event), events.level(end, event)))
    if not low < target < high:
        target = 0.5 * (low + high)
    y = locate(method, x, end, h, Stop(event, target), b)
    assert events.level(y, event) == pytest.approx(target, abs=5e-16)


def test_an_event_is_located_also_where_the_first_guess_leads_away_from_it():
    """A step so long that the cubic through its ends misses the event, and short steps do not find it."""
    b, x, h = UNIFORM.body, State(*random_states(60, seed=5)[:, 34], 0.0, 0.0), 1.0
    y = locate(RK4, x, rk4_step(x, h, b), h, Stop(events.TURNING_POINT, 0.0), b)
    assert abs(y.p) <= 5e-16


def test_the_path_depth_adds_the_centre_and_leaves_the_rest_close():
    b = UNIFORM.body
    x = start()
    full = np.array(march(DOPRI5, x, 0.01, 200, b))
    assert abs(full[8:]).max() > 0.1
    assert energy(State(*full), b) == pytest.approx(energy(x, b), rel=1e-11)
    assert PATH > ANGLES > REDUCED


@pytest.mark.parametrize(
    ("moved", "status"),
    [
        ((0.0, 0.0, 0.0), Status.OK),
        ((1e-3, 0.0, 0.0), Status.INVARIANT_DRIFT),
        ((0.0, 3e-4, 0.0), Status.INVARIANT_DRIFT),
        ((np.nan, 0.0, 0.0), Status.INVARIANT_DRIFT),
        ((0.0, 0.0, 1.01 * RESOLVED_SHARE * 1e-5), Status.UNRESOLVED_SIDE),
        ((0.0, 0.0, np.nan), Status.UNRESOLVED_SIDE),
    ],
)
def test_a_motion_is_ok_only_where_its_constants_stayed_and_the_side_is_known(moved, status):
    assert verdict(ConstantsError(*moved), -1e-5, 2.0, 1e-4) == status


def test_one_component_that_is_not_finite_is_enough():
    for place in range(10):
        for bad in (np.nan, np.inf, -np.inf):
            assert not all_finite(State(*np.where(np.arange(10) == place, bad, 1.0)))
    assert all_finite(start())
