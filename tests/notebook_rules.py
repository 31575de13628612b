"""What every committed notebook keeps to. Each rule reads a notebook and yields its faults."""

import ast
import itertools
import json
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from urllib.parse import unquote

import nbformat
from nbformat import NotebookNode

from s2glib.teaching import build

PACKAGE = build.ROOT / "s2glib"
LARGEST, LARGEST_OUTPUT = 600_000, 1_000_000  # bytes
MOST_WORDS = 2200
LEAST_COMPARED = 0.6  # of code cells
LONGEST_RUN = 45  # seconds
CAPTION = re.compile(r"\*\*Figure\.\*\* (.*)")
HEADER = {
    "id": str,
    "minutes": int,
    "needs": list,
    "goals": list,
    "papers": dict,
    "demos": list,
    "exercises": list,
    "questions": list,
    "data": list,
    "budget_s": int,
    "reached": dict,
}
FORBIDDEN = {
    "interact": r"\binteract(ive|_manual)?\(",
    "an Output widget": r"\bOutput\(",
    "clear_output": r"\bclear_output\b",
    "tqdm": r"\btqdm\b",
    "a timing magic": r"^\s*%%?time",
    "a clock": r"\btime\.\w+\(|\bperf_counter\b|\bmonotonic\b",
    "a shell": r"^\s*(!|%%?(bash|sh|pip|conda|system)\b)|\bos\.system\b|\bsubprocess\b",
    "a trailing semicolon": r";\s*$",
    "plt.show": r"\bplt\.show\b",
    "the network": r"https?://|^\s*(import|from) (urllib|requests|httpx|socket)\b|\btorch\.hub\b",
}
FOLDERS = "home|root|tmp|usr|var|opt|mnt|private|Users"
ABSOLUTE = re.compile(rf"(?<![\w./~-])/(?:{FOLDERS})/|\b[A-Za-z]:\\+\w")
FETCHED = re.compile(r"""src\s*=\s*["']?(?:https?:)?//|!\[[^\]]*\]\(https?:|@import|<iframe""")


def code_cells(notebook: NotebookNode) -> Iterator[tuple[str, NotebookNode]]:
    """The code cells with the names that nbval gives them."""
    cells = (cell for cell in notebook.cells if cell.cell_type == "code")
    return ((f"Cell {index}", cell) for index, cell in enumerate(cells))


def prose(notebook: NotebookNode) -> str:
    """All markdown, without blocks of code."""
    texts = (cell.source for cell in notebook.cells if cell.cell_type == "markdown")
    return re.sub(r"^```.*?^```", "", "\n".join(texts), flags=re.MULTILINE | re.DOTALL)


def headings(notebook: NotebookNode) -> list[tuple[int, str]]:
    """Level and words of every heading, in order."""
    found = re.findall(r"^(#+) +(.*?) *$", prose(notebook), re.MULTILINE)
    return [(len(marks), words) for marks, words in found]


def tags(cell: NotebookNode) -> list[str]:
    return cell.metadata.get("tags", [])


def texts(output: NotebookNode) -> Iterator[str]:
    """What an output says, pictures aside."""
    yield from (output[key] for key in ("text", "evalue") if key in output)
    for kind, content in output.get("data", {}).items():
        if not kind.startswith("image/") or kind == "image/svg+xml":
            yield content if isinstance(content, str) else json.dumps(content)


def it_ran_from_top_to_bottom(path: Path, notebook: NotebookNode) -> Iterator[str]:
    counts = [cell.execution_count for _, cell in code_cells(notebook)]
    if counts != list(range(1, len(counts) + 1)):
        yield f"cells were executed as {counts}"
    for name, cell in code_cells(notebook):
        failed = any(output.output_type == "error" for output in cell.outputs)
        if failed and "raises-exception" not in tags(cell):
            yield f"{name} stored an error"


def its_header_is_complete(path: Path, notebook: NotebookNode) -> Iterator[str]:
    header = notebook.metadata.get("s2g", {})
    wrong = [key for key, kind in HEADER.items() if not isinstance(header.get(key), kind)]
    if wrong or header.keys() - HEADER.keys():
        yield f"header: wrong or missing {wrong}, unknown {sorted(header.keys() - HEADER.keys())}"
        return
    if header["id"] != path.stem[:2]:
        yield f"header: the id is {header['id']!r}"
    if header["minutes"] <= 0 or not 0 < header["budget_s"] <= LONGEST_RUN:
        yield "header: minutes or budget_s is out of bounds"
    shelf = {other.stem[:2] for other in path.parent.glob("[0-9][0-9]_*.ipynb")}
    for need in header["needs"]:
        if need not in shelf or need >= header["id"]:  # so needs have no cycle
            yield f"header: it needs {need}, which is no earlier notebook"


