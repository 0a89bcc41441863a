"""Columns that a user gives, as arrays: cells that are no number, missing ones, text."""

from fractions import Fraction

import numpy as np
import pandas as pd
import pyarrow
import pytest

from explorer.errors import InputError
from explorer.scenes.given_columns import as_columns, as_numbers, as_own, read_csv

TEXT = """tilt,precession,name,id
0.1,60,a,1

0.2,abc,b,2
0.3,1
 0.4 ,-1e-3,"x,y",4
1,2,3,4,5
,5,,6
"""


def test_a_line_of_a_csv_file_that_is_no_state_keeps_its_place(tmp_path):
    path = tmp_path / "some.csv"
    path.write_text(TEXT)
    found = read_csv(path, {"tilt": 0, "precession": 0}, "--states some.csv")
    nan = np.nan
    np.testing.assert_array_equal(found["tilt"], [0.1, 0.2, nan, 0.4, nan, nan])
    np.testing.assert_array_equal(found["precession"], [60, nan, nan, -1e-3, nan, 5])
    assert found["name"].tolist() == ["a", "b", "", "x,y", "", ""]
    np.testing.assert_array_equal(found["id"], [1, 2, nan, 4, nan, 6])


def test_a_cell_of_a_csv_file_is_a_number(tmp_path):
    path = tmp_path / "some.csv"
    path.write_text("x,y\n0x1,1_0\nx,2\n +1e0 ,3\n-.5,4\nTrue,5\n", encoding="utf-8")
    found = read_csv(path, {"x": 0}, "--states some.csv")
    np.testing.assert_array_equal(found["x"], [np.nan, np.nan, 1.0, -0.5, np.nan])
    assert found["y"].tolist() == ["1_0", "2", "3", "4", "5"]


@pytest.mark.parametrize("library", ["pandas", "arrow"])
def test_missing_cells_of_any_kind_are_nan_or_empty(library):
    frame = pd.DataFrame(
        {
            "real": [0.1, None, 0.3],
            "whole": pd.array([1, None, 3], dtype="Int64"),
            "kind": pd.Categorical(["a", None, "b"]),
            "time": pd.to_datetime(["2020", None, "2022"]),
        }
    )
    table = as_columns(frame if library == "pandas" else pyarrow.Table.from_pandas(frame), "states")
    np.testing.assert_array_equal(as_numbers("whole", table["whole"], "states"), [1, np.nan, 3])
    np.testing.assert_array_equal(as_own("whole", table["whole"], "states"), [1, np.nan, 3])
    assert as_own("kind", table["kind"], "states").tolist() == ["a", "", "b"]
    assert np.isnat(as_own("time", table["time"], "states")).tolist() == [False, True, False]


def test_a_masked_cell_is_no_number():
    masked = np.ma.array([1, 2, 3], mask=[False, True, False])
    np.testing.assert_array_equal(as_numbers("x", masked, "states"), [1, np.nan, 3])
    np.testing.assert_array_equal(as_own("x", masked, "states"), [1, np.nan, 3])


def test_a_number_stands_for_a_column():
    table = as_columns({"tilt": [0.1, 0.2], "spin": 3.0}, "states")
    np.testing.assert_array_equal(table["spin"], [3.0, 3.0])


def test_a_missing_object_of_the_user_is_an_empty_cell():
    assert as_own("x", np.array(["a", pd.NA, None], object), "states").tolist() == ["a", "", ""]


@pytest.mark.parametrize("cell", ["x", "0x1", True, 1j, None], ids=repr)
def test_a_cell_that_is_no_number_is_nan_and_the_others_are_read(cell):
    cells = np.array([cell, 0.5, "2", Fraction(1, 4)], object)
    np.testing.assert_array_equal(as_numbers("x", cells, "states"), [np.nan, 0.5, 2.0, 0.25])


@pytest.mark.parametrize("column", [[True, False], ["a", "b"], np.array([1], "M8[ns]")])
def test_a_column_without_numbers_is_refused(column):
    with pytest.raises(InputError, match=r"^states: column 'x' holds no numbers"):
        as_numbers("x", as_columns({"x": column}, "states")["x"], "states")


def test_bools_of_the_user_stay_what_they_are():
    assert as_own("x", [True, False], "states").dtype == as_own("x", np.ma.array([True]), "states").dtype == bool


def test_what_cannot_be_kept_is_refused_by_its_column():
    with pytest.raises(InputError, match="states: column 'x' holds several shapes; give one entry"):
        as_own("x", as_columns({"x": [[1.0], [1.0, 2.0]]}, "states")["x"], "states")
