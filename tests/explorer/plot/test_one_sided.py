"""Pictures of the two one-sided limit motions: the data of their artists."""

import numpy as np
import pytest
from conftest import BODIES

from explorer import plot
from explorer.phase.states import constants_to_states
from explorer.portrait.both_sides import both_sides

HOOP = BODIES["hoop"]


@pytest.fixture(scope="module")
def both():
    return both_sides(constants_to_states(HOOP, 0.6, 0.0, 1.0))


def test_phi_and_chi_are_drawn_on_both_sides_with_their_limits(both):
    phi, chi = plot.one_sided_phi(both), plot.one_sided_chi(both)
    for row, sign in enumerate((1, -1)):
        np.testing.assert_array_equal(phi.lines[row].get_ydata(), both.motions[sign]["phi"])
        np.testing.assert_array_equal(chi.lines[2 * row].get_ydata(), both.motions[sign]["chi"])
        np.testing.assert_array_equal(chi.lines[2 * row + 1].get_ydata(), both.limits[sign].chi)
    impacts = [line.get_xdata()[0] for line in chi.lines[4:]]
    assert impacts == pytest.approx(both.impacts)
    assert f"{HOOP.race_limit:.3f}" in chi.texts[0].get_text()


def test_limit_paths_break_at_impacts_and_all_paths_start_together(both):
    ax = plot.contact_paths(both)
    dotted = [line for line in ax.lines if line.get_ls() == ":"]
    assert len(dotted) == 2 * (len(both.impacts) + 1)
    assert sum(len(line.get_xdata()) for line in dotted) == 2 * both.t.size
    solid = [line for line in ax.lines if line.get_ls() in ("-", "--") and len(line.get_xdata()) > 2]
    assert [line.get_xydata()[0].tolist() for line in solid] == [[0.0, 0.0], [0.0, 0.0]]
    assert f"{HOOP.gap:.3f} rad apart" in ax.get_title()


def test_distances_are_the_medians_of_the_summary_on_each_side():
    rows = [
        {"eta_hat": 0.1, "median_plus": 0.3, "median_minus": 0.2},
        {"eta_hat": 0.01, "median_plus": 0.04},
    ]
    ax = plot.one_sided_distance({"disks": {"hoop": {"distances": rows}}})
    plus, minus, law = ax.lines
    assert list(plus.get_ydata()) == [0.3, 0.04]
    assert list(minus.get_ydata()) == [0.2]
    x, y = law.get_data()
    np.testing.assert_allclose(y, x * np.log(1.0 / x))
