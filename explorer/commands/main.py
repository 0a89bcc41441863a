"""The command `nearflat`: parse, call one function, print.

Exit status: 0 done, 1 the run failed, 2 bad arguments, 130 interrupted, 141 where the reader of a pipe has gone.
Results go to stdout, progress and errors to stderr. Nothing heavy is imported before a command
is known: each command is a module of this folder with `add_arguments(parser)` and `call(options)`, which returns
the exit status.
"""

import argparse
import contextlib
import gc
import os
import re
import shlex
import sys
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from types import ModuleType
from typing import Any, NamedTuple, NoReturn, Self

from explorer.errors import InputError, Interrupted, RunError, nearest, shorten, words_of_the_command
from explorer.runs.interrupt import STATUS, as_interrupts, ignore, leave_lost_terminal, was_told
from explorer.version import installed_version


class Command(NamedTuple):
    """A command: what imports its module, what --help says, and the words of an example after its name."""

    load: Callable[[], ModuleType]
    text: str
    example: str


def _runs() -> ModuleType:
    return import_module("explorer.commands.runs")


# Objects after which Python looks for garbage: loading makes many that stay, and to look through them again and
# again is a tenth of the start of a command.
_COLLECTED = 50_000
_PIPE_CLOSED = 141  # as a shell reports a program that SIGPIPE ended
_STORED = "results/race-angles-uniform-0"
COMMANDS = {
    "demo": Command(
        lambda: import_module("explorer.commands.demo"),
        "Do the main job, small: map the falling set, compare the limits, histogram the race.",
        "--jobs 2",
    ),
    "run": Command(
        lambda: import_module("explorer.commands.run"),
        "Run a scene on many initial states and store samples, summary and figures.",
        "race-angles --disk hoop --samples 1e5 --eta-hat 1e-6:1e-2 --out results/races",
    ),
    "status": Command(_runs, "Say how far a stored run is.", _STORED),
    "verify": Command(_runs, "Check every chunk of a stored run; exit status 1 if one is bad.", _STORED),
    "resume": Command(_runs, "Go on with a stored run: compute what is missing or bad, nothing else.", _STORED),
    "summary": Command(_runs, "Add up the numbers of a stored run anew, from its chunks.", _STORED),
    "passage": Command(
        lambda: import_module("explorer.commands.passage"),
        "Compute one passage near flat, from vertical to vertical: race angle, times, limits, forces.",
        "--disk uniform --sigma3-bar 1 --eta-hat -1e-6 --phidot 1 --json",
    ),
    "plan": Command(
        lambda: import_module("explorer.commands.plan"),
        "Say which model and method a run would use, and why, and what it will cost: time, memory, disk.",
        "race-angles --disk hoop --samples 1e7 --jobs 2",
    ),
    "columns": Command(
        lambda: import_module("explorer.commands.columns"),
        "Say what every column of results and stored runs means, and every status.",
        "race-angles",
    ),
    "trade": Command(
        lambda: import_module("explorer.commands.trade"),
        "Measure error and cost of every method on a scene's samples; `--accuracy` and `--method auto` use it.",
        "race-angles --disk hoop --eta-hat 1e-8:1",
    ),
    "paper": Command(
        lambda: import_module("explorer.commands.paper"),
        "Check every statement of the paper, draw its figures, list its misprints; exit status 1 if one fails.",
        "--only LEMMA-5",
    ),
    "portrait": Command(
        lambda: import_module("explorer.commands.portrait"),
        "Draw the disk, its limits, F, phase portraits, slices, races, paths and a film.",
        "--disk hoop --only paths",
    ),
    "view": Command(
        lambda: import_module("explorer.commands.view"),
        "Write one self-contained page in which the disk rolls in 3-D, live, on both sides of F.",
        "--disk hoop --eta-hat -1e-12 --out page.html --open",
    ),
    "gallery": Command(
        lambda: import_module("explorer.commands.gallery"),
        "Write the page of a folder of results: every picture with the command that makes it.",
        "results",
    ),
    "cite": Command(
        lambda: import_module("explorer.commands.cite"), "Print BibTeX of this software and of the paper.", ""
    ),
    "warmup": Command(
        lambda: import_module("explorer.commands.warmup"), "Compile all kernels into the cache.", ""
    ),
}


