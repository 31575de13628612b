"""The house of storeys: who may import whom, each rule shown to fail on a planted fault."""

import ast
import graphlib
import re
from pathlib import Path

import pytest
from source_code import dotted_imports, find_modules, import_graph, plant, room_of

ROOT = Path(__file__).resolve().parents[1]
FLOORS = (
    {
        *("audio", "body", "warping"),  # the signals wing
        *("layers", "quantization", "diffusion", "losses", "metrics"),  # the mechanisms wing
        *("checkpoint", "folders"),
    },
    {"data", "viz"},
    {
        *("corpus", "papers", "papers.probtalk", "papers.amuse", "papers.mddiffusion"),
        "papers.baselines",
    },
    {"recipes", "widgets"},
    {"teaching", "commands"},
    {"__main__"},
)
TEXT = {".py", ".md", ".js", ".css", ".toml", ".cfg", ".yml", ".yaml", ".cff", ".ipynb", ".json"}
OUTSIDE = re.compile(r"\.\./shared|[/]work/|parent\W+shared\b")


def floor_of(room: str) -> int | None:
    return next((level for level, rooms in enumerate(FLOORS) if room in rooms), None)


def floor_faults(graph: dict[str, set[str]]) -> list[str]:
    """Every import that does not go to a lower floor or stay inside its room."""
    faults = []
    for module, targets in graph.items():
        if "." not in module:
            faults += [
                f"{module} imports {target}: the front door must stay light" for target in targets
            ]
            continue
        room, floor = room_of(module), floor_of(room_of(module))
        if floor is None:
            faults.append(f"{module}: {room} is on no floor")
            continue
        for target in sorted(target for target in targets if "." in target):
            there = floor_of(room_of(target))
            if room_of(target) != room and there is not None and there >= floor:
                where = "same floor" if there == floor else "a higher floor"
                faults.append(f"{module} imports {room_of(target)}: {where}")
    return faults


def find_cycle(graph: dict[str, set[str]]) -> list[str]:
    """One cycle of imports, or nothing."""
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        return error.args[1]
    return []


def network_parameters(losses: dict[str, Path]) -> list[str]:
    """Parameters of loss functions that take a network, any callable, or a warp."""
    faults = []
    for name, path in losses.items():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.arg) and node.annotation is not None:
                kind = ast.unparse(node.annotation)
                if re.search(r"Module|Callable|ThinPlateSpline", kind):
                    faults.append(f"{name}: {node.arg} is a {kind}; take its features")
    return faults


def readers_outside(root: Path) -> list[str]:
    """Files of the repository that name a place outside it."""
    folders = ("s2glib", "tests", "notebooks", "benchmarks", "docs", ".ci")
    files = [path for folder in folders for path in (root / folder).rglob("*") if path.is_file()]
    files += [path for path in root.iterdir() if path.is_file()]
    return [
        str(path.relative_to(root))
        for path in sorted(files)
        if (path.suffix in TEXT or path.parent.name == ".ci")
        and OUTSIDE.search(path.read_text(encoding="utf-8"))
    ]


def house(root: Path, **files: str) -> dict[str, Path]:
    """Write a small s2glib with the given files, and list its modules."""
    plant(root, {f"s2glib/{name}": text for name, text in {"__init__.py": "", **files}.items()})
    return find_modules(root / "s2glib")


def test_imports_go_down_only():
    assert floor_faults(import_graph(find_modules(ROOT / "s2glib"))) == []


def test_nothing_imports_itself_round_a_corner():
    assert " -> ".join(find_cycle(import_graph(find_modules(ROOT / "s2glib")))) == ""


def test_losses_take_features_never_networks_or_warps():
    assert network_parameters(find_modules(ROOT / "s2glib" / "losses")) == []


def test_the_front_door_imports_nothing():
    assert dotted_imports(ast.parse((ROOT / "s2glib" / "__init__.py").read_text())) == set()


def test_nothing_reads_outside_the_repository():
    assert readers_outside(ROOT) == []


@pytest.mark.parametrize(
    ("file", "line", "fault"),
    [
        ("diffusion/process.py", "import s2glib.audio.io", "imports audio: same floor"),
        ("diffusion/process.py", "def f(): from s2glib import audio", "imports audio: same floor"),
        ("diffusion/process.py", "from ..audio import io", "imports audio: same floor"),
        ("losses/image.py", "from s2glib.warping import x", "imports warping: same floor"),
        ("data/samples.py", "from s2glib.papers.amuse import x", "papers.amuse: a higher floor"),
        ("papers/amuse/prior.py", "from s2glib.papers import probtalk", "probtalk: same floor"),
        ("papers/amuse/prior.py", "from ..probtalk.pqvae import x", "probtalk: same floor"),
        ("cellar/stuff.py", "import numpy", "cellar is on no floor"),
        ("__init__.py", "import s2glib.audio", "the front door must stay light"),
    ],
)
def test_a_planted_import_is_found(tmp_path, file, line, fault):
    rooms = ("audio", "warping", "papers", "papers/amuse", "papers/probtalk")
    files = {f"{room}/__init__.py": "" for room in rooms}
    files |= {"audio/io.py": "", "papers/probtalk/pqvae.py": "", file: line}
    (found,) = floor_faults(import_graph(house(tmp_path, **files)))
    assert fault in found


def test_imports_that_are_allowed_raise_no_fault(tmp_path):
    files = {
        "audio/io.py": "import numpy",
        "audio/rhythm.py": "from s2glib.audio.io import load\nfrom s2glib import __version__",
        "papers/amuse/config.py": "",
        "papers/amuse/prior.py": "from . import config",
        "recipes/fit.py": "from s2glib.audio import io\nfrom s2glib.papers.amuse import prior",
    }
    graph = import_graph(house(tmp_path, **files))
    assert graph["s2glib.recipes.fit"] == {"s2glib.audio.io", "s2glib.papers.amuse.prior"}
    assert floor_faults(graph) == []
    assert find_cycle(graph) == []


def test_a_planted_cycle_is_found_through_the_rooms_own_door(tmp_path):
    door = {"audio/__init__.py": "from s2glib.audio.io import load"}
    graph = import_graph(
        house(tmp_path, **door, **{"audio/io.py": "from s2glib.audio import load"})
    )
    assert set(find_cycle(graph)) == {"s2glib.audio", "s2glib.audio.io"}


@pytest.mark.parametrize("kind", ["nn.Module", "Callable[[Tensor], Tensor]", "ThinPlateSpline"])
def test_a_loss_that_takes_a_network_is_found(tmp_path, kind):
    modules = house(tmp_path, **{"losses/image.py": f"def loss(x: Tensor, net: {kind}): ..."})
    assert network_parameters(modules) == [
        f"s2glib.losses.image: net is a {kind}; take its features"
    ]


@pytest.mark.parametrize("text", ["open('../{}/x')", "ROOT.parent / '{}'"])
def test_a_reader_of_the_design_pages_is_found(tmp_path, text):
    house(tmp_path, **{"audio/io.py": text.format("shared")})
    assert readers_outside(tmp_path) == ["s2glib/audio/io.py"]
