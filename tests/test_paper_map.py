"""Every module says what it is, where from and where shown; the map of them all is kept fresh.

Rewrite docs/PAPER_MAP.md with:  python tests/test_paper_map.py
"""

import ast
import itertools
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from source_code import dotted_imports, find_modules, import_graph, module_of, plant, room_of

ROOT = Path(__file__).resolve().parents[1]
MAP = ROOT / "docs" / "PAPER_MAP.md"
NOTEBOOK_NAMES = (
    *("00_start_here", "01_motion_and_sound"),
    *("02_thin_plate_splines", "03_motion_decoupling", "04_repairing_pixels"),
    *("05_product_codes", "06_masked_prediction", "07_refiner"),
    *("08_speech_patches", "09_disentanglement"),
    *("10_diffusion", "11_losses_and_guidance"),
    *("12_motion_prior", "13_latent_diffusion", "14_emotion_swap_studio"),
    *("15_long_sequences", "16_fewer_steps"),
    *("17_motion_distances", "18_beats"),
    *("19_judging_video", "20_asking_people"),
    *("21_cost_and_harm", "22_capstone"),
)
NOTEBOOKS = {f"notebooks/{name}.ipynb" for name in NOTEBOOK_NAMES}
BACKSTAGE = {"recipes", "teaching", "commands", "__main__"}  # these work for the notebooks, unseen
HEADER = re.compile(
    r"(?P<what>\S[^\n]*\.)\n\n(?:\S.*\n\n)?"
    r"Paper:    (?P<paper>\S[^\n]*)\nNotebook: (?P<notebooks>\S[^\n]*)(?:\n\n\S.*)?",
    re.DOTALL,
)


class Header(NamedTuple):
    """The three lines with which a module opens."""

    what: str
    paper: str
    notebooks: list[str]


def read_header(name: str, path: Path) -> Header:
    """Read a module's header; ValueError says what is wrong with it."""
    match = HEADER.fullmatch(ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "")
    if match is None:
        raise ValueError(f"{name} does not open with its three lines: what, Paper, Notebook")
    notebooks = match["notebooks"].split(", ")
    if notebooks == ["-"] and name.split(".")[1] in BACKSTAGE:
        notebooks = []
    unknown = set(notebooks) - NOTEBOOKS
    if unknown:
        raise ValueError(f"{name} names {', '.join(sorted(unknown))}, which is no notebook")
    return Header(match["what"], match["paper"], notebooks)


def read_headers(modules: dict[str, Path]) -> dict[str, Header]:
    """The headers of all modules; a room's door needs none."""
    files = {name: path for name, path in modules.items() if path.name != "__init__.py"}
    return {name: read_header(name, path) for name, path in files.items()}


def code_of(notebook: Path) -> ast.Module:
    """The Python of a notebook's code cells, without magics."""
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    lines = itertools.chain.from_iterable(
        "".join(cell["source"]).splitlines() for cell in cells if cell["cell_type"] == "code"
    )
    return ast.parse("\n".join(line for line in lines if not re.match(r"\s*[%!]", line)))


def dotted_uses(tree: ast.Module) -> Iterator[str]:
    """What a notebook imports, and `s2glib.room.name` for `room.name` once the room is imported."""
    aliases = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            origin = f"{node.module}." if isinstance(node, ast.ImportFrom) else ""
            for alias in node.names:
                aliases[alias.asname or alias.name] = origin + alias.name
    yield from aliases.values()
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            holder = ast.unparse(node.value)
            if holder in aliases:
                yield f"{aliases[holder]}.{node.attr}"


def shown_in(notebook: Path, modules: dict[str, Path]) -> set[str]:
    """The modules a notebook imports, by name or through their room's door, and what carries them.

    A module is carried by a neighbour in its room that imports it; a module without a room
    (`s2glib/checkpoint.py`), by whoever imports it.
    """
    graph = import_graph(modules)
    lone = {name for name, path in modules.items() if f"s2glib.{path.stem}" == name}
    shown = set()
    for dotted in dotted_uses(code_of(notebook)):
        module = module_of(dotted, modules)
        if module and modules[module].name == "__init__.py":
            door = ast.parse(modules[module].read_text(encoding="utf-8"))
            wanted = dotted.rpartition(".")[2]
            behind = dotted_imports(door, module, modules[module])
            shown |= {module_of(name, modules) for name in behind if name.endswith(f".{wanted}")}
        elif module:
            shown.add(module)
    waiting = list(shown)
    while waiting:
        module = waiting.pop()
        carried = {to for to in graph[module] if to in lone or room_of(to) == room_of(module)}
        waiting += carried - shown
        shown |= carried
    return shown


def missing_imports(root: Path) -> list[str]:
    """Modules that an existing notebook should import and does not; a program is run instead."""
    modules = find_modules(root / "s2glib")
    headers = read_headers(modules)
    faults = []
    for notebook in sorted({name for header in headers.values() for name in header.notebooks}):
        if (root / notebook).exists():
            shown = shown_in(root / notebook, modules)
            named = {module for module, header in headers.items() if notebook in header.notebooks}
            silent = sorted(module for module in named - shown if not module.endswith("__main__"))
            faults += [f"{notebook} does not import {module}" for module in silent]
    return faults


