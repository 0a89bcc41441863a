import json
import math

import numpy as np
import pytest
from conftest import BODIES, computed
from matplotlib.figure import Figure
from scipy.optimize import brentq

import explorer as ex
from explorer.phase.membership import impact_speed, well
from explorer.plot import portrait as pictures
from explorer.plot import steady as steady_pictures
from explorer.portrait.potential import (
    CENTRE,
    FLAT,
    SADDLE,
    TURNING,
    Potential,
    at_constants,
    level_energies,
    on_line,
    well_separatrix,
)
from explorer.portrait.steady import (
    bifurcation,
    circular_closed,
    circular_rolling,
    last_unstable_tilt,
    path_values,
    rolling_closed,
    rolling_threshold,
    spinning_closed,
    spinning_threshold,
    stability_edges,
    steady_motions,
    threshold,
)
from explorer.scenes.portrait import Portrait

UNIFORM, COIN = BODIES["uniform"], BODIES["coin"]
# Natural units: sigma3_bar, eta_hat, side. On the lines, beside them, far away, and the upright cases.
CONSTANTS = [
    (0.25, 0.0, 1),
    (0.2, 0.0, -1),
    (0.25, 0.01, 1),
    (0.25, -1e-6, 1),
    (1.0, 0.0, 1),
    (-0.8, 0.3, -1),
    (0.0, 0.3, 1),
    (0.0, 0.0, 1),
    (30.0, 2.0, 1),
]


def made(disk, row):
    return Potential(disk, *row)


def state_at(potential, phi, phidot):
    """A state with these constants, found by the chart of the states and not by the potential."""
    disk = potential.disk
    grid = [ex.constants(disk, phi, 0.0, s3, s4) for s3, s4 in ((1.0, 0.0), (0.0, 1.0))]
    map_ = np.array([[g.sigma3_bar[0] for g in grid], [g.sigma4_bar[0] for g in grid]])
    s3, s4 = np.linalg.solve(map_, [potential.sigma3_bar, potential.sigma4_bar])
    return phi, phidot, s3, s4


@pytest.mark.parametrize("row", CONSTANTS)
def test_v_is_the_energy_of_a_state_at_rest_with_the_same_constants(body, row):
    unit = body.rate_unit
    potential = Potential(body, row[0], row[1], row[2])
    for phi in (-1.2, -0.4, 0.0, 0.7, 1.3):
        found = ex.constants(body, *state_at(potential, phi, 0.7 * unit))
        energy = found.energy[0] - 0.5 * body.body.M * 0.49 * body.energy_unit
        assert energy == pytest.approx(float(potential.V(phi)), rel=1e-11)


@pytest.mark.parametrize("row", CONSTANTS)
def test_derivatives_are_those_of_v(body, row):
    potential, h = made(body, row), 1e-3
    phi = np.linspace(-1.2, 1.2, 25)
    five = np.array([1.0, -8.0, 8.0, -1.0]) / (12.0 * h)
    for lower, upper in ((potential.V, potential.dV), (potential.dV, potential.d2V)):
        measured = sum(w * lower(phi + k * h) for w, k in zip(five, (-2, -1, 1, 2), strict=True))
        size = abs(upper(phi)).max() + body.energy_unit
        assert abs(measured - upper(phi)).max() < 1e-8 * size


@pytest.mark.parametrize("row", CONSTANTS)
def test_equilibria_solve_v_prime_and_none_is_missed(body, row):
    potential = made(body, row)
    for at in potential.equilibria:
        assert at.residual < 50.0
        assert at.theta == pytest.approx(0.5 * math.pi - abs(at.phi), abs=1e-15)
        assert (at.curvature > 0.0) == (at.kind == CENTRE)
    # A finer count of sign changes, in phi rather than y, away from flat
    phi = np.linspace(-1.5, 1.5, 20_011)
    signs = np.sign(potential.dV(phi))
    changes = np.count_nonzero(signs[:-1] * signs[1:] < 0.0) + np.count_nonzero(signs == 0.0)
    assert changes == sum(abs(at.phi) < 1.5 for at in potential.equilibria)


