"""States that a user gives: what is read, cell by cell, how it is identified, and how damage is told."""

import gzip
import json

import numpy as np
import pandas as pd
import pyarrow
import pyarrow.parquet
import pytest
from told import said

import explorer as ex
from explorer.phase.results import stacked
from explorer.scenes import given_states
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.given_states import GivenStates
from explorer.scenes.scene import scene_of

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
    one, other = (stacked([scene.chunk(index)[0] for index in range(scene.chunks)]) for scene in scenes)
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
        (b"phi,phidot,sigma3,sigma4\nx,1,2,3\ny,1,2,3\n", "column 'phi', row 0 .*x is not a number"),
        (b"phi,phidot,sigma3,sigma4\nNA,1,2,3\n,1,2,3\n", "column 'phi' holds no numbers"),
        (b"\x1f\x8bno gzip", "cannot be read .*; give Parquet or CSV"),
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
        ({name: ["a"] for name in NAMES}, "column 'phi', row 0 .*a is not a number"),
        (dict.fromkeys(NAMES, np.ones((2, 2))), "is no table"),
        (pyarrow.table({name: [[1.0]] if name == "x" else [1.0] for name in (*NAMES, "x")}), "'x' holds list"),
        ({name: [True] for name in NAMES}, "column 'phi', row 0 .*True is not a number"),
        (dict.fromkeys(NAMES, np.array([1], "M8[ns]")), "column 'phi', row 0 .*is not a number"),
        ({key: [None] for key in NAMES}, "column 'phi' holds no numbers"),
        (pd.Series([1.0, 2.0]), "is a column .*, not a row"),
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
    (tmp_path / "some.csv").write_text('tilt,precession,name,spin\n0.1,60,a,1\n0.2,N/A,b,1\n ,-1e-3,"x,y",1\n')
    found, nan = GivenStates.of("states", tmp_path / "some.csv").columns, np.nan
    np.testing.assert_array_equal(found["tilt"], [0.1, 0.2, nan])
    np.testing.assert_array_equal(found["precession"], [60, nan, -1e-3])
    assert found["name"].tolist() == ["a", "b", "x,y"]
    (tmp_path / "some.csv").write_text("tilt,precession,spin\n0.1,60,1\n0.3,1\n")
    with pytest.raises(ex.InputError, match="Row #3: Expected 3 columns, got 2"):
        GivenStates.of("states", tmp_path / "some.csv")


def test_a_cell_of_a_csv_file_is_a_number(tmp_path):
    table = "tilt,precession,spin,y\n1.0D+00,1,1,1_0\n +1e0 ,1,1,3\n\u22121d0,1,1,4\n"
    (tmp_path / "some.csv").write_text(table, encoding="utf-8")
    found = GivenStates.of("states", tmp_path / "some.csv").columns
    np.testing.assert_array_equal(found["tilt"], [1.0, 1.0, -1.0])
    assert found["y"].tolist() == ["1_0", "3", "4"]


@pytest.mark.parametrize("text", ["x", "True", '"1,000"', "12:30", "5 deg"])
def test_a_cell_that_is_no_number_is_named(text, tmp_path):
    (tmp_path / "some.csv").write_text(f"tilt,precession,spin\n1,1,1\n{text},1,1\n2,1,1\n")
    with pytest.raises(ex.InputError, match=f"column 'tilt', row 1 .*{text.strip(chr(34))} is not a number"):
        GivenStates.of("states", tmp_path / "some.csv")


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


@pytest.mark.parametrize("missing", ["", " ", "N/A", "n/a", "#N/A", "NaN", "nan", "NA", "null", "None", "-", None])
def test_a_cell_that_says_that_it_has_no_number_is_nan_and_the_others_are_read(missing):
    given = {"tilt": [missing, "0.5", "2"], "precession": [1, None, 3], "spin": [3.0] * 3}
    found = GivenStates.of("states", given).columns
    np.testing.assert_array_equal(found["tilt"], [np.nan, 0.5, 2.0])
    np.testing.assert_array_equal(found["precession"], [1, np.nan, 3])


