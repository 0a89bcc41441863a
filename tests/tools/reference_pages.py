"""Write what the code knows better: options, columns, statuses and misprints in pages, and keywords for editors.

A part of a page stands between `<!-- made: NAME -->` and `<!-- end -->`; keywords: explorer/commands/calls.pyi.
`python tests/tools/reference_pages.py` makes them all anew, and a test compares.
"""

import argparse
import inspect
import re
from functools import partial
from pathlib import Path

import explorer as ex
from explorer import compiled
from explorer.commands import calls
from explorer.commands.main import COMMANDS, parser_of
from explorer.commands.trade import TradeOptions
from explorer.phase.columns import COLUMNS
from explorer.phase.portrait import Portrait
from explorer.runs.settings import Settings
from explorer.scenes.options import names_of, options_of
from explorer.scenes.scene import NAMES, scene_class

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PART = re.compile(r"(<!-- made: ([\w-]+) -->\n).*?(<!-- end -->)", flags=re.DOTALL)


def table(heads, rows):
    """A Markdown table; bars in cells are escaped, line ends become spaces."""
    lines = [heads, ["---"] * len(heads), *rows]
    cells = [[" ".join(cell.split()).replace("|", "\\|") for cell in line] for line in lines]
    return "\n".join(f"| {' | '.join(line)} |" for line in cells)


def parsers():
    """Words -> parser, for all commands, and for those about a scene with every scene."""
    words = [(name,) for name in COMMANDS] + [("run", scene) for scene in NAMES]
    return {" ".join(each): parser_of(each[0], each[1:]) for each in words}


def arguments(parser):
    """(how it is typed, what it says) for the arguments of a command."""
    for action in parser._actions:
        if action.help is argparse.SUPPRESS or "--help" in action.option_strings:
            continue
        words = parser._get_formatter()._expand_help(action) if action.help else ""
        typed = action.metavar or ("|".join(map(str, action.choices)) if action.choices else "")
        if not action.option_strings:
            yield f"`{typed or action.dest}`", words
        else:
            value = "" if action.nargs == 0 else f" {typed or action.dest.upper()}"
            yield f"`{', '.join(action.option_strings)}{value}`", words


def command_line():
    """A section for each command; below `run` one for each scene, with what only it takes."""
    sections = []
    every = parsers()
    for name, command in COMMANDS.items():
        example = f"nearflat {name} {command.example}".strip()
        sections.append(f"## nearflat {name}\n\n{command.text}\n\n```bash\n{example}\n```\n")
        rows = list(arguments(every[name]))
        if name == "plan":
            sections.append("Takes what `nearflat run` takes.\n")
        elif rows:
            sections.append(table(["argument", "meaning"], rows) + "\n")
        if name != "run":
            continue
        for scene in NAMES:
            own = [row for row in arguments(every[f"run {scene}"]) if row not in rows]
            first = scene_class(scene).__doc__.partition("\n")[0]
            sections.append(
                f"### nearflat run {scene}\n\n{first} Its own options:\n\n{table(['argument', 'meaning'], own)}\n"
            )
    return "\n".join(sections)


def options():
    """Every option of every command, once, with the commands that have it."""
    known = {}
    for name, parser in parsers().items():
        for action in parser._actions:
            for flag in action.option_strings if action.help is not argparse.SUPPRESS else ():
                known.setdefault(flag, {})[name.partition(" ")[0]] = None
    rows = [
        (f"`{flag}`", ", ".join(names)) for flag, names in sorted(known.items()) if flag not in ("-h", "--help")
    ]
    return table(["option", "of the commands"], rows)


def columns():
    """Every column with unit and equation."""
    rows = [(f"`{name}`", each.unit or "–", each.equation or "–", each.meaning) for name, each in COLUMNS.items()]
    return table(["column", "unit", "equation", "meaning"], rows)


