"""The book: whole pages that call nobody, and what becomes of a notebook in them."""

import base64
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import nbformat
import pytest

from s2glib.teaching import book
from s2glib.teaching.build import NOTEBOOKS
from s2glib.teaching.keeping import KEPT

BUILT = sorted(NOTEBOOKS.glob("[0-9][0-9]_*.ipynb"))
MARKDOWN = """\
# First <steps>: what & why?

[next](05_second.ipynb#2.-More) and [the map](../docs/MAP.md)

## 1. A formula

$a < b$

<details><summary>Fold</summary>

**inside**
</details>"""
FILM = {"film": {"frames": 1}, "sheets": "", "sound": "", "width": 9, "title": ""}
SILENT = {"motion": "eJwDAAAAAAE=", "sound": "", "view": "</script>", "height": 300}


def write(path, number, markdown, outputs=()):
    header = {"id": number, "minutes": 15, "papers": {"AM": ["A", "Fig. A.4"], "PT": ["B"]}}
    code = nbformat.v4.new_code_cell("print('x')  # note", outputs=list(outputs))
    cells = [nbformat.v4.new_markdown_cell(markdown), code]
    nbformat.write(nbformat.v4.new_notebook(cells=cells, metadata={"s2g": header}), path)
    return path


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A book of three notebooks, page by page."""
    folder = tmp_path_factory.mktemp("notebooks")
    shown = [
        nbformat.v4.new_output("display_data", {"image/png": "AAAA", "text/plain": "figure"}),
        nbformat.v4.new_output("display_data", {"text/markdown": "**Figure.** What to see."}),
        nbformat.v4.new_output("display_data", {"text/plain": "Player"}, metadata={KEPT: SILENT}),
    ]
    films = [nbformat.v4.new_output("display_data", {"text/plain": "F"}, metadata={KEPT: FILM})]
    notebooks = [
        write(folder / "00_first.ipynb", "00", MARKDOWN, shown),
        write(folder / "05_second.ipynb", "05", "# Second"),
        write(folder / "06_third.ipynb", "06", "# Third", films),
    ]
    index = book.write_book(notebooks, folder / "pages" / "deep")
    return {path.name: path.read_text("utf-8") for path in index.parent.iterdir()}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The committed notebooks as a book."""
    folder = tmp_path_factory.mktemp("book")
    return {path: Page(path) for path in book.write_book(BUILT, folder).parent.glob("*.html")}


class Page(HTMLParser):
    """What a page refers to, and what it consists of."""

    def __init__(self, path: Path):
        super().__init__()
        self.links, self.loaded, self.ids, self.tags = [], [], [], []
        self.nameless = 0
        self.feed(path.read_text("utf-8"))

    def handle_starttag(self, tag, attrs):
        known = dict(attrs)
        self.tags.append(tag)
        self.ids += [known["id"]] if "id" in known else []
        if "href" in known:
            (self.links if tag == "a" else self.loaded).append(known["href"])
        self.loaded += [known[name] for name in ("src", "srcset", "data") if name in known]
        self.nameless += tag == "img" and not known.get("alt")


def test_links_lead_to_pages_and_what_is_not_in_the_book_is_words(small):
    assert '<a href="05_second.html#2.-More">next</a> and the map' in small["00_first.html"]
    assert ".ipynb" not in small["00_first.html"]


def test_every_page_leads_to_its_neighbours_and_to_the_contents(small):
    first, second = small["00_first.html"], small["05_second.html"]
    assert re.findall(r'rel="next" href="(.*?)"', first) == ["05_second.html"] * 2
    assert re.findall(r'rel="prev" href="(.*?)"', second) == ["00_first.html"] * 2
    assert 'rel="prev"' not in first
    assert 'href="index.html"' in first


def test_the_contents_tell_number_question_minutes_and_papers_by_part(small):
    words = " ".join(re.sub(r"<.*?>", " ", small["index.html"]).split())
    first = "First steps 00 First &lt;steps&gt; What &amp; why? 15 minutes"
    assert f"{first} · AMUSE: A, Fig. A.4 · ProbTalk: B Quantisation 05 Second 15 minutes" in words


def test_titles_and_sections_stand_in_the_page(small):
    assert "<title>00 First &lt;steps&gt; · s2glib</title>" in small["00_first.html"]
    assert '<a href="#1.-A-formula">1. A formula</a>' in small["00_first.html"]
    assert "¶" not in small["00_first.html"]


def test_formulas_folds_captions_and_code_stay(small):
    page = small["00_first.html"]
    assert "$a &lt; b$" in page
    assert "<details><summary>Fold</summary>\n<p><strong>inside</strong></p>" in page
    assert "<p><strong>Figure.</strong> What to see.</p>" in page
    assert re.search(r'<span class="nb">print</span>.*<span class="c1"># note</span>', page)


def test_only_a_page_with_a_player_loads_the_body(small):
    assert '<script src="mannequin.js">' in small["00_first.html"]
    assert "mannequin.js" not in small["05_second.html"]
    assert base64.b64decode(re.search('"(.*)"', small["mannequin.js"])[1])


def test_a_page_with_a_film_loads_its_player_and_no_body(small):
    assert "class FilmView" in small["06_third.html"]
    assert "mannequin.js" not in small["06_third.html"]
    assert "class FilmView" not in small["05_second.html"]


def test_what_a_player_keeps_cannot_end_its_script(small):
    after = small["00_first.html"].partition('<script type="application/json">')[2]
    assert json.loads(after.partition("</script>")[0])["view"] == "</script>"


def test_a_book_of_nothing_is_refused_before_anything_is_written(tmp_path):
    with pytest.raises(ValueError, match=r"run `python3 workbook.py build` first"):
        book.write_book([], tmp_path / "pages")
    assert not list(tmp_path.iterdir())


def test_the_committed_notebooks_load_nothing_from_elsewhere(pages):
    loaded = {each for page in pages.values() for each in page.loaded}
    files = {each for each in loaded if not each.startswith("data:")}
    assert all((path.parent / each).is_file() for path in pages for each in files)


def test_links_of_the_committed_notebooks_lead_to_a_place(pages):
    broken = []
    for path, page in pages.items():
        for link in page.links:
            name, _, anchor = link.partition("#")
            target = pages.get(path.parent / name if name else path)
            if target is None or (anchor and anchor not in target.ids):
                broken.append((path.name, link))
    assert broken == []


def test_every_page_has_its_landmarks_one_title_and_named_pictures(pages):
    for page in pages.values():
        assert (page.tags.count("main"), page.tags.count("h1"), page.nameless) == (1, 1, 0)
        assert len(page.ids) == len(set(page.ids))


def test_the_command_says_what_to_open(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(book, "NOTEBOOKS", tmp_path)
    write(tmp_path / "00_first.ipynb", "00", MARKDOWN)
    assert book.main(["--out", str(tmp_path / "pages")]) == 0
    assert capsys.readouterr().out == f"open {tmp_path / 'pages' / 'index.html'}\n"