def test_two_equilibria_much_closer_than_the_grid_are_both_found():
    angle, most = well(UNIFORM)
    close = on_line(UNIFORM, most * (1.0 - 1e-9)).equilibria
    assert [at.kind for at in close] == [CENTRE, SADDLE]
    assert abs(close[1].phi - close[0].phi) < 1e-3
    assert close[0].phi < angle < close[1].phi
    assert on_line(UNIFORM, most * (1.0 + 1e-9)).equilibria == ()


@pytest.mark.parametrize("eta", [1e-3, 1e-6, 1e-12, 1e-30, 1e-100])
def test_the_equilibrium_near_flat_follows_its_law(eta):
    """theta_0 = (eta^2/(I1 m g r))^(1/3) as eta -> 0, statement 30."""
    near = on_line(UNIFORM, 0.25, eta).equilibria[-1]
    b = UNIFORM.body
    law = ((b.I3 * b.r0 * eta) ** 2 / b.I1) ** (1.0 / 3.0)
    assert near.kind == CENTRE
    assert near.theta == pytest.approx(law, rel=2.0 * eta**0.25)


def test_constants_on_a_line_to_rounding_are_on_it(body):
    for face in (1, -1):
        on = on_line(body, 0.2 * body.rate_unit, 0.0, face)
        found = at_constants(body, on.sigma3_bar, on.sigma4_bar)
        assert (found.eta, found.face) == (0.0, face)


def test_a_motion_started_at_a_centre_stays_and_one_at_a_saddle_leaves():
    potential = on_line(UNIFORM, 0.25, 0.01)
    for at in potential.equilibria[:2]:
        run = ex.simulate(UNIFORM, state_at(potential, at.phi, 0.0), 20.0, observables=("phi",), accuracy=1e-9)
        away = abs(run.phi[0] - at.phi)
        if at.kind == CENTRE:
            assert away.max() < 1e-9
        else:
            # The growth rate is sqrt(-V''/M)
            rate = math.sqrt(-at.curvature / UNIFORM.body.M)
            assert away[0] < 1e-15
            assert away.max() < 1e-8 * math.exp(20.0 * rate)
        nudged = state_at(potential, at.phi, 1e-4)
        run = ex.simulate(UNIFORM, nudged, 20.0, observables=("phi",))
        assert (abs(run.phi[0] - at.phi).max() < 1e-3) == (at.kind == CENTRE)


@pytest.mark.parametrize("row", CONSTANTS)
def test_levels_conserve_energy_against_the_constants_of_states(body, row):
    potential = made(body, row)
    for energy in level_energies(potential):
        pieces = potential.components(float(energy))
        assert pieces
        for piece in pieces:
            phi, phidot = potential.curve(piece)
            inner = np.flatnonzero(abs(phi) < 1.4)[::23]
            for i in inner:
                found = ex.constants(body, *state_at(potential, phi[i], phidot[i])).energy[0]
                assert found == pytest.approx(energy, rel=1e-10)
            ends = zip(piece.ends, (piece.low, piece.high), phidot[[0, -1]], strict=True)
            for end, edge, speed in ends:
                if end == FLAT:
                    assert abs(edge) == 0.5 * math.pi
                    bar, natural = np.array([potential.bar]), np.array([energy / body.energy_unit])
                    impact = impact_speed(body, bar, natural)[0] * body.rate_unit
                    assert speed == pytest.approx(impact, rel=1e-12)
                elif abs(edge) < 1.5:
                    assert float(potential.V(edge)) == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize("eta", [0.01, -0.01])
def test_motions_run_along_their_level_between_its_ends(eta):
    potential = on_line(UNIFORM, 0.25, eta)
    energy = 1.3
    (piece,) = potential.components(energy)
    start = state_at(potential, 0.0, math.sqrt(2.0 * (energy - potential.V(0.0)) / UNIFORM.body.M))
    times = np.linspace(0.0, 12.0, 3001)
    run = ex.simulate(UNIFORM, start, t_eval=times, observables=("phi", "phidot"), accuracy=1e-10)
    assert run.phi.min() == pytest.approx(piece.low, abs=1e-4)
    assert run.phi.max() == pytest.approx(piece.high, abs=1e-4)
    phi = np.clip(run.phi[0], piece.low, piece.high)
    along = 0.5 * UNIFORM.body.M * run.phidot[0] ** 2 + potential.V(phi)
    # Near the wall V' is about 1e3: what phi does not know, V cannot
    assert abs(along[abs(phi) < 1.4] - energy).max() < 1e-8