TABLE = "tilt,tilt_rate,precession,spin,x\n0.2125,-1.5,620,-380,1.5\n0.175,-80.5,1000,-600,-2\n0.5,0,400,250,3\n"
TABLES = {
    "header of numpy": ("# " + TABLE).encode(),
    "header of numpy after comments": ("# camera 3, 240 fps\n# " + TABLE).encode(),
    "comments": ("# camera 3, 240 fps\n#\n# tilt in rad\n" + TABLE).encode(),
    "header of numpy, spaces": ("# " + TABLE.replace(",", " ")).encode(),
    "tabs and decimal commas": TABLE.replace(",", "\t").replace(".", ",").encode(),
    "semicolons and decimal commas": TABLE.replace(",", ";").replace(".", ",").encode(),
    "semicolons and decimal points": TABLE.replace(",", ";").encode(),
    "minus sign": TABLE.replace("-", "\N{MINUS SIGN}").encode(),
    "UTF-16": TABLE.encode("utf-16"),
    "UTF-16, big-endian": "\ufeff".encode("utf-16-be") + TABLE.encode("utf-16-be"),
    "UTF-8 with a mark, CRLF": TABLE.replace("\n", "\r\n").encode("utf-8-sig"),
    "Latin-1": TABLE.replace(",x", ",°").encode("latin-1"),
    "Fortran": TABLE.replace("\n0.5,", "\n5.0D-01,").encode(),
    "Excel": ("sep=;\n" + TABLE.replace(",", ";").replace(".", ",")).encode(),
    "aligned": TABLE.replace(",", "   ").replace("\n", "  \n  ").encode(),
    "header of numpy before a comment and a blank line": (
        "# " + TABLE.replace("x\n", "x\n# tilt in rad\n\n")
    ).encode(),
    "quoted header after #": (
        '# "'
        + TABLE.replace("x\n", 'x"\n', 1)
        .replace(",t", '","t', 1)
        .replace("e,p", 'e","p')
        .replace("n,s", 'n","s')
        .replace("n,x", 'n","x')
    ).encode(),
    "comments of Matlab": ("% one\n%\n" + TABLE).encode(),
    "comments between rows and after": TABLE.replace("\n0.5", "\n# one, two\n0.5").encode() + b"# end\n",
    "gzip": gzip.compress(TABLE.encode()),
    "gzip of UTF-16": gzip.compress(TABLE.encode("utf-16")),
}


@pytest.mark.parametrize("name", TABLES)
def test_a_csv_file_as_people_have_it_is_read(name, tmp_path):
    (tmp_path / "plain.csv").write_text(TABLE)
    (tmp_path / "some.csv").write_bytes(TABLES[name])
    wanted, found = (GivenStates.of("states", tmp_path / file).columns for file in ("plain.csv", "some.csv"))
    for column in ("tilt", "tilt_rate", "precession", "spin"):
        np.testing.assert_array_equal(found[column], wanted[column])
    if name != "minus sign":  # a column of the user's own stays as it is written
        np.testing.assert_array_equal(*(list(each.values())[-1] for each in (found, wanted)))


def test_lines_of_a_file_with_comments_are_counted_from_its_beginning(tmp_path):
    (tmp_path / "some.csv").write_text("# one\n# two\ntilt,precession,spin\n0.1,60,1\n0.3,1\n")
    with pytest.raises(ex.InputError, match="Row #5: Expected 3 columns, got 2"):
        GivenStates.of("states", tmp_path / "some.csv")


@pytest.mark.parametrize(
    "names",
    [
        "tilt (deg),tilt_rate (deg/s),precession (deg/s),spin (deg/s)",
        "Tilt,Tilt_Rate,Precession,Spin",
        "tilt [rad],tilt rate [rad/s],precession,spin",
        "tilt/rad,tilt_rate/s,precession,spin",
        "tilt_deg,tilt_rate_deg_s,precession,spin",
        "tilt deg,tilt.rate deg/s,precession,spin",
        "tilt.deg,tiltdot,precession,spin",
    ],
)
def test_a_name_with_a_unit_or_capitals_is_understood_in_the_message(names, tmp_path):
    (tmp_path / "some.csv").write_text(f"{names}\n1,2,3,4\n")
    with pytest.raises(ex.InputError, match="did you mean tilt, tilt_rate"):
        GivenStates.of("states", tmp_path / "some.csv")


def test_a_rate_with_a_unit_in_its_name_is_not_left_out_in_silence(tmp_path):
    (tmp_path / "some.csv").write_text("tilt,tilt_rate (deg/s),precession,spin\n1,2,3,4\n")
    with pytest.raises(ex.InputError, match="looks like 'tilt_rate'"):
        GivenStates.of("states", tmp_path / "some.csv")


@pytest.mark.parametrize("name", ["thetadot", "tilt_rate_deg", "tiltdot", "theta_dot", "Phi_dot", "theta"])
def test_another_tilt_or_rate_that_would_be_ignored_is_refused_with_its_remedy(name):
    given = {"tilt": [0.2], name: [5.0], "precession": [3.0], "spin": [1.0]}
    with pytest.raises(ex.InputError, match=f"'{name}' .*rename it"):
        GivenStates.of("states", given)


