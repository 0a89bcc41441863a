"""The amended potential against states, motions and laws that it does not know of."""

import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.phase.falling_set import impact_speed, well
from explorer.phase.potential import CENTRE, FLAT, SADDLE, TURNING, Potential, Terms

UNIFORM, HOOP, COIN = BODIES["uniform"], BODIES["hoop"], BODIES["coin"]
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
    grid = [ex.constants(ex.phi_to_states(disk, phi, 0.0, s3, s4)) for s3, s4 in ((1.0, 0.0), (0.0, 1.0))]
    map_ = np.array([[g.sigma3_bar for g in grid], [g.sigma4_bar for g in grid]])
    s3, s4 = np.linalg.solve(map_, [potential.sigma3_bar, potential.sigma4_bar])
    return phi, phidot, s3, s4


@pytest.mark.parametrize("row", CONSTANTS)
def test_v_is_the_energy_of_a_state_at_rest_with_the_same_constants(body, row):
    unit = body.rate_unit
    potential = Potential(body, row[0], row[1], row[2])
    for phi in (-1.2, -0.4, 0.0, 0.7, 1.3):
        found = ex.constants(ex.phi_to_states(body, *state_at(potential, phi, 0.7 * unit)))
        energy = found.energy - 0.5 * body.body.M * 0.49 * body.energy_unit
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
        _, slope, _, size, _ = potential.at_y(at.y)
        assert abs(slope[0]) <= 50.0 * np.finfo(float).eps * size[0]
        assert at.theta == pytest.approx(0.5 * math.pi - abs(at.phi), abs=1e-15)
        assert (at.curvature > 0.0) == (at.kind == CENTRE)
    # A finer count of sign changes, in phi rather than y, away from flat
    phi = np.linspace(-1.5, 1.5, 20_011)
    signs = np.sign(potential.dV(phi))
    changes = np.count_nonzero(signs[:-1] * signs[1:] < 0.0) + np.count_nonzero(signs == 0.0)
    assert changes == sum(abs(at.phi) < 1.5 for at in potential.equilibria)


def test_two_equilibria_much_closer_than_the_grid_are_both_found():
    angle, most = well(UNIFORM)
    close = ex.potential(UNIFORM, most * (1.0 - 1e-9)).equilibria
    assert [at.kind for at in close] == [CENTRE, SADDLE]
    assert abs(close[1].phi - close[0].phi) < 1e-3
    assert close[0].phi < angle < close[1].phi
    assert ex.potential(UNIFORM, most * (1.0 + 1e-9)).equilibria == ()


@pytest.mark.parametrize("eta", [1e-3, 1e-6, 1e-12, 1e-30, 1e-100])
def test_the_equilibrium_near_flat_follows_its_law(eta):
    """theta_0 = (eta^2/(I1 m g r))^(1/3) as eta -> 0, statement 30."""
    near = ex.potential(UNIFORM, 0.25, eta).equilibria[-1]
    b = UNIFORM.body
    law = ((b.I3 * b.r0 * eta) ** 2 / b.I1) ** (1.0 / 3.0)
    assert near.kind == CENTRE
    assert near.theta == pytest.approx(law, rel=2.0 * eta**0.25)


def test_no_equilibrium_is_missed_however_thin_the_body_and_far_the_wall():
    """A wall on both sides: one centre more than saddles; and motions turn where the arcs of `periods` end."""
    rng = np.random.default_rng(3)
    for least in np.repeat([-3.0, -30.0, -100.0], 40):
        I1, thin, bar, hat = 10.0 ** rng.uniform([-5.0, -12.0, -3.0, least], [1.0, 0.3, 3.0, 3.0])
        signs, face = rng.choice([-1.0, 1.0], 2), int(rng.choice([-1, 1]))
        disk = ex.Disk(I1=I1, I3=thin * I1)
        made = ex.potential(disk, signs[0] * bar, signs[1] * hat, face)
        kinds = [at.kind for at in made.equilibria]
        assert kinds.count(CENTRE) - kinds.count(SADDLE) == 1
        assert np.isfinite(made.levels()).all()
        for at in made.equilibria:
            pieces = [piece for piece in made.components(1.01 * at.energy) if piece.low <= at.phi <= piece.high]
            if at.kind == CENTRE and at.theta > 1e-12 and pieces[0].ends == (TURNING, TURNING):
                given = {"sigma3_bar": made.sigma3_bar, "eta_hat": made.eta_hat, "face": face}
                states = ex.coordinates_to_states(disk, phi=at.phi, energy=1.01 * at.energy, **given)
                tilt = 2.0 * math.atan(math.exp(-max(map(abs, pieces[0].y))))
                assert ex.periods(states).theta_min == pytest.approx(tilt, rel=1e-9)