@pytest.mark.parametrize("row", CONSTANTS)
def test_separatrices_leave_saddles_at_their_energy(body, row):
    potential = made(body, row)
    saddles = [at for at in potential.equilibria if at.kind == SADDLE]
    found = potential.separatrices()
    assert [each.saddle for each in found] == saddles
    for each in found:
        left, right = each.branches
        assert left.high == right.low == each.saddle.phi
        assert left.energy == right.energy == each.saddle.energy
        assert float(potential.V(each.saddle.phi)) == pytest.approx(each.saddle.energy, rel=1e-14)
        for piece, edge, end in ((left, left.low, left.ends[0]), (right, right.high, right.ends[1])):
            assert end in (TURNING, FLAT, SADDLE)
            if end == TURNING and abs(edge) < 1.5:
                assert float(potential.V(edge)) == pytest.approx(each.saddle.energy, rel=1e-12)
            phi, phidot = potential.curve(piece)
            inner = (abs(phi) < 1.5) & (phidot > 0.0)
            kinetic = 0.5 * body.body.M * (phidot[inner] / body.rate_unit) ** 2 * body.energy_unit
            assert kinetic + potential.V(phi[inner]) == pytest.approx(each.saddle.energy, rel=1e-13)
            # V stays below the saddle on the way: nothing stops the motion
            assert (potential.V(phi[abs(phi) < 1.5][2:-2]) < each.saddle.energy).all()


def test_at_least_one_separatrix_was_tested():
    assert sum(len(made(UNIFORM, row).separatrices()) for row in CONSTANTS) >= 5


def test_symmetric_saddles_are_joined_to_each_other():
    """A potential with two equal maxima, made by hand: no disk that was tried has two saddles."""

    class Two(Potential):
        def terms(self, q, z):
            phi = np.arctan2(z, q)
            # Maxima of -cos 4 phi at +-pi/4, kept in by a steep wall
            wall = np.maximum(abs(phi) - 0.9, 0.0)
            V = -np.cos(4.0 * phi) + 200.0 * wall**3
            # and equal to rounding only
            V = V * np.where(phi > 0.0, 1.0 + 4e-16, 1.0)
            dV = 4.0 * np.sin(4.0 * phi) + 600.0 * np.sign(phi) * wall**2
            d2V = 16.0 * np.cos(4.0 * phi) + 1200.0 * wall
            return V, dV, d2V, abs(4.0 * np.sin(4.0 * phi)) + 600.0 * wall**2 + 1e-3

    low, high = Two(UNIFORM, 0.0, 0.3).separatrices()
    assert low.branches[1].ends == (SADDLE, SADDLE) == high.branches[0].ends
    assert low.branches[1].high == pytest.approx(high.saddle.phi, abs=1e-14)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
@pytest.mark.parametrize("face", [1, -1])
def test_the_shading_agrees_with_who_could_fall(name, face):
    disk = BODIES[name]
    random = np.random.default_rng(3)
    for bar in (0.1, 0.2, 0.7):
        potential = on_line(disk, bar, 0.0, face)
        y = np.sort(random.uniform(-2.5, 2.5, 60))
        phi = np.arctan(np.sinh(y))
        speed = random.uniform(0.0, 1.5, 60)
        edge = potential.falling_edge(y)
        s3, s4 = np.transpose([state_at(potential, float(at), 0.0)[2:] for at in phi])
        falls = ex.falls(disk, phi, speed, s3, s4)
        could = falls.could_fall_plus if face > 0 else falls.could_fall_minus
        assert (could == (speed > edge)).all()
        assert could.any()
        if bar == 0.1:
            assert not could.all()
    assert np.isinf(on_line(disk, 0.2, 1e-9, face).falling_edge(y)).all()


