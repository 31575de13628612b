"""For the meta-tests: read imports from source, and write small packages to try a rule on."""

import ast
from pathlib import Path


def find_modules(package: Path) -> dict[str, Path]:
    """Map dotted names to files; a room's `__init__.py` goes by the room's own name."""
    names = {}
    for path in sorted(package.rglob("*.py")):
        parts = path.relative_to(package.parent).with_suffix("").parts
        names[".".join(part for part in parts if part != "__init__")] = path
    return names


def origin(node: ast.ImportFrom, name: str, path: Path) -> str:
    """The dotted module that a `from ... import` reads from, dots resolved."""
    if not node.level:
        return node.module or ""
    drop = node.level - (path.name == "__init__.py")
    return ".".join([*name.split(".")[: len(name.split(".")) - drop], *filter(None, [node.module])])


def dotted_imports(tree: ast.AST, name: str = "", path: Path = Path()) -> set[str]:
    """All imports of a file, at any depth: `a.b` for `import a.b` and for `from a import b`."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {f"{origin(node, name, path)}.{alias.name}" for alias in node.names}
    return found


def module_of(dotted: str, modules: dict[str, Path]) -> str | None:
    """The longest beginning of a dotted name that is a module of the package."""
    while dotted and dotted not in modules:
        dotted = dotted.rpartition(".")[0]
    return dotted or None


def room_of(module: str) -> str:
    """`papers.amuse` for a module of that paper, else the first name below the package."""
    parts = module.split(".")[1:]
    return ".".join(parts[:2] if parts[:1] == ["papers"] else parts[:1])


def import_graph(modules: dict[str, Path]) -> dict[str, set[str]]:
    """For every module, the modules of the package that it imports, inside functions too."""
    graph = {}
    for name, path in modules.items():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        targets = {module_of(dotted, modules) for dotted in dotted_imports(tree, name, path)}
        graph[name] = targets - {None}
    return graph


def plant(root: Path, files: dict[str, str]) -> None:
    """Write files below a folder."""
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
