"""The paper's figures: the data behind the lines."""

import numpy as np
import pytest

import explorer as ex
from explorer.paper.figures import CHI0, CHI0_FITS, FIGURES, ZOOM, axis, curves, figure, period_of
from explorer.paper.statement import ETA_HAT
from explorer.pictures.one_sided import flattest
from explorer.pictures.register import caption_of

BODIES = {disk.name: disk for disk in (ex.Disk.uniform(), ex.Disk.hoop())}


@pytest.fixture(params=[(name, side) for name in BODIES for side in (1, -1)], ids=str, scope="module")
def case(request):
    name, side = request.param
    return BODIES[name], side, curves(BODIES[name], ETA_HAT, 3.0)


def test_rings_stand_at_the_flattest_moment_of_every_period(case):
    disk, side, both = case
    theta_min = ex.passages(disk, 1.0, side * ETA_HAT, 1.0).theta_min
    phi = both.motions[side]["phi"][flattest(both, side)]
    assert 0.5 * np.pi - phi == pytest.approx(np.full(3, theta_min), rel=1e-2)


def test_the_zoom_holds_the_race(case):
    """All of the loop about the origin: chi gains kappa pi, to 0.1 kappa pi, inside the window."""
    disk, side, both = case
    phi, chi = both.motions[side]["phi"], both.motions[side]["chi"]
    seen = ((axis(phi, chi) > ZOOM[0]) & (axis(phi, chi) < ZOOM[1])).all(axis=1)
    inside = seen & (abs(both.t - both.impacts[0]) < 0.5)
    assert side * (chi[inside][-1] - chi[inside][0]) == pytest.approx(disk.race_limit, rel=0.1)


def test_the_contact_point_is_on_the_rim_below_the_centre(case):
    motion = case[2].motions[case[1]]
    apart = np.hypot(*(motion["contact"] - motion["path"])[:, :2].T)
    assert apart == pytest.approx(abs(np.sin(motion["phi"])), abs=1e-12)


def fits_figure_7(turns):
    """A test of chi(0): whether the hoop's paths reach the outermost ticks of Fig. 7 and not the next ones.

    Ticks: 0.5 to 3 and -1 to 1.5 on the left, -1.5 to 1.5 and -1 to 2 on the right; none at the origin.
    """
    left, right = ((-0.5, 0.5, 3, 3.5), (-1.5, -1, 1.5, 2)), ((-2, -1.5, 1.5, 2), (-1.5, -1, 2, 2.5))
    both = curves(BODIES["hoop"], ETA_HAT, turns)
    paths = [both.motions[side]["path"][:, :2] @ [1, 1j] for side in (1, -1)]

    def fits(chi0):
        turned = [path * np.exp(1j * chi0) for path in paths]
        return all(
            below < x.min() < first and last < x.max() < above
            for path, axes in zip(turned, (left, right), strict=True)
            for x, (below, first, last, above) in zip((path.real, path.imag), axes, strict=True)
        )

    return fits


def test_the_ticks_of_figure_7_leave_the_stated_range_of_chi0():
    fits, (low, high) = fits_figure_7(FIGURES[7].turns), CHI0_FITS
    assert low < CHI0 < high
    around = np.arange(-3.14, 3.14, 0.005)
    found = [chi0 for chi0 in around if fits(chi0)]
    assert min(found) == pytest.approx(low, abs=0.0051)
    assert max(found) == pytest.approx(high, abs=0.0051)
    assert not any(map(fits_figure_7(3.4), around))


def shown(both, side, kind):
    """What a panel shows of a motion, turned so that chi begins with CHI0."""
    motion = both.motions[side]
    if kind == "chi":
        return np.stack([both.t, motion["chi"] + CHI0], axis=1)
    if kind == "axis":
        return axis(motion["phi"], motion["chi"])
    turned = motion[kind][:, :2] @ [1, 1j] * np.exp(1j * CHI0)
    return np.stack([turned.real, turned.imag], axis=1)


@pytest.mark.parametrize("number", FIGURES)
def test_each_figure_shows_its_panels_with_body_eta_and_limit(number):
    plan, made = FIGURES[number], figure(number)
    both = curves(plan.disk, ETA_HAT, plan.turns)
    for place, (side, ax) in enumerate(zip(plan.sides, made.axes, strict=True)):
        seen, expected = ax.lines[0].get_xydata(), shown(both, side, plan.kind)
        known = np.isfinite(seen[:, 1])
        np.testing.assert_array_equal(seen[known], expected[known])
        assert known.all() or plan.kind == "axis"
        assert any((line.get_label() or "").startswith("limit") for line in ax.lines)
        if plan.kind == "axis" and place == 1:
            assert ax.get_xlim() == ax.get_ylim() == ZOOM
        else:
            assert f"{side * ETA_HAT:+g}".replace("-", "−") in ax.get_title()
            assert plan.disk.name in ax.get_title()
    assert both.t[-1] == pytest.approx(plan.turns * period_of(plan.disk))
    assert caption_of(made).text.startswith(f"Fig. {number}. ")


def test_a_figure_of_another_body_is_of_that_body_in_natural_units():
    coin, ring = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81), ex.Disk.annulus(0.4)
    same, paper = figure(8, coin), figure(8)
    for ours, theirs in zip(same.axes, paper.axes, strict=True):
        # Steps follow an estimated error, so that rounding of the units moves a point along its curve
        np.testing.assert_allclose(ours.lines[0].get_xydata(), theirs.lines[0].get_xydata(), rtol=0.0, atol=1e-7)
    assert caption_of(same) == caption_of(paper)
    other, both = figure(8, ring, 3e-3), curves(ring, 3e-3, FIGURES[8].turns)
    np.testing.assert_array_equal(other.axes[0].lines[0].get_xydata(), shown(both, 1, "contact"))
    assert caption_of(other).text.startswith("As Fig. 8. The path of the contact point of the disk annulus-0.4")
    assert "0.003" in caption_of(other).text


@pytest.mark.parametrize(("number", "eta_hat", "says"), [(8, -1e-3, "eta_hat"), (10, ETA_HAT, "from 1 to 9")])
def test_what_is_no_figure_is_refused_in_a_sentence(number, eta_hat, says):
    with pytest.raises(ex.InputError, match=says):
        figure(number, None, eta_hat)