def test_a_second_tilt_beside_phi_is_refused():
    with pytest.raises(ex.InputError, match=r"'tilt' .* beside phi, .*rename it, or leave it out"):
        GivenStates.of("states", {key: [0.3] for key in (*NAMES, "tilt")})


def test_a_constant_beside_the_others_agrees_with_these_or_is_refused():
    given = {"phidot": [0.3, 0.3], "sigma3_bar": [1.0, 1.2], "eta_hat": [1e-3, 1e-3]}
    states = ex.constants_to_states(DISK, **given)
    for name in ("sigma4_bar", "energy"):
        values = getattr(ex.constants(states), name).copy()
        assert GivenStates.of("states", given | {name: values}).read(DISK, 0, 2).states.ok.all()
        values[1] += 0.1
        with pytest.raises(ex.InputError, match=f"row 1: {name} is by .*leave one set out"):
            GivenStates.of("states", given | {name: values}).read(DISK, 0, 2)


@pytest.mark.parametrize("name", [*NAMES, "energy"])
def test_a_coordinate_or_the_energy_without_the_rest_of_its_set_agrees_with_the_state_or_is_refused(name):
    given = {"tilt": [0.2, 0.3], "precession": [3.0, 3.0], "spin": [1.0, 1.0]}
    states = ex.rates_to_states(DISK, **given)
    values = getattr(states if name in NAMES else ex.constants(states), name).copy()
    assert GivenStates.of("states", given | {name: values}).read(DISK, 0, 2).states.ok.all()
    values[1] += 0.1
    with pytest.raises(ex.InputError, match=f"row 1: {name} is by tilt, .*, by {name} .*leave one set out"):
        GivenStates.of("states", given | {name: values}).read(DISK, 0, 2)


@pytest.mark.parametrize("sign", ["-", "\N{MINUS SIGN}"])
def test_a_point_beside_decimal_commas_is_refused_by_row_column_and_text(sign, tmp_path):
    table = f"tilt;precession;spin\n10,5;600,5;{sign}1,5\n10,5;1.600;1,5\n"
    (tmp_path / "some.csv").write_text(table, encoding="utf-8")
    with pytest.raises(ex.InputError, match=r"column 'precession', row 1 .*1\.600 is not a number where commas"):
        GivenStates.of("states", tmp_path / "some.csv")
    (tmp_path / "some.csv").write_text(table.replace("1.600", "1600"), encoding="utf-8")
    assert GivenStates.of("states", tmp_path / "some.csv").columns["spin"].tolist() == [-1.5, 1.5]


def test_dates_and_versions_do_not_decide_on_the_decimal_point(tmp_path):
    (tmp_path / "some.csv").write_text("date;version;tilt;precession;spin\n01.02.2020;1.2;10,5;600;100\n")
    found = GivenStates.of("states", tmp_path / "some.csv").columns
    assert (found["tilt"][0], found["date"][0]) == (10.5, "01.02.2020")


def test_a_label_that_begins_with_a_hash_is_no_comment(tmp_path):
    (tmp_path / "some.csv").write_text("name,tilt,precession,spin\n#1,0.1,2,3\n#2,0.2,2,3\n")
    assert GivenStates.of("states", tmp_path / "some.csv").columns["name"].tolist() == ["#1", "#2"]


@pytest.mark.parametrize("content", [b"", b"PAR1", b"tilt,precession,spin\n1,2,3\n"])
@pytest.mark.parametrize("name", ["a.parquet", "z.parquet"])
def test_a_file_of_a_folder_that_is_no_parquet_is_named(name, content, columns, tmp_path):
    pyarrow.parquet.write_table(pyarrow.table(columns), tmp_path / "m.parquet")
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ex.InputError, match=rf"{name[0]}\.parquet.*remove it, or write it again"):
        GivenStates.of("states", tmp_path)


def test_a_column_of_a_frame_is_told_from_a_row():
    frame = pd.DataFrame({"tilt": [0.5], "precession": [1.0], "spin": [3.0]}, index=["a"])
    with pytest.raises(ex.InputError, match="is a column of a frame, not a row; give the frame"):
        GivenStates.of("states", frame["tilt"])


