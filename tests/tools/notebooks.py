"""The tutorials as notebooks with pictures: `python tests/tools/notebooks.py` writes them to docs/notebooks."""

import base64
import re
from pathlib import Path

import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output

ROOT = Path(__file__).resolve().parents[2]
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("[0-9]*.md"))
NOTEBOOKS, IMAGES = ROOT / "docs" / "notebooks", ROOT / "docs" / "images"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```\n", flags=re.MULTILINE | re.DOTALL)
PICTURE = re.compile(r"^!\[[^\]]*\]\([^)]*\)\n", flags=re.MULTILINE)
PROMPT = re.compile(r"^(?:>>>|\.\.\.) ?(.*)$", flags=re.MULTILINE)


def without_prompts(code):
    """The lines after `>>>`, without what they print; other code as it is."""
    return "\n".join(PROMPT.findall(code)) if code.startswith(">>>") else code.rstrip()


def code_of(kind, text):
    """The source of a cell; None for blocks that a notebook leaves out, such as what a command printed."""
    if kind == "python":
        # The figure itself, last in a cell, is shown.
        return re.sub(r"^figure\.savefig\(.*\)$", "figure", without_prompts(text), flags=re.MULTILINE)
    if kind == "sh":
        return "\n".join(f"!{line}" for line in text.splitlines() if line)
    return None


def pictures_of(text):
    """What a block that saves a picture shows: the one that `pages.py` has stored."""
    files = [IMAGES / f"{name}.png" for name in re.findall(r"savefig\(\"([\w-]+)\.png", text)]
    data = [base64.b64encode(file.read_bytes()).decode() for file in files]
    return [new_output("display_data", data={"image/png": each}) for each in data]


def notebook(page):
    """A page as a notebook."""
    cells, at = [new_code_cell("%matplotlib inline")], 0
    text = PICTURE.sub("", page.read_text("utf-8"))
    for block in BLOCK.finditer(text):
        words, code = text[at : block.start()].strip(), code_of(*block.groups())
        if block[1] == "bash":
            words = f"{words}\n\n{block[0].strip()}"
        cells += [new_markdown_cell(words)] if words else []
        cells += [new_code_cell(code, outputs=pictures_of(block[2]))] if code else []
        at = block.end()
    cells.append(new_markdown_cell(text[at:].strip()))
    for number, cell in enumerate(cells):
        cell.id = f"cell-{number}"
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return new_notebook(cells=cells, metadata=kernel)


def path_of(page):
    """Where the notebook of a page is kept."""
    return NOTEBOOKS / f"{page.stem}.ipynb"


if __name__ == "__main__":
    NOTEBOOKS.mkdir(exist_ok=True)
    for each in TUTORIALS:
        nbformat.write(notebook(each), path_of(each))
