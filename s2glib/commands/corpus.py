"""Build the corpus that ships, or write a page that shows it.

Paper:    AM F
Notebook: -
"""

from argparse import ArgumentParser, Namespace
from pathlib import Path


def describe(parser: ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("what", choices=("build", "report"))
    parser.add_argument("--out", type=Path, help="folder to write into")
    parser.add_argument(
        "--split", help="render this split into the cache instead: train, test, motion, ..."
    )
    parser.add_argument(
        "--clock", action="store_true", help="also let all voices read, and write the clock anew"
    )


def run(options: Namespace) -> int:
    """Write the shipped data or the report, or fill the cache.

    Raises:
        ValueError: if neither a folder nor a split is named, or there is no such split.
    """
    if options.split is not None:
        from s2glib.corpus.build import render_split

        print(f"the cache holds {render_split(options.split)} clips of {options.split}")
        return 0
    if options.out is None:
        raise ValueError("say where to write: --out FOLDER, or --split NAME for the cache")
    options.out.mkdir(parents=True, exist_ok=True)
    if options.what == "report":
        from s2glib.recipes.corpus_report import write_report

        print(f"wrote {write_report(options.out)}")
        return 0
    from s2glib.corpus.ship import write_clock, write_samples

    if options.clock:
        write_clock(options.out)
    write_samples(options.out)
    print(f"wrote the shipped corpus into {options.out}")
    return 0
