"""Which modules and notebooks stand for each section, equation, figure and table of the papers.

Rewrite docs/coverage.json and docs/EQUATIONS.md with:  python tests/test_coverage.py
"""

import itertools
import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from source_code import find_modules, plant
from test_paper_map import HEADED, NOTEBOOK_NAMES, read_headers

ROOT = Path(__file__).resolve().parents[1]
ITEMS, COVERAGE, EQUATIONS = "docs/paper_items.json", "docs/coverage.json", "docs/EQUATIONS.md"
PAPERS = {"PT": "ProbTalk", "AM": "AMUSE", "MDD": "S2G-MDDiffusion"}
KINDS = ("sections", "equations", "figures", "tables")
NUMBER = r"[A-L]\.?\d+|\d+\.\d+|\d+|[A-L]"
TOKEN = re.compile(
    r"\b(?P<paper>PT|AM|MDD)\b|\b(?P<kind>Eq|Fig|Tab)s?\."
    rf"|(?<![\w.])(?P<first>{NUMBER}|L_\w+|SRGR)(?:-(?P<last>{NUMBER}))?(?!\w)"
)
REMARK = re.compile(r"\((?!(?:Eq|Fig|Tab)s?\.)[^()]*\)")
BRACKETS = re.compile(r"\[((?:PT|AM|MDD)\b[^\]]*)\]")
TITLE = """\
# Equation index

Every equation of the three supplements: which code it is, and where it is taught. A dash means: not
yet. AMUSE does not number its equations; they go by the letter on their left.

Made by `python tests/test_coverage.py` from headers and comments; do not edit."""
Item = tuple[str, str]  # a paper and one of its items, such as ("MDD", "Eq. A5")


def read_items(root: Path) -> dict[Item, str]:
    """What each item of the supplements is about."""
    papers = json.loads((root / ITEMS).read_text(encoding="utf-8"))
    return {
        (paper, item): what
        for paper in PAPERS
        for kind in KINDS
        for item, what in papers[paper][kind].items()
    }


def citable(root: Path) -> set[Item]:
    """The items of the supplements, and those of the main papers that may be cited."""
    papers = json.loads((root / ITEMS).read_text(encoding="utf-8"))
    main = {(paper, item) for paper in PAPERS for item in papers[paper]["main"]}
    return read_items(root).keys() | main


def cited(text: str, known: set[Item]) -> Iterator[Item]:
    """The items that a citation names, such as "MDD Sup. B.2, Eqs. B10-B12 (DDPM); AM E".

    What stands behind a colon is a remark, and what stands in parentheses unless it opens with an
    equation, a figure or a table.
    """
    paper = ""
    for part in REMARK.sub("", text).split(";"):
        kind = ""
        for token in TOKEN.finditer(part.partition(":")[0]):
            if token["paper"]:
                paper, kind = token["paper"], ""
            elif token["kind"]:
                kind = f"{token['kind']}. "
            else:
                for tag in span(token["first"], token["last"]):
                    names = (paper, kind + tag), (paper, tag), (paper, f"Eq. {tag}")
                    found = next((name for name in names if name in known), None)
                    if found is None:
                        raise ValueError(f"{paper} {kind}{tag} in {text!r} is not in {ITEMS}")
                    yield found


def span(first: str, last: str | None) -> list[str]:
    """All tags from the first to the last: A.1, A.2, A.3 for A.1-A.3."""
    if last is None:
        return [first]
    head, start = re.fullmatch(r"(\D*(?:\d+\.)?)(\d+)", first).groups()
    stop = re.search(r"\d+$", last)[0]
    return [f"{head}{number}" for number in range(int(start), int(stop) + 1)]


def citations(root: Path) -> Iterator[tuple[str, str]]:
    """Everything that cites: a file of the repository, and what it says."""
    modules = find_modules(root / "s2glib")
    for name, header in read_headers(modules).items():
        file = modules[name].relative_to(root).as_posix()
        yield file, header.paper
        for text in BRACKETS.findall(modules[name].read_text(encoding="utf-8")):
            yield file, text
    for path in sorted((root / "notebooks").glob("[0-9][0-9]_*.ipynb")):
        notebook, file = json.loads(path.read_text("utf-8")), path.relative_to(root).as_posix()
        for paper, items in notebook["metadata"]["s2g"]["papers"].items():
            yield file, f"{paper} {', '.join(items)}"
        for text in BRACKETS.findall("\n".join("".join(c["source"]) for c in notebook["cells"])):
            yield file, text


