import math
from itertools import pairwise

import matplotlib
import numpy as np
import pytest
from conftest import BODIES
from matplotlib.figure import Figure
from PIL import Image
from scipy.integrate import quad

import explorer as ex
from explorer.plot import bodies, slices
from explorer.plot import film as animation
from explorer.plot import wander as paths
from explorer.portrait.bodies import flat_body, measured_gaps, race_numbers
from explorer.portrait.bounce import turn_per_bounce
from explorer.portrait.film import film
from explorer.portrait.slices import Slice, map_slice, race_slice
from explorer.portrait.wander import resonance, wander, wander_path

UNIFORM, HOOP = BODIES["uniform"], BODIES["hoop"]


def start(disk, sigma3_bar, eta_hat, phidot=1.0):
    unit = disk.rate_unit
    return ex.constants_to_states(disk, np.multiply(sigma3_bar, unit), np.multiply(eta_hat, unit), phidot * unit)


@pytest.fixture(scope="module")
def resonant():
    return resonance(UNIFORM, 0.01, 1.0, 2, (0.15, 0.3))


@pytest.fixture(scope="module")
def wanders(resonant):
    return {"generic": wander_path(start(UNIFORM, 1.0, 0.01), 30), "resonance": wander_path(resonant[1], 8)}


@pytest.fixture(scope="module")
def slice_of_uniform():
    return race_slice(UNIFORM, Slice.defaults(UNIFORM)[0], 61)


@pytest.fixture(scope="module")
def bounces():
    return [turn_per_bounce(disk) for disk in (UNIFORM, HOOP)]


# Slices


@pytest.mark.parametrize("number", [0, 1])
def test_the_tilt_by_quadrature_is_that_of_the_integrated_slices(number):
    where = Slice.defaults(HOOP)[number]
    one, other = race_slice(HOOP, where, 31).map, map_slice(HOOP, where, 31)
    both = np.isfinite(one.theta_min) & np.isfinite(other.theta_min)
    assert both.mean() > 0.98
    np.testing.assert_allclose(one.theta_min[both], other.theta_min[both], rtol=3e-3)


def test_the_way_is_the_direction_of_the_contact_point_at_the_flattest_moment(slice_of_uniform):
    """Against passages from the vertical, where chi is integrated: its sign near F."""
    at = slice_of_uniform.map
    x, y = np.meshgrid(at.x, at.y)
    known = ex.constants(UNIFORM, 0.0, 1.0, x, y)
    face = np.ravel(slice_of_uniform.face)
    eta = np.where(face > 0, known.eta_hat_plus, known.eta_hat_minus)
    near = (abs(eta) < 0.1) & (abs(eta) > 1e-3) & (np.ravel(slice_of_uniform.way) != 0)
    assert near.sum() > 100
    turned = ex.passages(UNIFORM, known.sigma3_bar[near], eta[near], 1.0, face[near]).race_angle
    np.testing.assert_array_equal(np.sign(turned), np.ravel(slice_of_uniform.way)[near])


def test_the_colours_change_on_f_and_the_tilt_vanishes_there(slice_of_uniform):
    """Along a column the strongest cells of the two colours are the neighbours of l_+ and l_-."""
    at = slice_of_uniform.map
    slope = 0.7285923160189477
    column = int(np.argmin(abs(at.x - 1.0)))
    tilt, way = at.theta_min[:, column], slice_of_uniform.way[:, column]
    for line in (slope, -slope):
        above = int(np.searchsorted(at.y, line * at.x[column]))
        assert {way[above - 1], way[above]} == {-1, 1}
        assert max(tilt[above - 1], tilt[above]) < 0.1
    assert np.median(tilt[way != 0]) > 0.2


def test_colours_are_strongest_at_f_and_missing_where_nothing_falls(slice_of_uniform):
    ax = Figure().subplots()
    assert slices.race_slice_map(slice_of_uniform, ax) is ax
    drawn = np.ma.getmaskarray(ax.collections[0].get_array())
    np.testing.assert_array_equal(drawn[slice_of_uniform.way == 0], True)
    values = slices.signed_tilt(slice_of_uniform)
    shown = np.isfinite(values)
    np.testing.assert_array_equal(np.sign(values[shown]), slice_of_uniform.way[shown])
    flat = np.argsort(slice_of_uniform.map.theta_min[shown])
    assert (np.diff(abs(values[shown])[flat]) >= 0.0).all()