def test_rows_without_numbers_are_told_with_their_cells_as_they_are_written(tmp_path, capsys):
    table = "tilt,tilt_rate,precession,spin\n0.2,0,1,1\nN/A,-,n/a,1\n9.0,0,1,1\n0.3,0,1,1\n"
    (tmp_path / "some.csv").write_text(table)
    where = ("--states", tmp_path / "some.csv", "--out", tmp_path / "run")
    status, out, _ = said(capsys, "run", "falling-set", *where, "--no-figures", "--quiet")
    assert status == 0
    assert "row 1 (tilt 'N/A', tilt_rate '-', precession 'n/a'), 2\n" in out
    run = ex.run("falling-set", states={"tilt": [0.2, None], "precession": [1, 1], "spin": [1, 1]})
    assert "row 1 (tilt 'nan')" in run.headline[-1]


def test_a_folder_of_parquet_is_one_table_and_so_are_the_chunks_of_a_run(columns, tmp_path):
    run = ex.run("falling-set", samples=500, keep="all", chunk_size=128, out=tmp_path / "mine", figures=False)
    again = ex.run("falling-set", states=tmp_path / "mine" / "chunks", keep="all", chunk_size=256, jobs=1)
    np.testing.assert_allclose(again.frame()["theta_min"], run.frame()["theta_min"], rtol=1e-9)
    np.testing.assert_array_equal(again.frame()["given_theta_min"], run.frame()["theta_min"])
    assert again.frame()["row"].tolist() == list(range(500))
    for first in range(0, 500, 125):
        part = pyarrow.table(columns).slice(first, 125)
        pyarrow.parquet.write_table(part, tmp_path / f"{first:03}.parquet", row_group_size=50)
    found = GivenStates.of("states", tmp_path)
    expected = ex.phi_to_states(DISK, **columns).natural
    for first, count in ((0, 500), (120, 10), (499, 1)):
        np.testing.assert_array_equal(
            found.read(DISK, first, count).states.natural, expected[:, first : first + count]
        )
    pyarrow.parquet.write_table(part, tmp_path / "500.parquet")
    with pytest.raises(ex.InputError, match="is not the file of states"):
        GivenStates.of("states", found.describe()).read(DISK, 0, 1)
    (tmp_path / "empty").mkdir()
    with pytest.raises(ex.InputError, match="cannot be read"):
        GivenStates.of("states", tmp_path / "empty")


@pytest.mark.parametrize("rows", [500, 100, 900])
@pytest.mark.parametrize("folder", [False, True])
def test_states_are_those_of_the_file_that_the_run_began_with(columns, folder, rows, tmp_path):
    """A file that is replaced while a run reads it piece by piece is refused, whatever it holds."""
    (tmp_path / "states").mkdir()
    path, new = tmp_path / "states" / "a.parquet", tmp_path / "new.parquet"
    pyarrow.parquet.write_table(pyarrow.table(columns), path, row_group_size=100)
    other = {name: np.resize(values[::-1], rows) for name, values in columns.items()}
    pyarrow.parquet.write_table(pyarrow.table(other), new, row_group_size=100)
    found = GivenStates.of("states", path.parent if folder else path)
    assert len(found.read(DISK, 0, 100).states) == 100
    new.replace(path)
    for first in (0, 100, 400):
        with pytest.raises(ex.InputError, match=r"was changed or replaced meanwhile|cannot be read"):
            found.read(DISK, first, 100)


@pytest.mark.parametrize("kind", [float, object])
def test_a_row_of_a_frame_is_a_table_of_one_row(kind):
    frame = pd.DataFrame({"tilt": [0.5, 0.6], "precession": [1.0, 2.0], "spin": [3.0, 4.0]}).astype(kind)
    found = GivenStates.of("states", frame.iloc[1])
    np.testing.assert_array_equal(
        found.read(DISK, 0, 1).states.natural, ex.rates_to_states(DISK, 0.6, 0.0, 2.0, 4.0).natural
    )


def test_every_column_of_a_table_comes_back_and_none_under_a_name_with_another_meaning():
    given = {
        "time": [0.5],
        "tilt": [0.3],
        "precession": [2.0],
        "spin": [1.0],
        "phi": [np.pi / 2 - 0.3],
        "sigma4": [1.0],
        "theta_min": [0.1],
        "given_phi": [4.0],
        "status": ["seen"],
        "row": [17],
        "mass": [5.0],
        "mine": [6.0],
    }
    own = {name: values[0] for name, values in given.items() if name not in ("tilt", "precession", "spin")}
    for scene in ("falling-set", "race-angles"):
        found = ex.run(scene, states=given, keep="all").frame().iloc[0]
        back = {name: found[f"given_{name}"] for name in own if name not in ("phi", "given_phi", "mine")}
        back |= {"phi": found["given_phi"], "given_phi": found["given_given_phi"], "mine": found["mine"]}
        assert back == own
        assert found["phi"] == pytest.approx(np.pi / 2 - 0.3)
        assert (found["tilt"], found["row"], found["sigma4"]) == (0.3, 0, 1.0)


