"""The definition sketch: its lines and sides are those of the body."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer import plot
from explorer.plot.style import SIGN_COLOURS

HOOP = BODIES["hoop"]


@pytest.fixture(scope="module")
def plane():
    return plot.definitions(HOOP).axes[1]


def test_the_line_of_face_one_is_where_eta_vanishes(plane):
    bar, spin = plane.lines[0].get_data()
    states = ex.phi_to_states(HOOP, 0.0, 1.0, bar, spin)
    assert abs(ex.constants(states).eta_hat_plus).max() < 1e-12


def test_the_motion_drawn_has_the_colour_of_its_side(plane):
    (dot,) = [line for line in plane.lines if line.get_marker() == "o"]
    eta_hat = ex.constants(ex.phi_to_states(HOOP, 0.0, 1.0, *np.ravel(dot.get_data()))).eta_hat_plus
    assert dot.get_color() == SIGN_COLOURS[int(np.sign(eta_hat.item()))]
