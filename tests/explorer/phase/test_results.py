"""Results as tables, and short descriptions of them."""

import numpy as np
import pyarrow as pa

import explorer as ex
from explorer.phase.columns import COLUMNS
from explorer.phase.results import to_arrow

BOUNCES = ex.bounces(ex.phi_to_states(ex.Disk.hoop(), [0.3, np.nan, -0.4], 0.5, 0.4, 0.2), 2)


def test_a_result_is_a_table_with_one_row_for_each_sample():
    frame = BOUNCES.to_pandas()
    assert list(frame.columns) == list(BOUNCES.columns)
    assert len(frame) == len(BOUNCES) == 6
    assert frame["status"].tolist() == ["ok", "ok", "bad_input", "bad_input", "ok", "ok"]
    np.testing.assert_array_equal(frame["delta_chi"], BOUNCES.delta_chi.ravel())


def test_arrow_fields_say_meaning_unit_and_equation():
    table = BOUNCES.to_arrow()
    assert table.schema.field("race_angle").metadata[b"unit"] == b"rad"
    assert b"kappa pi" in table.schema.field("race_angle").metadata[b"meaning"]
    assert table.schema.field("race_angle").metadata[b"equation"] == b"(7.9)"
    assert pa.types.is_dictionary(table.schema.field("status").type)
    moments = to_arrow({"race_angle_plus": np.ones(3)}).schema.field("race_angle_plus")
    assert moments.metadata == table.schema.field("race_angle").metadata


def test_columns_that_nobody_described_are_columns_all_the_same():
    assert to_arrow({"mine": np.arange(3)}).column("mine").to_pylist() == [0, 1, 2]


def test_a_description_is_a_few_lines_however_many_samples_there_are():
    many = ex.bounces(ex.phi_to_states(ex.Disk.hoop(), np.linspace(-1.0, 1.0, 500), 0.5, 0.4, 0.2))
    assert len(repr(many).splitlines()) <= 8
    assert repr(many).startswith("Bounces of 500 (500 x 1)\n  status: ok")
    assert "<table>" in many._repr_html_()
    assert "bad_input 2 (numbers below: of the 4 ok)" in repr(BOUNCES)


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
        made = to_arrow({name: values}).column(0).chunk(0)
        made.validate(full=True)
        assert made.equals(pa.array(values.ravel())) or np.isnan(values).any()
        np.testing.assert_array_equal(made.to_numpy(zero_copy_only=False), values.ravel())
    status = to_arrow({"status": BOUNCES.status}).column(0).chunk(0)
    status.validate(full=True)
    assert status.to_pylist() == BOUNCES.status_names.ravel().tolist()
