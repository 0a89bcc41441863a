"""Chunks with rightful checksums whose content is not what the scene stores are refused by all who read them."""

import json
import time

import numpy as np
import pyarrow as pa
import pytest
from fuzz.forged import ROWS, TYPES, forge, refilled, retyped

import explorer as ex
from explorer.commands.main import main
from explorer.phase.results import to_arrow
from explorer.runs import schema, store
from explorer.runs.inspect import status, verify


def refused(run, path):
    """Every reader of rows and counts names the chunk, in a sentence, with the remedy."""
    opened = ex.open(run.folder)
    for read in (opened.arrow, lambda: list(opened.tables(["race_angle"]))):
        with pytest.raises(ex.RunError) as caught:
            read()
        said = str(caught.value)
        assert path.name in said
        assert ".resume()" in said
        assert len(said) <= 300
        assert "\n" not in said
    (fault,) = verify(run.folder)
    assert fault.startswith(f"{path.name}: ")
    return fault


def refuses_to_count(run, path, capsys):
    """As `refused`, by those who read counts only."""
    capsys.readouterr()
    assert main(["summary", str(run.folder)]) == 2
    said = capsys.readouterr().err
    assert path.name in said
    assert len(said.splitlines()) == 1
    assert len(said) <= 330
    (fault,) = verify(run.folder)
    assert fault.startswith(f"{path.name}: ")
    return fault


@pytest.mark.parametrize("kind", TYPES)
def test_a_column_of_another_type_is_refused(finished, kind):
    path = forge(finished.folder, 1, retyped("race_angle", kind))
    fault = refused(finished, path)
    assert "race_angle" in fault


@pytest.mark.parametrize("kind", ["whole", "text", "words"])
def test_statuses_are_words_that_are_known(finished, kind):
    path = forge(finished.folder, 1, retyped("status", kind))
    fault = refused(finished, path) if kind != "words" else verify(finished.folder)[0]
    assert "status" in fault or "nonsense" in fault
    with pytest.raises(ex.RunError, match=r"status|nonsense"):
        finished.arrow()


@pytest.mark.parametrize("what", ROWS)
def test_other_columns_and_other_rows_are_refused(finished, what):
    refused(finished, forge(finished.folder, 1, ROWS[what]))


@pytest.mark.parametrize(("name", "value"), [("wrong_way", -5), ("plus", 10**400), ("energy", [])])
def test_counts_that_are_none_are_refused(finished, name, value, capsys):
    path = forge(finished.folder, 1, said=lambda note: note["tally"].update({name: value}))
    refuses_to_count(finished, path, capsys)
    assert status(finished.folder).chunks_done == 4


@pytest.mark.parametrize(
    "change",
    [
        lambda note: note.update(samples=10**15),
        lambda note: note.update(index=3),
        lambda note: note["tally"]["status"].update(ok=10**18),
        lambda note: note["tally"].update(status={"ok": 1}),
        lambda note: note["tally"].update(more=1),
        lambda note: note["tally"].pop("decades"),
        lambda note: note["tally"]["plus"].update(bins=[10**9], counts=[1]),
        lambda note: note["tally"]["energy"].update(first=10**6),
        lambda note: note["tally"]["energy"].update(zeros=-1),
        lambda note: note["tally"]["energy"].update(range=[float("nan"), 1.0]),
        lambda note: note["tally"]["decades"].update({"9" * 5000: {}}),
        lambda note: note["tally"]["plus"].update(sum=float("inf")),
    ],
)
def test_a_footer_that_says_more_than_can_be_is_refused(finished, change, capsys):
    refuses_to_count(finished, forge(finished.folder, 1, said=change), capsys)


def test_a_number_that_is_missing_is_found_by_verify_alone(finished):
    """Whoever wrote it made all digests anew."""
    note = store.read_note(store.found_chunks(finished.folder)[1])
    rows = dict(store.read_chunk(store.found_chunks(finished.folder)[1]))
    rows["race_angle"] = np.full(note.samples, np.nan)

    def signed(said):
        said["digest"] = store.digest_of(rows, note.tally)

    path = forge(finished.folder, 1, refilled("race_angle", float("nan")), signed)
    assert verify(finished.folder) == [f"{path.name}: column 'race_angle' is not finite in a row with status ok"]
    assert ex.open(finished.folder).arrow().num_rows == 3000


