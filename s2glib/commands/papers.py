"""Print what the papers report, table by table.

Paper:    AM Tabs. A.1-A.5, C.3, D, E, F
Notebook: -
"""

import json
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping
from importlib.resources import files
from typing import Any

PAPERS = ("amuse",)


def describe(parser: ArgumentParser) -> None:
    """It takes no arguments."""


def run(options: Namespace) -> int:
    """Print the papers' numbers."""
    for paper in PAPERS:
        text = (files("s2glib.papers") / paper / "printed.json").read_text("utf-8")
        print("\n".join(lines(json.loads(text, parse_float=str))))  # digits as printed
    return 0


def lines(printed: Mapping[str, Any]) -> Iterator[str]:
    """A paper's tables, then the numbers in its text."""
    yield f"{printed['paper']}, as printed"
    for table in printed["tables"]:
        yield from ("", f"{table['where']}  {table['what']}")
        cells = [["", *table["columns"]]]
        cells += [[name, *map(_cell, row)] for name, row in table["rows"].items()]
        yield from aligned(cells)
        yield from _remark(table)
    yield ""
    for said in printed["statements"]:
        unit = said.get("unit", "")
        yield f"{said['where']:<5}{said['what']}: {said['value']} {unit}".rstrip()
        yield from _remark(said)


def aligned(cells: list[list[str]]) -> list[str]:
    """Rows of cells as columns: the first to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return [
        "  ".join(
            [row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])],
        ).rstrip()
        for row in cells
    ]


def _cell(value: str | int | None) -> str:
    return "-" if value is None else str(value)


def _remark(entry: Mapping[str, Any]) -> list[str]:
    return [f"     ({entry['remark']})"] if "remark" in entry else []
