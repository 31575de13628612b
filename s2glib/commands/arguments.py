"""Arguments that commands share.

Paper:    -
Notebook: -
"""

from argparse import ArgumentParser, ArgumentTypeError
from pathlib import Path

from s2glib.folders import data_folder

PARTS = ("face", "body", "left_hand", "right_hand")  # in the order of ProbTalk's masks
NAMED = {part: (part,) for part in PARTS} | {"hands": PARTS[2:], "all": PARTS}


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


def positive(text: str) -> int:
    """A number of steps."""
    number = int(text)
    if number < 1:
        raise ValueError
    return number


def natural(text: str) -> int:
    """A number that can seed a generator."""
    number = int(text)
    if not 0 <= number < 2**63:
        raise ValueError
    return number


def frame_spans(text: str) -> list[slice]:
    """Frames, a:b, or several with commas; without a from the first, without b to the last.

    Raises:
        ArgumentTypeError: if these are no frames, or none at all.
    """
    try:
        return [_span(piece) for piece in text.split(",")]
    except ValueError:
        raise ArgumentTypeError(
            f"expected frames as a:b with a below b, or several with commas, such as 0:60 or "
            f":30,90:; got {text!r}"
        ) from None


def _span(piece: str) -> slice:
    start, stop = (int(end) if end.strip() else None for end in piece.split(":"))
    if (start or 0) < 0 or (stop is not None and stop <= (start or 0)):
        raise ValueError
    return slice(start, stop)


def part_names(text: str) -> list[str]:
    """Parts of the body, one or several with commas.

    Raises:
        ArgumentTypeError: if there is no such part.
    """
    names = [name.strip() for name in text.split(",")]
    if not NAMED.keys() >= set(names):
        raise ArgumentTypeError(
            f"expected one or several of {', '.join(NAMED)}, with commas; got {text!r}"
        )
    wanted = {part for name in names for part in NAMED[name]}
    return [part for part in PARTS if part in wanted]
