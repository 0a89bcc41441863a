"""States that a user gives: what is read, cell by cell, how it is identified, and how damage is told."""

import json

import numpy as np
import pandas as pd
import pyarrow
import pyarrow.parquet
import pytest
from told import said

import explorer as ex
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.given_states import GivenStates
from explorer.scenes.scene import joined, scene_of

DISK = ex.Disk.uniform()
NAMES = ("phi", "phidot", "sigma3", "sigma4")


@pytest.fixture
def columns():
    random = np.random.default_rng(3)
    return {name: random.uniform(-1, 1, 500) for name in NAMES}


def test_bad_rows_are_flagged_with_their_number_and_the_others_are_computed(columns, tmp_path):
    random = np.random.default_rng(3)
    clean, spoilt = tmp_path / "clean.parquet", tmp_path / "spoilt.parquet"
    pyarrow.parquet.write_table(pyarrow.table(columns), clean, row_group_size=100)
    bad = random.choice(500, 5, replace=False)
    for row, value in zip(bad, (np.nan, np.inf, -np.inf, 1e300, 7.0), strict=True):
        columns["phi" if value == 7.0 else "sigma3"][row] = value
    pyarrow.parquet.write_table(pyarrow.table({**columns, "label": [f"n{i}" for i in range(500)]}), spoilt)
    scenes = [FallingSet(states=path, keep="all", chunk_size=128) for path in (clean, spoilt)]
    one, other = (joined([scene.chunk(index)[0] for index in range(scene.chunks)]) for scene in scenes)
    assert set(other["row"][other["status"] == ex.Status.BAD_INPUT]) == set(bad)
    kept = np.setdiff1d(np.arange(500), bad)
    np.testing.assert_array_equal(one["theta_min"][kept], other["theta_min"][kept])
    assert other["label"].tolist() == [f"n{i}" for i in other["row"]]
    record = json.loads(json.dumps(scenes[1].options, default=dict))
    assert scene_of(record).options == record
    pyarrow.parquet.write_table(pyarrow.table(columns).slice(1), spoilt)
    with pytest.raises(ex.InputError, match="is not the file of states that the run began with"):
        scene_of(record).chunk(0)


def test_a_stored_run_is_read_without_the_file_of_its_states_and_says_what_it_cannot(columns, tmp_path, capsys):
    path, folder = tmp_path / "states.csv", tmp_path / "run"
    columns["sigma3"][7] = np.nan
    pd.DataFrame(columns).to_csv(path, index=False)
    run = ex.run("falling-set", states=path, out=folder, figures=False, chunk_size=128)
    path.rename(tmp_path / "moved.csv")
    assert said(capsys, "verify", folder)[:2] == (0, "intact\n")
    status, out, _ = said(capsys, "summary", folder)
    assert status == 0
    assert "which are no states (bad_input) cannot be said" in out
    assert ex.open(folder).summary == run.summary
    run.chunks[2].content.unlink()
    status, _, err = said(capsys, "resume", folder, "--no-figures")
    assert (status, len(err.splitlines())) == (2, 1)
    assert f"{path}: cannot be read (No such file or directory); put" in err
    (tmp_path / "moved.csv").rename(path)
    assert said(capsys, "resume", folder, "--no-figures")[0] == 0
    assert ex.open(folder).summary == run.summary


class Stream:
    """A frame of another library, as Arrow sees it: of polars or duckdb."""

    def __init__(self, table):
        self.table = table

    def __arrow_c_stream__(self, schema=None):
        return self.table.__arrow_c_stream__(schema)