# Bodies


def test_gaps_are_those_of_the_disks_and_of_the_paper():
    numbers = race_numbers(16.0, 17)
    np.testing.assert_array_equal(numbers.matching, [0.0, 3.0, 8.0, 15.0])
    np.testing.assert_array_equal(numbers.gap[np.isin(numbers.ratio, numbers.matching)], 0.0)
    assert numbers.gap[numbers.ratio == 4.0][0] == pytest.approx(1.483259, abs=1e-6)
    assert numbers.gap[numbers.ratio == 2.0][0] == pytest.approx(4.599611, abs=1e-6)
    for ratio, kappa, gap in zip(numbers.ratio[1:], numbers.kappa[1:], numbers.gap[1:], strict=True):
        assert (kappa, gap) == pytest.approx(
            (flat_body(float(ratio)).kappa, flat_body(float(ratio)).gap), abs=1e-12
        )


def test_passages_beside_f_measure_kappa_and_the_gap():
    """Race angles by quadrature, on both sides; the law eta ln(1/eta) leaves 1e-10 at 1e-12."""
    disks = [HOOP, UNIFORM, flat_body(3.0), flat_body(8.0), BODIES["thick"], BODIES["coin"]]
    found = measured_gaps(disks)
    np.testing.assert_allclose(found.kappa, [disk.kappa for disk in disks], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found.gap, [disk.gap for disk in disks], rtol=0.0, atol=1e-8)


def test_the_matching_bodies_are_drawn_at_zero_and_the_curve_breaks_there():
    numbers = race_numbers(16.0, 200)
    figure = bodies.race_bodies(numbers, measured_gaps([HOOP, UNIFORM]))
    curve, matching, measured = figure.axes[1].lines[:3]
    np.testing.assert_array_equal(matching.get_xdata(), [0.0, 3.0, 8.0, 15.0])
    np.testing.assert_array_equal(matching.get_ydata(), 0.0)
    np.testing.assert_allclose(measured.get_ydata(), [4.599611, 1.483259], atol=1e-6)
    y = np.asarray(curve.get_ydata())
    assert np.isnan(y).sum() == 3
    assert np.nanmax(abs(np.diff(y))) < 1.0
    assert {text.get_text() for text in figure.axes[0].texts} == {"hoop", "uniform"}


# Bounces


def leading_turn(disk, level):
    """Turn per bounce of p^2/2 M + 1/(2 u^2) + u at 3/2 level: an integral over u = m + s sin(x), none of ours."""
    inner, outer = sorted(root.real for root in np.roots([1.0, -1.5 * level, 0.0, 0.5]) if root.real > 0.0)
    third = -0.5 / (inner * outer)  # (2E u^2 - 1 - 2 u^3) = 2 (u - inner)(outer - u)(u - third)
    middle, half = 0.5 * (inner + outer), 0.5 * (outer - inner)

    def rate(x):
        u = middle + half * math.sin(x)
        return 1.0 / (u * math.sqrt(2.0 * (u - third)))

    turn = quad(rate, -0.5 * math.pi, 0.5 * math.pi, epsabs=1e-12, epsrel=1e-12, limit=500)[0]
    return 2.0 * math.sqrt(disk.body.M / disk.body.I1) * turn


@pytest.mark.parametrize(
    ("disk", "first", "last"), [(UNIFORM, 2.58177, 2.23607), (HOOP, 1.99983, 1.73205)], ids=["uniform", "hoop"]
)
def test_the_turn_per_bounce_goes_from_the_euler_disk_to_the_race(disk, first, last):
    found = turn_per_bounce(disk, [1.001, 1e4])
    np.testing.assert_allclose(found.chi / math.pi, [first, last], atol=6e-6)
    closer = turn_per_bounce(disk, [1.0001, 1.001]).chi
    # linear in the energy above the bottom, so the limit can be read off
    assert closer[0] + (closer[0] - closer[1]) / 9.0 == pytest.approx(found.slowest, abs=1e-7)
    assert found.slowest == pytest.approx(2.0 * math.pi * math.sqrt(disk.kappa**2 / 3.0))
    assert found.chi[1] == pytest.approx(disk.race_limit, abs=2e-4)


