"""Show the code that a notebook talks about: the package's own, never a copy.

Paper:    -
Notebook: -
"""

import inspect
from collections.abc import Callable
from pathlib import Path

from IPython.display import display

PACKAGE = Path(__file__).resolve().parents[1]


def show_source(function: Callable) -> None:
    """Show a function or class of the package, with the file where it stands.

    Raises:
        ValueError: if it is not from this package.
    """
    display(source_panel(function), raw=True)


def source_panel(function: Callable) -> dict[str, str]:
    """What `show_source` shows, as Markdown and as plain text.

    Raises:
        ValueError: if the function is not from this package.
    """
    path = Path(inspect.getfile(inspect.unwrap(function))).resolve()
    if not path.is_relative_to(PACKAGE):
        raise ValueError(f"{function.__name__} is not from {PACKAGE.name}; show only its own code")
    file = path.relative_to(PACKAGE.parent).as_posix()
    code = inspect.getsource(function).rstrip()
    return {
        "text/markdown": f"From `{file}`:\n```python\n{code}\n```",
        "text/plain": f"From {file}:\n{code}",
    }