ABSURD = {
    "theta_min": (-0.1, 1.6, 1e308),
    "duration": (-1e-9, 1.7e308),
    "error_estimate": (-1e-9, 2.0),
    "race_angle": (1e17, -1.7e308),
    "delta_chi": (-1e300,),
    "phidot": (1e151,),
    "face": (2, -100),
}


@pytest.mark.parametrize(
    ("name", "value"), [(name, value) for name, several in ABSURD.items() for value in several]
)
def test_a_number_that_no_passage_has_is_found_by_verify(name, value, finished):
    """Though it is finite, and whoever wrote it made all digests anew."""
    note = store.read_note(store.found_chunks(finished.folder)[1])
    rows = dict(store.read_chunk(store.found_chunks(finished.folder)[1]))
    rows[name] = rows[name].copy()
    rows[name][-1] = value

    def signed(said):
        said["digest"] = store.digest_of(rows, note.tally)

    def last(table):
        place = table.column_names.index(name)
        return table.set_column(place, table.schema.field(name), pa.array(rows[name]))

    path = forge(finished.folder, 1, last, signed)
    (fault,) = verify(finished.folder)
    assert fault.startswith(f"{path.name}: column {name!r} holds {value:g} in a row with status ok, not ")


@pytest.mark.parametrize("disk", ["uniform", "uniform:m=1e-9,r=1e-6,g=1e9", "hoop:m=1e9,r=1e6,g=1e-9"])
def test_right_rows_are_within_their_ends_whatever_the_units(disk, tmp_path):
    """Extreme states that are given, and what scenes draw by themselves; every column of every scene."""
    body, rng = ex.Disk.parse(disk), np.random.default_rng(5)
    sizes = body.rate_unit * rng.choice([-1.0, 1.0], (3, 2000)) * 10.0 ** rng.uniform(-30.0, 30.0, (3, 2000))
    states = ex.phi_to_states(body, rng.uniform(-1.57, 1.57, 2000), *sizes)
    drawn = {"samples": 2000, "keep": "all"}
    asked = [
        ("race-angles", {"eta_hat": (1e-100 * body.rate_unit, 10.0 * body.rate_unit), **drawn}),
        ("race-angles", {"states": states, "keep": "all"}),
        ("falling-set", {"theta_min": "all", **drawn}),
        ("falling-set", {"states": states, "theta_min": "all", "keep": "all"}),
        ("measure-zero", {**drawn, "samples": 300, "tube": 512}),
        ("one-sided", {"samples": 4}),
        ("portrait", {}),
    ]
    for number, (name, options) in enumerate(asked):
        run = ex.run(name, disk=disk, out=tmp_path / str(number), figures=False, **options)
        assert verify(run.folder) == []


def test_other_rows_than_the_digest_is_of_are_found(finished):
    path = forge(finished.folder, 1, refilled("race_angle", 0.5))
    assert verify(finished.folder) == [f"{path.name}: its rows and counts have another digest than it says"]


def test_resume_computes_anew_what_was_forged(finished, capsys):
    before = store.found_chunks(finished.folder)[1].read_bytes()
    forge(finished.folder, 1, ROWS["no rows"])
    forge(finished.folder, 3, said=lambda note: note["tally"].update(wrong_way=-1))
    assert len(verify(finished.folder)) == 2
    assert main(["resume", str(finished.folder), "--no-figures"]) == 0
    assert "it holds 0 rows, not 700" in capsys.readouterr().err
    assert verify(finished.folder) == []
    assert store.found_chunks(finished.folder)[1].read_bytes() == before