def statuses():
    """Every status of a sample with its remedy."""
    codes = compiled.status.Status
    rows = [(f"`{each.name.lower()}`", str(int(each)), each.sentence, each.remedy) for each in codes]
    return table(["status", "code", "what happened", "what to do"], rows)


def misprints():
    """The table of results/paper/misprints.md without the names of statements."""
    lines = (ROOT / "results" / "paper" / "misprints.md").read_text("utf-8").splitlines()
    rows = [re.split(r"(?<!\\) \| ", line.strip("| ")) for line in lines if line.startswith("| ")]
    kept = [[row[0], row[1], row[2], *row[4:]] for row in rows]
    return "\n".join(f"| {' | '.join(row)} |" for row in [kept[0], ["---"] * len(kept[0]), *kept[1:]])


# The pages about Python: of what they are, and the rooms whose public names they have.
SUBJECTS = {
    "states": ("Bodies, states and their constants", {"phase"}),
    "motions": ("Motions", {"motion"}),
    "statistics": ("Statistics of falling", {"measure"}),
    "runs": ("Runs of many states", {"runs", "scenes", "commands"}),
    "pictures": ("Pictures and the page", {"pictures", "view"}),
    "errors": ("Errors, warnings and statuses", {"errors", "status"}),
}
# Sphinx takes these for the rooms of the same names.
_ROOMS = {"view": "explorer.view.page", "pictures": "explorer.pictures.calls"}


def public(subject):
    """The public names of a subject with their objects."""
    found = {name: getattr(ex, name) for name in ex.__all__ if not inspect.ismodule(getattr(ex, name))}
    return {
        name: value
        for name, value in sorted(found.items())
        if value.__module__.split(".")[1] in SUBJECTS[subject][1]
    }


def returned(values):
    """The classes that functions return and that have no public name."""
    for value in values:
        if inspect.isfunction(value):
            kind = inspect.signature(value).return_annotation
            kind = vars(inspect.getmodule(value)).get(kind) if isinstance(kind, str) else kind
            if (
                inspect.isclass(kind)
                and kind.__module__.startswith("explorer.")
                and not hasattr(ex, kind.__name__)
            ):
                yield f"{kind.__module__}.{kind.__name__}"


def subject(name):
    """The full text of all names of a subject, and of what they return, for the site."""
    objects = public(name)
    kinds = {word: "autoclass" if inspect.isclass(value) else "autofunction" for word, value in objects.items()}
    kinds["pictures"] = "autodata"
    texts = [f".. {kinds[word]}:: {_ROOMS.get(word, 'explorer')}.{word}\n" for word in objects]
    texts += [f".. autoclass:: {path}\n" for path in dict.fromkeys(returned(objects.values()))]
    return "```{eval-rst}\n" + "\n".join(texts) + "```"


def python():
    """All public names with their first sentences, by subject."""
    parts = []
    for name, (title, _) in SUBJECTS.items():
        firsts = [
            (f"`{word}`", (inspect.getdoc(each) or "").partition("\n\n")[0]) for word, each in public(name).items()
        ]
        parts.append(f"## [{title}](python/{name}.md)\n\n{table(['name', 'what it does'], firsts)}\n")
    return "\n".join(parts)


def all_pictures():
    """All pictures, with what they take."""
    told = {name: " ".join(inspect.getdoc(each.draw).split()) for name, each in sorted(ex.pictures.items())}
    rows = [(f"`{name}{ex.pictures[name].signature}`", text) for name, text in told.items()]
    return table(["picture", "what it draws"], rows)


def keys(value, before=""):
    """The paths of keys to all numbers; [] for each row of a list."""
    if isinstance(value, list) and value and isinstance(value[0], dict):
        value, before = {name: each for row in value for name, each in row.items()}, f"{before}[]"
    if not isinstance(value, dict) or not value:
        return [before]
    return [path for name, each in value.items() for path in keys(each, f"{before}.{name}".lstrip("."))]


