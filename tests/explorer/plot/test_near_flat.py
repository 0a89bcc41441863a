"""Pictures of the limit: the limit's path has its races, and the orbit on the blown-up flat state its two ways."""

import numpy as np
from conftest import BODIES

from explorer import plot
from explorer.plot.style import SIGN_COLOURS
from explorer.portrait.near_flat import near_flat, toward_limits

HOOP = BODIES["hoop"]


def test_the_path_of_the_limit_with_its_races_is_that_of_a_motion_beside_it():
    (both,) = toward_limits(HOOP, [1e-4])
    for sign in (1, -1):
        whole, beside = both.limit_path(sign), both.motions[sign]["contact"][:, :2]
        # Each point of one lies on the other: the races as well.
        apart = np.linalg.norm(beside[:, None] - whole[None], axis=2)
        assert apart.min(axis=1).max() < 0.05
        assert apart.min(axis=0).max() < 0.1
    figure = plot.limit_paths([both])
    assert [ax.get_title() for ax in figure.axes[:2]] == [r"$|\hat\eta| = 10^{-4}$", "limit"]


def test_both_halves_of_the_orbit_lead_from_the_impact_to_the_rise():
    figure = plot.blow_up(near_flat(HOOP, [1e-2, -1e-2]))
    orbits = {line.get_color(): np.array(line.get_data_3d()) for line in figure.axes[0].lines[:2]}
    for sign, colour in SIGN_COLOURS.items():
        x, y, _ = orbits[colour]
        assert x[0] < 0.0 < x[-1]
        assert (sign * y >= -1e-12).all()
