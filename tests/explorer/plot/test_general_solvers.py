"""Races by general solvers: every passage is on the picture, and the titles count."""

import numpy as np
from conftest import BODIES

from explorer import plot
from explorer.portrait.general_solvers import OURS, GeneralSolvers

HOOP = BODIES["hoop"]


def test_each_passage_is_drawn_once_in_each_panel_and_the_title_counts_the_wrong_ones():
    full = HOOP.race_limit
    eta_hat = np.array([0.1, -0.1, 1e-4, -1e-4])
    right, other = np.array([1.0, -1.0, 1.0, -1.0]) * full, np.array([1.0, 1.0, 5.0, np.nan]) * full
    none = np.zeros(4, bool)
    solved = GeneralSolvers(HOOP, eta_hat, {"other": other, OURS: right}, {"other": none, OURS: none})
    figure = plot.missed_races(solved)
    for ax, wrong in zip(figure.axes, (3, 0), strict=True):
        assert f"{wrong} of 4 wrong" in ax.get_title()
        drawn = [line for line in ax.lines if line.get_marker() in ("o", "x", "^", "v")]
        assert sorted(np.concatenate([line.get_xdata() for line in drawn])) == sorted(abs(eta_hat))