@pytest.mark.parametrize(("I1", "I3", "bar", "eta_hat"), [(0.3, 1e-7, 10.0, 1.0), (0.00186, 9.3e-9, 1.6, 0.43)])
def test_a_thin_body_rests_where_the_wall_meets_its_spin(I1, I3, bar, eta_hat):
    """There rho = eta/(I1 theta) turns at the rate eta/(I1 theta^2) = J spin/I1; spin is sigma4 at flat."""
    disk = ex.Disk(I1=I1, I3=I3)
    (only,) = ex.potential(disk, bar, eta_hat).equilibria
    b = disk.body
    spin = bar / (b.k * b.r0) - b.r0 * eta_hat
    assert only.kind == CENTRE
    assert only.theta == pytest.approx(math.sqrt(b.I3 * b.r0 * eta_hat / (b.J * spin)), rel=1e-3)


def test_constants_on_a_line_to_rounding_are_on_it(body):
    for face in (1, -1):
        on = ex.potential(body, 0.2 * body.rate_unit, 0.0, face)
        found = ex.potential(body, on.sigma3_bar, sigma4_bar=on.sigma4_bar)
        assert (found.hat, found.face) == (0.0, face)


def test_a_motion_started_at_a_centre_stays_and_one_at_a_saddle_leaves():
    potential = ex.potential(UNIFORM, 0.25, 0.01)
    for at in potential.equilibria[:2]:
        run = ex.simulate(
            ex.phi_to_states(UNIFORM, *state_at(potential, at.phi, 0.0)), 20.0, observables=("phi",), accuracy=1e-3
        )
        away = abs(run.phi - at.phi)
        if at.kind == CENTRE:
            assert away.max() < 1e-9
        else:
            # The growth rate is sqrt(-V''/M)
            rate = math.sqrt(-at.curvature / UNIFORM.body.M)
            assert away[0] < 1e-15
            assert away.max() < 1e-8 * math.exp(20.0 * rate)
        nudged = state_at(potential, at.phi, 1e-4)
        run = ex.simulate(ex.phi_to_states(UNIFORM, *nudged), 20.0, observables=("phi",))
        assert (abs(run.phi - at.phi).max() < 1e-3) == (at.kind == CENTRE)


@pytest.mark.parametrize("row", CONSTANTS)
def test_levels_conserve_energy_against_the_constants_of_states(body, row):
    potential = made(body, row)
    for energy in potential.levels():
        pieces = potential.components(float(energy))
        assert pieces
        for piece in pieces:
            phi, phidot = potential.curve(piece)
            inner = np.flatnonzero(abs(phi) < 1.4)[::23]
            for i in inner:
                found = ex.constants(ex.phi_to_states(body, *state_at(potential, phi[i], phidot[i]))).energy
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
    potential = ex.potential(UNIFORM, 0.25, eta)
    energy = 1.3
    (piece,) = potential.components(energy)
    start = state_at(potential, 0.0, math.sqrt(2.0 * (energy - potential.V(0.0)) / UNIFORM.body.M))
    times = np.linspace(0.0, 12.0, 3001)
    run = ex.simulate(
        ex.phi_to_states(UNIFORM, *start), t_eval=times, observables=("phi", "phidot"), accuracy=1e-10
    )
    assert run.phi.min() == pytest.approx(piece.low, abs=1e-4)
    assert run.phi.max() == pytest.approx(piece.high, abs=1e-4)
    phi = np.clip(run.phi, piece.low, piece.high)
    along = 0.5 * UNIFORM.body.M * run.phidot**2 + potential.V(phi)
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
            return Terms(V, dV, d2V, abs(4.0 * np.sin(4.0 * phi)) + 600.0 * wall**2 + 1e-3, 0.0 * V)

    low, high = Two(UNIFORM, 0.0, 0.3).separatrices()
    assert low.branches[1].ends == (SADDLE, SADDLE) == high.branches[0].ends
    assert low.branches[1].high == pytest.approx(high.saddle.phi, abs=1e-14)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
@pytest.mark.parametrize("face", [1, -1])
def test_the_shading_agrees_with_who_could_fall(name, face):
    disk = BODIES[name]
    random = np.random.default_rng(3)
    for bar in (0.1, 0.2, 0.7):
        potential = ex.potential(disk, bar, 0.0, face)
        y = np.sort(random.uniform(-2.5, 2.5, 60))
        phi = np.arctan(np.sinh(y))
        speed = random.uniform(0.0, 1.5, 60)
        edge = potential.falling_edge(y)
        s3, s4 = np.transpose([state_at(potential, float(at), 0.0)[2:] for at in phi])
        falls = ex.falls(ex.phi_to_states(disk, phi, speed, s3, s4))
        could = falls.could_fall_plus if face > 0 else falls.could_fall_minus
        assert (could == (speed > edge)).all()
        assert could.any()
        if bar == 0.1:
            assert not could.all()
    assert np.isinf(ex.potential(disk, 0.2, 1e-9, face).falling_edge(y)).all()


