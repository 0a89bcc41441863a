"""The command `nearflat`: parse, call one function, print.

Exit status: 0 done, 1 the run failed or a check did not hold, 2 bad arguments, 130 interrupted. Results go to
stdout, progress and errors to stderr. Each command is a module of this folder with `call(options)`, which returns
an `Answer`, and `add_arguments(parser, words)` where it has any; nothing heavy is imported before it is known.
"""

import argparse
import contextlib
import gc
import io
import json
import os
import re
import shlex
import signal
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any, NamedTuple, NoReturn, TextIO

from explorer.errors import (
    InputError,
    Interrupted,
    RunError,
    nearest,
    note,
    printable,
    shorten,
    suggest,
)
from explorer.version import installed_version


class Command(NamedTuple):
    """A command: the module that has it, what help says, and the words of an example after its name."""

    home: str
    text: str
    example: str


# Objects after which Python looks for garbage: loading makes many that stay, and to look through them again and
# again is a tenth of the start of a command.
_COLLECTED = 50_000
_RUN = "race-angles --disk hoop --samples 1e5 --eta-hat 1e-6:1e-2 --out results/races"
_PASSAGE = "--disk uniform --sigma3-bar 1 --eta-hat -1e-6 --phidot 1 --json"
_PLAN, _TRADE = "race-angles --disk hoop --samples 1e7 --jobs 2", "--disk hoop --eta-hat 1e-6:1e-2"
_RARE = "--event theta_min:1e-6 --tilt norm:60:5 --precession norm:0:30 --spin=-30:30 --degrees"
_VIEW = "--disk hoop --eta-hat -1e-12 --out page.html --open"
_STORED = "results/race-angles-uniform-0"
COMMANDS = {
    "demo": Command(
        "demo",
        "Map the falling set, compare its two sides and count races, all on a small scale.",
        "--jobs 2",
    ),
    "run": Command(
        "run",
        "Run a scene (a question about many states), either one of ours or one of your own; store samples, "
        "summary and figures.",
        _RUN,
    ),
    "status": Command("runs", "Say how far a stored run has got.", _STORED),
    "verify": Command("runs", "Check every chunk of a stored run; exit status 1 if one is damaged.", _STORED),
    "resume": Command("runs", "Continue a stored run: compute what is missing or damaged, nothing else.", _STORED),
    "summary": Command("runs", "Recompute the summary of a stored run from its chunks.", _STORED),
    "merge": Command("runs", "Add up runs that differ only in their seed.", "results/races-1 results/races-2"),
    "passage": Command("passage", "Compute one passage near flat: race angle, times, limits, forces.", _PASSAGE),
    "probability": Command(
        "probability",
        "Compute the probability that the tilt falls below a given value, for random initial states.",
        _RARE,
    ),
    "plan": Command("plan", "Show which method a run would use and why, and what the run would cost.", _PLAN),
    "columns": Command(
        "columns", "Explain every column of the results, and every status of a sample.", "race-angles"
    ),
    "trade": Command("trade", "Measure error and cost of every method on passages near the falling set.", _TRADE),
    "paper": Command(
        "paper",
        "Check the statements of Cushman & Duistermaat (2006), draw their figures; exit status 1 if a statement "
        "fails.",
        "--only LEMMA-5",
    ),
    "portrait": Command(
        "portrait", "Draw the falling set F, phase portraits, slices, races, paths and a film.", "--disk hoop"
    ),
    "view": Command("view", "Write a web page: an article on what the disk does, and controls to try it.", _VIEW),
    "gallery": Command(
        "gallery", "Write README.md of a folder of results: every picture with its caption and command.", "results"
    ),
    "completion": Command(
        "completion", "Print completions for bash and zsh; to use them: source <(nearflat completion).", ""
    ),
    "cite": Command("cite", "Print BibTeX of this software and of the paper.", ""),
    "warmup": Command("warmup", "Compile all numerical code now, so that later commands start at once.", ""),
}


class Once(argparse.Action):
    """An argument that takes one value: a second one is refused."""

    def __call__(self, parser: argparse.ArgumentParser, found: Any, value: Any, flag: str | None = None) -> None:
        if getattr(found, self.dest, self.default) is not self.default:
            raise InputError(f"{self.dest}: is given twice; leave one out")
        setattr(found, self.dest, value)


