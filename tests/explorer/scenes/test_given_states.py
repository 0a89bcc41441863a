"""States that a user gives: what is read, how it is identified, and how damage is told."""

import numpy as np
import pandas as pd
import pyarrow
import pyarrow.parquet
import pytest

import explorer as ex
from explorer.runs import folder as folders
from explorer.scenes.given_states import GivenStates

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
    options = {"grid": 5, "keep": "all", "chunk_size": 128}
    good = ex.run("falling-set", states=clean, out=tmp_path / "good", **options)
    run = ex.run("falling-set", states=spoilt, out=tmp_path / "run", **options)
    one, other = (
        {name: np.concatenate([table[name] for table in done.tables()]) for name in ("status", "theta_min", "row")}
        for done in (good, run)
    )
    assert set(other["row"][other["status"] == ex.Status.BAD_INPUT]) == set(bad)
    kept = np.setdiff1d(np.arange(500), bad)
    np.testing.assert_array_equal(one["theta_min"][kept], other["theta_min"][kept])
    labels = np.concatenate([table["label"] for table in run.tables()])
    assert labels.tolist() == [f"n{i}" for i in other["row"]]
    assert folders.scene_of(run.folder).options() == run.scene.options()
    pyarrow.parquet.write_table(pyarrow.table(columns).slice(1), spoilt)
    with pytest.raises(ex.InputError, match="is not the file of states that the run began with"):
        folders.scene_of(run.folder)


def test_every_kind_of_table_gives_the_same_states(columns, tmp_path):
    frame = pd.DataFrame(columns)
    frame.to_csv(tmp_path / "a.csv", index=False)
    frame.to_csv(tmp_path / "b.txt", index=False, sep=";", encoding="utf-8-sig")
    frame.to_parquet(tmp_path / "c.parquet")
    kinds = [
        frame,
        columns,
        pyarrow.table(columns),
        frame.to_records(index=False),
        np.column_stack(list(columns.values())),
        ex.phi_to_states(DISK, **columns),
        {name: values.astype(">f8") for name, values in columns.items()},
        {name: np.ma.array(values) for name, values in columns.items()},
        tmp_path / "a.csv",
        str(tmp_path / "b.txt"),
        tmp_path / "c.parquet",
    ]
    expected = ex.phi_to_states(DISK, **columns).natural[:, 100:300]
    for kind in kinds:
        given = GivenStates.of("--states", kind)
        assert given.rows == 500
        found = given.read(DISK, 100, 200)
        np.testing.assert_array_equal(found.states.natural, expected)
        np.testing.assert_array_equal(found.columns["row"], np.arange(100, 300))


def test_an_eta_that_was_given_is_kept_however_small():
    states = ex.constants_to_states(DISK, 1.0, [1e-200, -1e-200], 1.0, [1, -1])
    for given in (states, {"sigma3_bar": 1.0, "eta_hat": [1e-200, -1e-200], "phidot": 1.0, "face": [1, -1]}):
        read = GivenStates.of("--states", given).read(DISK, 0, 2).states
        for one, other in zip(read.exact, states.exact, strict=True):
            np.testing.assert_array_equal(one, other)


def test_degrees_are_those_of_angles_and_rates():
    given = {"tilt": [30.0], "tilt_rate": 10.0, "precession": 50.0, "spin": -20.0, "name": ["a"]}
    found = GivenStates.of("--states", given).read(DISK, 0, 1, degrees=True)
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
        (b"", "is empty"),
        (b"PAR1 and no more", "cannot be read"),
        (b"\x89PNG\r\n\x1a\n\0\0", "neither Parquet nor CSV"),
        (b"a,b\n1,2\n", "which say no state; name columns as in one of: phi"),
        (b"phi,Phidot,sigma3,sigma4\n1,2,3,4\n", r"add phidot \(is it 'Phidot'\?\)"),
        (b"phi,phi,phidot,sigma3,sigma4\n1,1,1,1,1\n", "several columns 'phi'"),
        (b"phi,phidot,sigma3,sigma4\n", "holds no states"),
        (b"phi,phidot,sigma3,sigma4\nx,1,2,3\ny,1,2,3\n", "column 'phi' holds no numbers"),
    ],
)
def test_a_damaged_file_is_told_in_one_sentence(content, message, tmp_path):
    with pytest.raises(ex.InputError, match=message) as caught:
        GivenStates.of("--states", spoilt(tmp_path / "states.csv", content))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (5, "int is no table"),
        ({}, "has no columns"),
        ({"phi": [0.1, 0.2], "phidot": [1.0], "sigma3": 1.0, "sigma4": 1.0}, "columns differ in length"),
        ({"phi": [], "phidot": [], "sigma3": [], "sigma4": []}, "holds no states"),
        ({name: ["a"] for name in NAMES}, "holds no numbers"),
        (dict.fromkeys(NAMES, np.ones((2, 2))), "has shape"),
        (np.ones((3, 5)), "is not \\(n, 4\\)"),
        ("nowhere.csv", "cannot be read"),
    ],
)
def test_what_is_no_table_of_states_is_refused_in_words(given, message):
    with pytest.raises(ex.InputError, match=message):
        GivenStates.of("--states", given)


def test_a_file_that_is_damaged_later_ends_the_run_with_a_sentence(columns, tmp_path):
    path = tmp_path / "states.parquet"
    pyarrow.parquet.write_table(pyarrow.table(columns), path, write_page_checksum=True, compression="none")
    given = GivenStates.of("--states", path)
    content = bytearray(path.read_bytes())
    content[200] ^= 1
    path.write_bytes(content)
    with pytest.raises(ex.InputError, match="put the file back"):
        given.read(DISK, 0, 500)
