"""The committed notebooks: small, compared in every section, and free of what breaks comparison."""

import itertools
import re
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).resolve().parents[1]
COMMITTED = sorted((ROOT / "notebooks").glob("[0-9][0-9]_*.ipynb"))
LARGEST = 600_000  # bytes
FORBIDDEN = re.compile(
    r"interact\(|Output\(|clear_output|tqdm|%time|^!|time\.\w+\(|https?://|plt\.show|/(home|tmp|root)/",
    re.MULTILINE,
)


def headings(notebook) -> list[tuple[int, str]]:
    """Level and words of every heading, in order."""
    texts = (cell.source for cell in notebook.cells if cell.cell_type == "markdown")
    lines = (line for text in texts for line in text.splitlines())
    found = (re.match(r"(#+) (.*)", line) for line in lines)
    return [(len(match[1]), match[2]) for match in found if match]


def is_compared(cell) -> bool:
    """Whether nbval compares a text that this cell wrote."""
    kinds = {kind for output in cell.outputs for kind in output.get("data", {"text/plain": 0})}
    ignored = "nbval-ignore-output" in cell.metadata.get("tags", [])
    return not ignored and any(kind.startswith("text/") for kind in kinds)


def code_by_section(notebook) -> list[list]:
    """The code cells below each second-level heading; what comes before the first is a section."""
    sections = [[]]
    for cell in notebook.cells:
        if cell.cell_type == "code":
            sections[-1].append(cell)
        elif re.search(r"^## ", cell.source, re.MULTILINE):
            sections.append([])
    return [cells for cells in sections if cells]


@pytest.fixture(params=COMMITTED, ids=lambda path: path.stem)
def path(request):
    return request.param


@pytest.fixture
def notebook(path):
    return nbformat.read(path, as_version=4)


def test_it_is_small(path):
    assert path.stat().st_size <= LARGEST


def test_most_cells_are_compared_and_every_section_has_one(notebook):
    sections = code_by_section(notebook)
    cells = [cell for section in sections for cell in section]
    assert sum(map(is_compared, cells)) >= 0.6 * len(cells)
    assert all(any(map(is_compared, section)) for section in sections)


def test_it_has_one_title_and_no_heading_skips_a_level(notebook):
    levels = [level for level, _ in headings(notebook)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(deeper <= level + 1 for level, deeper in itertools.pairwise(levels))


def test_its_code_holds_nothing_that_breaks_comparison(notebook):
    code = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "code")
    assert FORBIDDEN.findall(code) == []


def test_its_links_lead_somewhere(path, notebook):
    text = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "markdown")
    targets = re.findall(r"\]\(([^)#]+)", text)
    assert [target for target in targets if not (path.parent / target).exists()] == []


def test_it_says_what_it_is_for(path, notebook):
    card = notebook.metadata["s2g"]
    assert card["id"] == path.stem[:2]
    assert card["goals"]
    assert card["minutes"] > 0
    assert all(need < card["id"] for need in card["needs"])


@pytest.mark.parametrize(
    "code",
    [
        "interact(draw, x=3)",
        "out = widgets.Output()",
        "import tqdm",
        "x = 1\n%timeit x",
        "!pip install x",
        "start = time.perf_counter()",
        "load('/home/me/x.wav')",
        "get('https://x.org')",
    ],
)
def test_forbidden_code_is_found(code):
    assert FORBIDDEN.findall(code)


@pytest.mark.parametrize(
    ("outputs", "tags", "compared"),
    [
        ([{"output_type": "stream", "name": "stdout", "text": "3"}], [], True),
        (
            [{"output_type": "stream", "name": "stdout", "text": "3"}],
            ["nbval-ignore-output"],
            False,
        ),
        ([{"output_type": "display_data", "data": {"image/png": ""}, "metadata": {}}], [], False),
        ([], [], False),
    ],
)
def test_a_cell_is_compared_where_it_wrote_text(outputs, tags, compared):
    cell = nbformat.v4.new_code_cell("x", outputs=outputs, metadata={"tags": tags})
    assert is_compared(nbformat.from_dict(cell)) == compared
