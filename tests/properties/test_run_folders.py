"""A run folder that was edited is found out and mended, or reads the same: never silently other numbers."""

import json
import shutil

import pytest
from hypothesis import given
from hypothesis import strategies as st

import explorer as ex
from properties.strategies import examples

FILES = ("chunk 0", "chunk 1", "run.json", "summary.json")
VALUES = (None, True, -1, 0, 1, 31, 1e308, "x", "../../up", "x" * 500, [], [True], {}, "uniform", "dopri5", 1e-5)
places = st.integers(0, 10**6)  # modulo the size of a file, or the number of values in it


@st.composite
def edits(draw):
    """What is done to which file, and where in it."""
    how = draw(st.sampled_from(["flip", "cut", "remove", "rename", "swap", "other value"]))
    files = {"other value": FILES[2:], "swap": FILES[:2]}.get(how, FILES)
    return how, draw(st.sampled_from(files)), draw(places), draw(st.sampled_from(VALUES))


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A finished run, and another of other samples."""
    asked = {"samples": 64, "chunk_size": 32, "eta_hat": "1e-4:1e-2", "keep": "all", "figures": False}
    place = tmp_path_factory.mktemp("runs")
    return [ex.run("race-angles", out=place / f"{seed}", seed=seed, **asked) for seed in (1, 2)]


def file_of(folder, name):
    if name.startswith("chunk"):
        return next(folder.glob(f"chunks/chunk-00000{name[-1]}-*.parquet"), None)
    return folder / name if (folder / name).exists() else None


def owners(content):
    """Every place in a JSON value, as what holds it and under which key."""
    for key, value in list(content.items() if isinstance(content, dict) else enumerate(content)):
        yield content, key
        yield from owners(value) if isinstance(value, dict | list) else ()


def edit(folder, other, how, name, place, value):
    path = file_of(folder, name)
    if path is None:  # an edit before this one moved it
        return
    content = bytearray(path.read_bytes())
    place %= max(1, len(content))
    if how == "flip" and content:
        content[place] ^= 1 << place % 8
        path.write_bytes(content)
    elif how == "cut":
        path.write_bytes(content[:place])
    elif how == "remove":
        path.unlink()
    elif how == "rename":
        path.rename(
            path.with_name([f"old-{path.name}", path.name.replace("0", "1"), f"{path.name}.old"][place % 3])
        )
    elif how == "swap":
        shutil.copy(file_of(other, name), path if place % 2 else path.parent)
    elif how == "other value":
        try:
            record = json.loads(content)
        except ValueError:  # an edit before this one cut it
            return
        several = list(owners(record))
        owner, key = several[place % len(several)]
        owner[key] = value
        path.write_text(json.dumps(record))


def test_an_edited_run_is_found_out_and_mended_or_reads_the_same(runs, tmp_path_factory, counts):
    run, other = runs
    rows, numbers = run.arrow(), json.loads(json.dumps(run.summary))
    place = tmp_path_factory.mktemp("edited")

    @examples(0.05)
    @given(st.lists(edits(), min_size=1, max_size=2))
    def claim(several):
        folder = place / "run"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(run.folder, folder)
        for each in several:
            edit(folder, other.folder, *each)
        try:
            found = ex.open(folder)
            faults = found.verify()
            if not faults:
                assert found.arrow().equals(rows)
                assert json.loads(json.dumps(found.summary)) == numbers
            elif found.scene.chunks > 10:  # a number of run.json became a large one
                return
            found.resume(progress=False, figures=False)
        except (ex.InputError, ex.RunError):
            if "run.json" not in [name for _, name, _, _ in several]:
                raise
            counts["run folder"]["refused"] += 1
            return
        assert found.verify() == []
        same = found.options == run.options
        assert not same or (found.arrow().equals(rows) and found.summary["digest"] == numbers["digest"])
        counts["run folder"]["mended" if faults else "read the same"] += 1

    claim()
