"""An observable of one's own for every state."""

import numpy as np
import pytest

import explorer as ex
from explorer.motion.scan import OBSERVABLES, scan

DISK = ex.Disk.uniform()
STATES = ex.phi_to_states(DISK, 0.2, 0.5, np.linspace(-1.0, 1.0, 23), 0.3)


@pytest.mark.parametrize("name", OBSERVABLES)
def test_every_named_observable_gives_one_value_for_each_state(name):
    assert scan(STATES, name)[name].shape == (23,)


def test_a_name_is_the_column_of_its_call():
    np.testing.assert_array_equal(scan(STATES, "theta_min"), ex.periods(STATES).theta_min)
    both = scan(STATES, ["race_angle", "theta_min"])
    np.testing.assert_array_equal(both["race_angle"], ex.bounces(STATES).race_angle[:, 0])
    with pytest.raises(ex.InputError, match="choose one by its name"):
        np.asarray(both)


def test_batches_and_jobs_do_not_change_what_a_function_returns():
    def turns(batch):
        motion = ex.simulate(batch, t_eval=[3.0], observables=("chi", "phi"))
        return {"turns": motion.chi[:, 0] / (2.0 * np.pi), "tilted": motion.phi}

    whole, parts = scan(STATES, turns), scan(STATES, turns, jobs=2, batch=5)
    assert whole["tilted"].shape == (23, 1)
    for name in whole:
        np.testing.assert_array_equal(whole[name], parts[name])


def test_a_function_sees_no_more_states_than_a_batch():
    sizes = []
    scan(STATES, lambda batch: sizes.append(len(batch)) or np.zeros(len(batch)), batch=10)
    assert sizes == [10, 10, 3]


@pytest.mark.parametrize(
    ("observable", "message"),
    [
        ("theta_mim", "did you mean 'theta_min'"),
        (3, "neither a name nor a function"),
        (lambda batch: 1.0, "one entry"),
        (lambda batch: {"own": batch.phi + 1j}, "let it return real numbers"),
        (lambda batch: ["up"] * len(batch), "let it return real numbers"),
        (lambda batch: ex.simulate(batch, -1.0), "^t_end = -1.0 must be"),
    ],
)
def test_what_is_no_observable_is_refused_in_words(observable, message):
    with pytest.raises(ex.InputError, match=message):
        scan(STATES, observable)


def test_arrays_have_the_shape_of_the_states_and_a_table_has_their_entries():
    states = ex.phi_to_states(DISK, 0.2, [[0.5], [0.6]], np.linspace(-1.0, 1.0, 7), 0.3)
    found = scan(states, lambda batch: {"pair": np.stack([batch.phidot, batch.sigma3], axis=1), "one": batch.phi})
    assert found["pair"].shape == (2, 7, 2)
    np.testing.assert_array_equal(found["pair"][..., 1], states.sigma3)
    table = found.to_arrow()
    assert table.column_names == ["phi", "phidot", "sigma3", "sigma4", "pair_0", "pair_1", "one"]
    np.testing.assert_array_equal(table["pair_1"], states.sigma3.ravel())


@pytest.mark.parametrize("key", [1, None, ("a", "b"), "status", "phi"])
def test_a_name_that_no_column_can_have_is_refused_at_once(key):
    calls = []
    with pytest.raises(ex.InputError, match=r"^observable: the function returned .* as a name; give text"):
        scan(STATES, lambda batch: calls.append(1) or {key: batch.phi + 1.0}, batch=4)
    assert len(calls) == 1


def test_a_function_with_the_name_of_a_column_is_refused():
    def status(batch):
        return batch.phi

    with pytest.raises(ex.InputError, match="returned 'status' as a name"):
        scan(STATES, status)


@pytest.mark.parametrize("kind", ["f2", "f4", ">f8", np.longdouble, "u1", ">i4", "?"])
def test_arrays_of_every_type_of_real_numbers_are_columns(kind):
    found = scan(STATES, lambda batch: {"mine": (1.0 + batch.sigma3).astype(kind)})
    np.testing.assert_array_equal(found.to_arrow()["mine"], found["mine"])
    np.testing.assert_array_equal(found.to_pandas()["mine"], (1.0 + STATES.sigma3).astype(kind))


def test_arrays_of_any_name_are_columns():
    names = ("file", "args", "self", "compress", "η of a/b", "arr_0", "x.npy")
    found = scan(STATES, lambda batch: {name: batch.sigma3 + i for i, name in enumerate(names)})
    for table in (found.to_arrow(), found.to_pandas()):
        for name in names:
            np.testing.assert_array_equal(table[name], found[name])


def test_two_columns_of_one_name_are_refused_and_none_is_lost():
    for names in (("pair", "pair_0"), ("pair_0", "pair")):
        arrays = {"pair": np.zeros((23, 2)), "pair_0": np.ones(23)}
        found = scan(STATES, lambda batch, names=names, arrays=arrays: {name: arrays[name] for name in names})
        with pytest.raises(ex.InputError, match="two columns 'pair_0'; give arrays other names"):
            found.to_arrow()


def test_some_states_of_a_scan_are_chosen_as_entries_of_an_array_are():
    states = ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, np.array([[0.5], [0.7]]), np.linspace(-1.0, 1.0, 5))
    found = ex.scan(states, ["theta_min", "crosses"])
    some = found[found["theta_min"] < 0.3]
    assert list(some) == ["theta_min", "crosses"]
    np.testing.assert_array_equal(some["theta_min"], found["theta_min"][found["theta_min"] < 0.3])
    np.testing.assert_array_equal(found[0].states.sigma4, states.sigma4[0])
    assert found[:, 1:3].shape == (2, 2)