def find_coverage(root: Path) -> dict[Item, list[str]]:
    """For each item of the supplements, the files that cite it, modules before notebooks."""
    known, files = citable(root), {item: set() for item in read_items(root)}
    for file, text in citations(root):
        for item in cited(text, known):
            files.get(item, set()).add(file)
    return {
        item: sorted(citing, key=lambda file: (is_notebook(file), file))
        for item, citing in files.items()
    }


def is_notebook(file: str) -> bool:
    return file.endswith(".ipynb")


def grouped(items: list[Item]) -> dict[str, list[str]]:
    return {paper: [item for mine, item in items if mine == paper] for paper in PAPERS}


def render_coverage(root: Path) -> str:
    """The whole of docs/coverage.json."""
    coverage = find_coverage(root)
    without = [item for item, files in coverage.items() if not any(map(is_notebook, files))]
    document = {
        "about": "Made by `python tests/test_coverage.py`; do not edit.",
        "covered": {
            paper: {item: coverage[paper, item] for item in items if coverage[paper, item]}
            for paper, items in grouped(list(coverage)).items()
        },
        "open": grouped([item for item in without if not coverage[item]]),
        "in modules only": grouped([item for item in without if coverage[item]]),
    }
    return json.dumps(document, indent=1) + "\n"


def gaps(root: Path) -> list[Item]:
    """What no notebook shows, once all notebooks are there."""
    if not all((root / "notebooks" / f"{name}.ipynb").exists() for name in NOTEBOOK_NAMES):
        return []
    coverage = find_coverage(root)
    return [item for item, files in coverage.items() if not any(map(is_notebook, files))]


def render_equations(root: Path) -> str:
    """The whole of docs/EQUATIONS.md."""
    coverage, lines = find_coverage(root), [TITLE]
    for paper, name in PAPERS.items():
        lines += [f"\n## {name}\n", "| equation | what | code | notebook |", "|---|---|---|---|"]
        for (mine, item), what in read_items(root).items():
            if mine == paper and item.startswith("Eq. "):
                files = coverage[mine, item]
                code = ", ".join(link(file) for file in files if not is_notebook(file))
                taught = ", ".join(link(file) for file in files if is_notebook(file))
                short = item.removeprefix("Eq. ").replace("_", r"\_")
                lines.append(f"| {short} | {what} | {code or '-'} | {taught or '-'} |")
    return "\n".join(lines) + "\n"


def link(file: str) -> str:
    path = Path(file)
    name = path.stem if is_notebook(file) else ".".join(path.with_suffix("").parts[1:])
    return f"[{name.replace('_', chr(92) + '_')}](../{file})"


RENDERED = {COVERAGE: render_coverage, EQUATIONS: render_equations}
ITEM = {"sections": {"B": "all", "B.1": "one"}, "equations": {"Eq. A1": "x", "Eq. L_a": "y"}}
LIST = {
    paper: ITEM | {"figures": {}, "tables": {"Tab. 2": "z"}, "main": ["3.2"]} for paper in PAPERS
}


@pytest.fixture
def house(tmp_path):
    """A package with one module, one notebook, and a short list of items."""
    page = {"metadata": {"s2g": {"papers": {"AM": ["B"]}}}, "cells": [{"source": ["# [PT B.1]"]}]}
    files = {
        "s2glib/__init__.py": "",
        "s2glib/warping/tps.py": HEADED.replace("A5", "A1") + "x = 1  # [MDD B.1]\n",
        "notebooks/02_thin_plate_splines.ipynb": json.dumps(page),
        ITEMS: json.dumps(LIST),
    }
    plant(tmp_path, files)
    return tmp_path


def test_the_committed_files_are_fresh():
    for file, render in RENDERED.items():
        fresh = (ROOT / file).exists() and (ROOT / file).read_text("utf-8") == render(ROOT)
        assert fresh, f"{file} is stale: run python tests/test_coverage.py"


