"""One HTML file from the modules of this folder, without a bundler.

Every module becomes a function that is called once, in the order in which they need each other: its imports
are taken from what earlier ones returned, its exports are what it returns. So the page holds the code as it
is written here, works where a page may load nothing, not even a module, and names of two modules never meet.
The modules keep to two forms: `import { a, b } from "./file.js";` on one line, and `export` in front of a
`const`, `function`, `async function` or `class` of one name.
"""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent
_IMPORT = re.compile(r'^import \{ ([\w, ]+) \} from "\./(\w+)\.js";$', re.MULTILINE)
_EXPORT = re.compile(r"^export ((?:async )?(?:const|function|class) (\w+))", re.MULTILINE)


@cache
def program() -> str:
    """The modules of the page as one script, `main.js` last."""
    done: dict[str, str] = {}

    def add(name: str) -> None:
        source = (FOLDER / f"{name}.js").read_text(encoding="utf-8")
        for _, needed in _IMPORT.findall(source):
            if needed not in done:
                add(needed)
        exports = [exported for _, exported in _EXPORT.findall(source)]
        body = _EXPORT.sub(r"\1", _IMPORT.sub(r'const { \1 } = modules["\2"];', source))
        done[name] = f'modules["{name}"] = (() => {{\n{body}return {{ {", ".join(exports)} }};\n}})();\n'

    add("main")
    return '"use strict";\nconst modules = {};\n' + "\n".join(done.values())


def assemble(start: dict[str, Any]) -> str:
    """The whole page, which begins with what `start` says."""
    text, article, style = (
        (FOLDER / name).read_text(encoding="utf-8") for name in ("page.html", "article.html", "style.css")
    )
    # A "</" inside a string would end the script.
    data = json.dumps(start, allow_nan=False, ensure_ascii=False).replace("</", "<\\/")
    parts = {"<!--ARTICLE-->": article, "/*STYLE*/": style, "/*START*/": data, "/*PROGRAM*/": program()}
    for mark, content in parts.items():
        text = text.replace(mark, content)
    return text
