"""Delivering files: all of them, complete, or none.

Paper:    -
Notebook: -
"""

import os
import tempfile
from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path


@contextmanager
def delivery(out: Path, names: Collection[str]) -> Iterator[Path]:
    """Lend a hidden folder to write into; its files move to `out` when all went well.

    `out` is made only then. What else it holds stays; files of these names are replaced.

    Args:
        out: where the files are wanted.
        names: of the files that will be written.

    Raises:
        ValueError: if `out` cannot be a folder or be written to, or holds folders of these names.
    """
    ground = next(place for place in (out, *out.absolute().parents) if os.path.exists(place))
    if not ground.is_dir():
        raise ValueError(f"{ground} is a file, so {out} cannot be a folder; choose another --out")
    for name in names:
        if (out / name).is_dir():
            raise ValueError(f"{out / name} is a folder; move it away or choose another --out")
    with ExitStack() as stack:
        with writing(out):
            workshop = stack.enter_context(tempfile.TemporaryDirectory(dir=ground, prefix=".s2g-"))
        yield Path(workshop)
        with writing(out):
            out.mkdir(parents=True, exist_ok=True)
            for name in names:
                os.replace(Path(workshop) / name, out / name)


@contextmanager
def writing(out: Path) -> Iterator[None]:
    """Turn what the disk says into a sentence.

    Raises:
        ValueError: in place of an OSError.
    """
    try:
        yield
    except OSError as error:
        why = error.strerror or error
        raise ValueError(f"cannot write to {out} ({why}); choose another --out") from error
