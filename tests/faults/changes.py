"""Changes of one line of code at random: operators, comparisons, constants, signs, dropped terms."""

import ast
import random
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).parents[2]
NUMERICAL = {
    "kernels": ("kernels/arcs", "kernels/disk", "kernels/near_flat", "kernels/steps"),
    "explorer": ("explorer/phase", "explorer/motion", "explorer/measure"),
}
APPLICATION = ("explorer/runs", "explorer/scenes")
ONE_TOKEN = ("operator", "comparison", "constant", "sign", "logic", "function")

ARITHMETIC = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.Pow: "*",
    ast.Mod: "*",
    ast.FloorDiv: "*",
}
COMPARISONS = {ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">", ast.Eq: "!=", ast.NotEq: "=="}
REVERSED = {ast.Lt: ">", ast.LtE: ">=", ast.Gt: "<", ast.GtE: "<=", ast.Eq: "!=", ast.NotEq: "=="}


@dataclass(frozen=True)
class Mutant:
    """One change: at a line (from 1) of a file, in a function, these columns become `new`."""

    file: str
    line: int
    start: int
    end: int
    kind: str
    new: str
    function: str


class Sites(ast.NodeVisitor):
    """All changes that a file allows."""

    def __init__(self, file):
        self.file, self.text, self.within, self.found = file, (ROOT / file).read_text(encoding="utf-8"), [], []
        self.lines = self.text.splitlines()
        self.visit(ast.parse(self.text))

    def add(self, node, kind, new):
        if node.lineno == node.end_lineno:
            line = self.lines[node.lineno - 1].encode()  # columns of ast count bytes
            start, end = (len(line[:column].decode()) for column in (node.col_offset, node.end_col_offset))
            where = ".".join(self.within)
            self.found.append(Mutant(self.file, node.lineno, start, end, kind, new, where))

    def source(self, node):
        return ast.get_source_segment(self.text, node)

    def _named(self, node):
        self.within.append(node.name)
        for part in node.body:
            self.visit(part)
        self.within.pop()

    visit_FunctionDef = visit_ClassDef = _named

    def _skipped(self, node):
        """What is no arithmetic: texts, errors, types, imports."""

    visit_Raise = visit_JoinedStr = visit_Import = visit_ImportFrom = visit_Assert = visit_Global = _skipped

    def visit_AnnAssign(self, node):
        if node.value:
            self.visit(node.value)

    def visit_BinOp(self, node):
        self.generic_visit(node)
        left, right, swap = self.source(node.left), self.source(node.right), ARITHMETIC.get(type(node.op))
        if swap is None or (isinstance(node.left, ast.Constant) and isinstance(node.left.value, str)):
            return
        self.add(node, "operator", f"({left}) {swap} ({right})")
        self.add(node, "dropped", f"({left})")
        if not isinstance(node.op, ast.Pow):
            self.add(node, "dropped", f"({right})")

    def visit_UnaryOp(self, node):
        self.generic_visit(node)
        if isinstance(node.op, ast.USub | ast.Not):
            self.add(node, "sign", f"({self.source(node.operand)})")

    def visit_Compare(self, node):
        self.generic_visit(node)
        if len(node.ops) == 1 and type(node.ops[0]) in COMPARISONS:
            left, right, name = self.source(node.left), self.source(node.comparators[0]), type(node.ops[0])
            self.add(node, "comparison", f"{left} {COMPARISONS[name]} {right}")
            self.add(node, "comparison", f"{left} {REVERSED[name]} {right}")

    def visit_BoolOp(self, node):
        self.generic_visit(node)
        word = " or " if isinstance(node.op, ast.And) else " and "
        self.add(node, "logic", "(" + word.join(self.source(value) for value in node.values) + ")")
        self.add(node, "dropped", f"({self.source(node.values[0])})")

    def visit_AugAssign(self, node):
        self.generic_visit(node)
        if type(node.op) in (ast.Add, ast.Sub, ast.Mult):
            sign = {ast.Add: "-=", ast.Sub: "+=", ast.Mult: "/="}[type(node.op)]
            self.add(node, "operator", f"{self.source(node.target)} {sign} {self.source(node.value)}")

    def visit_IfExp(self, node):
        self.generic_visit(node)
        self.add(node, "branch", f"({self.source(node.body)})")
        self.add(node, "branch", f"({self.source(node.orelse)})")

    def visit_Constant(self, node):
        value = node.value
        if type(value) is int:
            self.add(node, "constant", str(value + 1))
        elif type(value) is float:
            self.add(node, "constant", "1.0" if value == 0.0 else repr(value * 1.01))

    def visit_Call(self, node):
        self.generic_visit(node)
        name = self.source(node.func)
        swap = {
            "min": "max",
            "max": "min",
            "math.sin": "math.cos",
            "math.cos": "math.sin",
            "np.minimum": "np.maximum",
        }
        if name in swap:
            self.add(node.func, "function", swap[name])


def drawn(layer, count, seed):
    """Changes of a layer at random: a file has a chance that grows like the square root of what it allows."""
    draw = random.Random(f"{layer} {seed}")
    files = [
        f"{room}/{path.name}" for room in NUMERICAL[layer] for path in sorted((ROOT / room).glob("[a-z]*.py"))
    ]
    sites = {file: found for file in files if (found := Sites(file).found)}
    for found in sites.values():
        draw.shuffle(found)
    chosen, places = [], set()
    while len(chosen) < count and sites:
        file = draw.choices(list(sites), [len(found) ** 0.5 for found in sites.values()])[0]
        mutant = sites[file].pop()
        if not sites[file]:
            del sites[file]
        if (file, mutant.line, mutant.start) not in places:
            places.add((file, mutant.line, mutant.start))
            chosen.append(mutant)
    return chosen


def shared(other, count, seed):
    """Changes of one token of the application at random, on lines that stand once here and once in `other`."""
    found = []
    for path in sorted(path for room in APPLICATION for path in (ROOT / room).glob("[a-z]*.py")):
        file = path.relative_to(ROOT).as_posix()
        if (other / file).is_file():
            here, there = ((root / file).read_text(encoding="utf-8").splitlines() for root in (ROOT, other))
            sites = (site for site in Sites(file).found if site.kind in ONE_TOKEN)
            found += [site for site in sites if here.count(line := here[site.line - 1]) == there.count(line) == 1]
    random.Random(seed).shuffle(found)
    by_line = {(site.file, site.line): site for site in reversed(found)}  # the first of each line
    return [site for site in found if by_line[site.file, site.line] is site][:count]


def moved(mutant, text, other):
    """The same change where its line stands in another text of the file."""
    line = text.splitlines()[mutant.line - 1]
    return replace(mutant, line=other.splitlines().index(line) + 1)


def changed(mutant, text):
    """The text of a file with the change."""
    lines = text.splitlines(keepends=True)
    line = lines[mutant.line - 1]
    lines[mutant.line - 1] = line[: mutant.start] + mutant.new + line[mutant.end :]
    return "".join(lines)
