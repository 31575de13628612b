"""The committed notebooks keep every rule, and every rule finds the fault that it is there for."""

from pathlib import Path

import nbformat
import pytest
from nbformat.v4 import new_output
from notebook_rules import RULES, is_compared

from s2glib.teaching import build

COMMITTED = sorted(build.NOTEBOOKS.glob("[0-9][0-9]_*.ipynb"))
CAPTION = "Two lines that cross in the middle; look where they do."
HEADER = (
    '{"id": "01", "minutes": 40, "needs": ["00"], "goals": ["halve"], "papers": {"MDD": ["B.5"]}, '
    '"demos": ["toy arm"], "exercises": ["01-1"], "questions": ["01-p1"], "data": ["shipped"], '
    '"budget_s": 25, "reached": {"halve": ["01-1", "01-p1"]}}'
)
SOURCE = f"""\
# ---
# jupyter:
#   s2g: {HEADER}
# ---

# %% [markdown]
# # Halves: where is the middle?
#
# After [the start](00_start.ipynb#A-start). See [below](#2.-Do-it-yourself).

# %% tags=["s2g-setup"]
setup("01")

# %% [markdown]
# ## 1. A *picture*

# %% tags=["s2g-figure"]
figure(fig, "...")

# %% [markdown]
# ## 2. Do it `yourself`

# %% tags=["s2g-exercise"]
def half(x):
    ...

# %% tags=["s2g-solution"]
def half(x):
    return x / 2

# %% tags=["s2g-check", "nbval-ignore-output"]
half = check("01-1", half)

# %%
ask("01-p1")

# %% tags=["s2g-demo"]
ToyArm()

# %%
report(half=half(3))
"""
WORDS = new_output("stream", text="half : 1.5\n")
SHOWN = new_output("display_data", {"text/markdown": f"**Figure.** {CAPTION}", "text/plain": "x"})
PICTURE = new_output("display_data", {"image/png": "/tmp/", "text/plain": "figure"})
SETUP, FIGURE, STUB, CHECK, ASK, DEMO, REPORT = 1, 3, 5, 6, 7, 8, 9  # places of cells
VIEW = new_output("execute_result", {"text/plain": "ToyArm: needs a kernel"})
OUTPUTS = {SETUP: [WORDS], FIGURE: [PICTURE, SHOWN], ASK: [WORDS], DEMO: [VIEW], REPORT: [WORDS]}


@pytest.fixture
def lesson(tmp_path):
    """A small notebook without faults, beside another; and where to save it."""
    (tmp_path / "source").mkdir()
    start = nbformat.v4.new_notebook(cells=[nbformat.v4.new_markdown_cell("# A start")])
    nbformat.write(start, tmp_path / "00_start.ipynb")
    path = tmp_path / "01_halves.ipynb"
    source = tmp_path / "source" / "01_halves.py"
    source.write_text(SOURCE)
    notebook = build.read_source(source)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    for count, cell in enumerate(code, start=1):
        cell.execution_count = count
    for place, outputs in OUTPUTS.items():
        notebook.cells[place].outputs = nbformat.from_dict(outputs)
    nbformat.write(notebook, path)
    return path, notebook


def faults(path: Path, notebook) -> list[str]:
    nbformat.write(notebook, path)
    return [fault for rule in RULES for fault in rule(path, notebook)]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: path.stem)
def test_a_committed_notebook_keeps_the_rule(path, rule):
    assert list(rule(path, nbformat.read(path, as_version=4))) == []


def test_a_lesson_without_faults_has_none(lesson):
    assert faults(*lesson) == []


@pytest.mark.parametrize(
    ("key", "value", "fault"),
    [
        ("id", "02", "header: the id is '02'"),
        ("id", 1, "header: wrong or missing ['id'], unknown []"),
        ("minute", 40, "header: wrong or missing [], unknown ['minute']"),
        ("minutes", 0, "header: minutes or budget_s is out of bounds"),
        ("budget_s", 46, "header: minutes or budget_s is out of bounds"),
        ("needs", ["01"], "header: it needs 01, which is no earlier notebook"),
        ("needs", ["0"], "header: it needs 0, which is no earlier notebook"),
        ("goals", ["halve", "double"], "header: `reached` does not list the goals"),
        ("reached", {"halve": []}, "header: 'halve' is reached by []"),
        ("reached", {"halve": ["01-9"]}, "header: 'halve' is reached by ['01-9']"),
        ("questions", ["01-p1", "01-p2"], "header: questions are ['01-p1', '01-p2'], in the cells"),
        ("exercises", ["01-1", "01-2"], "header: exercises are ['01-1', '01-2'], in the cells"),
        ("demos", ["wave"], "header: no cell shows the demo 'wave'"),
    ],
)
def test_a_wrong_header_is_found(lesson, key, value, fault):
    path, notebook = lesson
    notebook.metadata.s2g[key] = nbformat.from_dict(value)
    found = faults(path, notebook)
    assert len(found) == 1
    assert found[0].startswith(fault)


@pytest.mark.parametrize("key", ["papers", "data"])
def test_a_missing_key_of_the_header_is_found(lesson, key):
    path, notebook = lesson
    del notebook.metadata.s2g[key]
    assert faults(path, notebook) == [f"header: wrong or missing ['{key}'], unknown []"]


