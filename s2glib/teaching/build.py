"""Build the notebooks: execute each source, tidy it, and validate it as on another processor.

A source is `notebooks/source/NN_name.py` in jupytext's percent form; the built notebook is
`notebooks/NN_name.ipynb`, committed with its outputs. Run as `python3 workbook.py build [NN ...]`.
In a source, the cell after an exercise is its solution. Students get the notebook without them;
tests put them into the exercises' cells, and every output must stay the same (see conftest.py).

Paper:    -
Notebook: -
"""

import argparse
import os
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import jupytext
import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode

from s2glib.teaching.keeping import WIDGET_VIEW, keep_players

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = ROOT / "notebooks"
CELL_TIMEOUT = 300  # seconds
EXERCISE, SOLUTION = "s2g-exercise", "s2g-solution"  # tags of cells
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


def read_source(path: Path, *, solved: bool = False) -> NotebookNode:
    """Read a source as a notebook without outputs; its cells get lasting ids.

    Args:
        path: the source.
        solved: whether exercises hold their solutions instead of what students find there.

    Raises:
        ValueError: an exercise is not followed by its solution, or a solution follows none.
    """
    notebook = jupytext.read(path)
    for before, cell in pairwise([None, *notebook.cells, None]):
        if has_tag(before, EXERCISE) != has_tag(cell, SOLUTION):
            raise ValueError(
                f"in {path.name}, an {EXERCISE} cell and the {SOLUTION} cell right after it belong "
                f"together; one of them is missing at {(before or cell).source[:60]!r}"
            )
        if solved and has_tag(cell, SOLUTION):
            before.source = cell.source
    notebook.cells = [cell for cell in notebook.cells if not has_tag(cell, SOLUTION)]
    for index, cell in enumerate(notebook.cells):
        cell.id = f"cell-{index:02d}"
        cell.metadata.pop("lines_to_next_cell", None)
    header = {key: value for key, value in notebook.metadata.items() if key == "s2g"}
    notebook.metadata = NotebookNode(header)
    return notebook


def has_tag(cell: NotebookNode | None, tag: str) -> bool:
    """Whether there is a cell and it has this tag."""
    return cell is not None and tag in cell.metadata.get("tags", [])


def find_faults(folder: Path, numbers: Sequence[str]) -> Iterator[str]:
    """Say which notebooks in `folder` are not what the sources in `folder/source` say.

    Nothing is executed. A notebook without a source is a fault too.
    """
    sources = find_sources(folder / "source", numbers)
    for source in sources:
        built = folder / f"{source.stem}.ipynb"
        if not built.exists():
            yield f"{built.name} is not built"
        elif differs(source, built):
            yield f"{built.name} differs from its source"
    if not numbers:
        with_source = {source.stem for source in sources}
        for built in sorted(folder.glob("[0-9][0-9]_*.ipynb")):
            if built.stem not in with_source:
                yield f"{built.name} has no source"


def differs(source: Path, built: Path) -> bool:
    """Whether cells, tags or header differ, anything but outputs and execution counts."""
    expected = read_source(source)
    tidy(expected)
    return outline(expected) != outline(nbformat.read(built, as_version=4))


def outline(notebook: NotebookNode) -> tuple[dict, list]:
    """What a source decides about a notebook."""
    cells = [(cell.id, cell.cell_type, cell.source, cell.metadata) for cell in notebook.cells]
    return notebook.metadata, cells


def execute(notebook: NotebookNode, folder: Path) -> None:
    """Run all cells, in place, in a kernel that works in `folder`, as a newcomer would."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    environment = os.environ | settings["tool"]["s2glib"]["kernel-environment"]
    environment.pop("S2G_STRICT", None)
    client = NotebookClient(
        notebook,
        timeout=CELL_TIMEOUT,
        kernel_name="python3",
        resources={"metadata": {"path": str(folder)}},
        record_timing=False,
        coalesce_streams=True,
    )
    with tempfile.TemporaryDirectory() as home:
        client.execute(env=environment | {"S2G_HOME": home})


def tidy(notebook: NotebookNode) -> None:
    """Drop, in place, what makes a reopened notebook large or shows as an error.

    Widget state would be megabytes, and a widget's view without it reads "model not found"; the
    static preview beside the view stays, and what a player plays goes beside it.
    """
    keep_players(notebook)
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

    A text that differs there will differ on a reader's machine: print a verdict instead of it. Each
    notebook runs as it is and with its exercises solved.
    """
    workers = ["-n", "2", "--dist", "loadfile"]
    command = [sys.executable, "-m", "pytest", "-q", "--nbval", *workers, *map(str, notebooks)]
    return subprocess.run(command, cwd=ROOT, env=os.environ | OTHER_PROCESSOR).returncode


def main(arguments: Sequence[str]) -> int:
    """Build and validate the named notebooks, or with `--check` say which of them are stale."""
    parser = argparse.ArgumentParser(prog="workbook.py build")
    parser.add_argument("numbers", nargs="*", metavar="NN", help="all notebooks without one")
    parser.add_argument("--check", action="store_true", help="only compare with the sources")
    options = parser.parse_args(arguments)
    if options.check:
        faults = list(find_faults(NOTEBOOKS, options.numbers))
        print("\n".join(faults) or "every notebook is what its source says")
        return 1 if faults else 0
    built = []
    for source in find_sources(NOTEBOOKS / "source", options.numbers):
        print(f"building {source.stem} ...", flush=True)
        built.append(build(source, NOTEBOOKS))
    return validate(built)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