class _Parser(argparse.ArgumentParser):
    """Errors in one or two lines, without the whole usage; words such as -1e-3 and -1:2 are values, not flags."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def error(self, message: str) -> NoReturn:
        if message.startswith("argument COMMAND: invalid choice"):
            from explorer.scenes.registry import SCENES

            scene = next((name for name in SCENES if f"choice: {name!r}" in message), None)
            if scene is not None:
                message = f"{scene!r} is a scene, not a command; write {self.prog} run {scene}"
        print(f"{self.prog}: {shorten(message, 300)}\nTry '{self.prog} --help'.", file=sys.stderr)
        raise SystemExit(2)


class _CommandParser(_Parser):
    """The parser of one command, which imports its module and adds its arguments when it is first used."""

    def __init__(self, load: Callable[[], ModuleType], **options: Any) -> None:
        super().__init__(conflict_handler="resolve", **options)
        self._load: Callable[[], ModuleType] | None = load

    def loaded(self) -> Self:
        """This parser with the arguments of its command."""
        if self._load is not None:
            family, self._load = self._load(), None
            family.add_arguments(self)
            self.add_argument("--quiet", action="store_true", help="no progress and no notes")
            self.set_defaults(call=family.call)
        return self

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        self.loaded()
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:  # said here, where it is known which command was meant
            self.error(f"unrecognized arguments: {' '.join(unknown)}{self._meant(unknown)}")
        return found, unknown

    def _meant(self, unknown: list[str]) -> str:
        """The options that were probably meant, each beside what was written."""
        words = [word.partition("=")[0].lstrip("-") for word in unknown if word.startswith("-")]
        names = [option.lstrip("-") for option in self._option_string_actions]  # dashes would make all alike
        near = [f"--{name}" for word in words if (name := nearest(word, names))]
        return f"; did you mean {' '.join(near)}?" if near else ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns its exit status."""
    _open_what_is_closed()
    if arguments is None:
        gc.set_threshold(_COLLECTED)
        os.environ["MPLBACKEND"] = "agg"  # no command opens a window; matplotlib fails where it knows no such name
    try:
        with as_interrupts():
            status = _to_the_end(sys.argv[1:] if arguments is None else list(arguments))
    except KeyboardInterrupt:  # before the command began, or after it ended
        status = STATUS
    if arguments is None:
        ignore()
        gc.freeze()  # or Python looks through all that was loaded as it ends: a fifth of a short command
    return status


def _to_the_end(words: list[str]) -> int:
    """Run one command and send all that it printed to whoever reads it."""
    try:
        try:
            with words_of_the_command():
                return _run(words)
        finally:
            sys.stdout.flush()  # here, where a closed pipe can be caught, not at the end of the interpreter
    except BrokenPipeError:
        _close_quietly()
        return _PIPE_CLOSED
    except OSError as error:
        lost = leave_lost_terminal()  # its signal may come later than the error, and nobody is left to tell
        _close_quietly()
        if lost or was_told():
            return STATUS
        print(f"nearflat: cannot be read or written: {error}", file=sys.stderr)
        return 1


def _open_what_is_closed() -> None:
    """Let streams that were closed lead nowhere; else the next file that is opened takes their place."""
    for number, name in ((1, "stdout"), (2, "stderr")):
        if getattr(sys, name) is None:
            place = os.open(os.devnull, os.O_WRONLY)
            if place < number:
                place = os.dup2(place, number)
            setattr(sys, name, os.fdopen(place, "w", encoding="utf-8"))


def _close_quietly() -> None:
    """Send what the streams still hold nowhere: the interpreter would complain about it when it ends."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            with contextlib.suppress(OSError):  # a stream that is no file has nothing to close
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _run(words: list[str]) -> int:
    options = argparse.Namespace(command="")
    try:
        options = _parser().parse_args(words)
        options.command_line = shlex.join(["nearflat", *words])
        if options.arithmetic is not None:
            # Read when the kernels are first loaded, here and in worker processes.
            os.environ["NEARFLAT_ARITHMETIC"] = options.arithmetic
        with warnings.catch_warnings():
            warnings.showwarning = partial(_say_warning, options.command)
            status: int = options.call(options)
        return status
    except Interrupted as error:
        return _complain(options, error, STATUS)
    except KeyboardInterrupt:
        return _interrupted(options)
    except Exception as error:
        if was_told():  # some libraries turn an interrupt into an error of their own
            return _interrupted(options)
        if isinstance(error, InputError | ImportError):
            return _complain(options, error, 2)
        if isinstance(error, RunError):
            return _complain(options, error, 1)
        raise


def _say_warning(command: str, message: Warning | str, *_place: Any) -> None:
    """Print a warning as a sentence, without the place in the code that means nothing to who types a command."""
    print(f"nearflat {command}: {message}", file=sys.stderr)


def _interrupted(options: argparse.Namespace) -> int:
    folder = getattr(options, "out", None) or "DIR"
    hint = f"; finished chunks are kept: nearflat resume {folder} goes on" if options.command == "run" else ""
    return _complain(options, f"interrupted{hint}", STATUS)


def _complain(options: argparse.Namespace, error: object, status: int) -> int:
    print(f"nearflat {options.command}".rstrip() + f": {error}", file=sys.stderr)
    return status


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="nearflat",
        description="Explore the phase space of the rolling disk that nearly falls flat.",
        epilog="example: nearflat demo",
    )
    parser.add_argument(
        "--arithmetic",
        choices=("strict", "relaxed"),
        help="relaxed lets the compiler reorder operations: faster, and the last digits depend on the machine",
    )
    installed = installed_version() or "(not installed)"
    parser.add_argument("--version", action="version", version=f"nearflat {installed}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=_CommandParser)
    for name, (load, text, example) in COMMANDS.items():
        epilog = f"example: nearflat {name} {example}"
        commands.add_parser(name, load=load, help=text, description=text, epilog=epilog)
    return parser


if __name__ == "__main__":
    sys.exit(main())