def test_the_whole_curve_is_the_leading_order_integral(body):
    found = turn_per_bounce(body, np.geomspace(1.01, 1e3, 12), 1e-12 * body.rate_unit)
    wanted = [leading_turn(body, level) for level in found.level]
    np.testing.assert_allclose(found.chi, wanted, rtol=0.0, atol=2e-6)
    np.testing.assert_allclose(found.level, np.geomspace(1.01, 1e3, 12), rtol=1e-6)
    assert (np.diff(found.chi) < 0.0).all()


def test_the_sign_of_eta_is_the_way_of_the_bounces():
    one, other = (turn_per_bounce(HOOP, [2.0, 50.0], eta).chi for eta in (1e-10, -1e-10))
    np.testing.assert_allclose(one, -other, rtol=1e-12)


def test_the_euler_disk_turns_at_the_rate_of_the_steady_motion():
    """Near the bottom chi-dot = Omega with Omega^2 = m g r/(I1 sin theta)."""
    found = turn_per_bounce(UNIFORM, [1.0001])
    rate = found.chi[0] / found.period[0]
    assert rate == pytest.approx(math.sqrt(1.0 / (UNIFORM.I1 * math.sin(found.theta_0))), rel=1e-3)


def test_bounces_draw_their_curves_and_limits(bounces):
    ax = bodies.bounce_turns(bounces)
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), bounces[0].chi / math.pi)
    assert ax.lines[1].get_ydata()[0] == pytest.approx(2.0 * math.sqrt(5.0 / 3.0))
    assert ax.lines[2].get_ydata()[0] == pytest.approx(math.sqrt(5.0))


# Wander


@pytest.mark.parametrize(
    ("disk", "eta_hat", "period", "chi", "step"),
    [
        (UNIFORM, 0.01, 3.5309125568, 10.16442885, 1.62355),
        (UNIFORM, -0.01, 3.5069444328, -3.87572184, 2.16059),
        (HOOP, 0.01, 3.5443368831, 8.57037740, 2.14376),
        (HOOP, -0.01, 3.5168724512, -2.31358306, 1.61133),
    ],
)
def test_the_drift_is_that_of_the_figures_of_the_paper(disk, eta_hat, period, chi, step):
    """sigma1 = 0, sigma2 = sigma3 = 1: phidot = 1 at the vertical."""
    found = wander(start(disk, 1.0, eta_hat))
    assert found.period[0] == pytest.approx(period, abs=1e-9)
    assert found.chi[0] == pytest.approx(chi, abs=1e-7)
    assert abs(found.step[0]) == pytest.approx(step, abs=6e-6)


def test_one_period_tells_the_place_after_many(wanders):
    for found in wanders.values():
        places = found.wander.after(found.count)[0]
        after = np.isin(found.t, found.wander.period[0] * np.arange(found.count + 1))
        assert after.sum() == found.count + 1
        np.testing.assert_allclose(found.centre[after] @ [1.0, 1j], places, atol=1e-6)
        # the contact point stays within a radius of the centre's shadow
        assert np.hypot(*(found.contact - found.centre).T).max() <= 1.0 + 1e-9


def test_at_a_resonance_the_drift_has_no_bound_and_elsewhere_it_has(resonant, wanders):
    root, states = resonant
    assert 0.15 < root < 0.3
    found = ex.periods(states, 1e-9, eta_hat=0.01)
    assert found.chi[0] == pytest.approx(4.0 * math.pi, abs=1e-9)
    beside = ex.periods(start(UNIFORM, root + 1e-3, 0.01), 1e-9, eta_hat=0.01)
    assert abs(beside.chi[0] - 4.0 * math.pi) > 1e-4
    walked = wanders["resonance"]
    distance = abs(walked.wander.after(1000)[0])
    np.testing.assert_allclose(distance, np.arange(1001) * abs(walked.wander.step[0]), rtol=1e-6)
    assert np.hypot(*walked.centre[-1]) == pytest.approx(8 * abs(walked.wander.step[0]), rel=1e-6)
    generic = wanders["generic"].wander
    assert abs(generic.after(100_000)[0]).max() == pytest.approx(2.0 * generic.radius[0], rel=1e-3)


def test_the_drift_scales_with_the_units():
    """The coin in SI units wanders as the uniform disk does, in radii."""
    coin = BODIES["coin"]
    one, other = (wander(start(disk, [0.4, 1.0], 0.02)) for disk in (UNIFORM, coin))
    np.testing.assert_allclose(other.step / coin.r, one.step, rtol=1e-7)
    np.testing.assert_allclose(other.radius / coin.r, one.radius, rtol=1e-7)


