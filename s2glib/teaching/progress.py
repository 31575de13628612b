"""What a student has done so far, kept in one file of the student's own.

The file is JSON: by kind, id and state, how often that was recorded, such as
{"exercise": {"01-2": {"tried": 3, "hint": 1, "solved": 1}}}. Where no file can be written, progress
lasts as long as the session; a notebook never fails over it.

Paper:    -
Notebook: -
"""

import contextlib
import json
from pathlib import Path
from typing import Any

from s2glib.body.whole_file import whole_file
from s2glib.folders import home_folder

Progress = dict[str, dict[str, dict[str, int]]]
KINDS = ("exercise", "notebook", "question")
_unwritten: Progress = {}  # all of it, once a file could not be written


def record(kind: str, id: str, state: str) -> None:
    """Count that something happened.

    Args:
        kind: one of `KINDS`.
        id: of the exercise, notebook or question, such as "01-2".
        state: what happened, such as "solved".

    Raises:
        ValueError: if there is no such kind.
    """
    if kind not in KINDS:
        raise ValueError(f"progress is of a kind among {', '.join(KINDS)}; got {kind!r}")
    progress = recorded()
    states = progress.setdefault(kind, {}).setdefault(id, {})
    states[state] = states.get(state, 0) + 1
    try:
        with whole_file(_file()) as file:
            file.write(json.dumps(progress, indent=1, sort_keys=True).encode())
    except (OSError, RuntimeError):  # RuntimeError: the user has no home
        _unwritten.update(progress)


def recorded() -> Progress:
    """All that was recorded. A file that cannot be understood is set aside as `progress.bak`."""
    if _unwritten:
        return _unwritten
    try:
        file = _file()
        text = file.read_bytes()
    except (OSError, RuntimeError):
        return {}
    try:
        return _understood(json.loads(text))
    except (ValueError, RecursionError):
        with contextlib.suppress(OSError):
            file.replace(file.with_suffix(".bak"))
        return {}


def _file() -> Path:
    return home_folder() / "progress.json"


def _understood(progress: Any) -> Progress:
    """The same, if it is counts by kind, id and state."""
    levels = [progress]
    for _ in range(3):
        if not all(isinstance(level, dict) for level in levels):
            raise ValueError("progress is counted by kind, id and state")
        levels = [inner for level in levels for inner in level.values()]
    if not all(type(count) is int for count in levels):
        raise ValueError("counts are whole numbers")
    return progress
