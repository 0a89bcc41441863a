"""A scene of a user: everything that ours have follows from its declarations."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from told import said

import explorer as ex
from explorer.scenes import NUMBER, Counts, SampledScene, option
from explorer.scenes import scene as scenes

EXAMPLE = f"{Path(__file__).parents[3] / 'docs' / 'examples' / 'own_scene.py'}:Periods"


@pytest.fixture(autouse=True)
def forgotten(monkeypatch):
    """What a test loads is not known to the next."""
    monkeypatch.setattr(scenes, "_own", {})
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield
    sys.modules.pop("own_scene", None)


def test_its_help_is_that_of_its_fields(capsys):
    status, out, _ = said(capsys, "run", EXAMPLE, "--help")
    text = " ".join(out.split())
    assert status == 0
    assert "How long is a period? Of motions that start at the vertical with speeds below a limit." in text
    assert "--speed X largest speed at the vertical (default 2)" in text
    assert "--samples N" in text
    assert "--ladder" not in text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--speed", "fast"], "speed = fast is not a number"),
        (["--speed", "0.05"], "speed = 0.05 must be a finite number, 0.1 or more"),
        (["--method", "rk4"], "method rk4: periods names no observables"),
        (["--ladder", "1:2"], "--ladder"),
        (["--samples", "0"], "samples = 0"),
    ],
)
def test_its_values_are_checked(words, message, capsys, tmp_path):
    status, _, err = said(capsys, "run", EXAMPLE, *words, "--out", tmp_path / "run")
    assert status == 2
    assert message in err
    assert not (tmp_path / "run").exists()


def test_its_folder_remembers_where_it_came_from(capsys, tmp_path, monkeypatch):
    folder = tmp_path / "run"
    assert said(capsys, "run", EXAMPLE, "--samples", "1e3", "--speed", "2", "--seed", "4", "--out", folder)[0] == 0
    summary = json.loads((folder / "summary.json").read_text())
    assert (summary["speed"], summary["known"]) == (2.0, 1000)
    monkeypatch.setattr(scenes, "_own", {})
    sys.modules.pop("own_scene")
    (chunk,) = (folder / "chunks").glob("*.parquet")
    chunk.unlink()
    assert said(capsys, "verify", folder)[0] == 1
    assert said(capsys, "resume", folder, "--backend", "processes")[0] == 0
    assert json.loads((folder / "summary.json").read_text()) == summary
    field = ex.open(folder).arrow().schema.field("period")
    assert field.metadata[b"unit"] == b"time"


def test_status_and_verify_do_without_its_file_and_say_where_it_was_changed(capsys, tmp_path):
    file, folder = tmp_path / "own_scene.py", tmp_path / "run"
    file.write_text(Path(EXAMPLE.removesuffix(":Periods")).read_text())
    assert said(capsys, "run", f"{file}:Periods", "--samples", "100", "--out", folder, "--no-figures")[0] == 0
    moved = file.rename(tmp_path / "moved.py")
    assert said(capsys, "status", folder)[0] == 0
    assert said(capsys, "verify", folder)[:2] == (0, "intact\n")
    file.write_text(moved.read_text() + "raise SystemExit('nobody runs this')\n")
    status, out, _ = said(capsys, "verify", folder)
    assert status == 1
    assert out.strip() == (
        f"run.json: {file}:Periods was changed since; put that file back as it was to resume the run, or replace "
        "the run"
    )


def test_it_may_be_named_in_a_scene_file_with_its_own_options(capsys, tmp_path):
    (tmp_path / "scene.toml").write_text(f"scene = '{EXAMPLE}'\nspeed = 3\nsamples = 10\n")
    status, out, _ = said(capsys, "run", tmp_path / "scene.toml", "--out", tmp_path / "run", "--json", "--quiet")
    assert status == 0
    assert json.loads(out)["speed"] == 3.0


def test_a_plan_does_not_invent_a_method(capsys):
    assert said(capsys, "plan", EXAMPLE, "--samples", "100")[0] == 0


def test_what_is_no_scene_is_refused(capsys, tmp_path):
    class Named(SampledScene):
        name = "race-angles"

    for wrong, message in ((3, "is no scene"), (Named, "is a scene of nearflat")):
        with pytest.raises(ex.InputError, match=message):
            ex.register(wrong)
    for words, message in (
        (f"{tmp_path}/none.py:Scene", "there is no file"),
        (EXAMPLE.replace("Periods", "Preiods"), "known: Periods"),
        (EXAMPLE.removesuffix(":Periods"), "name its class too"),
    ):
        status, _, err = said(capsys, "run", words)
        assert status == 2
        assert message in err


class HeadCounts(Counts):
    heads: int


class Coins(SampledScene):
    """How often does a coin show heads?"""

    tally = HeadCounts

    def draw(self, random, count):
        return {"heads": random.random(count) < 0.5}

    def observe(self, drawn):
        return {**drawn, "status": 0 * drawn["heads"].astype("i1")}

    def count(self, tally, table):
        tally.heads += int(table["heads"].sum())

    def summarise(self, tally):
        return {"share": tally.heads / self.samples}


def test_a_class_is_a_scene_of_python_and_its_runs_add_up():
    runs = [ex.run(Coins, samples=3000, rng=seed, chunk_size=700) for seed in (1, 2)]
    assert 0.45 < runs[0].summary["share"] < 0.55
    both = ex.merge(*runs)
    assert both.summary["share"] == pytest.approx(sum(run.summary["share"] for run in runs) / 2)
    assert ex.run("coins", samples=3000, seed=1, chunk_size=700).summary["share"] == runs[0].summary["share"]


class DictCounts(Counts):
    faces: dict


class WithoutDraw(SampledScene):
    observe = Coins.observe


class WithDict(Coins):
    tally = DictCounts


class WithoutTally(Coins):
    tally = dict


class Seeded(Coins):
    seed: float = option(NUMBER, "a seed of its own", default=1.0)


class Parallel(Coins):
    jobs: float = option(NUMBER, "jobs of its own", default=1.0)


class Named(Coins):
    scene: float = option(NUMBER, "a scene of its own", default=1.0)


class Bare(Coins):
    bias: float = 0.5


class PlainCounts(Counts):
    heads = 0


class WithPlain(Coins):
    tally = PlainCounts


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        (Named, "scene is the name of something that every scene has"),
        (Bare, r"bias is no option yet; write bias: ... = option\(...\)"),
        (WithPlain, "PlainCounts gives heads a value; declare what it counts, as heads: int"),
        (WithoutDraw, r"WithoutDraw: has no method draw; a scene offers draw\(random, count\)"),
        (WithDict, r"DictCounts declares faces as dict, which does not add up; declare int, .*ByName"),
        (WithoutTally, "give a class derived from explorer.scenes.Counts"),
        (Seeded, "seed is the name of something that every scene has"),
        (Parallel, "jobs is a setting of runs"),
    ],
)
def test_a_wrong_declaration_is_refused_in_a_sentence(kind, message):
    with pytest.raises(ex.InputError, match=message):
        ex.run(kind, samples=10)


def test_statuses_and_numbers_of_any_kind_can_be_stored(tmp_path):
    class Odd(Coins):
        def observe(self, drawn):
            return {**drawn, "status": np.zeros(drawn["heads"].size, int)}

        def summarise(self, tally):
            return {"none": np.float64("nan"), "many": np.int64(3), "list": np.arange(2)}

    run = ex.run(Odd, samples=100, out=tmp_path / "run")
    assert run.verify() == []
    assert [run.summary[name] for name in ("none", "many", "list")] == [None, 3, [0, 1]]
    assert json.loads((tmp_path / "run" / "summary.json").read_text()) == run.summary


def test_sums_of_numpy_are_counts_and_a_scene_that_draws_too_few_is_refused():
    class Summed(Coins):
        def count(self, tally, table):
            tally.heads += table["heads"].sum()

    class Few(Coins):
        def draw(self, random, count):
            return {"heads": random.random(3) < 0.5}

    assert ex.run(Summed, samples=100).summary["share"] == ex.run(Coins, samples=100).summary["share"]
    with pytest.raises(ex.RunError, match="few: `draw` gives 3 values of heads for 100 samples"):
        ex.run(Few, samples=100)


def test_a_table_without_a_status_is_refused_in_a_sentence():
    class Silent(Coins):
        def observe(self, drawn):
            return drawn

    with pytest.raises(ex.RunError, match="silent: `observe` gives no column `status`"):
        ex.run(Silent, samples=100)


def test_columns_of_several_lengths_are_refused_with_their_lengths():
    class Short(Coins):
        def observe(self, drawn):
            return {**super().observe(drawn), "less": drawn["heads"][:-1]}

    with pytest.raises(ex.RunError, match=r"of several shapes \(heads \(100,\), status \(100,\), less \(99,\)\)"):
        ex.run(Short, samples=100)
