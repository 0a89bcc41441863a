"""Results have the shape of their arguments, with axes of their own behind it, and are indexed over all of it."""

import math
from dataclasses import fields

import numpy as np
import pytest

import explorer as ex

UNIFORM = ex.Disk.uniform()
SHAPES = (), (1,), (3,), (2, 3), (2, 1, 2), (0,), (2, 0)
BROADCAST = ((2, 1), (3,), (2, 3)), ((), (3,), (3,)), ((0,), (1,), (0,)), ((1,), (), (1,))
KEYS = {
    (): ((), ..., None),
    (3,): (0, -1, slice(1, None), slice(0), [2, 0, 0], np.array([True, False, True]), ..., np.zeros((2, 2), int)),
    (2, 3): (1, (0, 2), (..., 0), (slice(None), [0, 2]), np.eye(2, 3) > 0, slice(None, None, -1), (None, 0)),
    (0,): (slice(None), [], ..., np.zeros(0, bool)),
}


def spread(low, high, shape):
    """Numbers between both, a plain one where the shape is ()."""
    values = np.linspace(low, high, math.prod(shape)).reshape(shape)
    return values if shape else float(values)


def states_of(shape, disk=UNIFORM):
    return ex.phi_to_states(disk, spread(0.1, 0.4, shape), 0.5, 0.8, spread(0.6, 0.3, shape))


# Calls of states by name, and the axes that each result has of its own behind the shape of the states.
OF_STATES = {
    "constants": (ex.constants, ()),
    "falls": (ex.falls, ()),
    "periods": (ex.periods, ()),
    "periods by dopri5": (lambda states: ex.periods(states, method="dopri5"), ()),
    "bounces": (ex.bounces, (1,)),
    "two bounces": (lambda states: ex.bounces(states, 2, jobs=2), (2,)),
    "wander": (ex.wander, ()),
    "flow_stretch": (ex.flow_stretch, ()),
    "scan by names": (lambda states: ex.scan(states, ["theta_min", "on_f"]), ()),
    "scan by a function": (lambda states: ex.scan(states, lambda some: ex.bounces(some, 2).time), ()),
    "compare": (lambda states: ex.compare(states, count=2).bounces["dop853"], (2,)),
    "reversed": (ex.States.reversed, ()),
    "simulate": (lambda states: ex.simulate(states, 2.0, observables=EVERY), ()),
    "simulate at times": (lambda states: ex.simulate(states, t_eval=[0.0, 0.5], observables=EVERY), ()),
    "motions at a time": (lambda states: ex.simulate(states, 2.0, observables=EVERY)(1.0), ()),
    "motions at times": (lambda states: ex.simulate(states, 2.0, observables=EVERY)([[0.1], [1.0]]), ()),
    "motions since the lowest": (lambda states: ex.simulate(states, 2.0)([-0.1, 0.1], since="lowest"), ()),
    "simulate by rk8": (lambda states: ex.simulate(states, t_eval=[0.0, 0.5], method="rk8"), ()),
    "motions by rk8": (lambda states: ex.simulate(states, t_eval=[0.5], method="rk8", observables=EVERY)(0.3), ()),
}
EVERY = "phi", "tilt", "phidot", "sigma3", "sigma4", "chi", "psi", "path", "contact"
# Calls of arguments that broadcast; each takes two.
OF_ARGUMENTS = {
    "passages": lambda a, b: ex.passages(UNIFORM, b, a, 1.0),
    "passages by rk8": lambda a, b: ex.passages(UNIFORM, b, a, 1.0, method="rk8"),
    "passage_forces": lambda a, b: ex.passage_forces(UNIFORM, b, a, 1.0),
    "rocking": lambda a, b: ex.rocking(UNIFORM, 10.0 * (a + b)),
    "steady_motions": lambda a, b: ex.steady_motions(UNIFORM, a, b),
    "phi_to_states": lambda a, b: ex.phi_to_states(UNIFORM, a, b, 1.0, 0.5),
    "theta_to_states": lambda a, b: ex.theta_to_states(UNIFORM, a, b, 1.0, 0.5),
    "rates_to_states": lambda a, b: ex.rates_to_states(UNIFORM, a, 0.0, b, 0.5),
    "constants_to_states": lambda a, b: ex.constants_to_states(UNIFORM, b, a, 1.0),
    "coordinates_to_states": lambda a, b: ex.coordinates_to_states(UNIFORM, phi=a, phidot=1.0, sigma3=b, sigma4=0),
}


def arrays_of(found):
    """All arrays that a result shows, by name: its fields, and the columns of its table."""
    shown = ("phi", "phidot", "sigma3", "sigma4", "status") if isinstance(found, ex.States) else ()
    names = [*shown, *(field.name for field in fields(found) if not shown and not field.name.startswith("_"))]
    arrays = {name: getattr(found, name) for name in names} | dict(getattr(found, "values", None) or {})
    arrays |= {
        name: getattr(found, name) for name in ("ok", "status_names", "side", "step") if hasattr(found, name)
    }
    return {name: values for name, values in arrays.items() if isinstance(values, np.ndarray | np.generic)}