def test_two_chunks_of_one_number_are_refused_and_computed_anew(finished, capsys):
    path = store.found_chunks(finished.folder)[3]
    content = path.read_bytes()
    other = forge(finished.folder, 3, said=lambda note: None)
    path.write_bytes(content)
    assert store.all_chunks(finished.folder)[3] == sorted([path, other])
    with pytest.raises(ex.RunError, match="holds two of chunk 3"):
        finished.arrow()
    assert {fault.split(":")[1] for fault in verify(finished.folder)} == {
        " is no chunk of this run, or there are two of its number"
    }
    assert main(["resume", str(finished.folder), "--no-figures"]) == 0
    assert "both are put aside" in capsys.readouterr().err
    assert verify(finished.folder) == []


def test_a_scene_that_makes_what_readers_refuse_is_told_so(monkeypatch):
    from explorer.scenes.race_angles import RaceAngles

    process = RaceAngles.process

    def with_more(self, index):
        rows, tally = process(self, index)
        return {**rows, "more": np.zeros(1)}, tally

    monkeypatch.setattr(RaceAngles, "process", with_more)
    with pytest.raises(ex.RunError, match="race-angles made what cannot be stored"):
        ex.run("race-angles", samples=10, eta_hat="1e-4:1e-2", keep="all")


def test_own_columns_may_be_of_other_types_in_other_chunks(tmp_path):
    """Whole numbers of which one is missing come as doubles."""
    import pyarrow.parquet as pq

    columns = {name: np.linspace(0.1, 0.5, 8) for name in ("phi", "phidot", "sigma3", "sigma4")}
    table = pa.table({**columns, "own": pa.array([1, 2, 3, 4, 5, None, 7, 8])})
    pq.write_table(table, tmp_path / "states.parquet", row_group_size=4)
    how = {"chunk_size": 4, "keep": "all", "out": tmp_path / "run", "figures": False}
    run = ex.run("falling-set", states=tmp_path / "states.parquet", **how)
    assert verify(run.folder) == []
    assert run.arrow(["own"])["own"].to_pylist()[:2] == [1.0, 2.0]
    assert json.loads((run.folder / "summary.json").read_text())["samples"] == 8


def test_what_unpacks_to_far_more_than_is_stored_is_refused_unread(finished, monkeypatch):
    """A Parquet bomb: a few kilobytes of which a reader would make gigabytes. Here one column is packed."""
    path, place = store.found_chunks(finished.folder)[1], schema.Place(finished.scene, 1)
    note, rows = store.read_note(path), store.read_chunk(path)
    packed = to_arrow({**rows, "race_angle": np.full(note.samples, 0.5)})
    bomb = store.write_chunk(finished.folder, note, packed)
    assert store.read_chunk(bomb, None, place)["race_angle"].size == note.samples
    monkeypatch.setattr(schema, "_SMALL", 0)
    monkeypatch.setattr(schema, "_DENSEST", 1)
    monkeypatch.setattr(store, "_rows", lambda *_: pytest.fail("it was unpacked"))
    for read in (store.read_note, lambda path, place: store.read_chunk(path, None, place)):
        with pytest.raises(ex.RunError, match=r"its columns unpack to .* bytes; .* is the most that is read"):
            read(bomb, place)


def test_very_many_columns_are_refused_at_once(finished):
    wide = pa.table({f"x{i}": pa.array([0.5]) for i in range(5_000)})
    path = forge(finished.folder, 2, lambda _: wide)
    begun = time.process_time()
    with pytest.raises(ex.RunError, match="is missing"):
        store.read_chunk(path, None, schema.Place(finished.scene, 2))
    assert time.process_time() - begun < 5.0


def test_columns_of_a_run_are_looked_at_once_and_those_that_differ_again(finished, monkeypatch):
    looked = []
    check = schema.check_columns
    monkeypatch.setattr(schema, "check_columns", lambda *each: looked.append(each) or check(*each))
    assert verify(finished.folder) == []
    assert len(looked) == 1
    path = forge(finished.folder, 3, retyped("race_angle", "single"))
    looked.clear()
    (fault,) = verify(finished.folder)
    assert fault.startswith(f"{path.name}: column 'race_angle' holds float32")
    assert len(looked) == 2
