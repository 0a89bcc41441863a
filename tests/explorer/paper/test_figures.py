"""The paper's figures: the data behind the lines."""

import numpy as np
import pytest

import explorer as ex
from explorer.paper.figures import CHI0, CHI0_FITS, ETA_HAT, FIGURES, ZOOM, figure, limit, motion, period_of
from explorer.pictures.register import caption_of

CASES = [(disk, eta_hat) for disk in (ex.Disk.uniform(), ex.Disk.hoop()) for eta_hat in (ETA_HAT, -ETA_HAT)]


@pytest.fixture(params=CASES, ids=lambda case: f"{case[0].name}{case[1]:+g}", scope="module")
def case(request):
    disk, eta_hat = request.param
    return disk, eta_hat, motion(disk, eta_hat, 3.0), limit(disk, int(np.sign(eta_hat)), 11.0)


def test_the_curve_is_upright_again_after_each_period(case):
    disk, eta_hat, here, _ = case
    tau = period_of(disk, eta_hat)
    assert here.t[-1] == pytest.approx(3.0 * tau, rel=1e-14)
    assert np.interp(tau * np.arange(4), here.t, here.phi) == pytest.approx(np.zeros(4), abs=1e-4)


def test_the_samples_meet_the_flattest_moment_of_every_period(case):
    disk, eta_hat, here, _ = case
    flattest = ex.passages(disk, 1.0, eta_hat, 1.0).theta_min[0]
    for flat in here.flat:
        near = abs(here.t - flat) < 0.2
        assert 0.5 * np.pi - here.phi[near].max() == pytest.approx(flattest, rel=1e-6)
    assert here.flat.size == 3


def test_the_zoom_holds_the_race(case):
    """All of the loop about the origin: chi gains kappa pi, to 0.1 kappa pi, inside the window."""
    disk, eta_hat, here, _ = case
    inside = ((here.axis > ZOOM[0]) & (here.axis < ZOOM[1])).all(axis=1) & (abs(here.t - here.flat[0]) < 0.5)
    turned = here.chi[inside][-1] - here.chi[inside][0]
    assert np.sign(eta_hat) * turned == pytest.approx(disk.race_limit, rel=0.1)


def test_the_contact_point_is_on_the_rim_below_the_centre(case):
    here = case[2]
    apart = np.hypot(*(here.contact - here.centre).T)
    assert apart == pytest.approx(abs(np.sin(here.phi)), abs=1e-12)


def distances(here, there):
    """Largest distance to the limit over the motion, away from impacts, of each thing that is drawn."""
    calm = abs(here.t[:, None] - np.concatenate([here.flat, there.flat])).min(axis=1) > 0.12
    assert calm.sum() > 800
    t, first = np.unique(there.t, return_index=True)
    for name in ("phi", "chi", "centre", "contact"):
        ours, theirs = (np.atleast_2d(getattr(curve, name).T) for curve in (here, there))
        apart = [abs(o - np.interp(here.t, t, x[first])) for o, x in zip(ours, theirs, strict=True)]
        yield np.max(apart, axis=0)[calm].max()


def test_limit_lines_lie_beside_the_motion_and_closer_with_smaller_eta(case):
    """eta ln(1/eta) falls by a factor 7.5 from 0.001 to 0.0001; at 0.01 terms of order eta still count."""
    disk, eta_hat, here, there = case
    wide, close, closer = (
        list(distances(curve, there)) for curve in (here, *(motion(disk, s * eta_hat, 3.0) for s in (0.1, 0.01)))
    )
    assert all(b < a for a, b in zip(wide, close, strict=True))
    assert all(c < b / 5.0 for b, c in zip(close, closer, strict=True))


def test_the_limit_jumps_by_the_race_number_round_the_rim(case):
    disk, eta_hat, _, there = case
    for flat in there.flat:
        race = there.t == flat
        assert np.ptp(there.chi[race]) == pytest.approx(disk.race_limit, rel=1e-12)
        assert np.sign(there.chi[race][-1] - there.chi[race][0]) == np.sign(eta_hat)
        assert np.hypot(*(there.contact - there.centre)[race].T) == pytest.approx(np.ones(race.sum()), rel=1e-9)
        before, after = np.flatnonzero(race)[[0, -1]] + [-1, 1]
        for name in ("chi", "centre", "contact"):
            values = getattr(there, name)
            assert np.max(abs(values[race][0] - values[before])) < 0.04, name
            assert np.max(abs(values[race][-1] - values[after])) < 0.04, name


def fits_figure_7(turns):
    """A test of chi(0): whether the hoop's paths reach the outermost ticks of Fig. 7 and not the next ones.

    Ticks: 0.5 to 3 and -1 to 1.5 on the left, -1.5 to 1.5 and -1 to 2 on the right; none at the origin.
    """
    left, right = ((-0.5, 0.5, 3, 3.5), (-1.5, -1, 1.5, 2)), ((-2, -1.5, 1.5, 2), (-1.5, -1, 2, 2.5))
    paths = [motion(ex.Disk.hoop(), eta_hat, turns).centre @ [1, 1j] for eta_hat in (ETA_HAT, -ETA_HAT)]

    def fits(chi0):
        turned = [path * np.exp(1j * (chi0 - CHI0)) for path in paths]
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


@pytest.mark.parametrize("number", FIGURES)
def test_each_figure_shows_its_panels_with_body_eta_and_limit(number):
    plan, made = FIGURES[number], figure(number)
    assert len(made.axes) == 2
    for (side, options), ax in zip(plan.panels, made.axes, strict=True):
        eta_hat = side * ETA_HAT
        assert f"{eta_hat:+g}".replace("-", "−") in ax.get_title()
        assert plan.disk.name in ax.get_title()
        lines = {line.get_label(): line for line in ax.get_lines()}
        here = motion(plan.disk, eta_hat, plan.turns)
        there = limit(plan.disk, int(np.sign(eta_hat)), here.t[-1])
        kind = options.get("what", "axis")
        expected = there.chi if number == 1 else getattr(there, kind)[:, 1]
        np.testing.assert_array_equal(lines["limit"].get_ydata(), expected)
        if options.get("zoom"):
            assert ax.get_xlim() == ax.get_ylim() == ZOOM
    assert caption_of(made).text.startswith(f"Fig. {number}. ")


def test_a_figure_of_another_body_is_of_that_body_in_natural_units():
    coin, ring = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81), ex.Disk.annulus(0.4)
    same, paper = figure(8, coin), figure(8)
    for ours, theirs in zip(same.axes, paper.axes, strict=True):
        np.testing.assert_allclose(ours.lines[0].get_xydata(), theirs.lines[0].get_xydata(), atol=1e-9)
    assert caption_of(same) == caption_of(paper)
    other = figure(8, ring, 3e-3)
    here = motion(ring, 3e-3, FIGURES[8].turns)
    np.testing.assert_allclose(other.axes[0].lines[0].get_xydata(), here.contact)
    assert caption_of(other).text.startswith("As Fig. 8. The path of the point of contact of the disk annulus-0.4")
    assert "0.003" in caption_of(other).text


@pytest.mark.parametrize(("number", "eta_hat", "says"), [(8, -1e-3, "eta_hat"), (10, ETA_HAT, "from 1 to 9")])
def test_what_is_no_figure_is_refused_in_a_sentence(number, eta_hat, says):
    with pytest.raises(ex.InputError, match=says):
        figure(number, None, eta_hat)
