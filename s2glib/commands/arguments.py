"""Arguments that commands share.

Paper:    -
Notebook: -
"""

from argparse import ArgumentParser
from pathlib import Path

from s2glib.folders import data_folder


def add_gesturing(parser: ArgumentParser) -> None:
    """From a recording to a folder: what `swap` and `generate` both take."""
    parser.add_argument("speech", type=Path, metavar="SPEECH", help="wav, flac, ogg or mp3")
    parser.add_argument("--out", type=Path, metavar="DIR", required=True, help="where files go")
    parser.add_argument("--seed", type=natural, default=0, help="of the noise; 0 by default")
    parser.add_argument(
        "--checkpoints",
        type=Path,
        metavar="DIR",
        default=data_folder() / "checkpoints",
        help="trained networks; the shipped ones by default",
    )


def natural(text: str) -> int:
    """A number that can seed a generator."""
    number = int(text)
    if not 0 <= number < 2**63:
        raise ValueError
    return number