def test_paths_keep_the_race_round_at_small_eta():
    found = wander_path(start(UNIFORM, 1.0, 1e-6), 2)
    hops = np.hypot(*np.diff(found.contact, axis=0).T)
    assert hops.max() < 0.15


def test_the_pictures_of_paths_show_places_and_circle(wanders):
    figure = paths.rosette_and_resonance(wanders["generic"], wanders["resonance"])
    rosette, walk = figure.axes
    wander = wanders["generic"].wander
    x, y = rosette.lines[3].get_data()
    place = wander.after(30)[0]
    middle = wander.step[0] / (1.0 - np.exp(1j * wander.chi[0]))
    np.testing.assert_allclose(np.hypot(x - middle.real, y - middle.imag), wander.radius[0])
    np.testing.assert_allclose(abs(place - middle), wander.radius[0])
    assert len(walk.lines) == 3
    assert "unbounded" in walk.get_title()
    assert "unbounded" not in rosette.get_title()


def test_the_picture_of_distances_bounds_the_generic_motion_only(wanders):
    ax = paths.wander_distance(wanders)
    bound = [line for line in ax.lines if line.get_ls() == ":" and len(line.get_xdata()) == 2]
    assert [line.get_ydata()[0] for line in bound] == pytest.approx([2.0 * wanders["generic"].wander.radius[0]])


def test_the_radius_peaks_at_the_resonance(resonant):
    bars = np.linspace(0.15, 0.3, 31)
    ax = paths.wander_radius(bars, wander(start(UNIFORM, bars, 0.01)), 1.0, {2: resonant[0]})
    x, y = ax.lines[0].get_data()
    assert abs(x[np.argmax(y)] - resonant[0]) < 0.005
    assert y.max() > 20.0 * y[-1]
    assert ax.lines[2].get_xdata()[0] == resonant[0]


# The film


@pytest.fixture(scope="module")
def shown():
    return film(UNIFORM, frames=60)


def test_both_motions_of_the_film_are_flattest_at_zero_and_race_opposite_ways(shown):
    wanted = ex.passages(UNIFORM, 1.0, [0.05, -0.05], 1.0)
    for sign, theta, turn in zip((1, -1), wanted.theta_min, wanted.delta_chi, strict=True):
        tilt = 0.5 * math.pi - shown.phi[sign]
        assert abs(shown.t[np.argmin(tilt)]) < 2e-3
        assert tilt.min() == pytest.approx(theta, rel=1e-3)
        assert shown.chi[sign][-1] - shown.chi[sign][0] == pytest.approx(turn, abs=0.02)
        np.testing.assert_allclose(shown.contact[sign][:, 2], 0.0, atol=1e-15)


def test_the_clock_of_the_film_slows_in_proportion_to_the_tilt(shown):
    """dt = q ds: from frame to frame time goes on by q, so that the race fills many frames."""
    steps = np.diff(shown.t)
    assert (steps > 0.0).all()
    middle = 0.5 * (1.0 / shown.slowed[1:] + 1.0 / shown.slowed[:-1])
    ratio = steps / middle
    assert ratio.max() / ratio.min() < 1.02
    per_frame = abs(np.diff(shown.chi[1][shown.frames]))
    assert per_frame.max() < 0.6
    assert shown.slowed.max() > 20.0


def test_the_rim_touches_the_table_without_sliding(shown):
    for sign in (1, -1):
        for row in (0, 100, 177, 300):
            rim = shown.rim(sign, row, np.linspace(0.0, 2.0 * math.pi, 181))
            np.testing.assert_allclose(rim[0], shown.contact[sign][row], atol=1e-12)
            assert rim[:, 2].min() > -1e-12
            np.testing.assert_allclose(np.linalg.norm(rim - shown.centre[sign][row], axis=1), 1.0, rtol=1e-12)


def test_the_point_of_the_body_at_the_contact_is_at_rest(shown):
    """The one that touches the table at a row has hardly a speed, while the contact point runs."""
    for sign in (1, -1):
        for row in (60, 150, 250):
            moves = []
            for near in (row + 1, row - 1):
                moves.append(shown.mark(sign, near, shown.psi[sign][row]) - shown.contact[sign][row])
            speed = np.linalg.norm(moves[0] - moves[1]) / (shown.t[row + 1] - shown.t[row - 1])
            raced = np.linalg.norm(shown.contact[sign][row + 1] - shown.contact[sign][row - 1]) / (
                shown.t[row + 1] - shown.t[row - 1]
            )
            assert speed < 0.02 * max(raced, 1.0)


