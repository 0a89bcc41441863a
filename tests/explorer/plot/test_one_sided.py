"""Pictures of the two one-sided limit motions: the data of their artists."""

import numpy as np
import pytest
from conftest import BODIES
from matplotlib.colors import to_hex

from explorer import plot
from explorer.phase.states import constants_to_states
from explorer.plot.style import SIGN_COLOURS
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
    assert [text.get_text() for text in chi.texts if text.get_text()] == ["+κπ = +5.44", "−κπ = −5.44"]
    assert "2 turns − 1.684 rad" in chi.get_title()


@pytest.mark.parametrize("sign", [1, -1])
def test_arrows_point_along_the_motion(both, sign):
    """Each arrow head lies on the path of its side, and points where the contact point goes there."""
    ax = plot.contact_paths(both)
    path = both.motions[sign]["contact"][:, :2] / HOOP.r
    heads = [text for text in ax.texts if getattr(text, "arrow_patch", None) is not None]
    mine = [head for head in heads if to_hex(head.arrow_patch.get_facecolor()) == SIGN_COLOURS[sign].lower()]
    assert len(mine) == 5
    for head in mine:
        tip, tail = np.array(head.xy), np.array(head.xyann)
        row = int(np.argmin(np.hypot(*(path - tip).T)))
        assert np.hypot(*(path[row] - tip)) < 1e-12
        velocity = path[row] - path[max(row - 1, 0)]
        along = velocity @ (tip - tail) / np.hypot(*velocity) / np.hypot(*(tip - tail))
        assert along > 0.9


def test_limit_paths_have_their_races_and_all_paths_start_together(both):
    ax = plot.contact_paths(both)
    dotted = [line.get_xydata() for line in ax.lines if line.get_ls() == ":"]
    assert len(dotted) == 2
    for limit in dotted:
        # The circle that is run through in no time joins the pieces: no step is longer than one of 0.1 rad.
        assert np.hypot(*np.diff(limit, axis=0).T).max() < 0.15
    solid = [line for line in ax.lines if line.get_ls() == "-" and len(line.get_xdata()) > 2]
    assert [line.get_xydata()[0].tolist() for line in solid] == [[0.0, 0.0], [0.0, 0.0]]
    assert "1.684 rad apart" in ax.get_title()


def test_distances_are_the_worse_medians_of_the_summary_with_the_largest_as_a_band():
    rows = [
        {"eta_hat": 0.1, "median_plus": 0.3, "median_minus": 0.2, "largest_plus": 0.5, "largest_minus": 0.9},
        {"eta_hat": 0.01, "median_plus": 0.04, "largest_plus": 0.04},
    ]
    ax = plot.one_sided_distance({"disks": {"hoop": {"distances": rows}}})
    medians, law = ax.lines
    assert list(medians.get_ydata()) == [0.3, 0.04]
    assert ax.collections[0].get_paths()[0].vertices[:, 1].max() == 0.9
    named = [text.get_text() for text in ax.get_legend().get_texts()]
    assert [named[0], named[-1]] == ["hoop", "median to largest\nover the starts"]
    x, y = law.get_data()
    assert np.ptp(y / (x * np.log(1.0 / x))) < 1e-12
    assert x.max() <= 0.02
