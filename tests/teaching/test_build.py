"""The notebook build: what it keeps, what it drops, and that the committed notebooks are fresh."""

import nbformat
import pytest
from nbclient.exceptions import CellExecutionError

from s2glib.teaching import build

SOURCE = """\
# ---
# jupyter:
#   s2g: {"id": "00"}
# ---

# %% [markdown]
# # Title

# %% tags=["s2g-demo"]
import os
import ipywidgets
ipywidgets.IntSlider(7)



# %%
print(os.environ["OMP_NUM_THREADS"], os.path.basename(os.getcwd()))
print(os.environ.get("S2G_STRICT"), os.listdir(os.environ["S2G_HOME"]))
"""
COMMITTED = sorted(build.NOTEBOOKS.glob("*.ipynb"))


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A small notebook, built twice."""
    folder = tmp_path_factory.mktemp("notebooks")
    source = folder / "00_small.py"
    source.write_text(SOURCE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("S2G_STRICT", "1")
        return [build.build(source, folder).read_text() for _ in range(2)]


def test_a_build_repeats_to_the_byte(built):
    assert built[0] == built[1]


def test_a_built_notebook_counts_its_cells_and_keeps_no_widget(built):
    notebook = nbformat.reads(built[0], as_version=4)
    markdown, widget, last = notebook.cells
    assert markdown.source == "# Title"
    assert (widget.execution_count, last.execution_count) == (1, 2)
    assert widget.metadata == {"tags": ["s2g-demo"]}
    assert widget.outputs[0].data.keys() == {"text/plain"}
    assert notebook.metadata == build.KERNEL | {"s2g": {"id": "00"}}


def test_the_kernel_works_in_the_notebooks_folder_with_one_thread_for_a_newcomer(built):
    notebook = nbformat.reads(built[0], as_version=4)
    place, student = notebook.cells[-1].outputs[0].text.splitlines()
    assert place.startswith("1 notebooks")
    assert student == "None []"


def test_a_failing_cell_leaves_nothing_behind(tmp_path):
    source = tmp_path / "00_broken.py"
    source.write_text("# %%\nraise RuntimeError('no')\n")
    with pytest.raises(CellExecutionError, match="no"):
        build.build(source, tmp_path)
    assert list(tmp_path.iterdir()) == [source]


def test_sources_are_found_by_number(tmp_path):
    for name in ("00_a.py", "01_b.py", "notes.py"):
        (tmp_path / name).touch()
    assert [path.stem for path in build.find_sources(tmp_path, [])] == ["00_a", "01_b"]
    assert [path.stem for path in build.find_sources(tmp_path, ["01"])] == ["01_b"]


@pytest.mark.parametrize("number", ["07", "", "0"])
def test_a_number_without_a_source_is_refused(tmp_path, number):
    (tmp_path / "00_a.py").touch()
    with pytest.raises(ValueError, match="give two digits"):
        build.find_sources(tmp_path, [number])


EXERCISE = """\
# %% tags=["s2g-exercise"]
def half(x):
    ...

# %% tags=["s2g-solution"]
def half(x):
    return x / 2

# %%
print(half(3))
"""


def plant(folder, *names, text=SOURCE):
    """Write sources and read them as notebooks, as if built."""
    (folder / "source").mkdir(exist_ok=True)
    for name in names:
        source = folder / "source" / f"{name}.py"
        source.write_text(text)
        notebook = build.read_source(source)
        build.tidy(notebook)
        nbformat.write(notebook, folder / f"{name}.ipynb")


def test_students_find_exercises_without_solutions_and_tests_put_them_in(tmp_path):
    source = tmp_path / "00_half.py"
    source.write_text(EXERCISE)
    student, solved = (build.read_source(source, solved=solved) for solved in (False, True))
    assert [cell.source for cell in student.cells] == ["def half(x):\n    ...", "print(half(3))"]
    assert [cell.source for cell in solved.cells] == [
        "def half(x):\n    return x / 2",
        "print(half(3))",
    ]
    for cell, twin in zip(student.cells, solved.cells, strict=True):
        assert (cell.id, cell.metadata) == (twin.id, twin.metadata)


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ("s2g-solution", "other", "def half"),
        ("s2g-exercise", "other", "def half"),
        ("# %%\nprint", '# %% tags=["s2g-exercise"]\nprint', "print"),
        ('# %% tags=["s2g-sol', '# %% [markdown]\n# A word.\n\n# %% tags=["s2g-sol', "def half"),
    ],
    ids=["no solution", "no exercise", "exercise at the end", "something between"],
)
def test_an_exercise_and_its_solution_belong_together(tmp_path, old, new, where):
    source = tmp_path / "00_half.py"
    source.write_text(EXERCISE.replace(old, new))
    with pytest.raises(ValueError, match=rf"in 00_half.py.*missing at '{where}"):
        build.read_source(source)


def test_what_is_built_from_its_source_has_no_faults(tmp_path):
    plant(tmp_path, "00_a", "01_b")
    assert list(build.find_faults(tmp_path, [])) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [("# Title", "# Another"), ("s2g-demo", "other"), ('"00"', '"01"'), ("\n\n# %%", "\n")],
    ids=["text", "tag", "header", "cells"],
)
def test_a_changed_source_makes_its_notebook_stale(tmp_path, old, new):
    plant(tmp_path, "00_a", "01_b")
    (tmp_path / "source" / "01_b.py").write_text(SOURCE.replace(old, new))
    assert list(build.find_faults(tmp_path, [])) == ["01_b.ipynb differs from its source"]
    assert list(build.find_faults(tmp_path, ["00"])) == []


def test_a_missing_notebook_and_a_missing_source_are_found(tmp_path):
    plant(tmp_path, "00_a", "01_b")
    (tmp_path / "source" / "00_a.py").unlink()
    (tmp_path / "01_b.ipynb").unlink()
    assert list(build.find_faults(tmp_path, [])) == [
        "01_b.ipynb is not built",
        "00_a.ipynb has no source",
    ]


@pytest.mark.parametrize(("text", "status"), [(SOURCE, 0), ("# %%\n1\n", 1)])
def test_check_names_what_is_stale_and_runs_nothing(tmp_path, monkeypatch, capsys, text, status):
    plant(tmp_path, "00_a")
    (tmp_path / "source" / "00_a.py").write_text(text)
    monkeypatch.setattr(build, "NOTEBOOKS", tmp_path)
    monkeypatch.setattr(build, "build", None)
    assert build.main(["--check"]) == status
    assert ("00_a.ipynb differs from its source" in capsys.readouterr().out) == bool(status)


def test_the_committed_notebooks_are_what_their_sources_say():
    assert list(build.find_faults(build.NOTEBOOKS, [])) == []


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: path.stem)
def test_a_committed_notebook_keeps_no_widget(path):
    assert build.WIDGET_VIEW not in path.read_text()
