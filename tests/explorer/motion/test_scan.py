"""An observable of one's own for every state."""

import numpy as np
import pytest
from pyarrow.parquet import read_table

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
        return {"turns": motion.chi[:, 0] / (2.0 * np.pi), "phi": motion.phi}

    whole, parts = scan(STATES, turns), scan(STATES, turns, jobs=2, batch=5)
    assert whole["phi"].shape == (23, 1)
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
        (np, "neither a name nor a function"),
        (lambda batch: 1.0, "one entry"),
        (int, r"observable: TypeError: int\(\) argument .*; it must return one real number"),
        (lambda batch: 1 // 0, "observable: ZeroDivisionError: .*; it must return one real number"),
        (lambda batch: np.ma.array(batch.phi, mask=batch.sigma3 > 0.9), "observable: .* masked entries"),
        (lambda batch: {"own": batch.phi + 1j}, "it returned complex128"),
        (lambda batch: np.full(len(batch), "2026-01-01", "M8[D]"), "it returned datetime64"),
        (lambda batch: ["up"] * len(batch), "it returned <U2"),
        (lambda batch: ex.simulate(batch, -1.0), "^observable: InputError: t_end = -1.0 must be"),
    ],
)
def test_what_is_no_observable_is_refused_in_words(observable, message):
    with pytest.raises(ex.InputError, match=message):
        scan(STATES, observable)


def test_rows_of_another_shape_for_some_states_are_refused():
    with pytest.raises(
        ex.InputError, match=r"'rows' with rows of shape \(3,\) for some states and \(10,\) for other"
    ):
        scan(STATES, lambda batch: {"rows": np.zeros((len(batch), len(batch)))}, batch=10)


def test_arrays_have_the_shape_of_the_states_and_are_stored_with_it(tmp_path):
    states = ex.phi_to_states(DISK, 0.2, [[0.5], [0.6]], np.linspace(-1.0, 1.0, 7), 0.3)
    found = scan(states, lambda batch: {"pair": np.stack([batch.phidot, batch.sigma3], axis=1), "one": batch.phi})
    assert found["pair"].shape == (2, 7, 2)
    np.testing.assert_array_equal(found["pair"][..., 1], states.sigma3)
    stored = np.load(found.save(tmp_path / "own.npz"))
    np.testing.assert_array_equal(stored["pair"], found["pair"])
    np.testing.assert_array_equal(stored["phidot"], states.phidot)
    table = read_table(found.save(tmp_path / "own.parquet"))
    assert table.column_names == ["phi", "phidot", "sigma3", "sigma4", "pair_0", "pair_1", "one"]
    np.testing.assert_array_equal(table["pair_1"], states.sigma3.ravel())
    with pytest.raises(ex.InputError, match=r"ends in \.npz or \.parquet"):
        found.save(tmp_path / "own.txt")
    with pytest.raises(ex.InputError, match="there is no folder"):
        found.save(tmp_path / "nowhere" / "own.npz")
