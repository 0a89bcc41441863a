"""The portrait of both sides of F."""

import numpy as np
import pytest
from conftest import BODIES

from explorer import plot
from explorer.plot.style import SIGN_COLOURS
from explorer.portrait.potentials import on_line

UNIFORM = BODIES["uniform"]


def test_the_race_goes_opposite_ways_and_the_tilt_alike():
    potentials = [on_line(UNIFORM, 0.25, eta) for eta in (1e-4, -1e-4)]
    tilt, race = plot.portrait_of_sides(*potentials).axes
    for potential, side in zip(potentials, (1, -1), strict=True):
        levels = [line for line in race.lines if line.get_color() == SIGN_COLOURS[side]]
        assert len(levels) == 4
        for line in levels:
            rho, phidot = line.get_data()
            # Half of the ellipse phidot^2 + rho^2/kappa^2 = A^2, eq. (7.6), on the half of this side
            fastest = rho[np.argmax(abs(rho))]
            assert np.sign(fastest) == np.sign(potential.eta) == side
            assert abs(fastest) / UNIFORM.kappa == pytest.approx(phidot.max(), rel=0.01)
    plus, minus = (
        [line.get_data() for line in tilt.lines if line.get_color() == SIGN_COLOURS[side]] for side in (1, -1)
    )
    for one, other in zip(plus, minus, strict=True):
        assert one[1].max() == pytest.approx(other[1].max(), rel=1e-3)