@pytest.mark.parametrize(
    ("code", "fault"),
    [
        ("interact(draw, x=3)", "Cell 6 uses interact"),
        ("out = widgets.Output()", "Cell 6 uses an Output widget"),
        ("clear_output()", "Cell 6 uses clear_output"),
        ("from tqdm import tqdm", "Cell 6 uses tqdm"),
        ("%timeit x", "Cell 6 uses a timing magic"),
        ("start = time.perf_counter()", "Cell 6 uses a clock"),
        ("!pip install x", "Cell 6 uses a shell"),
        ("%pip install x", "Cell 6 uses a shell"),
        ("x;", "Cell 6 uses a trailing semicolon"),
        ("plt.show()", "Cell 6 uses plt.show"),
        ("get('https://x.org')", "Cell 6 uses the network"),
        ("from urllib import request", "Cell 6 uses the network"),
        ("load('/home/me/x.wav')", "cell-09 holds an absolute path"),
        (r"load('C:\\Users')", "cell-09 holds an absolute path"),
        ("def load_clip(a, b): ...", "Cell 6 defines load_clip, which the package offers"),
        ("class Motion: ...", "Cell 6 defines Motion, which the package offers"),
        ("figure(fig, '')", "Cell 6 calls figure(...) without the tag s2g-figure, or the reverse"),
    ],
)
def test_forbidden_code_is_found(lesson, code, fault):
    path, notebook = lesson
    notebook.cells[REPORT].source = f"x = 1\n{code}"
    assert faults(path, notebook) == [fault]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("# Another title", "2 titles, the first heading is of level [1]"),
        ("#### Deep", "a heading skips a level: [1, 2, 2, 4]"),
        ("[next](02_next.ipynb)", "a link leads to 02_next.ipynb, which does not exist"),
        ('<a href="no.md">x</a>', "a link leads to no.md, which does not exist"),
        ("[x](#3.-Nowhere)", "a link leads to #3.-Nowhere, which is no heading"),
        ("[x](00_start.ipynb#Start)", "a link leads to #Start, which is no heading"),
        ("![](00_start.ipynb)", "a picture has no description"),
        ("![x](https://x.org/x.png)", "the text loads something from outside"),
        ('<img alt="x" src="//x.org/x.png">', "the text loads something from outside"),
        ("see /tmp/x.png", "cell-04 holds an absolute path"),
        ("word " * 2200, "it has 2219 words"),
    ],
)
def test_a_faulty_text_is_found(lesson, text, fault):
    path, notebook = lesson
    notebook.cells[4].source += f"\n\n{text}"
    assert fault in faults(path, notebook)


@pytest.mark.parametrize(
    ("place", "change", "fault"),
    [
        (SETUP, {"execution_count": 9}, "cells were executed as [9, 2, 3, 4, 5, 6, 7]"),
        (
            REPORT,
            {"outputs": [new_output("error", ename="E", evalue="no"), WORDS]},
            "Cell 6 stored an error",
        ),
        (STUB, {"outputs": [WORDS]}, "the exercise cell-05 writes something"),
        (
            CHECK,
            {"metadata": {"tags": ["s2g-check"]}},
            "the exercise cell-05 has no check after it",
        ),
        (FIGURE, {"outputs": [PICTURE, WORDS]}, "Cell 1 shows no caption"),
        (
            FIGURE,
            {"outputs": [new_output("display_data", {"text/markdown": "**Figure.** Short."})]},
            "Cell 1 has a caption of 6 characters",
        ),
        (
            ASK,
            {"outputs": [new_output("stream", text="saved in /tmp/x")]},
            "cell-07 holds an absolute path",
        ),
        (
            ASK,
            {"outputs": [new_output("display_data", {"text/html": '<img src="http://x">'})]},
            "Cell 4 wrote something that loads from outside",
        ),
        (FIGURE, {"outputs": []}, "nothing is compared in 1. A *picture*"),
        (ASK, {"outputs": []}, "only 4 of 7 code cells are compared"),
        (
            ASK,
            {"outputs": [new_output("stream", text="x" * 1_000_001)]},
            "an output of Cell 4 is too large for nbval",
        ),
    ],
)
def test_a_faulty_cell_is_found(lesson, place, change, fault):
    path, notebook = lesson
    notebook.cells[place].update(nbformat.from_dict(change))
    assert fault in faults(path, notebook)


def test_an_expected_error_is_no_fault(lesson):
    path, notebook = lesson
    error = new_output("error", ename="ValueError", evalue="no")
    notebook.cells[REPORT].update(outputs=[error, WORDS], metadata={"tags": ["raises-exception"]})
    assert faults(path, nbformat.from_dict(notebook)) == []


def test_a_large_file_is_found(lesson):
    path, notebook = lesson
    large = new_output("display_data", {"image/png": "x" * 600_000, "text/plain": "figure"})
    notebook.cells[REPORT].outputs.append(large)
    (fault,) = faults(path, notebook)
    assert fault.startswith("the file has 603")


def test_a_solution_that_defines_something_else_is_found(lesson):
    path, notebook = lesson
    source = path.parent / "source" / "01_halves.py"
    source.write_text(SOURCE.replace("def half(x):\n    return", "def half(y):\n    return"))
    assert faults(path, notebook) == [
        "the solution of cell-05 does not define what its exercise does"
    ]


@pytest.mark.parametrize(
    ("outputs", "tags", "compared"),
    [
        ([WORDS], [], True),
        ([WORDS], ["nbval-ignore-output"], False),
        ([new_output("display_data", {"image/png": ""})], [], False),
        ([], [], False),
    ],
)
def test_a_cell_is_compared_where_it_wrote_text(outputs, tags, compared):
    cell = nbformat.v4.new_code_cell("x", outputs=outputs, metadata={"tags": tags})
    assert is_compared(nbformat.from_dict(cell)) == compared