def test_every_kind_of_table_gives_the_same_states(columns, tmp_path):
    frame = pd.DataFrame(columns)
    frame.to_csv(tmp_path / "a.csv", index=False)
    frame.to_csv(tmp_path / "b.txt", index=False, sep=";", encoding="utf-8-sig")
    frame.to_csv(tmp_path / "t.tsv", index=False, sep="\t")
    frame.to_parquet(tmp_path / "c.parquet", row_group_size=70)
    kinds = [
        frame,
        columns,
        frame.set_index(2 * np.arange(500)),
        pyarrow.table(columns),
        Stream(pyarrow.table(columns)),
        ex.phi_to_states(DISK, **columns),
        {name: values.tolist() for name, values in columns.items()},
        tmp_path / "a.csv",
        str(tmp_path / "b.txt"),
        tmp_path / "t.tsv",
        tmp_path / "c.parquet",
    ]
    expected = ex.phi_to_states(DISK, **columns).natural[:, 100:300]
    for kind in kinds:
        given = GivenStates.of("states", kind)
        assert given.rows == 500
        found = given.read(DISK, 100, 200)
        np.testing.assert_array_equal(found.states.natural, expected)
        np.testing.assert_array_equal(found.columns["row"], np.arange(100, 300))
        assert not found.own


def test_an_eta_that_was_given_is_kept_however_small():
    states = ex.constants_to_states(DISK, 1.0, [1e-200, -1e-200], 1.0, [1, -1])
    for given in (
        states,
        {"sigma3_bar": [1.0, 1.0], "eta_hat": [1e-200, -1e-200], "phidot": [1.0, 1.0], "face": [1, -1]},
    ):
        read = GivenStates.of("states", given).read(DISK, 0, 2).states
        for one, other in zip(read.motion, states.motion, strict=True):
            np.testing.assert_array_equal(one, other)


def test_degrees_are_those_of_angles_and_rates():
    given = {"tilt": [30.0], "tilt_rate": [10.0], "precession": [50.0], "spin": [-20.0], "name": ["a"]}
    found = GivenStates.of("states", given).of_degrees(True).read(DISK, 0, 1)
    direct = ex.rates_to_states(DISK, 30.0, 10.0, 50.0, -20.0, degrees=True)
    np.testing.assert_allclose(found.states.natural, direct.natural, rtol=1e-15)
    assert found.own["given_tilt"][0] == 30.0  # tilt without a word is in radians
    assert "tilt" not in found.own
    assert found.own["name"][0] == "a"


def spoilt(path, content):
    path.write_bytes(content)
    return path


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "Empty CSV file"),
        (b"PAR1 and no more", "cannot be read"),
        (b"\x89PNG\r\n\x1a\n\0\0", "cannot be read .*; give Parquet or CSV"),
        (b"a,b\n1,2\n", "they do not determine a state; give one of these sets: phi"),
        (b"phi,Phidot,sigma3,sigma4\n1,2,3,4\n", "add phidot"),
        (b"phi,phi,phidot,sigma3,sigma4\n1,1,1,1,1\n", "several columns 'phi'"),
        (b"phi,phidot,sigma3,sigma4\n", "holds no states"),
        (b"phi,phidot,sigma3,sigma4\nx,1,2,3\ny,1,2,3\n", "column 'phi' holds no numbers"),
    ],
)
def test_a_damaged_file_is_told_in_one_sentence(content, message, tmp_path):
    with pytest.raises(ex.InputError, match=message) as caught:
        GivenStates.of("states", spoilt(tmp_path / "states.csv", content))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (5, "is no table"),
        ({}, "none were given; give one of these sets"),
        ({"phi": [0.1, 0.2], "phidot": [1.0]}, "expected length 2 but got length 1"),
        (dict.fromkeys(NAMES, 1.0), "is no table"),
        ({"phi": [1.0, "x"]}, "is no table"),
        ({"phi": [], "phidot": [], "sigma3": [], "sigma4": []}, "holds no states"),
        ({name: ["a"] for name in NAMES}, "holds no numbers"),
        (dict.fromkeys(NAMES, np.ones((2, 2))), "is no table"),
        (pyarrow.table({name: [[1.0]] if name == "x" else [1.0] for name in (*NAMES, "x")}), "'x' holds list"),
        ({name: [True] for name in NAMES}, "column 'phi' holds no numbers"),
        (dict.fromkeys(NAMES, np.array([1], "M8[ns]")), "column 'phi' holds no numbers"),
        (np.ones((3, 5)), "is no table .*; give a path, a DataFrame, a dict of columns"),
        ("nowhere.csv", "cannot be read"),
    ],
)
def test_what_is_no_table_of_states_is_refused_in_words(given, message):
    with pytest.raises(ex.InputError, match=message):
        GivenStates.of("states", given)


