"""What pictures compute for themselves, against laws and motions that they do not know of."""

import math

import numpy as np
import pytest
from conftest import BODIES
from matplotlib.colors import to_hex

import explorer as ex
from explorer.phase.bifurcation import PATHS, bifurcation, stability_edges
from explorer.pictures.bifurcations import least_energies, one_in_each_region
from explorer.pictures.bodies import gap_of, race_number_of
from explorer.pictures.near_flat import followed
from explorer.pictures.rotation import rotation_numbers
from explorer.pictures.slices import signed_tilt
from explorer.pictures.style import SIGN_COLOURS
from explorer.pictures.surface import sheets

UNIFORM, HOOP, COIN = BODIES["uniform"], BODIES["hoop"], BODIES["coin"]


@pytest.mark.parametrize("eta_hat", [1e-4, -1e-4, 1e-8, -1e-8])
def test_the_race_is_the_arctangent_of_the_stretched_time(eta_hat):
    (one,) = followed(HOOP, [eta_hat])
    seen = abs(one.stretched) < 30.0
    assert seen.sum() > 20
    apart = one.raced[seen] - math.copysign(1.0, eta_hat) * np.arctan(one.stretched[seen])
    # phi is rounded near pi/2, and at the flattest moment the stretched time is a square root of a difference.
    rounded = math.sqrt(np.finfo(float).eps / one.theta_min)
    assert abs(apart).max() < 100.0 * abs(eta_hat) + rounded


def test_a_passage_keeps_to_the_ellipse_of_the_energy_at_flat():
    """p^2 + (rho/kappa)^2 = A^2, but for what gravity and the spin add at a tilt of theta."""
    (one,) = followed(HOOP, [-1e-6])
    flat = one.theta < 1e-4
    np.testing.assert_allclose(np.hypot(one.p, one.rho / HOOP.kappa)[flat], one.impact_speed, rtol=2e-4)
    assert one.rho[flat].min() == pytest.approx(-HOOP.kappa * one.impact_speed, rel=1e-2)
    with pytest.raises(ex.InputError, match="1e-12"):
        next(followed(HOOP, [1e-12]))