def test_on_the_line_v_ends_at_v0_and_the_wall_appears_beside_it():
    on = ex.potential(UNIFORM, 0.25)
    assert on.at_flat(1) == pytest.approx(0.08687994 * 0.25**2, rel=1e-7)
    assert float(on.V(0.5 * math.pi - 1e-7)) == pytest.approx(on.at_flat(1), abs=2e-7)
    assert float(on.dV(0.5 * math.pi - 1e-6)) == pytest.approx(-1.0, abs=1e-4)
    for eta in (1e-3, -1e-3):
        beside = ex.potential(UNIFORM, 0.25, eta)
        assert math.isinf(beside.at_flat(1))
        # V ~ eta^2/(2 I1 theta^2)
        size = (UNIFORM.body.I3 * UNIFORM.body.r0 * eta) ** 2 / (2.0 * UNIFORM.body.I1 * 1e-12)
        assert float(beside.V(0.5 * math.pi - 1e-6)) == pytest.approx(size, rel=1e-3)


def test_the_well_has_a_separatrix_only_below_its_threshold():
    most = well(COIN).sigma3_bar * COIN.rate_unit
    found = ex.potential(COIN, 0.8 * most).separatrices()[0]
    assert found.branches[0].ends == (TURNING, SADDLE)
    assert found.branches[1].ends == (SADDLE, FLAT)
    mirrored = ex.potential(COIN, 0.8 * most, 0.0, -1).separatrices()[0]
    assert mirrored.saddle.phi == pytest.approx(-found.saddle.phi, abs=1e-15)
    assert mirrored.branches[0].ends == (FLAT, SADDLE)
    for bar in (1.01 * most, -2.0 * most):
        assert not ex.potential(COIN, bar).separatrices()


def test_bad_arguments_get_a_sentence():
    with pytest.raises(ex.InputError, match="face = 2"):
        ex.potential(UNIFORM, 0.2, 0.0, 2)
    with pytest.raises(ex.InputError, match="between the flat states"):
        ex.potential(UNIFORM, 0.2).V(2.0)


@pytest.mark.parametrize(("method", "wrong"), [("V", 1e3), ("d2V", [0.0, -(2**64)]), ("rho", np.inf)])
def test_what_lies_beyond_flat_is_refused_by_its_name(method, wrong):
    with pytest.raises(ex.InputError, match=r"^phi: "):
        getattr(ex.potential(ex.Disk.uniform(), 0.25, 0.01), method)(wrong)


@pytest.mark.parametrize("face", [1, -1])
def test_both_ways_to_name_the_constants_give_one_potential(face):
    near = ex.potential(HOOP, 0.4, 0.03, face)
    same = ex.potential(HOOP, near.sigma3_bar, sigma4_bar=near.sigma4_bar)
    phi = np.linspace(-1.2, 1.2, 7)
    np.testing.assert_allclose(same.V(phi), near.V(phi), rtol=1e-13)


def test_levels_lie_between_the_bottom_and_above_the_saddles():
    potential = ex.potential(HOOP, 0.25, 0.01)
    levels = potential.levels()
    assert levels.min() > potential.bottom
    assert levels.max() > ex.potential(HOOP, 0.25).separatrices()[0].saddle.energy


@pytest.mark.parametrize("size", [1e7, 1e9, 1e60, 1e74])
def test_levels_of_the_fastest_motions_are_apart_in_doubles(size):
    fastest = {"eta_hat": size}, {"sigma4_bar": size}
    for potential in (*(ex.potential(HOOP, 0.25, **each) for each in fastest), ex.potential(HOOP, size)):
        levels = potential.levels()
        assert (np.diff(levels, prepend=potential.bottom) > 0.0).all()
        assert all(potential.components(float(energy)) for energy in levels)


@pytest.mark.parametrize(("name", "value"), [("sigma3_bar", 1e101), ("sigma3_bar", np.nan), ("eta_hat", "x")])
def test_constants_that_are_none_are_refused_by_name(name, value):
    with pytest.raises(ex.InputError, match=f"{name} = "):
        ex.potential(HOOP, **{"sigma3_bar": 0.1, name: value})
