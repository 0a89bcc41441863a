"""Changes one line of the numerical code at a time, and asks the tests whether they notice.

    python tests/faults/mutants.py STORE            # goes on where STORE, a JSON file, ends; Linux
    python tests/faults/mutants.py STORE --again    # those that no test noticed, with the tests of now
    python tests/faults/mutants.py STORE --table    # writes results/faults/mutants.md
    python tests/faults/mutants.py STORE --before CHECKOUT    # the same changes here and in an older checkout

Kernels are interpreted, so that no change has to be compiled. Each change is tried in a copy of the project, in a
fork of a process that has loaded all libraries. First the tests beside the changed file are asked about all
changes, then for those that none of these noticed the tests of the room, then those of the rooms above. Asked are
tests that reach the changed function, quick ones first, up to a budget of processor time; what a test reaches, and
how long it takes, is found out when its file is first needed. A change is killed by a test that fails, and by
processor time that grows fivefold.

What nobody noticed is judged by people: a row of STORE may have "judgement", why the change alters no result, or
"gone" where its line is no longer there. Without either it is a change that a claim is missing for.

With --before, tokens of `explorer/runs` and `explorer/scenes` are changed, one at a time and on lines that both
checkouts have; all tests of these rooms are asked in each, compiled, in processes of their own. A row with a
"judgement" is shown and not counted, and another change takes its place: so many are counted as --count says.
"""

import argparse
import ast
import builtins
import compileall
import contextlib
import importlib
import json
import os
import py_compile
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import asdict
from pathlib import Path

import pytest
from changes import NUMERICAL, ROOT, Mutant, changed, drawn, moved, shared

CLAIMS = {
    "kernels": ("tests/kernels", *(f"tests/explorer/{room}" for room in ("phase", "motion", "measure"))),
    "explorer": tuple(f"tests/explorer/{room}" for room in ("phase", "motion", "measure", "scenes")),
}
OUT = ROOT / "results" / "faults" / "mutants.md"
STAGES = ("beside", "room", "above")
COUNTS = {"kernels": 200, "explorer": 120}
LONGEST = 1.5  # seconds of processor time; slower tests are not asked
BUDGET = {"beside": 10.0, "room": 6.0, "above": 6.0}  # seconds of processor time for one change
PYTEST = ["-q", "-n0", "-x", "-W", "default", "-p", "no:cacheprovider"]
OF_APPLICATION = ("tests/explorer/runs", "tests/explorer/scenes", "tests/properties")
UNNEEDED = shutil.ignore_patterns(".git", "results", "__pycache__", "build", ".*_cache", ".hypothesis")
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
        jit = importlib.import_module("kernels._jit")
        for name in jit.cached_names():
            jit.KERNELS[name].compile()


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
        shutil.copytree(ROOT, copy, ignore=UNNEEDED)
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


def ask_all(copy, seconds, first=()):
    """Whether a test of the application fails in a copy of a checkout, and how long that took; None: too long."""
    environment = {**os.environ, "PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1", "CI": "1"}
    where = [sys.executable, "-c", "import explorer, kernels; print(explorer.__file__, kernels.__file__)"]
    files = subprocess.run(where, cwd="/", env=environment, capture_output=True, text=True, check=False).stdout
    assert not files or all(file.startswith(f"{copy}/") for file in files.split())  # what is changed is what runs
    commands = sorted(
        path.relative_to(copy).as_posix() for path in copy.glob("tests/explorer/commands/test_run*.py")
    )
    asked = [place for place in (*first, *commands, *OF_APPLICATION) if (copy / place).exists()]
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *asked]
    start = time.monotonic()
    with subprocess.Popen(
        command,
        cwd=copy,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as tests:
        try:
            failed = tests.wait(seconds) != 0
        except subprocess.TimeoutExpired:
            failed = None
        with contextlib.suppress(ProcessLookupError):
            os.killpg(tests.pid, signal.SIGKILL)
    return failed, time.monotonic() - start


def compare(store, before, count, seed):
    """Try the same changes in an older checkout and here, and print a table of what became of them."""
    rows = json.loads(store.read_text()) if store.exists() else []
    known = {(row["file"], row["line"], row["start"], row["new"]): row for row in rows}
    with tempfile.TemporaryDirectory() as name:
        copies = {when: Path(name).resolve() / when for when in ("before", "after")}
        limits = {}
        for (when, copy), root in zip(copies.items(), (before, ROOT), strict=True):
            shutil.copytree(root, copy, ignore=UNNEEDED)
            # By hashes, since a change within a second may leave time and size of a file as they were.
            by_hash = py_compile.PycInvalidationMode.CHECKED_HASH
            compileall.compile_dir(copy, quiet=2, invalidation_mode=by_hash)
            failed, seconds = ask_all(copy, 3600.0)
            if failed is not False:
                raise SystemExit(f"{root}: tests fail there without any change")
            limits[when] = 60.0 + 3.0 * seconds
            print(f"{when}: {seconds:.0f} s without a change", file=sys.stderr, flush=True)
        counted, rows = 0, []
        for mutant in shared(before, 10 * count, seed):
            if counted == count:
                break
            texts = {when: (copy / mutant.file).read_text(encoding="utf-8") for when, copy in copies.items()}
            row = known.get((mutant.file, mutant.line, mutant.start, mutant.new))
            if row is None:
                lines = [
                    text.splitlines()[mutant.line - 1].strip()
                    for text in (texts["after"], changed(mutant, texts["after"]))
                ]
                row = {**asdict(mutant), "was": lines[0], "is": lines[1]}
                folder, _, file = mutant.file.rpartition("/")
                for when, copy in copies.items():
                    there = changed(moved(mutant, texts["after"], texts[when]), texts[when])
                    (copy / mutant.file).write_text(there, encoding="utf-8")
                    failed, _ = ask_all(copy, limits[when], [f"tests/{folder}/test_{file}"])
                    row[when] = {True: "killed", False: "survived", None: "killed by time"}[failed]
                    (copy / mutant.file).write_text(texts[when], encoding="utf-8")
            rows.append(row)
            counted += "judgement" not in row
            store.write_text(json.dumps(rows, indent=1))
            print("{file}:{line}: {was}  ->  {is}: {before}, {after}".format(**row), file=sys.stderr, flush=True)
    print("| where | was | is | before | after | not counted, since |", "|---|---|---|---|---|---|", sep="\n")
    for row in rows:
        lines = (f"`{row[name]}`".replace("|", "\\|") for name in ("was", "is"))
        print("|", " | ".join([row["file"], *lines, row["before"], row["after"], row.get("judgement", "")]), "|")
    left = [row for row in rows if "judgement" not in row]
    for when in copies:
        print(f"{when}: {sum(row[when] == 'survived' for row in left)} of {len(left)} survive")


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
    parser.add_argument("--before", type=Path, metavar="CHECKOUT")
    parser.add_argument("--count", type=int, default=20, help="with --before: so many changes are counted")
    given = parser.parse_args()
    if given.table:
        table(given.store)
        return
    if given.before:
        compare(given.store, given.before.resolve(), given.count, given.seed)
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