def test_passages_beside_f_measure_kappa_and_gaps_are_those_of_the_paper():
    """Race angles by quadrature, on both sides; the law eta ln(1/eta) leaves 1e-10 at 1e-12."""
    disks = [HOOP, UNIFORM, BODIES["thick"], COIN, ex.Disk.uniform(r=4.0, g=1.0), ex.Disk.uniform(g=1e-16)]
    found = race_number_of(disks)
    np.testing.assert_allclose(found, [disk.kappa for disk in disks], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(gap_of(found[:2]), [2.0 * np.pi - 4.599611, 1.483259], atol=1e-6)
    assert gap_of(np.array([1.0, 3.0])).tolist() == [0.0, 0.0]


def test_each_motion_of_the_map_of_turns_has_its_energy_and_its_turns():
    x, y, turns = rotation_numbers(UNIFORM, 2.0, 24)
    for row, column in ((12, 12), (5, 15), (20, 8)):
        left = 2.0 - UNIFORM.I1 * x[column] ** 2 - (UNIFORM.I3 + 1.0) * y[row] ** 2
        speed = np.sqrt(left / (UNIFORM.I1 + 1.0))
        period = ex.periods(ex.phi_to_states(UNIFORM, 0.0, speed, x[column], y[row]))
        assert period.energy.item() == pytest.approx(2.0)
        assert period.chi.item() / (2.0 * np.pi) == pytest.approx(turns[row, column], abs=1e-4)
    # An ellipse in its box; turning the other way turns the other way
    assert np.isfinite(turns).mean() == pytest.approx(np.pi / 4.0, abs=0.03)
    np.testing.assert_allclose(turns, -turns[::-1, ::-1], atol=1e-3)


def test_eta_vanishes_on_the_lines_of_both_faces():
    tilts = (-1.2, 0.3, 1.5)
    for face, lines in sheets(COIN, COIN.rate_unit, tilts).items():
        for phi, line in zip(tilts, lines, strict=True):
            known = ex.constants(ex.phi_to_states(COIN, phi, 1.0, *line.T))
            scale = abs(known.eta_hat_plus) + abs(known.eta_hat_minus)
            assert (abs(known.eta_hat_plus if face > 0 else known.eta_hat_minus) <= 1e-12 * scale + 1e-12).all()
            assert abs(line).max() == pytest.approx(COIN.rate_unit)


@pytest.mark.parametrize(("path", "counts"), [("line", [1, 2, 1, 1]), ("rolling", [2, 1, 1])])
def test_there_is_one_place_in_each_region_of_the_energies(path, counts):
    threshold = PATHS[path].threshold(HOOP)
    places = one_in_each_region(HOOP, path, threshold)
    assert [len(PATHS[path].potential(HOOP, at).components(energy)) for at, energy in places] == counts
    floor = least_energies(HOOP, path, np.array([at for at, _ in places]), bifurcation(HOOP, path, [places[0][0]]))
    assert all(energy > least for (_, energy), least in zip(places, floor, strict=True))


def test_the_least_energy_has_no_gap_at_the_threshold_where_the_steady_motion_is_of_no_branch():
    thick = ex.Disk(I1=0.5, I3=0.3, name="thick")
    edge = PATHS["rolling"].threshold(thick)
    at = edge * np.array([1.0 - 1e-3, 1.0, 1.0 + 1e-3])
    low, middle, high = least_energies(thick, "rolling", at, bifurcation(thick, "rolling", at))
    assert middle == pytest.approx(0.5 * (low + high), rel=1e-3)


def test_on_both_sides_of_f_the_race_goes_opposite_ways_and_the_tilt_alike():
    """Half of the ellipse phidot^2 + rho^2/kappa^2 = A^2, eq. (7.6), on the half of each side."""
    tilt, race = ex.picture("portrait-of-sides", ex.potential(UNIFORM, 0.25, 1e-4)).axes
    sides = {}
    for side, colour in SIGN_COLOURS.items():
        for line in [line for line in race.lines if line.get_color() == colour]:
            rho, phidot = line.get_data()
            fastest = rho[np.argmax(abs(rho))]
            assert np.sign(fastest) == side
            assert abs(fastest) / UNIFORM.kappa == pytest.approx(phidot.max(), rel=0.01)
        sides[side] = [line.get_ydata().max() for line in tilt.lines if line.get_color() == colour]
    assert len(sides[1]) == 4
    assert sides[1] == pytest.approx(sides[-1], rel=1e-3)


def test_arrows_of_contact_paths_point_along_the_motion():
    both = ex.both_sides(ex.constants_to_states(HOOP, 0.6, 0.0, 1.0))
    (ax,) = ex.picture("contact-paths", both).axes
    heads = [text for text in ax.texts if getattr(text, "arrow_patch", None) is not None]
    for sign, colour in SIGN_COLOURS.items():
        path = both.motions[sign]["contact"][:, :2] / HOOP.r
        mine = [head for head in heads if to_hex(head.arrow_patch.get_facecolor()) == colour.lower()]
        assert len(mine) == 5
        for head in mine:
            tip, tail = np.array(head.xy), np.array(head.xyann)
            row = int(np.argmin(np.hypot(*(path - tip).T)))
            velocity = path[row] - path[max(row - 1, 0)]
            assert velocity @ (tip - tail) / np.hypot(*velocity) / np.hypot(*(tip - tail)) > 0.9


def test_half_and_nine_tenths_of_the_passages_are_within_the_lines_of_the_deviation_which_fall_like_the_law():
    eta_hat = np.geomspace(1e-9, 1e-3, 300) * np.where(np.arange(300) % 2, 1.0, -1.0)
    sigma3_bar, phidot = np.random.default_rng(0).uniform(0.5, 2.0, (2, 300))
    found = ex.passages(UNIFORM, sigma3_bar, eta_hat, phidot, accuracy=1e-9)
    rows = ex.race_law(UNIFORM, eta_hat, found.race_angle, found.impact_speed)
    most, half, law = ex.picture("race-deviation", rows).axes[0].lines
    K = 2.0 / (UNIFORM.I1 * (UNIFORM.I1 + 1.0) * found.impact_speed**3)
    away = abs(found.race_angle - np.sign(eta_hat) * UNIFORM.race_limit) / K
    for line, share in ((most, 0.9), (half, 0.5)):
        assert (away < np.interp(abs(eta_hat), *line.get_data())).mean() >= share - 0.05
        # The constant beside the logarithm is as large as itself at 1e-4
        assert (abs(np.log(line.get_ydata() / law.get_ydata())) < np.log(5.0)).all()


def test_races_of_passages_bounces_and_a_summary_have_a_ridge_for_each_decade_and_side_and_a_law():
    eta_hat = [1e-3, -2e-3, 1e-5]
    passages = ex.passages(UNIFORM, 1.0, eta_hat, 1.0)
    bounces = ex.bounces(ex.constants_to_states(UNIFORM, 1.0, eta_hat, 1.0))
    for found in (passages, bounces):
        whole, ax = ex.picture("race-histogram", found, bins=4).axes
        spikes = [abs(np.average(p.get_data().edges[:-1], weights=p.get_data().values)) for p in whole.patches]
        assert spikes == pytest.approx([UNIFORM.race_limit] * 2, rel=0.05)
        assert [label.get_text() for label in ax.get_yticklabels()] == ["$10^{-5}$", "$10^{-3}$"]
        assert len([patch for patch in ax.patches if patch.get_data().baseline is not None]) == 4
        law = ex.picture("race-deviation", found).axes[0].lines[-1].get_xdata()
        np.testing.assert_allclose(law, np.sort(np.abs(eta_hat)), rtol=0.2)
    with pytest.raises(ex.InputError, match="give the summary of a run of race-angles"):
        ex.picture("race-deviation", UNIFORM)


def test_the_colours_of_a_slice_tell_side_and_tilt():
    cut = ex.slice_map(UNIFORM, "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2", points=61)
    values, could = signed_tilt(cut), cut.side != 0
    np.testing.assert_array_equal(np.isnan(values), np.isnan(cut["theta_min"]))
    np.testing.assert_array_equal(np.sign(values[could]), cut.side[could])
    known = np.isfinite(values) & could
    assert (np.diff(abs(values[known])[np.argsort(cut["theta_min"][known])]) >= 0.0).all()


@pytest.mark.parametrize("phidot", [0.0, 1e-3, 0.05])
def test_the_falling_set_is_drawn_for_states_that_hardly_move_too(phidot):
    """There could_fall is true on one side of F alone."""
    cut = ex.slice_map(UNIFORM, f"phi=0.3,phidot={phidot},sigma3=-2:2,sigma4=-2:2", points=101)
    figure = ex.picture("slice-of-tilts", cut)
    told = {text.get_text() for text in figure.axes[0].get_legend().get_texts()}
    assert {"$F$, face +1", "$F$, face −1"} <= told


def test_shares_of_samples_have_the_interval_of_their_counts():
    (ax,) = ex.picture("theta-min", np.geomspace(1e-3, 1.0, 10), 1000).axes
    band = ax.collections[0].get_paths()[0].vertices
    first = band[np.isclose(band[:, 0], band[:, 0].min(), rtol=0.01)]
    # Garwood: between 0.0253 and 5.57 for one count
    assert first[:, 1].min() == pytest.approx(0.0253e-3, rel=0.01)
    assert first[:, 1].max() == pytest.approx(5.572e-3, rel=0.01)


def test_what_nobody_knows_is_said():
    for theta, told in (([], "no sample was computed"), ([0.0, 0.0], "all samples fall flat")):
        assert ex.picture("theta-min", theta).axes[0].texts[0].get_text() == told
    nowhere = ex.phi_to_states(UNIFORM, 2.0, [1.0, 2.0], 1.0, 0.7)
    scanned = ex.picture("observable", ex.scan(nowhere, "theta_min")).axes[0]
    assert scanned.texts[0].get_text() == "theta min is not known of any state"
    assert "no deviation" in ex.picture("race-deviation", []).axes[0].texts[0].get_text()


def test_states_in_a_row_are_a_line_and_others_a_cloud():
    row = ex.scan(ex.phi_to_states(UNIFORM, 0.1, 0.5, np.linspace(0.1, 1.0, 9), 0.3), "theta_min")
    np.testing.assert_array_equal(ex.picture("observable", row).axes[0].lines[0].get_ydata(), row["theta_min"])
    cloud = ex.scan(ex.phi_to_states(UNIFORM, 0.1, [[0.5], [0.6]], np.linspace(0.1, 1.0, 9), 0.3), "theta_min")
    assert len(ex.picture("observable", cloud).axes[0].collections[0].get_offsets()) == 18


def named(ax, label):
    return next(line for line in ax.lines if line.get_label() == label)


def test_the_separatrix_has_the_energy_of_its_saddle_and_a_flat_state_is_a_wall_off_the_line():
    potential = ex.potential(UNIFORM, 0.25, 0.01)
    (ax,) = ex.picture("phase-portrait", potential).axes
    phi, phidot = named(ax, "separatrix").get_data()
    energy = 0.5 * UNIFORM.body.M * phidot**2 + potential.V(phi)
    assert energy == pytest.approx(potential.separatrices()[0].saddle.energy, rel=1e-12)
    assert named(ax, "wall at flat").get_xdata() == [-0.5 * math.pi, -0.5 * math.pi]
    (on,) = ex.picture("phase-portrait", ex.potential(UNIFORM, 0.25)).axes
    assert named(on, "flat, reached").get_xdata() == [0.5 * math.pi, 0.5 * math.pi]
    told = [{text.get_text() for text in each.get_legend().get_texts()} for each in (ax, on)]
    assert ["falls" in words for words in told] == [False, True]


@pytest.mark.parametrize("near_flat", [False, True])
def test_the_curves_of_the_potential_are_its_values(near_flat):
    potentials = [ex.potential(UNIFORM, 0.25, eta) for eta in (0.0, 0.01, -0.01)]
    (ax,) = ex.picture("potentials", potentials, near_flat).axes
    for potential, name in zip(potentials, ("0", "0.01", "−0.01"), strict=True):
        on = "on the line, " if potential.hat == 0.0 else ""
        x, V = named(ax, rf"{on}$\hat\eta$ = {name}").get_data()
        phi = 0.5 * math.pi - x if near_flat else x
        shown = np.isfinite(V) & (abs(phi) < 1.57)
        assert V[shown] == pytest.approx(potential.V(phi[shown]), rel=1e-6)


def test_the_map_of_circular_rolling_is_stable_outside_the_edges():
    (ax,) = ex.picture("steady-map", UNIFORM).axes
    mesh = next(each for each in ax.collections if np.size(each.get_array()) > 1000)
    stable = np.asarray(mesh.get_array()).reshape(321, 241)
    lean, precession = np.linspace(1e-3, 0.5 * np.pi - 1e-3, 241), np.linspace(0.02, 3.2, 321)
    fast, slow = stability_edges(UNIFORM, lean[16])[:, 0]
    assert (stable[:, 16] == ((precession < slow) | (precession > fast))).all()


def test_dots_of_a_rosette_lie_on_its_circle_and_a_resonance_walks(wanders):
    (ax,) = ex.picture("rosette", wanders["generic"]).axes
    wander = wanders["generic"].wander
    middle = wander.step / (1.0 - np.exp(1j * wander.chi))
    dots, circle = (line.get_xydata() @ [1.0, 1j] for line in ax.lines[2:])
    for points in (dots, circle):
        np.testing.assert_allclose(abs(points - middle), wander.radius)
    (walk,) = ex.picture("rosette", wanders["resonance"]).axes
    assert len(walk.lines) == 3
    assert "it walks" in walk.get_title()


def test_the_sketch_has_the_line_on_which_eta_vanishes_and_a_motion_in_the_colour_of_its_side():
    plane = ex.picture("definitions", HOOP).axes[1]
    states = ex.phi_to_states(HOOP, 0.0, 1.0, *plane.lines[0].get_data())
    assert abs(ex.constants(states).eta_hat_plus).max() < 1e-12
    (dot,) = [line for line in plane.lines if line.get_marker() == "o"]
    eta_hat = ex.constants(ex.phi_to_states(HOOP, 0.0, 1.0, *np.ravel(dot.get_data()))).eta_hat_plus
    assert dot.get_color() == SIGN_COLOURS[int(np.sign(eta_hat.item()))]


def test_a_legend_names_each_thing_once_however_often_it_is_drawn():
    both = ex.both_sides(ex.constants_to_states(UNIFORM, 1.0, 0.0, 1.0))
    disks = dict.fromkeys(("steady-plane", "race-collapse", "blow-up", "falling-surface"), (UNIFORM,))
    what = {
        **disks,
        "contact-paths": (both,),
        "one-sided-motion": (both,),
        "bifurcation-of-tilts": (UNIFORM, "spinning"),
        "phase-portrait": (ex.potential(UNIFORM, 0.25, 0.01),),
        "race-histogram": (ex.passages(UNIFORM, 1.0, [1e-3, -1e-3, 1e-5, -1e-5], 1.0),),
    }
    for name, given in what.items():
        figure = ex.picture(name, *given)
        legends = [*figure.legends, *filter(None, (ax.get_legend() for ax in figure.axes))]
        words = [[text.get_text() for text in legend.get_texts()] for legend in legends]
        assert words, name
        assert all(len(each) == len({*each}) > 0 for each in words), name