def assert_shaped(found, shape):
    """A number of numpy where there is no axis, and nowhere else."""
    assert found.shape == shape
    assert found.size == math.prod(shape)
    for name, values in arrays_of(found).items():
        assert values.shape[: len(shape)] == shape, name
        assert isinstance(values, np.ndarray) == (values.ndim > 0), name
    if shape:
        assert len(found) == shape[0]
        assert [each.shape for each in found if not isinstance(each, str)] in ([], [shape[1:]] * shape[0])
    else:
        for of_axes in (len, list):
            if not isinstance(found, type(SCANNED)) or of_axes is len:
                with pytest.raises(TypeError, match="single sample"):
                    of_axes(found)
    if hasattr(found, "to_pandas"):
        assert len(found.to_pandas()) == found.size
        assert {values.shape[: len(shape)] for values in found.columns.values()} == {shape}
    assert type(found).__name__ in repr(found)


SCANNED = ex.scan(states_of((1,)), "energy")


def assert_same(found, known):
    found, known = arrays_of(found), arrays_of(known)
    assert list(found) == list(known)
    for name, values in found.items():
        np.testing.assert_array_equal(values, known[name], err_msg=name)
        assert type(values) is type(known[name]), name


def in_a_row(found):
    return {n: np.reshape(v, (found.size, *v.shape[len(found.shape) :])) for n, v in arrays_of(found).items()}


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("call", OF_STATES)
def test_results_have_the_shape_of_the_states_and_their_own_axes_behind_it(call, shape):
    of, own = OF_STATES[call]
    states = states_of(shape)
    found, row = of(states), of(states_of((math.prod(shape),)))
    assert_shaped(found, (*shape, *own))
    for name, values in in_a_row(row).items():
        if name not in ("row", "t_end"):
            np.testing.assert_array_equal(in_a_row(found)[name], values, err_msg=name)


@pytest.mark.parametrize("shapes", BROADCAST, ids=str)
@pytest.mark.parametrize("call", OF_ARGUMENTS)
def test_results_have_the_shape_to_which_the_arguments_broadcast(call, shapes):
    first, second, shape = shapes
    a, b = spread(0.1, 0.2, first), spread(0.5, 1.0, second)
    found = OF_ARGUMENTS[call](a, b)
    assert_shaped(found, shape)
    whole = OF_ARGUMENTS[call](*np.broadcast_arrays(a, b))
    assert_same(found, whole)


@pytest.mark.parametrize("call", OF_ARGUMENTS)
def test_plain_numbers_give_numbers_of_numpy_and_those_of_arrays_of_one_entry(call):
    found, row = OF_ARGUMENTS[call](0.1, 0.5), OF_ARGUMENTS[call]([0.1], np.array([0.5]))
    assert_shaped(found, ())
    assert_same(found, row[0])


@pytest.mark.parametrize("shape", KEYS, ids=str)
@pytest.mark.parametrize("call", OF_STATES)
def test_states_and_results_are_indexed_as_their_arrays_are(call, shape):
    of, _ = OF_STATES[call]
    states = states_of(shape)
    found = of(states)
    for key in KEYS[shape]:
        np.testing.assert_array_equal(states[key].phi, states.phi[key])
        chosen, before = found[key], arrays_of(found) | getattr(found, "columns", {})
        for name, values in (arrays_of(chosen) | getattr(chosen, "columns", {})).items():
            for place in np.ndindex(before[name].shape[len(found.shape) :]):  # of a vector, for instance
                known = np.asarray(before[name])[(..., *place)][key]
                np.testing.assert_array_equal(np.asarray(values)[(..., *place)], known, err_msg=f"{name}[{key}]")
        assert_shaped(chosen, np.empty(found.shape)[key].shape)
    for wrong in ("x", 1.0, found.shape[0] if found.shape else 0):
        with pytest.raises((IndexError, ex.InputError)):
            found[wrong]


@pytest.mark.parametrize("call", [name for name in OF_STATES if not name.startswith(("simulate", "motions"))])
def test_samples_are_chosen_by_their_numbers_among_all_as_entries_of_a_list_are(call):
    found = OF_STATES[call][0](states_of((2, 3)))
    row = in_a_row(found)
    for rows in (slice(1, 4), slice(None, None, -2), [5, 0, -1], np.arange(found.size) % 2 == 0):
        some = found.at(rows)
        assert some.shape == np.arange(found.size)[rows].shape
        for name, values in in_a_row(some).items():
            if name != "t_end":
                np.testing.assert_array_equal(values, row[name][rows], err_msg=name)


