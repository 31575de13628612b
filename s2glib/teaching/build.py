"""Build the notebooks: execute each source, tidy it, and validate it as on another processor.

A source is `notebooks/source/NN_name.py` in jupytext's percent form; the built notebook is
`notebooks/NN_name.ipynb`, committed with its outputs. Run as `python3 workbook.py build [NN ...]`.

Paper:    -
Notebook: -
"""

import os
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path

import jupytext
import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = ROOT / "notebooks"
CELL_TIMEOUT = 300  # seconds
WIDGET_VIEW = "application/vnd.jupyter.widget-view+json"
KERNEL = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
OTHER_PROCESSOR = {"ATEN_CPU_CAPABILITY": "default", "ONEDNN_MAX_CPU_ISA": "SSE41"}


def find_sources(folder: Path, numbers: Sequence[str]) -> list[Path]:
    """List the sources whose names begin with one of `numbers`; all of them without numbers.

    Raises:
        ValueError: a number has no source, or more than one.
    """
    if not numbers:
        return sorted(folder.glob("[0-9][0-9]_*.py"))
    found = [sorted(folder.glob(f"{number}_*.py")) for number in numbers]
    for number, paths in zip(numbers, found, strict=True):
        if len(paths) != 1:
            raise ValueError(
                f"expected one source named {number}_*.py in {folder}, found {len(paths)}; "
                "give two digits, such as 00"
            )
    return [path for (path,) in found]


def read_source(path: Path) -> NotebookNode:
    """Read a source as a notebook without outputs; its cells get lasting ids."""
    notebook = jupytext.read(path)
    for index, cell in enumerate(notebook.cells):
        cell.id = f"cell-{index:02d}"
        cell.metadata.pop("lines_to_next_cell", None)
    header = {key: value for key, value in notebook.metadata.items() if key == "s2g"}
    notebook.metadata = NotebookNode(header)
    return notebook


def execute(notebook: NotebookNode, folder: Path) -> None:
    """Run all cells, in place, in a kernel that works in `folder`."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    environment = os.environ | settings["tool"]["s2glib"]["kernel-environment"]
    client = NotebookClient(
        notebook,
        timeout=CELL_TIMEOUT,
        kernel_name="python3",
        resources={"metadata": {"path": str(folder)}},
        record_timing=False,
        coalesce_streams=True,
    )
    client.execute(env=environment)


def tidy(notebook: NotebookNode) -> None:
    """Drop, in place, what makes a reopened notebook large or shows as an error.

    Widget state would be megabytes, and a widget's view without it reads "model not found"; the
    static preview beside the view stays.
    """
    notebook.metadata.pop("widgets", None)
    notebook.metadata.update(KERNEL)
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            output.get("data", {}).pop(WIDGET_VIEW, None)


def build(source: Path, folder: Path) -> Path:
    """Execute one source and write the notebook into `folder`, whole or not at all."""
    notebook = read_source(source)
    execute(notebook, folder)
    tidy(notebook)
    nbformat.validate(notebook)
    target = folder / f"{source.stem}.ipynb"
    part = target.with_suffix(".part")
    nbformat.write(notebook, part)
    part.replace(target)
    return target


def validate(notebooks: Sequence[Path]) -> int:
    """Compare stored outputs with a run on other arithmetic; return pytest's exit status.

    A text that differs there will differ on a reader's machine: print a verdict instead of it.
    """
    command = [sys.executable, "-m", "pytest", "-q", "--nbval", *map(str, notebooks)]
    return subprocess.run(command, cwd=ROOT, env=os.environ | OTHER_PROCESSOR).returncode


def main(numbers: Sequence[str]) -> int:
    """Build and validate the notebooks with these numbers, all of them without numbers."""
    built = []
    for source in find_sources(NOTEBOOKS / "source", numbers):
        print(f"building {source.stem} ...", flush=True)
        built.append(build(source, NOTEBOOKS))
    return validate(built)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