def its_goals_are_reached(path: Path, notebook: NotebookNode) -> Iterator[str]:
    header = {key: kind() for key, kind in HEADER.items()} | notebook.metadata.get("s2g", {})
    if not header["goals"] or header["reached"].keys() != set(header["goals"]):
        yield "header: `reached` does not list the goals"
    means = header["exercises"] + header["demos"] + header["questions"]
    for goal, ids in header["reached"].items():
        if not ids or set(ids) - set(means):
            yield f"header: {goal!r} is reached by {ids}"
    code = "\n".join(cell.source for _, cell in code_cells(notebook))
    for kind, function in (("exercises", "check"), ("questions", "ask")):
        found = re.findall(rf"""\b{function}\(["']([^"']+)["']""", code)
        if found != header[kind]:
            yield f"header: {kind} are {header[kind]}, in the cells {found}"
    views = [
        cell for _, cell in code_cells(notebook) if {"s2g-demo", "s2g-media"} & set(tags(cell))
    ]
    said = [text.lower() for cell in views for output in cell.outputs for text in texts(output)]
    for demo in header["demos"]:  # a demo goes by its class: "toy arm" where a ToyArm shows itself
        if not any(text.startswith(demo.replace(" ", "")) for text in said):
            yield f"header: no cell shows the demo {demo!r}"


def its_exercises_are_checked(path: Path, notebook: NotebookNode) -> Iterator[str]:
    for cell, after in itertools.pairwise([*notebook.cells, NotebookNode(metadata={}, source="")]):
        if build.EXERCISE in tags(cell):
            if cell.outputs:
                yield f"the exercise {cell.id} writes something"
            if not {"s2g-check", "nbval-ignore-output"} <= set(tags(after)):
                yield f"the exercise {cell.id} has no check after it"
    source = path.parent / "source" / f"{path.stem}.py"
    variants = [build.read_source(source, solved=solved) for solved in (False, True)]
    for stub, solution in zip(*(variant.cells for variant in variants), strict=True):
        if build.EXERCISE in tags(stub) and signatures(stub) - signatures(solution):
            yield f"the solution of {stub.id} does not define what its exercise does"


def signatures(cell: NotebookNode) -> set[str]:
    """The functions and classes that a cell defines."""
    return {
        f"{node.name}({ast.unparse(node.args) if isinstance(node, ast.FunctionDef) else ''})"
        for node in ast.parse(cell.source).body
        if isinstance(node, ast.FunctionDef | ast.ClassDef)
    }


def its_figures_have_captions(path: Path, notebook: NotebookNode) -> Iterator[str]:
    for name, cell in code_cells(notebook):
        tagged = "s2g-figure" in tags(cell)
        if tagged != bool(re.search(r"(?<!\.)\bfigure\(", cell.source)):
            yield f"{name} calls figure(...) without the tag s2g-figure, or the reverse"
        said = [text for output in cell.outputs for text in texts(output)]
        captions = [match[1] for match in map(CAPTION.match, said) if match]
        if tagged and not captions:
            yield f"{name} shows no caption"
        for caption in captions:
            if not 40 <= len(caption) <= 300:
                yield f"{name} has a caption of {len(caption)} characters"


def its_headings_descend(path: Path, notebook: NotebookNode) -> Iterator[str]:
    levels = [level for level, _ in headings(notebook)]
    if levels[:1] != [1] or levels.count(1) != 1:
        yield f"{levels.count(1)} titles, the first heading is of level {levels[:1]}"
    if any(deeper > level + 1 for level, deeper in itertools.pairwise(levels)):
        yield f"a heading skips a level: {levels}"


def its_links_resolve(path: Path, notebook: NotebookNode) -> Iterator[str]:
    linked = re.findall(r"\]\(([^)\s]+)|(?:href|src)=[\"']([^\"']+)", prose(notebook))
    for target in map("".join, linked):
        if re.match(r"https?:|mailto:", target):
            continue
        file, _, anchor = unquote(target).partition("#")
        there = path.parent / file if file else path
        if not there.exists():
            yield f"a link leads to {file}, which does not exist"
        elif anchor and anchor not in anchors(nbformat.read(there, 4) if file else notebook):
            yield f"a link leads to #{anchor}, which is no heading"
    if "![](" in prose(notebook):
        yield "a picture has no description"


