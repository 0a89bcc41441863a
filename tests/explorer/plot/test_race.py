"""Pictures of the race."""

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer import plot
from explorer.plot.style import SIGN_COLOURS
from explorer.portrait.races import race_law, race_ridges
from explorer.scenes.race_angles import RaceAngles

UNIFORM = BODIES["uniform"]


@pytest.fixture(scope="module")
def summary():
    scene = RaceAngles(samples=2000)
    return scene.summarise(computed(scene))


@pytest.fixture(scope="module")
def passages():
    """Mirror images on both sides, over six decades: the law has one constant for all of them."""
    eta_hat = np.geomspace(1e-9, 1e-3, 300) * np.where(np.arange(300) % 2, 1.0, -1.0)
    return eta_hat, ex.passages(UNIFORM, np.sign(eta_hat), eta_hat, 1.0, accuracy=1e-9)


def test_each_decade_has_a_ridge_for_each_side_about_its_limit(summary):
    ax = plot.race_histogram(summary)
    assert [label.get_text() for label in ax.get_yticklabels()] == [f"$10^{{{n}}}$" for n in (-6, -5, -4, -3)]
    ridges = [patch for patch in ax.patches if patch.get_data().baseline is not None]
    assert len(ridges) == 8
    for number, ridge in enumerate(ridges):
        heights, edges, row = ridge.get_data()
        assert row == number // 2
        # eta > 0 above its line, eta < 0 below it, and all within a few hundredths of a radian
        assert np.all((heights - row) * (1 if number % 2 == 0 else -1) >= -1e-12)
        assert abs(edges).max() <= 1.0
    strip = ax.child_axes[0]
    assert [label.get_text() for label in strip.get_xticklabels()] == ["−κπ", "−π", "0", "π", "+κπ"]
    assert strip.get_xticks()[-1] == UNIFORM.race_limit
    counts = [patch.get_data().values for patch in strip.patches]
    assert [int(np.count_nonzero(each)) > 0 for each in counts] == [True, True]


def test_ridges_hold_the_share_of_passages_on_each_side_of_the_limit(passages):
    """The areas of a ridge left and right of zero, in decades, are as the counts."""
    eta_hat, found = passages
    ridges = race_ridges(UNIFORM, eta_hat, found.race_angle)
    ax = plot.race_histogram(ridges, bins=6, range=(1e-13, 1.0))
    plus = [patch for patch in ax.patches if patch.get_facecolor()[2] > 0.5]
    assert len(plus) == len(ridges.ridges)
    for row, (decade, patch) in enumerate(zip(sorted(ridges.ridges), plus, strict=True)):
        heights, edges, _ = patch.get_data()
        outside = abs(edges[:-1] + edges[1:]) > 2e-13
        left, right = (
            (heights - row)[outside & (edges[1:] <= 0)].sum(),
            (heights - row)[outside & (edges[:-1] >= 0)].sum(),
        )
        signed = ridges.ridges[decade][1]
        assert left / (left + right) == pytest.approx(signed.row(above=False).total / signed.total, abs=0.05)


def test_the_deviation_lies_on_its_law_with_a_constant(passages):
    """Medians of (race angle - kappa pi) / (K eta) on ln(1/eta) - c, from passages by quadrature."""
    eta_hat, found = passages
    rows = race_law(UNIFORM, eta_hat, found.race_angle, found.impact_speed)
    ax = plot.race_deviation(rows)
    law, medians = ax.lines[:2]
    np.testing.assert_allclose(medians.get_ydata(), law.get_ydata(), atol=0.7)
    np.testing.assert_allclose(np.diff(law.get_ydata()) / np.diff(np.log(law.get_xdata())), -1.0)
    # The leading term alone is off by the constant, which is as large as itself at 1e-4.
    constant = np.median([row["constant"]["0.5"] for row in rows])
    assert 5.0 < constant < 12.0


def test_the_summary_draws_the_same_law_as_its_passages(summary):
    ax = plot.race_deviation(summary)
    assert [row["eta_hat"] for row in summary["law"]] == list(ax.lines[1].get_xdata())
    assert not {line.get_color() for line in ax.lines} & set(SIGN_COLOURS.values())


def test_a_run_without_a_law_says_so():
    ax = plot.race_deviation([])
    assert "no deviation" in ax.texts[0].get_text()