def render_map(root: Path) -> str:
    """The whole of docs/PAPER_MAP.md."""
    modules = find_modules(root / "s2glib")
    lines = [
        "# Paper map",
        "",
        "Which module stands for which part of which paper. PT = ProbTalk, AM = AMUSE, MDD = "
        "S2G-MDDiffusion.",
        "",
        "Made by `python tests/test_paper_map.py` from the modules' headers; do not edit.",
        "",
        "| module | what it is | paper | notebook |",
        "|---|---|---|---|",
    ]
    for name, header in read_headers(modules).items():
        file = modules[name].relative_to(root).as_posix()
        shown = ", ".join(f"[{Path(path).stem}](../{path})" for path in header.notebooks) or "-"
        short = name.removeprefix("s2glib.").replace("_", "\\_")
        what, paper = (text.replace("|", "\\|") for text in (header.what, header.paper))
        lines.append(f"| [{short}](../{file}) | {what} | {paper} | {shown} |")
    return "\n".join(lines) + "\n"


HEADED = '"""What.\n\nPaper:    MDD Eq. A5\nNotebook: notebooks/02_thin_plate_splines.ipynb\n"""\n'


@pytest.fixture
def house(tmp_path):
    """A package with one documented module behind a door."""
    files = {
        "s2glib/__init__.py": "",
        "s2glib/warping/__init__.py": "from s2glib.warping.tps import fit_tps",
        "s2glib/warping/tps.py": HEADED,
    }
    plant(tmp_path, files)
    return tmp_path


def plant_notebook(root: Path, code: str) -> None:
    cells = [{"cell_type": "code", "source": ["%matplotlib inline\n", code]}]
    plant(root, {"notebooks/02_thin_plate_splines.ipynb": json.dumps({"cells": cells})})


def plant_header(root: Path, docstring: str) -> Path:
    plant(root, {"module.py": f'"""{docstring}"""'})
    return root / "module.py"


def test_every_module_has_its_header_and_names_a_real_notebook():
    assert read_headers(find_modules(ROOT / "s2glib"))


def test_a_notebook_imports_the_modules_that_name_it():
    assert missing_imports(ROOT) == []


def test_the_committed_map_is_fresh():
    fresh = MAP.exists() and MAP.read_text(encoding="utf-8") == render_map(ROOT)
    assert fresh, "docs/PAPER_MAP.md is stale: run python tests/test_paper_map.py"


@pytest.mark.parametrize(
    "docstring",
    [
        "",
        "What.",
        "What.\n\nPaper: -\nNotebook: notebooks/10_diffusion.ipynb",
        "What.\n\nPaper:    -",
        "What.\nPaper:    -\nNotebook: notebooks/10_diffusion.ipynb",
        "What.\n\nPaper:    -\nNotebook: notebooks/10_difusion.ipynb",
        "What.\n\nPaper:    -\nNotebook: 10_diffusion",
        "What.\n\nPaper:    -\nNotebook: -",
    ],
)
def test_a_wrong_header_is_refused(tmp_path, docstring):
    path = plant_header(tmp_path, docstring)
    with pytest.raises(ValueError, match=r"s2glib\.audio\.io"):
        read_header("s2glib.audio.io", path)


def test_a_header_may_carry_more_and_backstage_needs_no_notebook(tmp_path):
    text = "What.\n\nMore.\n\nPaper:    AM B.5, MDD B.5\nNotebook: {}\n\nMore still.\n"
    two = "notebooks/10_diffusion.ipynb, notebooks/11_losses_and_guidance.ipynb"
    path = plant_header(tmp_path, text.format(two))
    assert read_header("s2glib.audio.io", path) == Header(
        "What.", "AM B.5, MDD B.5", two.split(", ")
    )
    path = plant_header(tmp_path, text.format("-"))
    assert read_header("s2glib.teaching.build", path).notebooks == []


@pytest.mark.parametrize(
    "code",
    [
        "import s2glib.warping.tps",
        "from s2glib.warping import fit_tps",
        "from s2glib import warping\nwarping.fit_tps()",
        "import s2glib.warping\ns2glib.warping.fit_tps()",
    ],
)
def test_a_notebook_may_import_by_name_or_through_the_door(house, code):
    plant_notebook(house, code)
    assert missing_imports(house) == []


@pytest.mark.parametrize(
    "code", ["import numpy", "from s2glib import warping", "from s2glib.warping import other"]
)
def test_a_notebook_that_does_not_import_its_module_is_found(house, code):
    plant_notebook(house, code)
    assert missing_imports(house) == [
        "notebooks/02_thin_plate_splines.ipynb does not import s2glib.warping.tps"
    ]


def test_no_notebook_yet_is_no_fault(house):
    assert missing_imports(house) == []


def test_a_module_behind_a_shown_one_counts_as_shown(house):
    carrier = HEADED + "from s2glib.warping.kernel import u\n"
    plant(house, {"s2glib/warping/kernel.py": HEADED, "s2glib/warping/tps.py": carrier})
    plant_notebook(house, "from s2glib.warping import fit_tps")
    assert missing_imports(house) == []


def test_a_lone_module_counts_as_shown_with_whoever_imports_it(house):
    carrier = HEADED + "from s2glib.folders import cache\n"
    plant(house, {"s2glib/folders.py": HEADED, "s2glib/warping/tps.py": carrier})
    plant_notebook(house, "from s2glib.warping import fit_tps")
    assert missing_imports(house) == []
    plant(house, {"s2glib/warping/tps.py": HEADED})
    assert len(missing_imports(house)) == 1


def test_the_map_changes_with_a_header(house):
    before = render_map(house)
    plant(house, {"s2glib/warping/tps.py": HEADED.replace("A5", "A4")})
    assert "MDD Eq. A5" in before
    assert render_map(house) == before.replace("A5", "A4")


if __name__ == "__main__":
    MAP.parent.mkdir(exist_ok=True)
    MAP.write_text(render_map(ROOT), encoding="utf-8")
