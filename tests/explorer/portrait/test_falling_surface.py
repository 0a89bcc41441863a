"""F as a surface, and squares round one of its points."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.falling_surface import falling_surface, zoom

HOOP, COIN = BODIES["hoop"], BODIES["coin"]


def test_eta_vanishes_on_both_sheets_each_for_its_own_face():
    surface = falling_surface(COIN, COIN.rate_unit, points=9)
    for face, name in ((1, "eta_hat_plus"), (-1, "eta_hat_minus")):
        columns = (surface.phi[face], surface.sigma3[face], surface.sigma4[face])
        phi, sigma3, sigma4 = (column.ravel() for column in columns)
        constants = ex.constants(ex.phi_to_states(COIN, phi, 1.0, sigma3, sigma4))
        scale = abs(constants.eta_hat_plus) + abs(constants.eta_hat_minus)
        assert (abs(getattr(constants, name)) <= 1e-12 * scale + 1e-12).all()
        assert max(abs(sigma3).max(), abs(sigma4).max()) == pytest.approx(COIN.rate_unit)


def test_in_every_square_the_side_of_f_is_the_way_of_the_race():
    seen = zoom(HOOP, [0.2, 2e-13], points=6)
    assert seen.falls == 0
    ways = np.sign(seen.race_angle)
    assert (ways == np.sign(seen.offset)[None, :, None]).all()


def test_an_odd_number_of_points_is_refused():
    with pytest.raises(ex.InputError, match="points = 5"):
        zoom(HOOP, [0.1], points=5)
