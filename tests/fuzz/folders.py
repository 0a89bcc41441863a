"""Cases of run folders and files of states that someone edited, damaged, or put something else in place of."""

import json
import random
import shutil

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import explorer as ex

from .judge import judge, judge_command

VALUES = (
    None,
    True,
    -1,
    0,
    10**400,
    1e308,
    "x",
    "../../up",
    "/etc/passwd",
    "\0",
    "x" * 5000,
    [],
    [True],
    {},
    [[[[]]]],
    {"file": "../x.parquet"},
    [None] * 3,
    "²",
    float("nan"),
)
COMMANDS = ("status", "verify", "summary", "resume")
PYTHON = "python"  # in place of a command


def small_run(place):
    """A finished run without pictures, to be spoilt."""
    return ex.run("race-angles", out=place, samples=60, chunk_size=30, seed=1, eta_hat="1e-4:1e-2").folder


def _paths(content, path=()):
    """Every place in a JSON value."""
    yield path
    pairs = (
        content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    )
    for key, value in pairs:
        yield from _paths(value, (*path, key))


def edit_json(path, rng):
    """Change, remove or add one value, or damage the text."""
    text = path.read_text(encoding="utf-8")
    if rng.random() < 0.75:
        content = json.loads(text)
        *parents, last = rng.choice([place for place in _paths(content) if place])
        owner = content
        for key in parents:
            owner = owner[key]
        if rng.random() < 0.2:
            del owner[last]
        else:
            owner[last] = rng.choice(VALUES)
        text = json.dumps(content)
    else:
        place = rng.randrange(len(text))
        text = rng.choice(
            (
                text[:place],
                "{}",
                "[]",
                "null",
                "1e999",
                "",
                text[:place] + "\0" + text[place:],
                text.replace('"samples": 60', f'"samples": {"9" * 5000}'),
                '{"identity": {"options": 1}}',
                "\ufeff" + text,
            )
        )
    path.write_text(text, encoding="utf-8")


def replace_by_something(path, rng):
    """Something else in the place of a file."""
    path.unlink()
    if rng.random() < 0.3:
        path.mkdir()
    else:
        path.write_bytes(rng.randbytes(rng.choice((0, 1, 100, 5000))))


def damage(path, rng):
    """Flip, cut or lengthen bytes."""
    content = bytearray(path.read_bytes())
    place = rng.randrange(len(content))
    if rng.random() < 0.5:
        content[place] ^= 1 << rng.randrange(8)
    elif rng.random() < 0.5:
        del content[place:]
    else:
        content[place:place] = rng.randbytes(50)
    path.write_bytes(bytes(content))


def spoil(folder, rng):
    """One fault in a run folder; what was done, in words."""
    records = [folder / "run.json", folder / "summary.json"]
    chunks = sorted((folder / "chunks").glob("*.parquet"))
    what = rng.choices(("json", "something else", "bytes", "missing", "chunks"), (8, 3, 3, 1, 1))[0]
    target = rng.choice(records if what == "json" else [*records, *chunks])
    if what == "json":
        edit_json(target, rng)
    elif what == "something else":
        replace_by_something(target, rng)
    elif what == "bytes":
        damage(target, rng)
    elif what == "missing":
        target.unlink()
    else:
        shutil.rmtree(folder / "chunks")
        if rng.random() < 0.5:
            (folder / "chunks").write_text("a file")
    return f"{what}: {target.name}"


def in_python(folder):
    """Verdict on what a user does with a run in Python."""

    def call():
        run = ex.open(folder)
        _ = run.verify(), run.summary, run.status
        return run.frame().shape

    return judge(call, {})


def run(cases, seed, place):
    """(what was done, words, verdict) of commands, or of Python, on run folders with one fault each."""
    rng, good = random.Random(seed), small_run(place / "good")
    for number in range(cases):
        folder = place / f"{number}"
        shutil.copytree(good, folder)
        done, words = spoil(folder, rng), [rng.choice((*COMMANDS, PYTHON)), str(folder)]
        yield done, words, in_python(folder) if words[0] == PYTHON else judge_command(words)
        shutil.rmtree(folder, ignore_errors=True)


def states_file(path, rng):
    """A file of states that may be damaged, lack what it needs, or be something else."""
    names = ["phi", "phidot", "sigma3", "sigma4"]
    columns = {name: pa.array(np.linspace(-0.5, 0.5, 8)) for name in names}
    what, kind = rng.choice(names), rng.randrange(12)
    odd = {
        0: pa.array(["x"] * 8),
        1: pa.array([None] * 8),
        2: pa.array([1.0, None, np.nan, np.inf, -np.inf, 1e308, 5e-324, 0.0]),
        3: pa.array([True] * 8),
        4: pa.array(list(range(8)), pa.uint64()),
        5: pa.array([[1.0]] * 8),
        6: pa.array([1] * 8, pa.timestamp("ns")),
        7: pa.array([10**30] * 8, pa.decimal128(38)),
        8: pa.array(["a", "b"] * 4).dictionary_encode(),
    }
    if kind in odd:
        columns[what] = odd[kind]
    elif kind == 9:
        del columns[what]
    table = pa.table(columns)
    if kind == 10:
        table = pa.Table.from_arrays([*table.columns, table.column(0)], [*names, what])
    if kind == 11:
        table = table.slice(0, 0)
    if path.suffix == ".csv":
        import pyarrow.csv

        try:
            pyarrow.csv.write_csv(table, path)
        except pa.ArrowException:
            path.write_text("phi,phidot\n1,x\n")
    else:
        pq.write_table(table, path)
    if rng.random() < 0.3:
        damage(path, rng)
    elif rng.random() < 0.2:
        replace_by_something(path, rng)
    return f"column {what}, kind {kind}"


def run_states(cases, seed, place):
    """(what was done, words, verdict) of runs on files of states with a fault."""
    rng = random.Random(seed)
    for number in range(cases):
        path = place / f"{number}{rng.choice(('.parquet', '.csv'))}"
        done = states_file(path, rng)
        words = [
            "run",
            "falling-set",
            "--states",
            str(path),
            "--out",
            str(place / f"out{number}"),
            "--grid",
            "3",
            "--quiet",
        ]
        yield done, words, judge_command(words)
        shutil.rmtree(place / f"out{number}", ignore_errors=True)