def test_on_the_line_v_ends_at_v0_and_the_wall_appears_beside_it():
    on = on_line(UNIFORM, 0.25)
    assert on.flat_value(1) == pytest.approx(0.08687994 * 0.25**2, rel=1e-7)
    assert float(on.V(0.5 * math.pi - 1e-7)) == pytest.approx(on.flat_value(1), abs=2e-7)
    assert float(on.dV(0.5 * math.pi - 1e-6)) == pytest.approx(-1.0, abs=1e-4)
    for eta in (1e-3, -1e-3):
        beside = on_line(UNIFORM, 0.25, eta)
        assert math.isinf(beside.flat_value(1))
        # V ~ eta^2/(2 I1 theta^2)
        size = (UNIFORM.body.I3 * UNIFORM.body.r0 * eta) ** 2 / (2.0 * UNIFORM.body.I1 * 1e-12)
        assert float(beside.V(0.5 * math.pi - 1e-6)) == pytest.approx(size, rel=1e-3)


def test_the_well_has_a_separatrix_only_below_its_threshold():
    most = well(COIN)[1] * COIN.rate_unit
    found = well_separatrix(COIN, 0.8 * most)
    assert found.branches[0].ends == (TURNING, SADDLE)
    assert found.branches[1].ends == (SADDLE, FLAT)
    mirrored = well_separatrix(COIN, 0.8 * most, -1)
    assert mirrored.saddle.phi == pytest.approx(-found.saddle.phi, abs=1e-15)
    assert mirrored.branches[0].ends == (FLAT, SADDLE)
    for bar in (1.01 * most, -2.0 * most, 0.0):
        with pytest.raises(ex.InputError, match=r"sigma3_bar = .*no well.*give 0 < \|sigma3_bar\| <"):
            well_separatrix(COIN, bar)


def test_thresholds_from_the_second_derivative_match_the_closed_forms(body):
    assert rolling_threshold(body) == pytest.approx(rolling_closed(body), rel=1e-9)
    assert spinning_threshold(body) == pytest.approx(spinning_closed(body), rel=1e-9)
    for lean, radius in ((0.1, 5.0), (0.7, 1.0), (1.4, 2.0)):
        found = circular_rolling(body, lean, radius * body.r)
        assert found == pytest.approx(circular_closed(body, lean, radius * body.r), rel=1e-9)


def test_thresholds_of_the_uniform_disk_and_the_hoop():
    """g/3r and g/4r for straight rolling, 4g/5r and 2g/3r for spinning."""
    for name, rolls, spins in (("uniform", 1 / 3, 4 / 5), ("hoop", 1 / 4, 2 / 3)):
        assert rolling_threshold(BODIES[name]) ** 2 == pytest.approx(rolls, rel=1e-9)
        assert spinning_threshold(BODIES[name]) ** 2 == pytest.approx(spins, rel=1e-9)


def test_steady_motions_solve_the_potential_and_simulate_as_circles(paper_body):
    disk = paper_body
    for phi, turn in ((-0.7, 1.3), (0.4, -2.0), (-1.3, 0.8)):
        found = steady_motions(disk, phi, turn)
        potential = at_constants(disk, float(found.sigma3_bar), float(found.sigma4_bar))
        assert abs(float(potential.dV(phi))) < 1e-13 * (1.0 + turn**2)
        assert float(potential.d2V(phi)) == pytest.approx(float(found.curvature), rel=1e-11)
        assert min(abs(at.phi - phi) for at in potential.equilibria) < 1e-12
        start = [phi, 0.0, float(found.sigma3), float(found.sigma4)]
        run = ex.simulate(disk, start, 3.0, observables=("phi", "chi", "contact"), accuracy=1e-10)
        assert abs(run.phi[0] - phi).max() < 1e-9
        assert run.chi[0, -1] == pytest.approx(3.0 * turn, rel=1e-9)
        # The contact point keeps its distance from the centre of its circle
        chi = run.chi[0]
        centre = run.contact[0, :, :2] + float(found.radius) * np.stack([np.cos(chi), np.sin(chi)], axis=1)
        assert abs(centre - centre[0]).max() < 1e-8