def test_in_the_end_a_notebook_shows_every_item():
    assert gaps(ROOT) == []


def test_each_item_is_listed_once_and_every_number_is_there():
    papers = json.loads((ROOT / ITEMS).read_text(encoding="utf-8"))
    for kind, paper in itertools.product(("equations", "figures", "tables"), PAPERS):
        tags = [re.search(r"\d+$", item) for item in papers[paper][kind]]
        numbers = [int(tag[0]) for tag in tags if tag]
        assert {b - a for a, b in itertools.pairwise(numbers)} <= {1}
    listed = grouped(list(read_items(ROOT)))
    assert {paper: len(items) for paper, items in listed.items()} == {"PT": 12, "AM": 45, "MDD": 44}


@pytest.mark.parametrize(
    ("text", "items"),
    [
        ("-", []),
        ("ours", []),
        ("MDD Sup. B.2, Eqs. B10-B12", ["MDD B.2", "MDD Eq. B10", "MDD Eq. B11", "MDD Eq. B12"]),
        ("AM B.2 (EA, SA), AM E (2 x 21 points)", ["AM B.2", "AM E"]),
        ("MDD B.1 (Eqs. B6-B7), B.5", ["MDD B.1", "MDD Eq. B6", "MDD Eq. B7", "MDD B.5"]),
        ("AM Tabs. A.1-A.2, C.3, D", ["AM Tab. A.1", "AM Tab. A.2", "AM C.3", "AM D"]),
        ("PT B Tab. 7-8 (BC); AM Fig. A.10", ["PT B", "PT Tab. 7", "PT Tab. 8", "AM Fig. A.10"]),
        ("MDD B16", ["MDD Eq. B16"]),
        ("AM Eq. L_self, Tab. 1", ["AM Eq. L_self", "AM Tab. 1"]),
        ("MDD, authors' code: 999, 979", []),
        ("PT A.2 (SMPL-X); for AM: ours in 6D", ["PT A.2"]),
    ],
)
def test_a_citation_is_read(text, items):
    assert [" ".join(item) for item in cited(text, citable(ROOT))] == items


@pytest.mark.parametrize(
    "text", ["AM B.7", "MDD Eq. B22", "PT Fig. 4", "AM Tab. A.1-A.6", "MDD Eqs. A1, A6", "PT 3.1"]
)
def test_an_item_that_no_paper_has_is_refused(text):
    with pytest.raises(ValueError, match="is not in docs/paper_items"):
        list(cited(text, citable(ROOT)))


def test_headers_comments_and_notebooks_count(house):
    module, notebook = "s2glib/warping/tps.py", "notebooks/02_thin_plate_splines.ipynb"
    found = {item: files for item, files in find_coverage(house).items() if files}
    assert found == {
        ("MDD", "Eq. A1"): [module],
        ("MDD", "B.1"): [module],
        ("AM", "B"): [notebook],
        ("PT", "B.1"): [notebook],
    }


def test_every_item_is_covered_or_said_to_be_open(house):
    document = json.loads(render_coverage(house))
    listed = [
        item for paper in PAPERS for item in (*document["covered"][paper], *document["open"][paper])
    ]
    assert len(listed) == len(read_items(house)) == 15
    assert document["open"]["MDD"] == ["B", "Eq. L_a", "Tab. 2"]
    assert document["in modules only"] == {"PT": [], "AM": [], "MDD": ["B.1", "Eq. A1"]}


def test_the_index_links_code_and_notebooks(house):
    rows = render_equations(house).splitlines()
    assert "| A1 | x | [warping.tps](../s2glib/warping/tps.py) | - |" in rows
    assert r"| L\_a | y | - | - |" in rows


def test_gaps_count_only_when_all_notebooks_are_there(house):
    assert gaps(house) == []
    empty = json.dumps({"metadata": {"s2g": {"papers": {}}}, "cells": []})
    plant(house, {f"notebooks/{name}.ipynb": empty for name in NOTEBOOK_NAMES})
    assert len(gaps(house)) == len(read_items(house))


if __name__ == "__main__":
    for name, render in RENDERED.items():
        (ROOT / name).write_text(render(ROOT), encoding="utf-8")
