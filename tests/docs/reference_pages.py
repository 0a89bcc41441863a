"""Write the parts of pages that the code knows better: options, columns, statuses, misprints.

Such a part stands between `<!-- made: NAME -->` and `<!-- end -->`. `python tests/docs/reference_pages.py` makes
them all anew, and a test compares.
"""

import argparse
import inspect
import re
from pathlib import Path

import explorer as ex
from explorer import compiled
from explorer.commands.main import COMMANDS, _parser
from explorer.phase.columns import COLUMNS

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PART = re.compile(r"(<!-- made: ([\w-]+) -->\n).*?(<!-- end -->)", flags=re.DOTALL)


def table(heads, rows):
    """A Markdown table; bars in cells are escaped, line ends become spaces."""
    lines = [heads, ["---"] * len(heads), *rows]
    cells = [[" ".join(cell.split()).replace("|", "\\|") for cell in line] for line in lines]
    return "\n".join(f"| {' | '.join(line)} |" for line in cells)


def parsers():
    """Name -> parser, for all commands, with their arguments."""
    (commands,) = (action for action in _parser()._actions if isinstance(action, argparse._SubParsersAction))
    return {name: parser.loaded() for name, parser in commands.choices.items()}


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
    """A section for each command."""
    sections = []
    for name, parser in parsers().items():
        command = COMMANDS[name]
        rows = list(arguments(parser))
        example = f"nearflat {name} {command.example}".strip()
        sections.append(f"## nearflat {name}\n\n{command.text}\n\n```bash\n{example}\n```\n")
        if rows:
            sections.append(table(["argument", "meaning"], rows) + "\n")
    return "\n".join(sections)


def options():
    """Every option of every command, once, with the commands that have it."""
    known = {}
    for name, parser in parsers().items():
        for action in parser._actions:
            for flag in action.option_strings if action.help is not argparse.SUPPRESS else ():
                known.setdefault(flag, []).append(name)
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
    # Sphinx takes `explorer.view` for the room of the same name.
    homes = {name: "explorer.view.page" if name == "view" else home.__name__ for name in objects}
    texts = [f".. {kinds[name]}:: {homes[name]}.{name}\n" for name in objects]
    return table(["name", "what it does"], firsts) + "\n\n```{eval-rst}\n" + "\n".join(texts) + "```\n"


def python():
    """All public names."""
    functions, pictures = described(ex, ex.__all__), described(ex.plot, ex.plot.__all__)
    data = described(ex.portrait, ex.portrait.__all__)
    return (
        f"## Functions and classes\n\n{functions}\n## Pictures: explorer.plot\n\n{pictures}\n"
        f"## The data of pictures: explorer.portrait\n\n{data}"
    )


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


if __name__ == "__main__":
    for page in pages_with_parts():
        page.write_text(renewed(page.read_text("utf-8")), encoding="utf-8")
        print(page.relative_to(ROOT))
