"""Write what the code knows better: options, columns, statuses and misprints in pages, and keywords for editors.

A part of a page stands between `<!-- made: NAME -->` and `<!-- end -->`; keywords: explorer/commands/calls.pyi.
`python tests/docs/reference_pages.py` makes them all anew, and a test compares.
"""

import argparse
import inspect
import re
from pathlib import Path

import explorer as ex
from explorer import compiled
from explorer.commands import calls
from explorer.commands.main import COMMANDS, parser_of
from explorer.commands.trade import Trading
from explorer.phase.columns import COLUMNS
from explorer.runs.settings import Settings
from explorer.scenes.options import options_of
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
    sections, said = [], set()
    every = parsers()
    for name, command in COMMANDS.items():
        example = f"nearflat {name} {command.example}".strip()
        sections.append(f"## nearflat {name}\n\n{command.text}\n\n```bash\n{example}\n```\n")
        rows = list(arguments(every[name]))
        if name == "plan":
            sections.append("Takes what `nearflat run` takes.\n")
        elif name == "trade":
            rows = [row for row in rows if row not in said]
            sections.append(
                "Takes the options of the scene, as `nearflat run` does, but `--method` and `--accuracy`.\n"
            )
            sections.append(table(["argument", "meaning"], rows) + "\n")
        elif rows:
            sections.append(table(["argument", "meaning"], rows) + "\n")
        if name != "run":
            continue
        said |= set(rows)
        for scene in NAMES:
            own = [row for row in arguments(every[f"run {scene}"]) if row not in rows]
            said |= set(own)
            first = scene_class(scene).__doc__.partition("\n")[0]
            sections.append(
                f"### nearflat run {scene}\n\n{first} Also:\n\n{table(['argument', 'meaning'], own)}\n"
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


def described(home, names):
    """A table of names with their first sentences, and the full text of each for the site."""
    objects = {name: getattr(home, name) for name in sorted(names) if not inspect.ismodule(getattr(home, name))}
    firsts = [(f"`{name}`", (inspect.getdoc(value) or "").partition("\n\n")[0]) for name, value in objects.items()]
    kinds = {name: "autoclass" if inspect.isclass(value) else "autofunction" for name, value in objects.items()}
    kinds["pictures"] = "autodata"
    # Sphinx takes these for the rooms of the same names.
    rooms = {"view": "explorer.view.page", "pictures": "explorer.pictures.calls"}
    homes = {name: rooms.get(name, home.__name__) for name in objects}
    texts = [f".. {kinds[name]}:: {homes[name]}.{name}\n" for name in objects]
    return table(["name", "what it does"], firsts) + "\n\n```{eval-rst}\n" + "\n".join(texts) + "```\n"


def python():
    """All public names."""
    told = {name: " ".join(inspect.getdoc(each.draw).split()) for name, each in sorted(ex.pictures.items())}
    rows = [(f"`{name}{ex.pictures[name].signature}`", text) for name, text in told.items()]
    shown = table(["picture", "what it draws"], rows)
    return f"## Functions and classes\n\n{described(ex, ex.__all__)}\n## Pictures\n\n{shown}\n"


MAKERS = {
    "python": python,
    "command-line": command_line,
    "options": options,
    "columns": columns,
    "statuses": statuses,
    "misprints": misprints,
}


def renewed(text):
    """A page with its made parts made again."""
    return PART.sub(lambda part: f"{part[1]}\n{MAKERS[part[2]]().strip()}\n\n{part[3]}", text)


def pages_with_parts():
    """The pages that have made parts."""
    return [page for page in sorted(DOCS.rglob("*.md")) if PART.search(page.read_text("utf-8"))]


STUB = Path(calls.__file__).with_suffix(".pyi")
HEAD = '''"""Keywords of run, plan and trade, made by tests/docs/reference_pages.py from what scenes declare."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np

from explorer.commands.plan import RunPlan
from explorer.commands.trade import Trade
from explorer.measure.sampling import Box
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
        types.setdefault(each.name, {}).update(dict.fromkeys(parts))
    text = HEAD + "\nclass Keywords(TypedDict, total=False):\n"
    text += "".join(f"    {name}: {' | '.join(known)}\n" for name, known in types.items())
    text += f"\nKnown = Literal[{', '.join(map(repr, NAMES))}]\n"
    for call, returned in (("run", "Run"), ("plan", "RunPlan")):
        text += f"\n@overload\ndef {call}(scene: Known, **options: Unpack[Keywords]) -> {returned}: ...\n"
        text += f"@overload\ndef {call}(scene: str | type[Scene], **options: Any) -> {returned}: ...\n"
    own = ", ".join(f"{each.name}: {each.metadata['reader'].accepts} = ..." for each in options_of(Trading))
    return f"{text}\ndef trade(scene: str | type[Scene] | None = ..., *, {own}, **options: Any) -> Trade: ...\n"


if __name__ == "__main__":
    STUB.write_text(stub(), encoding="utf-8")
    for page in pages_with_parts():
        page.write_text(renewed(page.read_text("utf-8")), encoding="utf-8")
        print(page.relative_to(ROOT))