def test_the_film_is_a_small_gif_whose_panels_differ(tmp_path):
    before = dict(matplotlib.rcParams)
    target = tmp_path / "fall.gif"
    animation.animate(target, HOOP)
    assert dict(matplotlib.rcParams) == before
    assert target.stat().st_size < 3_000_000
    with Image.open(target) as gif:
        assert gif.n_frames == 100
        assert gif.info["loop"] == 0
        durations, frames = [], []
        for number in range(gif.n_frames):
            gif.seek(number)
            durations.append(gif.info["duration"])
            frames.append(np.asarray(gif.convert("RGB"), dtype=int))
    assert durations == [60] * 99 + [1500]
    height, width = frames[0].shape[:2]
    inside = slice(int(0.2 * height), int(0.85 * height))
    last_left, last_right = frames[-1][inside, : width // 2], frames[-1][inside, width // 2 :]
    assert (abs(last_left - last_right).sum(axis=2) > 60).mean() > 0.05
    for one, next_one in pairwise(frames):
        assert (abs(one - next_one).sum(axis=2) > 60).any()


def test_the_artists_of_the_film_follow_the_rows(shown):
    scene = animation.Scene(shown)
    row = int(shown.frames[30])
    scene.show(row)
    for panel, sign in zip(scene.panels, (1, -1), strict=True):
        contact = animation.seen(shown.contact[sign][row])
        np.testing.assert_allclose(np.ravel(panel.contact.get_data()), contact)
        assert len(panel.past.get_xdata()) == row + 1
        rim = np.array(panel.rim.get_data()).T
        assert np.linalg.norm(rim - contact, axis=1).min() < 1e-12
    assert f"{shown.slowed[row]:.1f} times" in scene.clock.get_text()


# What people get wrong


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: race_slice(UNIFORM, Slice.defaults(UNIFORM)[0], 1), "points = 1"),
        (lambda: race_numbers(-1.0), "most = -1.0"),
        (lambda: race_numbers(16.0, 1), "points = 1"),
        (lambda: flat_body(0.0), "ratio = 0.0"),
        (lambda: measured_gaps([]), "disks: none"),
        (lambda: turn_per_bounce(UNIFORM, [0.9, 2.0]), "levels"),
        (lambda: turn_per_bounce(UNIFORM, []), "levels"),
        (lambda: turn_per_bounce(UNIFORM, [2.0], 0.0), "eta_hat = 0.0"),
        (lambda: turn_per_bounce(UNIFORM, [1e4], 1e-3), "eta_hat = 0.001"),
        (lambda: bodies.bounce_turns([]), "found"),
        (lambda: resonance(UNIFORM, 0.01, 1.0, 2, (0.5, 1.0)), "2 is not in between"),
        (lambda: resonance(UNIFORM, 0.01, 1.0, 2, (0.5,)), "two numbers"),
        (lambda: resonance(UNIFORM, 0.01, 1.0, 1.5, (0.1, 1.0)), "a whole one"),
        (lambda: resonance(UNIFORM, 0.0, 1.0, 2, (0.1, 1.0)), "no period at sigma3_bar = 0.1"),
        (lambda: wander_path(start(UNIFORM, [1.0, 1.1], 0.01), 3), "2 were given"),
        (lambda: wander_path(start(UNIFORM, 1.0, 0.01), 0), "count = 0"),
        (lambda: wander_path(start(UNIFORM, 1.0, 0.0), 3), "no period"),
        (lambda: film(UNIFORM, eta_hat=-0.05), "eta_hat = -0.05"),
        (lambda: film(UNIFORM, frames=1), "frames = 1"),
        (lambda: film(UNIFORM, sigma3_bar=[1.0, 2.0]), "sigma3_bar = [1.0, 2.0]"),
        (lambda: film(UNIFORM, sigma3_bar=math.nan), "sigma3_bar = nan"),
        (lambda: film(UNIFORM, phidot=-1.0), "phidot = -1.0"),
        (lambda: animation.animate("fall.png", UNIFORM), ".gif"),
        (lambda: animation.animate("no/such/folder/fall.gif", UNIFORM), "make it first"),
    ],
)
def test_bad_input_gets_a_sentence(call, says):
    with pytest.raises(ex.InputError) as caught:
        call()
    assert says in str(caught.value)
