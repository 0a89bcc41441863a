"""Changes one line of the numerical code at a time, and asks the tests whether they notice.

    python tests/faults/mutants.py STORE            # goes on where STORE, a JSON file, ends; Linux
    python tests/faults/mutants.py STORE --again    # those that no test noticed, with the tests of now
    python tests/faults/mutants.py STORE --table    # writes results/faults/mutants.md

Kernels are interpreted, so that no change has to be compiled. Each change is tried in a copy of the project, in a
fork of a process that has loaded all libraries. First the tests beside the changed file are asked about all
changes, then for those that none of these noticed the tests of the room, then those of the rooms above. Asked are
tests that reach the changed function, quick ones first, up to a budget of processor time; what a test reaches, and
how long it takes, is found out when its file is first needed. A change is killed by a test that fails, and by
processor time that grows fivefold.

What nobody noticed is judged by people: a row of STORE may have "judgement", why the change alters no result, or
"gone" where its line is no longer there. Without either it is a change that a claim is missing for.
"""

import argparse
import ast
import builtins
import contextlib
import importlib
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from dataclasses import asdict
from pathlib import Path

import pytest
from changes import NUMERICAL, ROOT, Mutant, changed, drawn

CLAIMS = {
    "kernels": ("tests/kernels", *(f"tests/explorer/{room}" for room in ("phase", "motion", "measure"))),
    "explorer": tuple(f"tests/explorer/{room}" for room in ("phase", "motion", "measure", "portrait", "scenes")),
}
OUT = ROOT / "results" / "faults" / "mutants.md"
STAGES = ("beside", "room", "above")
COUNTS = {"kernels": 200, "explorer": 120}
LONGEST = 1.5  # seconds of processor time; slower tests are not asked
BUDGET = {"beside": 10.0, "room": 6.0, "above": 6.0}  # seconds of processor time for one change
PYTEST = ["-q", "-n0", "-x", "-W", "default", "-p", "no:cacheprovider"]
LIBRARIES = (
    "hypothesis",
    "matplotlib.figure",
    "numba",
    "pandas",
    "pyarrow.parquet",
    "scipy.stats",
    "scipy.integrate",
)


class TooLong(BaseException):
    """A test takes more processor time than it may."""


class Claims:
    """A plugin of pytest: what each test reaches, and how long it takes. A fixture counts for all its users."""

    def __init__(self):
        self.tests, self.fixtures, self.passed = {}, {}, False
        self.reached = builtins._reached = set()

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef):
        before = set(self.reached)
        self.reached.clear()
        try:
            return (yield)
        finally:
            self.fixtures.setdefault(fixturedef.argname, set()).update(self.reached)
            self.reached |= before

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item):
        self.reached.clear()
        self.passed, start = False, time.process_time()
        signal.setitimer(signal.ITIMER_VIRTUAL, LONGEST)
        done = yield
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        if self.passed:
            used = [self.fixtures.get(name, set()) for name in item.fixturenames]
            seconds = round(time.process_time() - start, 3)
            self.tests[item.nodeid] = {"seconds": seconds, "reached": sorted(self.reached.union(*used))}
        return done

    def pytest_runtest_logreport(self, report):
        if report.when == "call":
            self.passed = report.passed


def too_long(number, frame):
    raise TooLong


class Noted(ast.NodeTransformer):
    """Has every function of a file note that it was reached."""

    def __init__(self, file):
        self.within = [file + ":"]

    def _named(self, node):
        self.within.append(node.name)
        self.generic_visit(node)
        if isinstance(node, ast.FunctionDef):
            first = bool(ast.get_docstring(node))
            place = self.within[0] + ".".join(self.within[1:])
            node.body[first:first] = ast.parse(f"_reached.add({place!r})").body
        self.within.pop()
        return node

    visit_FunctionDef = visit_ClassDef = _named