def test_saddle_nodes_have_no_slope_and_no_curvature_and_meet_the_line_where_the_well_ends(body):
    last = last_unstable_tilt(body)
    phi = last * np.array([-0.99, -0.6, -0.1, 0.3, 0.8])
    for turn in stability_edges(body, phi):
        for tilt, rate in zip(phi, turn, strict=True):
            found = steady_motions(body, tilt, rate)
            potential = at_constants(body, float(found.sigma3_bar), float(found.sigma4_bar))
            size = body.energy_unit
            assert abs(float(potential.dV(tilt))) < 1e-12 * size
            assert abs(float(potential.d2V(tilt))) < 1e-11 * size
    assert np.isnan(stability_edges(body, [1.001 * last, -1.3])).all()

    def off_line(t):
        tilt = -last * math.sin(t)
        return float(steady_motions(body, tilt, stability_edges(body, tilt)[1, 0]).eta_hat)

    at = brentq(off_line, 0.5, 0.5 * math.pi - 1e-6)
    tilt = -last * math.sin(at)
    found = steady_motions(body, tilt, stability_edges(body, tilt)[1, 0])
    angle, most = well(body)
    assert abs(float(found.sigma3_bar)) == pytest.approx(most * body.rate_unit, rel=1e-9)
    assert tilt == pytest.approx(angle, abs=1e-5)


@pytest.mark.parametrize("path", ["spinning", "rolling", "line"])
def test_branches_of_a_path_change_at_its_threshold(path):
    values, marks = path_values(UNIFORM, path)
    branches = bifurcation(UNIFORM, path, values)
    saddles = np.concatenate([branch.parameter for branch in branches if branch.kind == SADDLE])
    assert saddles.max() == pytest.approx(marks[0], rel=1e-6)
    assert saddles.max() < marks[0]
    assert saddles.min() == -saddles.max()
    outside = [b for b in branches if b.parameter.min() > marks[0]]
    assert {b.kind for b in outside} == (set() if path == "line" else {CENTRE})


def scene_of(**options):
    return Portrait(disks=(options.pop("disk", UNIFORM),), **options)


def test_the_summary_has_levels_equilibria_separatrices_and_thresholds():
    scene = scene_of()
    found = json.loads(json.dumps({**scene.options(), **scene.summarise(computed(scene))}, allow_nan=False))
    assert [place["name"] for place in found["places"]] == ["on", "plus", "minus"]
    assert [place["reaches_flat"] for place in found["places"]] == [[1], [], []]
    assert all(place["largest_energy_error"] < 1e-12 for place in found["places"])
    assert len(found["levels"]) == found["samples"] == 27 == found["status"]["ok"]
    assert {at["kind"] for at in found["equilibria"]} == {CENTRE, SADDLE}
    assert [len(each["branches"]) for each in found["separatrices"]] == [2, 2, 2]
    falling = [piece["falls"] for level in found["levels"] for piece in level["pieces"] if level["place"] == "on"]
    assert True in falling
    assert False in falling
    for name in ("straight_rolling", "spinning_upright", "circular_rolling"):
        pair = found["thresholds"][name]
        assert pair["measured"] == pytest.approx(pair["closed_form"], rel=1e-9)
    well_ = found["well_on_the_line"]
    assert well_["bottom"] < well_["rim"] == found["separatrices"][0]["energy"]
    assert len(scene.headline(found)) == 6


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"well": True, "sigma3_bar": 1.0}, "no well beside the falling motions"),
        ({"energies": (2.0, 1.0)}, "empty range"),
        ({"energies": (1.0, 1.0)}, "empty range"),
        ({"energies": (-2.0, -1.0)}, "no motion has an energy below"),
        ({"energies": (0.0, math.inf)}, "empty range"),
        ({"sigma4_bar": 0.1, "eta_hat": 0.1}, "leave out one"),
        ({"well": True, "sigma4_bar": 0.1}, "leave it out"),
        ({"sigma3_bar": math.nan}, "must be a finite number"),
        ({"disk": ex.Disk(I1=0.25, I3=0.0)}, "I3 = 0"),
    ],
)
def test_bad_input_gets_a_sentence(options, words):
    with pytest.raises(ex.InputError, match=words):
        scene_of(**options)