def test_states_and_results_are_compared_as_objects_are():
    """An array of truths would be no answer to whether they are in a list."""
    states = states_of((3,))
    branch, *_ = ex.bifurcation(UNIFORM, "line", [0.1, 0.2, 0.3])
    for found in (states, ex.periods(states), ex.scan(states, "energy"), branch):
        assert found == found
        assert found not in [states_of((3,)), ex.periods(states)]
        assert len({found, found}) == 1
    one, on_f = (ex.constants_to_states(UNIFORM, 0.7, eta_hat, 1.0) for eta_hat in (0.05, 0.0))
    for call in (lambda: ex.wander_path(one, 1), lambda: ex.both_sides(on_f), lambda: ex.limit_motion(on_f)):
        assert call() != call()


def test_results_with_axes_of_their_own_are_indexed_over_these_too():
    found = ex.bounces(states_of((2, 3)), 4)
    assert found.shape == (2, 3, 4)
    np.testing.assert_array_equal(found[..., 1].time, found.time[..., 1])
    np.testing.assert_array_equal(found[1, :, ::2].states.phi, states_of((2, 3)).phi[1, :, None] + np.zeros(2))
    assert found[0, 1, 2].time == found.time[0, 1, 2]


@pytest.mark.parametrize("how", [{"t_end": 3.0}, {"t_eval": [3.0], "method": "rk8"}])
def test_chosen_motions_can_be_called_and_chosen_again(how):
    motion = ex.simulate(states_of((2, 3)), **how)
    assert motion[1]([0.5, 2.0]).phi.shape == (3, 2)
    np.testing.assert_array_equal(motion[1][2](2.0).chi, motion(2.0).chi[1, 2])
    np.testing.assert_array_equal(motion[:, ::2](2.0).path, motion(2.0).path[:, ::2])
    assert motion(2.0)[0, 1].phi == motion(2.0).phi[0, 1]


@pytest.mark.filterwarnings("ignore::explorer.errors.CoarseTimesWarning")
def test_each_motion_may_have_times_of_its_own_in_the_shape_of_the_states():
    states = states_of((2, 3))
    times = np.linspace(-3.0, 3.0, 24).reshape(2, 3, 4)
    found = ex.simulate(states, t_eval=times, observables=EVERY)
    np.testing.assert_array_equal(found.t, times)
    for place in np.ndindex(2, 3):
        alone = ex.simulate(states[place], t_eval=times[place], observables=EVERY)
        for name in EVERY:
            np.testing.assert_array_equal(getattr(found, name)[place], getattr(alone, name))
    for wrong in (times[0], times.reshape(3, 2, 4)):
        with pytest.raises(ex.InputError, match="t_eval: has the shape"):
            ex.simulate(states, t_eval=wrong)
    with pytest.raises(ex.InputError, match="exact motions, of method auto, may have times of their own"):
        ex.simulate(states, t_eval=abs(times), method="rk8")


@pytest.mark.parametrize("phi", [0.2, [0.2], [[0.1, 0.2], [0.3, 0.4]], []])
def test_potentials_have_the_shape_of_the_angles(phi):
    potential = ex.potential(UNIFORM, 0.5, 0.1)
    for term in (potential.V, potential.dV, potential.d2V, potential.rho):
        assert np.shape(term(phi)) == np.shape(phi)
        assert isinstance(term(phi), np.float64 if np.ndim(phi) == 0 else np.ndarray)


def test_the_single_motions_of_a_call_may_have_any_shape_of_one_entry():
    on_f = [np.full(shape, 1.0) for shape in ((), (1,), (1, 1))]
    limits = [ex.limit_motion(ex.constants_to_states(UNIFORM, one, 0.0, 1.0)) for one in on_f]
    assert len({limit.period for limit in limits}) == 1
    both = [ex.both_sides(ex.constants_to_states(UNIFORM, one, 0.0, 1.0)) for one in on_f]
    paths = [ex.wander_path(ex.constants_to_states(UNIFORM, one, 0.05, 1.0), 1) for one in on_f]
    for some, name in ((both, "t"), (paths, "centre")):
        np.testing.assert_array_equal(getattr(some[0], name), getattr(some[1], name))
        np.testing.assert_array_equal(getattr(some[0], name), getattr(some[2], name))


def test_what_is_a_single_one_has_no_axis():
    constant = ex.falling_constant(UNIFORM)
    assert (constant.shape, constant.size, len(constant.to_pandas())) == ((), 1, 1)
    assert ex.circular_rolling(UNIFORM, 0.3, 2.0).shape == ()
    with pytest.raises(TypeError, match="single sample"):
        len(constant)


def test_the_centre_after_each_period_has_a_last_axis_for_the_periods():
    for shape in ((), (3,), (2, 3)):
        assert ex.wander(states_of(shape)).after(4).shape == (*shape, 5)