def test_a_file_that_is_damaged_later_ends_the_run_with_a_sentence(columns, tmp_path):
    path = tmp_path / "states.parquet"
    pyarrow.parquet.write_table(pyarrow.table(columns), path, write_page_checksum=True, compression="none")
    given = GivenStates.of("states", path)
    content = bytearray(path.read_bytes())
    content[200] ^= 1
    path.write_bytes(content)
    with pytest.raises(ex.InputError, match="put the file back"):
        given.read(DISK, 0, 500)


def test_a_line_of_a_csv_file_with_cells_too_few_is_named_and_one_that_is_no_state_keeps_its_place(tmp_path):
    (tmp_path / "some.csv").write_text('tilt,precession,name,spin\n0.1,60,a,1\n0.2,abc,b,1\n ,-1e-3,"x,y",1\n')
    found, nan = GivenStates.of("states", tmp_path / "some.csv").columns, np.nan
    np.testing.assert_array_equal(found["tilt"], [0.1, 0.2, nan])
    np.testing.assert_array_equal(found["precession"], [60, nan, -1e-3])
    assert found["name"].tolist() == ["a", "b", "x,y"]
    (tmp_path / "some.csv").write_text("tilt,precession,spin\n0.1,60,1\n0.3,1\n")
    with pytest.raises(ex.InputError, match="Row #3: Expected 3 columns, got 2"):
        GivenStates.of("states", tmp_path / "some.csv")


def test_a_cell_of_a_csv_file_is_a_number(tmp_path):
    (tmp_path / "some.csv").write_text("tilt,precession,spin,y\n0x1,1,1,1_0\nx,1,1,2\n +1e0 ,1,1,3\nTrue,1,1,4\n")
    found = GivenStates.of("states", tmp_path / "some.csv").columns
    np.testing.assert_array_equal(found["tilt"], [np.nan, np.nan, 1.0, np.nan])
    assert found["y"].tolist() == ["1_0", "2", "3", "4"]


@pytest.mark.parametrize("library", ["pandas", "arrow", "dict"])
def test_missing_cells_of_any_kind_are_nan_or_empty(library):
    frame = pd.DataFrame(
        {
            "tilt": [0.1, None, 0.3],
            "precession": pd.array([1, None, 3], dtype="Int64"),
            "spin": 1.0,
            "whole": pd.array([1, None, 3], dtype="Int64"),
            "kind": pd.Categorical(["a", None, "b"]),
            "time": pd.to_datetime(["2020", None, "2022"]),
            "truth": [True, False, True],
        }
    )
    given = {"pandas": frame, "arrow": pyarrow.Table.from_pandas(frame), "dict": dict(frame)}[library]
    found = GivenStates.of("states", given).columns
    for name in ("precession", "whole"):
        np.testing.assert_array_equal(found[name], [1, np.nan, 3])
    assert found["kind"].tolist() == ["a", "", "b"]
    assert np.isnat(found["time"]).tolist() == [False, True, False]
    assert found["truth"].dtype == bool


def test_a_cell_that_is_no_number_is_nan_and_the_others_are_read():
    given = {"tilt": ["x", "0.5", "2", None], "precession": [1, None, 3, 4], "spin": [3.0] * 4}
    found = GivenStates.of("states", given).columns
    np.testing.assert_array_equal(found["tilt"], [np.nan, 0.5, 2.0, np.nan])
    np.testing.assert_array_equal(found["precession"], [1, np.nan, 3, 4])
