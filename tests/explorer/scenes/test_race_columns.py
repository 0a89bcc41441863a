"""Columns of race-angles: blocks put together, and what bounces have from their motions."""

import numpy as np
from conftest import BODIES

import explorer as ex
from explorer.scenes.race_columns import filled, motion_constants


def test_blocks_become_columns_of_their_types_in_order():
    table = {"status": np.arange(5, dtype=np.int8), "wrong_way": np.arange(5) > 2, "energy": np.arange(5.0)}
    found = filled(5, ({name: values[rows] for name, values in table.items()} for rows in (slice(3), slice(3, 5))))
    assert list(found) == list(table)
    for name, values in table.items():
        assert found[name].dtype == values.dtype
        np.testing.assert_array_equal(found[name], values)


def test_bounces_of_a_motion_beside_f_keep_its_constants_and_go_no_wrong_way():
    disk = BODIES["uniform"]
    states = ex.constants_to_states(disk, sigma3_bar=[0.7, 0.7], eta_hat=[1e-3, -1e-3], phidot=1.0, face=1)
    found = ex.bounces(states, 1)
    table = motion_constants(states, found)
    np.testing.assert_allclose(table["sigma3_bar"], 0.7, rtol=1e-12)
    np.testing.assert_allclose(table["eta_hat"], [1e-3, -1e-3], rtol=1e-9)
    np.testing.assert_allclose(table["energy"], ex.constants(states).energy, rtol=1e-12)
    assert not table["wrong_way"].any()
