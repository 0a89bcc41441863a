"""`nearflat columns`: every column of every scene has a meaning, and every status a remedy."""

import json

import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer import compiled
from explorer.commands.main import main
from explorer.phase.columns import COLUMNS
from explorer.scenes.scene import NAMES, scene_class


def said(capsys, *words):
    assert main(["columns", *words]) == 0
    return capsys.readouterr().out


def test_all_columns_and_statuses_are_listed(capsys):
    text = said(capsys)
    assert all(f"\n{name} [" in text for name in COLUMNS)
    assert all(f"\n{code.name.lower()} ({int(code)})" in text for code in compiled.status.Status)
    assert "race_angle [rad, eq. (7.9)]\n    delta_chi minus fall_angle" in text


@pytest.mark.parametrize("scene", NAMES)
def test_a_scene_lists_what_it_stores(scene, capsys):
    """All that is there for every row; what depends on options, `row` for instance, may come beside it."""
    small = {
        "race-angles": SMALL_RACES,
        "falling-set": {"samples": 50},
        "measure-zero": {"samples": 500, "tube": 64},
        "one-sided": {"samples": 1, "disk": "hoop"},
    }[scene]
    table, _ = scene_class(scene).of({"keep": "all", **small} if scene != "one-sided" else small).chunk(0)
    listed = json.loads(said(capsys, scene, "--json"))["columns"]
    assert set(listed) == set(table)
    assert all(each["meaning"] for each in listed.values())


def test_an_unknown_scene_is_refused_with_the_nearest_name(capsys):
    assert main(["columns", "race-angel"]) == 2
    assert "did you mean 'race-angles'?" in capsys.readouterr().err


def test_chunks_carry_the_same_texts_and_statuses_by_name(tmp_path):
    """Whoever opens a chunk with another program finds them there."""
    import pyarrow.parquet as pq

    run = ex.run("race-angles", out=tmp_path / "run", **SMALL_RACES)
    chunk = pq.read_table(sorted((run.folder / "chunks").glob("*.parquet"))[0])
    for name in chunk.column_names:
        assert chunk.schema.field(name).metadata[b"meaning"].decode() == COLUMNS[name].meaning
    assert set(chunk["status"].to_pylist()) == {"ok"}
    assert next(iter(run.tables()))["status"].dtype == "int8"


@pytest.mark.parametrize("scene", ["race-angles", "falling-set"])
def test_columns_of_given_states_are_listed_too(scene, capsys):
    given = {"phi": [0.1], "phidot": [1.0], "sigma3": [1.0], "sigma4": [0.5], "batch": ["a"]}
    table, _ = scene_class(scene).of({"states": given, "keep": "all"}).chunk(0)
    listed = json.loads(said(capsys, scene, "--json"))
    assert set(table) - {"batch"} == {*listed["columns_with_given_states"], *listed["columns"]}
    text = said(capsys, scene)
    assert "your own columns" in text
    assert "\nstatus [name]\n" in text
