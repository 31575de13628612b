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
"""
COMMITTED = sorted(build.NOTEBOOKS.glob("*.ipynb"))


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A small notebook, built twice."""
    folder = tmp_path_factory.mktemp("notebooks")
    source = folder / "00_small.py"
    source.write_text(SOURCE)
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


def test_the_kernel_works_in_the_notebooks_folder_with_one_thread(built):
    notebook = nbformat.reads(built[0], as_version=4)
    assert notebook.cells[-1].outputs[0].text.split()[0] == "1"
    assert notebook.cells[-1].outputs[0].text.split()[1].startswith("notebooks")


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


def test_every_source_is_built():
    sources = build.find_sources(build.NOTEBOOKS / "source", [])
    assert [path.stem for path in sources] == [path.stem for path in COMMITTED]


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: path.stem)
def test_a_committed_notebook_is_its_source_executed_in_order(path):
    notebook = nbformat.read(path, as_version=4)
    source = build.read_source(build.NOTEBOOKS / "source" / f"{path.stem}.py")
    assert [cell.source for cell in notebook.cells] == [cell.source for cell in source.cells]
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert "widgets" not in notebook.metadata
    assert build.WIDGET_VIEW not in path.read_text()