class Parser(argparse.ArgumentParser):
    """Errors without the whole usage; words such as -1e-3 and -1:2 are values, not flags."""

    def __init__(self, prog: str, **options: Any) -> None:
        super().__init__(prog, allow_abbrev=False, conflict_handler="resolve", **options)
        self.register("action", None, Once)  # of every argument that says no other
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{shorten(message, 300)}\nTry '{self.prog} --help'.")

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        found, unknown = self.parse_known_args(args, namespace)
        if unknown:
            flags = [flag.lstrip("-") for flag in self._option_string_actions]  # dashes would make all alike
            words = [word.partition("=")[0].lstrip("-") for word in unknown if word.startswith("-")]
            near = " ".join(f"--{name}" for word in words if (name := nearest(word, flags)))
            meant = f"; did you mean {near}?" if near else ""
            self.error(f"unrecognized arguments: {' '.join(unknown)}{meant}")
        return found


def parser_of(name: str, words: Sequence[str] = ()) -> Parser:
    """The parser of a command. words: what follows its name; the options of a scene depend on which it is."""
    home, text, example = COMMANDS[name]
    parser = Parser(f"nearflat {name}", description=text, epilog=f"example: nearflat {name} {example}".rstrip())
    module = import_module(f"explorer.commands.{home}")
    if hasattr(module, "add_arguments"):
        module.add_arguments(parser, words)
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout and nothing else")
    parser.add_argument("-q", "--quiet", action="store_true", help="no progress and no notes")
    parser.set_defaults(call=module.call, command=name)
    return parser


def _outer_parser() -> Parser:
    width = max(map(len, COMMANDS))
    lines = [f"  {name:{width}}  {command.text}" for name, command in COMMANDS.items()]
    parser = Parser(
        "nearflat",
        usage="nearflat COMMAND ...",
        description="Explore the phase space of the rolling disk that nearly falls flat.\n\n" + "\n".join(lines),
        epilog="nearflat COMMAND --help says what a command takes; to begin: nearflat demo",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    installed = installed_version() or "(not installed)"
    parser.add_argument("--version", action="version", version=f"nearflat {installed}")
    parser.add_argument("command", metavar="COMMAND", nargs="?", help=argparse.SUPPRESS)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns its exit status."""
    words = sys.argv[1:] if arguments is None else [str(word) for word in arguments]
    if arguments is None:
        for stream in (sys.stdout, sys.stderr):  # a path may have letters that a terminal or a log file has not
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors="backslashreplace")
        gc.set_threshold(_COLLECTED)
        if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
            signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends as Ctrl-C does, with a sentence
        os.environ["MPLBACKEND"] = "agg"  # no command opens a window; matplotlib fails where it knows no such name
    name = "nearflat"
    try:
        with warnings.catch_warnings():
            outer = _outer_parser()
            after = next((n for n, word in enumerate(words, 1) if not word.startswith("-")), len(words))
            asked, rest = outer.parse_args(words[:after]), words[after:]
            if asked.command is None:
                outer.print_help()
                return 2
            _require_known(asked.command)
            name = f"nearflat {asked.command}"
            warnings.showwarning = lambda message, *_place: note(f"{name}: {message}", quiet=False)
            options = parser_of(asked.command, rest).parse_args(rest)
            options.command_line = shlex.join(["nearflat", *words])
            found = options.call(options)
            _conclude(json.dumps(found.record) if options.json else found.text, sys.stdout, arguments is None)
        return int(found.status)
    except BrokenPipeError:  # whoever read what was printed has gone, and Python must not complain at its end
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except (Interrupted, KeyboardInterrupt) as error:
        status, message = 130, str(error) or "interrupted"
    except (InputError, ImportError) as error:
        status, message = 2, str(error)
    except (RunError, OSError) as error:
        status, message = 1, str(error)
    with contextlib.suppress(OSError):  # the terminal may be closed
        _conclude(f"{name}: {message}", sys.stderr, arguments is None)
    return status


def _require_known(name: str) -> None:
    """Raise InputError for a word that is no command."""
    if name not in COMMANDS:
        from explorer.scenes.scene import NAMES

        if name in NAMES:
            raise InputError(f"{name!r} is a scene, not a command; write nearflat run {name}")
        raise InputError(f"{name!r} is no command; {suggest(name, list(COMMANDS))}\nTry 'nearflat --help'.")


def _conclude(text: str, stream: TextIO, alone: bool) -> None:
    """Print the last words of a command. alone: whether its process ends with it.

    From then on a signal is ignored: it could only add a traceback, or change an exit status that is decided.
    """
    for number in (signal.SIGINT, signal.SIGTERM) if alone else ():
        signal.signal(number, signal.SIG_IGN)
    print(printable(text), file=stream, flush=True)


if __name__ == "__main__":
    sys.exit(main())
