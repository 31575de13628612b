"""Measure what the shipped networks reach, beside what the papers print and what we aim at.

Paper:    -
Notebook: -
"""

from argparse import ArgumentParser, Namespace
from pathlib import Path


def describe(parser: ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("name", metavar="NAME", help="a table, such as amuse-speech, or all")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the rows there, too")
    parser.add_argument("--strict", action="store_true", help="exit code 1 if an aim is missed")
    parser.add_argument("--retrain", action="store_true", help="do recorded runs again (an hour)")


def run(options: Namespace) -> int:
    """Print the table.

    Raises:
        ValueError: if there is no such table, or a network is not usable.
        FileNotFoundError: if a network is missing.
    """
    from s2glib.recipes.evaluate import evaluate

    return evaluate(
        options.name, json_path=options.json, strict=options.strict, retrain=options.retrain
    )