@contextlib.contextmanager
def noted(layer):
    """The numerical files of the copy, whose functions note that they are reached."""
    files = [path for room in NUMERICAL[layer] for path in Path(room).glob("[a-z]*.py")]
    texts = {path: path.read_text(encoding="utf-8") for path in files}
    for path, text in texts.items():
        tree = Noted(path.as_posix()).visit(ast.parse(text))
        path.write_text(ast.unparse(ast.fix_missing_locations(tree)), encoding="utf-8")
    try:
        yield
    finally:
        for path, text in texts.items():
            path.write_text(text, encoding="utf-8")


def in_a_fork(work, seconds):
    """The exit status of a fork that does `work`; None where its processor time ran out."""
    sys.stdout.flush()
    pid = os.fork()
    if pid == 0:
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 2))
        status = 99
        try:
            with Path(os.devnull).open("w") as nothing:
                os.dup2(nothing.fileno(), 1)
                os.dup2(nothing.fileno(), 2)
            status = int(work())
        finally:
            os._exit(status)
    status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    return status if status >= 0 else None


class Asked:
    """The tests of a layer by their files, what each reaches and how long it takes; kept in a store."""

    def __init__(self, layer, store):
        self.layer, self.store = layer, store.with_suffix(f".{layer}.json")
        self.files = json.loads(self.store.read_text()) if self.store.exists() else {}

    def of(self, file):
        """The tests of a file that pass within their time, with what they reach."""
        if file not in self.files:
            found = Path("found.json")
            found.unlink(missing_ok=True)

            def look():
                signal.signal(signal.SIGVTALRM, too_long)
                watched = Claims()
                pytest.main([*(word for word in PYTEST if word != "-x"), file], plugins=[watched])
                found.write_text(json.dumps(watched.tests))
                return 0

            with noted(self.layer):
                in_a_fork(look, 600.0)
            self.files[file] = json.loads(found.read_text()) if found.exists() else {}
            self.store.write_text(json.dumps(self.files, indent=0))
        return self.files[file]

    def about(self, mutant, stage):
        """Names and seconds of the tests of a stage that reach the changed function, quick ones first."""
        folder, _, name = mutant.file.rpartition("/")
        beside = [f"tests/{folder}/test_{name}"]
        room = [path.as_posix() for path in sorted(Path("tests", folder).glob("test_*.py"))]
        above = [
            path.as_posix() for place in CLAIMS[self.layer] for path in sorted(Path(place).rglob("test_*.py"))
        ]
        files = {"beside": beside, "room": room, "above": above}[stage]
        done = {"beside": [], "room": beside, "above": room}[stage]
        place, spent, chosen = f"{mutant.file}:{mutant.function}", 0.0, {}
        tests = {test: found for file in files if file not in done for test, found in self.of(file).items()}
        for test, found in sorted(tests.items(), key=lambda pair: pair[1]["seconds"]):
            reaches = place in found["reached"] or (stage == "beside" and not mutant.function)
            if reaches and spent + found["seconds"] < BUDGET[stage]:
                chosen[test] = found["seconds"]
                spent += found["seconds"]
        return chosen


def tried(mutant, chosen):
    """Whether one of the tests notices the change: 'killed', 'killed by time' or 'survived'."""
    path = Path(mutant.file)
    before = path.read_text(encoding="utf-8")
    path.write_text(changed(mutant, before), encoding="utf-8")
    try:
        seconds = 5.0 + 5.0 * sum(chosen.values())
        status = in_a_fork(lambda: pytest.main([*PYTEST, *chosen]), seconds) if chosen else 0
    finally:
        path.write_text(before, encoding="utf-8")
    return "survived" if status == 0 else "killed by time" if status is None else "killed"


def loaded(layer):
    """Load what all forks need: libraries, and compiled kernels where it is the explorer that is changed."""
    sys.dont_write_bytecode = True
    os.environ |= {"CI": "1", "PYTHONDONTWRITEBYTECODE": "1"}  # hypothesis then tries the same examples each time
    if layer == "kernels":
        os.environ |= {"NUMBA_DISABLE_JIT": "1", "NUMBA_CACHE_DIR": tempfile.mkdtemp()}
    for library in LIBRARIES:
        importlib.import_module(library)
    if layer == "explorer":
        for path in sorted(Path("kernels").rglob("[a-z]*.py")):
            importlib.import_module(".".join(path.with_suffix("").parts))
        for kernel in importlib.import_module("kernels._jit").KERNELS.values():
            if kernel.is_cached():
                kernel.compile()