def test_bad_arguments_of_the_functions_get_a_sentence():
    with pytest.raises(ex.InputError, match="face = 2"):
        on_line(UNIFORM, 0.2, 0.0, 2)
    with pytest.raises(ex.InputError, match="between the flat states"):
        on_line(UNIFORM, 0.2).V(2.0)
    with pytest.raises(ex.InputError, match="a finite turn, not zero"):
        steady_motions(UNIFORM, 0.1, 0.0)
    with pytest.raises(ex.InputError, match="lean = 2"):
        circular_rolling(UNIFORM, 2.0, 1.0)
    with pytest.raises(ex.InputError, match="rolls round circles above"):
        circular_rolling(UNIFORM, 1.0, 0.1)
    with pytest.raises(ex.InputError, match="rolls round circles above"):
        circular_closed(UNIFORM, 1.0, 0.1)
    with pytest.raises(ex.InputError, match="path 'up' is not known"):
        bifurcation(UNIFORM, "up", [0.1])
    with pytest.raises(ex.InputError, match="at no speed"):
        threshold(UNIFORM, lambda rate: on_line(UNIFORM, 0.0, 0.0), 1.0)


def axes():
    return Figure().subplots()


def lines(ax, label):
    return [line for line in ax.lines if line.get_label() == label]


def test_the_portrait_draws_levels_separatrix_equilibria_and_walls():
    potential = on_line(UNIFORM, 0.25, 0.01)
    ax = pictures.phase_portrait(potential, ax=axes())
    (separatrix,) = lines(ax, "separatrix")
    phi, phidot = separatrix.get_data()
    energy = 0.5 * UNIFORM.body.M * phidot**2 + potential.V(phi)
    assert energy == pytest.approx(potential.separatrices()[0].saddle.energy, rel=1e-12)
    lower = ax.lines[list(ax.lines).index(separatrix) + 1]
    assert (lower.get_xdata() == phi).all()
    assert (lower.get_ydata() == -phidot).all()
    marks = {
        label: [float(line.get_xdata()[0]) for line in ax.lines if line.get_marker() == m]
        for label, m in ((CENTRE, "o"), (SADDLE, "X"))
    }
    assert marks == {kind: [at.phi for at in potential.equilibria if at.kind == kind] for kind in marks}
    (wall,) = lines(ax, "wall")
    assert wall.get_xdata() == [-0.5 * math.pi, -0.5 * math.pi]
    assert not lines(ax, "flat")
    assert "falls" not in [text.get_text() for text in ax.get_legend().get_texts()]
    on = pictures.phase_portrait(on_line(UNIFORM, 0.25), ax=axes())
    assert len(lines(on, "wall")) == len(lines(on, "flat")) == 1
    assert "falls" in [text.get_text() for text in on.get_legend().get_texts()]
    assert on.get_xlabel().endswith("(rad)")


@pytest.mark.parametrize("near_flat", [False, True])
def test_the_curves_of_the_potential_are_its_values(near_flat):
    potentials = [on_line(UNIFORM, 0.25, eta) for eta in (0.0, 0.01, -0.01)]
    ax = pictures.potential_curves(potentials, near_flat, ax=axes())
    for potential, sign in zip(potentials, ("on the line", "= 0.01", "= -0.01"), strict=True):
        (line,) = [line for line in ax.lines if sign in line.get_label()]
        x, V = line.get_data()
        phi = 0.5 * math.pi - x if near_flat else x
        shown = np.isfinite(V) & (abs(phi) < 1.57)
        assert V[shown] == pytest.approx(potential.V(phi[shown]), rel=1e-6)
        assert np.isnan(V).any() == (not near_flat or potential.eta != 0.0)
    (end,) = lines(ax, "$V_0$")
    assert end.get_ydata()[0] == pytest.approx(potentials[0].flat_value(1))


def test_the_plane_of_constants_has_the_lines_the_wells_and_the_thresholds():
    ax = steady_pictures.steady_plane(COIN, ax=axes())
    (marks,) = lines(ax, "thresholds")
    assert max(marks.get_xdata()) == pytest.approx(spinning_closed(COIN), rel=1e-9)
    assert max(marks.get_ydata()) == pytest.approx(rolling_closed(COIN), rel=1e-9)
    (with_well,) = lines(ax, "a well besides")
    x, y = with_well.get_data()
    assert max(x) == pytest.approx(well(COIN)[1] * COIN.rate_unit)
    for bar, spin in zip(x, y, strict=True):
        assert abs(at_constants(COIN, bar, spin).eta) < 1e-15
    for tilt in steady_pictures.TILTS:
        (curve,) = lines(ax, rf"$|\varphi|$ = {tilt:g}")
        bar3, bar4 = (np.asarray(v)[300:900:100] for v in curve.get_data())
        for bar, spin in zip(bar3, bar4, strict=True):
            if np.isfinite(bar):
                potential = at_constants(COIN, float(bar), float(spin))
                assert min(abs(at.phi - tilt) for at in potential.equilibria) < 1e-9


