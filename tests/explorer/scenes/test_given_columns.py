"""Columns that a user gives, as arrays: cells that are no number, missing ones, text."""

import warnings
from decimal import Decimal
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


def test_a_cell_of_a_csv_file_is_a_number_in_plain_digits(tmp_path):
    path = tmp_path / "some.csv"
    path.write_text("x,y\n1_000,1_0\n\uff11,2\n +1e0 ,3\n-.5,4\nTrue,5\n", encoding="utf-8")
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


@pytest.mark.parametrize("hidden", [np.ma.masked, np.ma.array(5.0, mask=True)], ids=["constant", "number"])
def test_a_masked_number_stands_for_a_column_without_numbers(hidden):
    table = as_columns({"tilt": [0.1, 0.2], "spin": hidden, "mixed": [hidden, 3.0]}, "states")
    np.testing.assert_array_equal(as_numbers("spin", table["spin"], "states"), [np.nan, np.nan])
    np.testing.assert_array_equal(as_numbers("mixed", table["mixed"], "states"), [np.nan, 3.0])


def test_a_missing_object_of_the_user_is_an_empty_cell():
    assert as_own("x", np.array(["a", pd.NA, None], object), "states").tolist() == ["a", "", ""]


@pytest.mark.parametrize("wrap", [list, np.ma.stack], ids=["list", "array"])
def test_rows_hide_what_is_masked_in_them(wrap):
    rows = wrap([np.ma.array([0.1, 0.2, 0.3, 0.4], mask=mask) for mask in ([0, 1, 0, 0], [0, 0, 0, 0])])
    table = as_columns(rows, "states")
    np.testing.assert_array_equal(as_numbers("phidot", table["phidot"], "states"), [np.nan, 0.2])
    np.testing.assert_array_equal(as_numbers("phi", table["phi"], "states"), [0.1, 0.1])


@pytest.mark.parametrize(
    "cell",
    [
        "1_000",
        "\uff11",
        "0x1",
        True,
        np.True_,
        b"1",
        10**400,
        "1" * 2000,
        Decimal("1e400"),
        Decimal("sNaN"),
        1j,
        None,
    ],
    ids=repr,
)
def test_a_cell_that_no_argument_could_be_is_no_number_and_the_others_are(cell):
    cells = np.array([cell, 0.5, "2", Fraction(1, 4)], object)
    with warnings.catch_warnings(action="error"):
        read = as_numbers("x", as_columns({"x": cells}, "states")["x"], "states")
    assert np.isnan(read[0])
    assert read.tolist()[1:] == [0.5, 2.0, 0.25]


@pytest.mark.parametrize(
    "column", [[True, False], np.array([True]), True, "1_000", 10**400, np.array([1], "M8[ns]")]
)
def test_a_column_without_numbers_is_refused(column):
    with pytest.raises(InputError, match=r"^states: column 'x' holds no numbers"):
        as_numbers("x", as_columns({"x": column}, "states")["x"], "states")


def test_long_doubles_are_numbers_where_they_are_doubles():
    eps = np.finfo(np.longdouble).eps
    if eps == np.finfo(float).eps:
        pytest.skip("long doubles are doubles here")
    cells = np.array([0.5, 1 + eps, np.finfo(np.longdouble).max], np.longdouble)
    for given in (cells, cells.astype(object)):
        with warnings.catch_warnings(action="error"):
            read = as_numbers("x", given, "states")
        np.testing.assert_array_equal(read, [0.5, np.nan, np.nan])
    with pytest.raises(InputError, match=r"^states: column 'x' holds .*, which results cannot keep"):
        as_own("x", np.array([0.5], np.longdouble), "states")


def test_bools_and_dates_of_the_user_stay_what_they_are():
    assert as_own("x", [True, False], "states").dtype == as_own("x", np.ma.array([True]), "states").dtype == bool
    dates = np.ma.array([1, 2], "M8[ns]", mask=[True, False])
    assert np.isnat(as_own("x", dates, "states")).tolist() == [True, False]


@pytest.mark.parametrize(
    ("column", "why"),
    [
        ([10**400, 1], "holds an integer that is too long; give it as text"),
        ([10**5000, "a"], "holds an integer that is too long; give it as text"),
        ([[1.0], [1.0, 2.0]], "holds several shapes; give one entry for each state"),
    ],
)
def test_what_cannot_be_kept_is_refused_by_its_column(column, why):
    with pytest.raises(InputError, match=f"^states: column 'x' {why}$"):
        as_own("x", as_columns({"x": column}, "states")["x"], "states")


@pytest.mark.parametrize("cells", [np.array(["a", "\ud800"]), np.array([None, "\udcff"], object)])
def test_text_that_no_file_can_hold_is_refused_by_its_column(cells):
    with pytest.raises(InputError, match=r"^states: column 'x' holds text that is none in UTF-8"):
        as_own("x", cells, "states")
