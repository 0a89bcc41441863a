"""Picture of the turns per bounce."""

import math

import numpy as np
import pytest
from conftest import BODIES

from explorer import plot
from explorer.portrait.rocking import rocking


def test_turns_are_drawn_with_their_limits():
    turns = [rocking(BODIES[name]) for name in ("uniform", "hoop")]
    ax = plot.rocking_turns(turns)
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), turns[0].chi / math.pi)
    assert ax.lines[1].get_ydata()[0] == pytest.approx(2.0 * math.sqrt(5.0 / 3.0))
    assert ax.lines[2].get_ydata()[0] == pytest.approx(math.sqrt(5.0))