def rows_of(store, layer, seed):
    """What is known of the changes of a layer, and of all others."""
    done = json.loads(store.read_text()) if store.exists() else []
    if not any(row["file"].startswith(layer) for row in done):
        for mutant in drawn(layer, COUNTS[layer], seed):
            text = (ROOT / mutant.file).read_text(encoding="utf-8")
            lines = [each.splitlines()[mutant.line - 1].strip() for each in (text, changed(mutant, text))]
            done.append({**asdict(mutant), "was": lines[0], "is": lines[1], "result": "survived", "asked": []})
    return done, [row for row in done if row["file"].startswith(layer) and row["result"] == "survived"]


def try_layer(layer, store, seed, again):
    """Try what the store does not know, in a copy of the project."""
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name).resolve() / "copy"
        unneeded = shutil.ignore_patterns(".git", "results", "__pycache__", "build", ".*_cache")
        shutil.copytree(ROOT, copy, ignore=unneeded)
        os.chdir(copy)
        sys.path.insert(0, str(copy))
        loaded(layer)
        asked = Asked(layer, store)
        done, todo = rows_of(store, layer, seed)
        for stage in STAGES:
            for row in todo:
                if row["result"] != "survived" or (stage in row["asked"] and not again):
                    continue
                mutant = Mutant(**{name: row[name] for name in Mutant.__dataclass_fields__})
                row["result"] = tried(mutant, asked.about(mutant, stage))
                row["asked"].append(stage)
                store.write_text(json.dumps(done, indent=1))
                print("{file}:{line}: {result} {asked}: {was}  ->  {is}".format(**row), flush=True)


def table(store):
    """How many changes of each layer were noticed, and what is known of the others."""
    rows = json.loads(store.read_text())
    text = [
        "# Changes of one line, and whether the tests notice",
        "",
        "Made by `python tests/faults/mutants.py STORE --table`. At random places of the numerical code one",
        "operator, comparison, constant, sign or term was changed, one at a time. Kernels were interpreted. A",
        "change whose line was rewritten before it was noticed is gone. What alters no result cannot be noticed.",
        "",
        "| layer | changes | noticed | gone | alter no result | not noticed |",
        "|---|---|---|---|---|---|",
    ]
    for layer in CLAIMS:
        of = [row for row in rows if row["file"].startswith(layer)]
        left = [row for row in of if row["result"] == "survived"]
        judged = Counter(judgement(row) for row in left)
        gone, missing = judged["gone"], judged["a claim is missing"]
        counts = (layer, len(of), len(of) - len(left), gone, len(left) - gone - missing, missing)
        text.append("| " + " | ".join(map(str, counts)) + " |")
    text += ["", "Those that were not noticed:", "", "| where | was | is | why |", "|---|---|---|---|"]
    for row in sorted((row for row in rows if row["result"] == "survived"), key=lambda row: row["file"]):
        if judgement(row) != "gone":
            lines = (f"`{row[name]}`".replace("|", "\\|") for name in ("was", "is"))
            cells = (f"{row['file']}, {row['function'] or 'constants'}", *lines, judgement(row))
            text.append("| " + " | ".join(cells) + " |")
    OUT.write_text("\n".join(text) + "\n", encoding="utf-8")


def judgement(row):
    """Why nobody noticed a change."""
    return row.get("judgement", "a claim is missing")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("store", type=Path)
    parser.add_argument("--layer", choices=CLAIMS, action="append")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--table", action="store_true")
    given = parser.parse_args()
    if given.table:
        table(given.store)
        return
    for layer in given.layer or CLAIMS:  # each in a process of its own, where kernels are interpreted or compiled
        pid = os.fork()
        if pid == 0:
            try_layer(layer, given.store.resolve(), given.seed, given.again)
            os._exit(0)
        os.waitpid(pid, 0)
    rows = json.loads(given.store.read_text())
    print(Counter((row["file"].split("/")[0], row["result"]) for row in rows))


if __name__ == "__main__":
    sys.exit(main())
