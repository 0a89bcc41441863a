"""Slices of the phase space: tilts and sides against motions that are followed."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.measure.slices import Slice, slice_map

UNIFORM, HOOP = BODIES["uniform"], BODIES["hoop"]


@pytest.fixture(scope="module")
def slice_of_uniform():
    return slice_map(UNIFORM, Slice.defaults(UNIFORM)[0], points=61)


@pytest.mark.parametrize("number", [0, 1])
def test_the_tilt_by_quadrature_is_that_of_the_integrated_slices(number):
    where = Slice.defaults(HOOP)[number]
    one, other = slice_map(HOOP, where, points=31), slice_map(HOOP, where, points=31, method="dopri5")
    both = np.isfinite(one["theta_min"]) & np.isfinite(other["theta_min"])
    assert both.mean() > 0.98
    np.testing.assert_allclose(one["theta_min"][both], other["theta_min"][both], rtol=3e-3)


def test_the_side_is_the_direction_of_the_contact_point_at_the_flattest_moment(slice_of_uniform):
    """Against passages from the vertical, where chi is integrated: its sign near F."""
    at = slice_of_uniform
    x, y = np.meshgrid(at.x, at.y)
    known = ex.constants(ex.phi_to_states(UNIFORM, 0.0, 1.0, x, y))
    face = slice_of_uniform.falls.face
    eta = np.where(face > 0, known.eta_hat_plus, known.eta_hat_minus)
    near = (abs(eta) < 0.1) & (abs(eta) > 1e-3) & (slice_of_uniform.side != 0)
    assert near.sum() > 100
    turned = ex.passages(UNIFORM, known.sigma3_bar[near], eta[near], 1.0, face[near]).race_angle
    np.testing.assert_array_equal(np.sign(turned), slice_of_uniform.side[near])


def test_the_colours_change_on_f_and_the_tilt_vanishes_there(slice_of_uniform):
    """Along a column the strongest cells of the two colours are the neighbours of l_+ and l_-."""
    at = slice_of_uniform
    slope = 0.7285923160189477
    column = int(np.argmin(abs(at.x - 1.0)))
    tilt, side = at["theta_min"][:, column], slice_of_uniform.side[:, column]
    for line in (slope, -slope):
        above = int(np.searchsorted(at.y, line * at.x[column]))
        assert {side[above - 1], side[above]} == {-1, 1}
        assert max(tilt[above - 1], tilt[above]) < 0.1
    assert np.median(tilt[side != 0]) > 0.2


@pytest.mark.parametrize(("asked", "done"), [("auto", "quadrature"), ("dopri5", "dopri5"), ("rk8", "rk8")])
def test_a_slice_says_how_it_was_computed(asked, done):
    assert slice_map(UNIFORM, Slice.defaults(UNIFORM)[0], points=3, method=asked).method == done


@pytest.mark.parametrize("points", [1, 4001, 2.5, True, "many"])
def test_a_number_of_points_that_cannot_be_is_named(points):
    with pytest.raises(ex.InputError, match="points = "):
        slice_map(UNIFORM, Slice.defaults(UNIFORM)[0], points=points)


def turns(batch):
    """Turns of the contact point within a time of 3."""
    return ex.simulate(batch, t_eval=[3.0], observables=["chi"]).chi[..., 0] / (2.0 * np.pi)


@pytest.mark.parametrize(
    "plane",
    [
        {"phi": 0.2, "phidot": 0.4, "sigma3": (-1, 1), "sigma4": (-0.5, 1)},
        {"phi": (-1, 1), "energy": 3, "sigma3_bar": 0.5, "eta_hat": (-0.3, 0.3)},
        {"phi": 0.1, "phidot": (-1, 1), "sigma3_bar": (-1, 1), "sigma4_bar": 0.2},
    ],
)
def test_a_map_of_ones_own_is_the_function_at_each_point_of_the_grid(plane):
    found = ex.slice_map(UNIFORM, plane, turns, points=5, jobs=2)
    (first, second), fixed = found.slice.axes, found.slice.fixed
    for j, i in ((0, 0), (2, 4), (4, 1)):
        state = ex.coordinates_to_states(UNIFORM, **fixed, **{first: found.x[i], second: found.y[j]})
        np.testing.assert_allclose(found["turns"][j, i], turns(state), rtol=1e-9)


def test_a_map_over_tilt_and_precession_in_degrees_is_a_scan_of_these_states():
    found = ex.slice_map(
        UNIFORM,
        "precession=-60:60,tilt=10:80,spin=40,tilt_rate=-5",
        ["theta_min", "period"],
        points=4,
        degrees=True,
    )
    tilt, precession = np.meshgrid(np.linspace(10, 80, 4), np.linspace(-60, 60, 4))
    states = ex.rates_to_states(UNIFORM, tilt, -5.0, precession, 40.0, degrees=True)
    wanted = ex.scan(states, ["theta_min", "period"])
    assert found.slice.axes == ("tilt", "precession")
    np.testing.assert_allclose(found.x, tilt[0])
    frame = found.to_pandas()
    np.testing.assert_allclose(frame["tilt"], tilt.ravel())
    np.testing.assert_allclose(frame["precession"], precession.ravel())
    np.testing.assert_allclose(frame[["spin", "tilt_rate"]], np.tile([40.0, -5.0], (16, 1)))
    units = {field.name: field.metadata[b"unit"].decode() for field in found.to_arrow().schema}
    assert [units[name] for name in ("tilt", "precession", "theta_min")] == ["degrees", "degrees/time", "rad"]
    axes = ex.picture("observable", found).axes[0]
    assert axes.get_xlabel() == "tilt (degrees)"
    assert "spin = 40 degrees/time" in axes.get_title()
    for name in found:
        np.testing.assert_allclose(found[name], wanted[name], rtol=1e-9)
    assert {"tilt", "tilt_rate", "precession", "spin"} <= set(found.to_pandas())


def test_an_eta_hat_of_a_map_is_where_the_falling_set_is():
    found = ex.slice_map(UNIFORM, "phi=0,phidot=1,sigma3_bar=0.2:1,eta_hat=-1:1", points=9)
    assert (np.argmin(found["theta_min"], axis=0) == 4).all()
    np.testing.assert_allclose(found.falls.distance_plus[4], 0.0, atol=1e-15)


def test_a_map_is_a_table_with_its_axes():
    found = ex.slice_map(UNIFORM, "phi=0,phidot=1,sigma3=-2:2,sigma4=-1:1", points=4)
    frame = found.to_pandas()
    assert frame.shape == (16, 5)
    np.testing.assert_array_equal(frame["theta_min"], found["theta_min"].ravel())
    np.testing.assert_array_equal(frame["sigma4"], np.repeat(found.y, 4))
    assert (frame["phidot"] == 1.0).all()


@pytest.mark.parametrize(
    ("plane", "message"),
    [
        ("phi=0,phidot=1,sigma3=-2:2", "do not determine a state; add sigma4"),
        ("phi=0,phidot=1,sigma3=-2:2,sigma4=0", "give two of phi, phidot, sigma3, sigma4 as LOW:HIGH"),
        ({"phi": 0, "phidot": 1, "sigma3": (-2, 2), "sigma5": (0, 1)}, "did you mean"),
        ({"phi": 0, "phidot": 1, "sigma3": "a:b", "sigma4": (0, 1)}, "is no distribution"),
        (7, "write"),
        ("tilt=10:80,precession=0:1,spin=1", "between 0 and pi; where it is in degrees, say so"),
        ("tilt=0.1:1,precession=0:1,spin=1,sigma3=1", "sigma3: leave out"),
    ],
)
def test_what_is_no_plane_is_refused_in_words(plane, message):
    with pytest.raises(ex.InputError, match=message):
        ex.slice_map(UNIFORM, plane)


def test_a_method_is_for_theta_min_alone():
    plane = "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2"
    with pytest.raises(ex.InputError, match="method 'dop853': is for the observable theta_min alone"):
        ex.slice_map(ex.Disk.uniform(), plane, "period", points=3, method="dop853")