def agreeing(disk, count=50):
    """A table with all coordinates of the same states."""
    random = np.random.default_rng(8)
    tilt, rate = random.uniform(0.1, 1.5, count), random.uniform(-1, 1, count)
    precession, spin = random.uniform(-1, 1, (2, count))
    states = ex.rates_to_states(disk, tilt, rate, precession, spin)
    known = ex.constants(states)
    coordinates = {name: getattr(states, name) for name in NAMES}
    rates = {"tilt": tilt, "tilt_rate": rate, "precession": precession, "spin": spin}
    constants = {"energy": known.energy, "sigma3_bar": known.sigma3_bar, "eta_hat": known.eta_hat_plus}
    return coordinates | rates | constants


@pytest.mark.parametrize("disk", [DISK, ex.Disk.hoop(m=5e-3, r=0.01, g=9.81)], ids=["natural", "SI"])
def test_two_sets_of_coordinates_may_agree_to_the_digits_that_people_keep(disk):
    table = agreeing(disk)
    rounded = {name: [float(f"{value:.4g}") for value in values] for name, values in table.items()}
    mirrored = table | {"phi": -table["phi"], "phidot": -table["phidot"]}
    del mirrored["eta_hat"]  # of face +1
    for given in (table, rounded, mirrored):
        assert (GivenStates.of("states", given).read(disk, 0, 50).states.status == 0).all()


@pytest.mark.parametrize("name", ["tilt", "tilt_rate", "precession", "spin", "energy", "sigma3_bar", "eta_hat"])
def test_two_sets_of_coordinates_that_disagree_are_refused_before_anything_is_written(name, tmp_path):
    table = agreeing(DISK)
    table[name] = table[name].copy()
    table[name][7] += 0.3
    for given in (table, {key: values for key, values in table.items() if key != "tilt_rate" or name == key}):
        with pytest.raises(ex.InputError, match=rf"row 7: (phi|sigma)\w* is by .*, by .*{name}") as told:
            ex.run("falling-set", states=given, out=tmp_path / "run", figures=False)
        assert "phi, phidot, sigma3, sigma4" in str(told.value)
    assert not (tmp_path / "run").exists()


def test_degrees_are_those_of_both_sets_of_coordinates():
    given = {"phi": [60.0], "phidot": [1.0], "sigma3": [2.0], "sigma4": [3.0], "tilt": [30.0], "spin": [3.0]}
    given["precession"] = [2.0 / np.sin(np.radians(30.0)) ** 2]
    assert GivenStates.of("states", given).of_degrees(True).read(DISK, 0, 1).states.ok.all()
    with pytest.raises(ex.InputError, match="row 0: sigma3 is"):
        GivenStates.of("states", given | {"precession": [9.0]}).of_degrees(True).read(DISK, 0, 1)


def test_a_csv_file_that_is_replaced_while_it_is_read_is_refused(tmp_path, monkeypatch):
    table, other = tmp_path / "states.csv", tmp_path / "other.csv"
    for path, speed in ((table, 1.0), (other, 2.0)):
        path.write_text(f"phi,phidot,sigma3,sigma4\n0,{speed},1,0.7\n")
    read = given_states._csv

    def replaced(path, *more):
        other.replace(path)
        return read(path, *more)

    monkeypatch.setattr(given_states, "_csv", replaced)
    with pytest.raises(ex.InputError, match="was changed or replaced meanwhile"):
        GivenStates.of("states", table)


def test_a_result_of_any_shape_is_a_table_of_its_states():
    states = ex.phi_to_states(ex.Disk.uniform(), [[0.1], [0.2]], 1.0, [0.8, 0.9, 1.0], 0.7)
    scanned = ex.scan(states, lambda some: {"mine": np.stack([some.phi, some.sigma3], axis=1), "one": some.phi})
    for found, own in ((scanned, ["mine_0", "mine_1", "one"]), (ex.wander(states), ["shift_x", "shift_y"])):
        table = ex.run("falling-set", states=found, keep="all", progress=False).frame()
        np.testing.assert_array_equal(table["sigma3"], found.to_pandas()["sigma3"])
        assert {name.removeprefix("given_") for name in table} >= {*own}