def test_the_fold_parts_one_steady_motion_from_three():
    x, y = steady_pictures.fold_curve(UNIFORM)
    assert (x[0], y[0]) == (x[-1], y[-1])
    assert abs(x).max() == pytest.approx(spinning_closed(UNIFORM), rel=1e-3)
    assert abs(y).max() == pytest.approx(rolling_closed(UNIFORM), rel=1e-3)
    for i in range(5, x.size, 157):
        inside, outside = (at_constants(UNIFORM, s * x[i], s * y[i]).equilibria for s in (0.99, 1.01))
        assert (len(inside), len(outside)) == (3, 1)


def test_the_map_of_circular_rolling_is_the_sign_of_the_curvature():
    ax = steady_pictures.steady_map(UNIFORM, ax=axes())
    (mesh,) = [
        child for child in ax.collections if child.get_array() is not None and child.get_array().size > 1000
    ]
    stable = np.asarray(mesh.get_array()).reshape(321, 241)
    assert stable.any()
    assert not stable.all()
    # lean 0.1 rad: rows of turn from 0.02 to 3.2
    column = stable[:, 16]
    lean = np.linspace(1e-3, 1.5, 241)[16]
    fast, slow = stability_edges(UNIFORM, lean)[:, 0]
    turn = np.linspace(0.02, 3.2, 321)
    assert (column == ((turn < slow) | (turn > fast))).all()


@pytest.mark.parametrize("path", ["spinning", "rolling", "line"])
def test_the_bifurcation_diagram_draws_its_branches(path):
    values, marks = path_values(UNIFORM, path)
    branches = bifurcation(UNIFORM, path, values)
    ax = steady_pictures.bifurcations(UNIFORM, path, branches, marks, ax=axes())
    assert len(lines(ax, "stable")) == len(lines(ax, "unstable")) == 1
    drawn = ax.lines[: len(branches)]
    for branch, line in zip(branches, drawn, strict=True):
        assert (line.get_ydata() == branch.phi).all()
        assert line.get_linestyle() == ("-" if branch.kind == CENTRE else "--")


def test_every_figure_of_the_scene_is_drawn(tmp_path):
    scene = scene_of(disk=BODIES["thick"], eta_hat=0.02)
    chunks = computed(scene)
    names = []
    for name, figure in scene.figures(scene.summarise(chunks), chunks):
        names.append(name)
        for ax in figure.axes:
            assert ax.get_xlabel()
            assert ax.get_ylabel()
    assert names[:2] == ["portrait-on", "portrait-beside"]
    assert len(names) == len(set(names)) == 9


def test_a_run_stores_its_levels_and_goes_on(tmp_path):
    run = ex.run("portrait", out=tmp_path / "run", disk="hoop", eta_hat="0.02", energies="0.5:2", well=True)
    assert run.summary["eta_hat"] == 0.02
    tables = list(run.tables())
    assert len(tables) == 2
    assert [np.unique(table["energy"]).size for table in tables] == [9, 9]
    assert (tmp_path / "run" / "figures" / "steady-plane.svg").exists()
    with pytest.raises(ex.InputError, match="resume"):
        ex.run("portrait", out=tmp_path / "run", disk="hoop", eta_hat=0.02)
    again = ex.run(
        "portrait", out=tmp_path / "run", disk="hoop", eta_hat=0.02, energies=(0.5, 2.0), well=True, resume=True
    )
    assert again.summary == run.summary
    for name, value in (("energies", "far"), ("well", "yes"), ("sigma3_bar", "far"), ("eta_hat", "1:2")):
        with pytest.raises(ex.InputError, match=f"--{name.replace('_', '-')}"):
            ex.run("portrait", out=tmp_path / "none", **{name: value})
    assert not (tmp_path / "none").exists()