def keys_in_words(found):
    """The keys of an object, each with those below it in brackets."""
    by_key = {}
    for path in (path for key, value in found.items() for path in keys(value, key)):
        first, _, rest = path.partition(".")
        by_key.setdefault(first, []).append(rest)
    return "; ".join(
        f"`{first}`" + (f" ({', '.join(rest)})" if rest != [""] else "") for first, rest in by_key.items()
    )


def summaries():
    """What the summary of each scene has beside its options."""
    few = {"samples": 1000, "progress": False}
    asked = dict.fromkeys(NAMES, few) | {
        "one-sided": {**few, "samples": 1, "disk": "hoop"},
        "measure-zero": {**few, "tube": 512, "ladder": "1e-7:1e-1"},
    }
    rows = []
    for name in NAMES:
        run = ex.run(name, **asked[name])
        found = {key: value for key, value in run.summary.items() if run.options.get(key) != value}
        rows.append((f"`{name}`", keys_in_words(found)))
    return table(["scene", "keys, and in brackets the keys below them"], rows)


def portrait():
    """What `nearflat portrait --only phase --json` has beside the files."""
    return f"{keys_in_words(Portrait(ex.Disk.uniform()).describe())}."


MAKERS = {
    "python": python,
    "all-pictures": all_pictures,
    **{f"python-{name}": partial(subject, name) for name in SUBJECTS},
    "command-line": command_line,
    "options": options,
    "columns": columns,
    "statuses": statuses,
    "misprints": misprints,
    "summaries": summaries,
    "portrait": portrait,
}


def renewed(text):
    """A page with its made parts made again."""
    return PART.sub(lambda part: f"{part[1]}\n{MAKERS[part[2]]().strip()}\n\n{part[3]}", text)


def pages_with_parts():
    """The pages that have made parts."""
    return [page for page in sorted(DOCS.rglob("*.md")) if PART.search(page.read_text("utf-8"))]


STUB = Path(calls.__file__).with_suffix(".pyi")
HEAD = '''"""Keywords of run, plan and trade, made by tests/tools/reference_pages.py from what scenes declare."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np

from explorer.commands.plan import RunPlan
from explorer.motion.work_precision import Trade
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States
from explorer.measure.slices import Slice
from explorer.runs.run import Run
from explorer.scenes.scene import Scene
'''


def stub():
    """The keywords of runs and of all scenes, each with the types that any of them takes."""
    kinds, types = (*(scene_class(name) for name in NAMES), Settings), {}
    for each in (each for kind in kinds for each in options_of(kind)):
        parts = re.split(r" \| (?![^\[]*\])", each.metadata["reader"].accepts)  # not within brackets
        for name in names_of(each):
            types.setdefault(name, {}).update(dict.fromkeys(parts))
    text = HEAD + "\nclass Keywords(TypedDict, total=False):\n"
    text += "".join(f"    {name}: {' | '.join(known)}\n" for name, known in types.items())
    text += f"\nKnown = Literal[{', '.join(map(repr, NAMES))}]\n"
    for call, returned in (("run", "Run"), ("plan", "RunPlan")):
        text += f"\n@overload\ndef {call}(scene: Known, **options: Unpack[Keywords]) -> {returned}: ...\n"
        text += f"@overload\ndef {call}(scene: str | type[Scene], **options: Any) -> {returned}: ...\n"
    taken = ((name, each.metadata["reader"]) for each in options_of(TradeOptions) for name in names_of(each))
    own = ", ".join(f"{name}: {reader.accepts} = ..." for name, reader in taken)
    return f"{text}\ndef trade(*, {own}) -> Trade: ...\n"


if __name__ == "__main__":
    STUB.write_text(stub(), encoding="utf-8")
    for page in pages_with_parts():
        page.write_text(renewed(page.read_text("utf-8")), encoding="utf-8")
        print(page.relative_to(ROOT))
