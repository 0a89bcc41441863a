"""Results as tables, and short descriptions of them."""

import numpy as np
import pyarrow as pa
import pytest

import explorer as ex
from explorer.phase.columns import COLUMNS
from explorer.phase.results import to_arrow

BOUNCES = ex.bounces(ex.phi_to_states(ex.Disk.hoop(), [0.3, np.nan, -0.4], 0.5, 0.4, 0.2), 2)


def test_a_result_is_a_table_with_one_row_for_each_sample():
    frame = BOUNCES.to_pandas()
    assert list(frame.columns) == list(BOUNCES.columns)
    assert len(frame) == BOUNCES.size == 6
    assert frame["status"].tolist() == ["ok", "ok", "bad_input", "bad_input", "ok", "ok"]
    np.testing.assert_array_equal(frame["delta_chi"], BOUNCES.delta_chi.ravel())


def test_arrow_fields_say_meaning_unit_and_equation():
    table = BOUNCES.to_arrow()
    assert table.schema.field("race_angle").metadata[b"unit"] == b"rad"
    assert b"kappa pi" in table.schema.field("race_angle").metadata[b"meaning"]
    assert table.schema.field("race_angle").metadata[b"equation"] == b"(7.9)"
    assert pa.types.is_dictionary(table.schema.field("status").type)
    entries = to_arrow({"path": np.ones((3, 3))}).schema
    assert entries.names == ["path_x", "path_y", "path_z"]
    assert {entries.field(place).metadata[b"unit"] for place in range(3)} == {b"length"}


@pytest.mark.parametrize("name", ["mine", "energy_ratio", "phi_mean", "time_x", "status_of"])
def test_columns_that_nobody_described_are_columns_all_the_same_and_say_nothing(name):
    table = to_arrow({name: np.arange(3)})
    assert table.column(name).to_pylist() == [0, 1, 2]
    assert table.schema.field(name).metadata is None


def test_a_description_is_a_few_lines_however_many_samples_there_are():
    many = ex.bounces(ex.phi_to_states(ex.Disk.hoop(), np.linspace(-1.0, 1.0, 500), 0.5, 0.4, 0.2))
    assert len(repr(many).splitlines()) <= 8
    assert repr(many).startswith("Bounces of 500 (500 x 1)\n  status: ok")
    assert "<table>" in many._repr_html_()
    assert "bad_input 2 (numbers below: of the 4 ok)" in repr(BOUNCES)
    assert f"bad_input: {ex.Status.BAD_INPUT.remedy}" in repr(BOUNCES)


def test_every_column_of_a_result_is_described():
    assert set(BOUNCES.columns) <= set(COLUMNS)


def test_columns_are_those_that_arrow_makes_of_them():
    of_every_kind = {
        "sure": np.array([True, False, True] * 5)[::2],
        "many": np.arange(12, dtype=np.uint16).reshape(3, 4),
        "sizes": np.array([1.5, np.nan, -np.inf, -0.0], np.float32),
        "none": np.zeros(0),
        "names": np.array(["a", "é"]),
    }
    for name, values in of_every_kind.items():
        made = to_arrow({name: values}, values.ndim).column(0).chunk(0)
        made.validate(full=True)
        assert made.equals(pa.array(values.ravel())) or np.isnan(values).any()
        np.testing.assert_array_equal(made.to_numpy(zero_copy_only=False), values.ravel())
    status = to_arrow({"status": BOUNCES.status}, 2).column(0).chunk(0)
    status.validate(full=True)
    assert status.to_pylist() == BOUNCES.status_names.ravel().tolist()


def test_samples_are_chosen_as_entries_of_an_array_are():
    """With the states to which they belong."""
    chosen = BOUNCES[BOUNCES.face == 1]
    np.testing.assert_array_equal(chosen.race_angle, BOUNCES.race_angle[BOUNCES.face == 1])
    np.testing.assert_array_equal(
        chosen.to_pandas()["phi"], BOUNCES.to_pandas()["phi"][(BOUNCES.face == 1).ravel()]
    )
    for rows in (0, np.s_[:, 1], np.s_[::2], [2, 0], (0, 1), BOUNCES.ok):
        found = BOUNCES[rows]
        np.testing.assert_array_equal(found.time, np.atleast_1d(BOUNCES.time[rows]))
        assert found.shape == found.states.shape
        assert len(found.to_arrow()) == found.size
    passages = ex.passages(ex.Disk.hoop(), [[1.0], [2.0]], [1e-3, -1e-3, 1e-6], 1.0)
    assert passages[1].delta_chi.tolist() == passages.delta_chi[1].tolist()
    assert passages[passages.side < 0].shape == (2,)
    assert len(passages) == len(list(passages)) == 2


def test_a_description_has_a_median_for_each_side_and_units_of_the_disk():
    coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    found = ex.passages(coin, 20.0, [1e-9, 2e-9, -1e-9], 30.0)
    race, duration = (line for line in repr(found).split("\n") if "race_angle" in line or "duration" in line)
    assert "median 7.02481" in race
    assert race.endswith(" rad where eta > 0; -7.02481 rad where eta < 0")
    assert duration.endswith(" s")
    one = ex.passages(ex.Disk.uniform(), 1.0, [1e-9, 2e-9], 1.0)
    assert "where" not in repr(one)
    assert " time" in repr(one)


def test_states_say_their_tilts_in_degrees():
    assert repr(ex.rates_to_states(ex.Disk.hoop(), [10.0, 100.0], 0.0, 1.0, 1.0, degrees=True)).endswith(
        "ok 2; tilts 10 to 80 degrees"
    )
