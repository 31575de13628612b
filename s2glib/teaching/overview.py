"""How far a student has come, notebook by notebook.

Paper:    -
Notebook: -
"""

from collections.abc import Container, Iterable, Sequence
from pathlib import Path

from IPython.display import display

from s2glib.teaching.exercises import all_exercises
from s2glib.teaching.progress import recorded
from s2glib.teaching.questions import QUESTIONS

NOTEBOOKS = Path(__file__).resolve().parents[2] / "notebooks"
COLUMNS = ("notebook", "opened", "exercises solved", "questions answered")


def progress() -> None:
    """Show which notebooks were opened, which exercises solved, and which questions answered."""
    rows = [_row(path) for path in sorted(NOTEBOOKS.glob("[0-9][0-9]_*.ipynb"))]
    widths = [max(map(len, column)) for column in zip(COLUMNS, *rows, strict=True)]
    rule = ["-" * width for width in widths]
    plain = [_aligned(row, widths) for row in (COLUMNS, *rows)]
    marked = [f"| {' | '.join(row)} |" for row in (COLUMNS, rule, *rows)]
    shown = {"text/markdown": "\n".join(marked), "text/plain": "\n".join(plain)}
    display(shown, raw=True)


def _aligned(row: Sequence[str], widths: Sequence[int]) -> str:
    return "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()


def _row(notebook: Path) -> tuple[str, ...]:
    number, _, words = notebook.stem.partition("_")
    done = recorded()
    solved = {id for id, states in done.get("exercise", {}).items() if "solved" in states}
    return (
        f"{number} {words.replace('_', ' ').capitalize()}",
        "yes" if number in done.get("notebook", {}) else "",
        _share(number, all_exercises(), solved),
        _share(number, (question.id for question in QUESTIONS), done.get("question", {})),
    )


def _share(number: str, ids: Iterable[str], done: Container[str]) -> str:
    """How many of a notebook's ids are done, such as "2 of 3"; nothing where there are none."""
    mine = [id for id in ids if id.startswith(number)]
    return f"{sum(id in done for id in mine)} of {len(mine)}" if mine else ""