def anchors(notebook: NotebookNode) -> set[str]:
    """What JupyterLab calls the headings in links."""
    return {re.sub(r"[*_`]", "", words).replace(" ", "-") for _, words in headings(notebook)}


def it_fetches_nothing(path: Path, notebook: NotebookNode) -> Iterator[str]:
    if FETCHED.search(prose(notebook)):
        yield "the text loads something from outside"
    for name, cell in code_cells(notebook):
        if any(FETCHED.search(text) for output in cell.outputs for text in texts(output)):
            yield f"{name} wrote something that loads from outside"


def it_names_no_place_of_one_machine(path: Path, notebook: NotebookNode) -> Iterator[str]:
    for cell in notebook.cells:
        said = [text for output in cell.get("outputs", []) for text in texts(output)]
        if any(map(ABSOLUTE.search, [cell.source, *said])):
            yield f"{cell.id} holds an absolute path"


def its_code_can_be_compared(path: Path, notebook: NotebookNode) -> Iterator[str]:
    for name, cell in code_cells(notebook):
        for thing, pattern in FORBIDDEN.items():
            if re.search(pattern, cell.source, re.MULTILINE):
                yield f"{name} uses {thing}"


@cache
def offered_names() -> set[str]:
    """What the rooms of the package offer at their doors."""
    doors = [ast.parse(door.read_text("utf-8")) for door in PACKAGE.rglob("__init__.py")]
    lists = [node for door in doors for node in door.body if isinstance(node, ast.Assign)]
    named = [node for node in lists if ast.unparse(node.targets[0]) == "__all__"]
    return {name for node in named for name in ast.literal_eval(node.value)}


def it_copies_nothing_from_the_package(path: Path, notebook: NotebookNode) -> Iterator[str]:
    for name, cell in code_cells(notebook):
        code = "\n".join(re.sub(r"^\s*[%!].*", "", line) for line in cell.source.splitlines())
        for node in [] if build.EXERCISE in tags(cell) else ast.walk(ast.parse(code)):
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name in offered_names():
                yield f"{name} defines {node.name}, which the package offers"


def is_compared(cell: NotebookNode) -> bool:
    """Whether nbval compares a text that this cell wrote."""
    kinds = {kind for output in cell.outputs for kind in output.get("data", {"text/plain": 0})}
    return "nbval-ignore-output" not in tags(cell) and any(k.startswith("text/") for k in kinds)


def enough_of_it_is_compared(path: Path, notebook: NotebookNode) -> Iterator[str]:
    compared = [is_compared(cell) for _, cell in code_cells(notebook)]
    if sum(compared) < LEAST_COMPARED * len(compared):
        yield f"only {sum(compared)} of {len(compared)} code cells are compared"
    title, cells = "its beginning", {}
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cells.setdefault(title, []).append(is_compared(cell))
        elif found := re.findall(r"^## +(.*)", cell.source, re.MULTILINE):
            title = found[-1]
    yield from (
        f"nothing is compared in {title}" for title, those in cells.items() if not any(those)
    )


def it_is_small(path: Path, notebook: NotebookNode) -> Iterator[str]:
    if path.stat().st_size > LARGEST:
        yield f"the file has {path.stat().st_size} bytes"
    for name, cell in code_cells(notebook):
        if any(len(json.dumps(output)) > LARGEST_OUTPUT for output in cell.outputs):
            yield f"an output of {name} is too large for nbval"
    words = re.findall(r"[^\W\d_][\w'-]*", re.sub(r"<[^>]+>|\$[^$]*\$", "", prose(notebook)))
    if len(words) > MOST_WORDS:
        yield f"it has {len(words)} words"


RULES = (
    it_ran_from_top_to_bottom,
    its_header_is_complete,
    its_goals_are_reached,
    its_exercises_are_checked,
    its_figures_have_captions,
    its_headings_descend,
    its_links_resolve,
    it_fetches_nothing,
    it_names_no_place_of_one_machine,
    its_code_can_be_compared,
    it_copies_nothing_from_the_package,
    enough_of_it_is_compared,
    it_is_small,
)
