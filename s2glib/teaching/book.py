"""The book: the built notebooks as pages that need a browser and nothing else, no network either.

Run as `python3 workbook.py book [--out DIR]`, then open `index.html` there.

Paper:    -
Notebook: -
"""

import argparse
import re
import sys
from collections.abc import Iterator, Sequence
from importlib.metadata import distribution
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import nbformat
from nbconvert import HTMLExporter

from s2glib.body import mannequin
from s2glib.teaching.build import NOTEBOOKS, ROOT
from s2glib.teaching.keeping import as_text, content_of
from s2glib.widgets import film_player, player
from s2glib.widgets.packing import pack_mesh
from s2glib.widgets.parts import read_parts
from s2glib.widgets.playback import STYLE

PARTS_OF_PLAYERS = dict.fromkeys((*player.PARTS, *film_player.PARTS, "local.js"))
TEMPLATES = Path(__file__).parent / "pages"
MATHJAX = "sphinx-mathjax-offline"  # of this package only MathJax itself is wanted, one file
PAPERS = {"PT": "ProbTalk", "AM": "AMUSE", "MDD": "S2G-MDDiffusion"}
PARTS = {  # by the first notebook of each
    "00": "First steps",
    "02": "Warping",
    "05": "Quantisation",
    "08": "Disentanglement",
    "10": "Diffusion",
    "17": "Metrics",
    "21": "Together",
}


class Section(NamedTuple):
    """A second-level heading, and where it stands in its page."""

    id: str
    text: str


class Chapter(NamedTuple):
    """One notebook as pages show it; `body` is its cells as HTML."""

    number: str
    page: str
    title: str
    question: str
    minutes: int
    papers: dict[str, list[str]]
    body: str

    @property
    def sections(self) -> list[Section]:
        """The headings that are listed beside the text."""
        return [Section(*found) for found in re.findall(r'<h2 id="(.*?)">(.*?)</h2>', self.body)]

    @property
    def plays(self) -> bool:
        """Whether there is a player on the page."""
        return '<div class="place' in self.body

    @property
    def has_bodies(self) -> bool:
        """Whether one of them shows the body."""
        return '<div class="place body">' in self.body


def write_book(notebooks: Sequence[Path], folder: Path) -> Path:
    """Write the pages, and return the one with the contents, where reading starts.

    Args:
        notebooks: built ones, in the order in which they are read.
        folder: where the pages go; it is made if it is not there.

    Raises:
        ValueError: if there is no notebook.
    """
    if not notebooks:
        raise ValueError("there is no built notebook; run `python3 workbook.py build` first")
    exporter = make_exporter()
    chapters = [read_chapter(path, exporter) for path in notebooks]
    files = {**shared_files(), **dict(rendered(chapters, exporter))}
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    return folder / "index.html"


def make_exporter() -> HTMLExporter:
    """What turns cells into HTML; its environment finds our templates."""
    return HTMLExporter(
        template_name=TEMPLATES.name,
        extra_template_basedirs=[str(TEMPLATES.parent)],
        filters={"content_of": content_of},
        exclude_input_prompt=True,
        exclude_output_prompt=True,
    )


def read_chapter(path: Path, exporter: HTMLExporter) -> Chapter:
    """Turn a built notebook into HTML, its links to notebooks into links to pages."""
    notebook = nbformat.read(path, as_version=4)
    header = notebook.metadata["s2g"]
    heading = notebook.cells[0].source.splitlines()[0]
    title, _, question = heading.removeprefix("# ").partition(": ")
    body, _ = exporter.from_notebook_node(notebook)
    return Chapter(
        number=header["id"],
        page=f"{path.stem}.html",
        title=title,
        question=question[:1].upper() + question[1:],
        minutes=header["minutes"],
        papers={PAPERS[key]: places for key, places in header["papers"].items()},
        body=of_one_book(body),
    )


def of_one_book(body: str) -> str:
    """Links to notebooks lead to their pages; what leads out of the book becomes words."""
    body = re.sub(r'href="(\d\d_\w+)\.ipynb', r'href="\1.html', body)
    body = re.sub(r'<a class="anchor-link".*?</a>', "", body)
    return re.sub(r'<a href="\.\./[^"]*">(.*?)</a>', r"\1", body)


def shared_files() -> dict[str, str]:
    """What all pages use, by file name."""
    mathjax = distribution(MATHJAX).locate_file(f"{MATHJAX}/static/mathjax/tex-svg.js")
    return {
        "book.css": (TEMPLATES / "book.css").read_text("utf-8") + STYLE + film_player.FILM_STYLE,
        "mannequin.js": f'window.mannequin = "{as_text(pack_mesh(mannequin()))}";\n',
        "mathjax.js": Path(str(mathjax)).read_text("utf-8"),
    }


def rendered(chapters: Sequence[Chapter], exporter: HTMLExporter) -> Iterator[tuple[str, str]]:
    """Every page, by file name."""
    contents, page = map(exporter.environment.get_template, ("contents.html.j2", "chapter.html.j2"))
    script = read_parts(*PARTS_OF_PLAYERS) + (TEMPLATES / "book.js").read_text("utf-8")
    neighbours = zip([None, *chapters], chapters, [*chapters[1:], None], strict=False)
    yield "index.html", contents.render(parts=list(parted(chapters)))
    for before, chapter, after in neighbours:
        yield (
            chapter.page,
            page.render(before=before, chapter=chapter, after=after, script=script),
        )


def parted(chapters: Sequence[Chapter]) -> Iterator[tuple[str, list[Chapter]]]:
    """The chapters by part, with the parts' names."""

    def first(chapter: Chapter) -> str:
        return max(number for number in PARTS if number <= chapter.number)

    for number, group in groupby(chapters, first):
        yield PARTS[number], list(group)


def main(arguments: Sequence[str]) -> int:
    """Write the book of all built notebooks, and say where it is."""
    parser = argparse.ArgumentParser(prog="workbook.py book", description="Write the HTML book.")
    parser.add_argument("--out", type=Path, default=ROOT / "book", metavar="DIR")
    options = parser.parse_args(arguments)
    built = sorted(NOTEBOOKS.glob("[0-9][0-9]_*.ipynb"))
    print(f"open {write_book(built, options.out)}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
