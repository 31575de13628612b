"""Swap the emotion or the style of a recording, and see the body gesture it anew.

Paper:    AM A (emotion and style editing), Fig. A.4
Notebook: -
"""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from s2glib.commands.arguments import add_gesturing


def describe(parser: ArgumentParser) -> None:
    """Add the arguments."""
    add_gesturing(parser)
    emotion = parser.add_mutually_exclusive_group()
    emotion.add_argument("--emotion", help="the mean of an emotion, such as anger")
    emotion.add_argument(
        "--emotion-from", dest="emotion", type=Path, metavar="WAV", help="the emotion of a donor"
    )
    parser.add_argument(
        "--style-from", dest="style", type=Path, metavar="WAV", help="the style of a donor"
    )


def run(options: Namespace) -> int:
    """Write the edited motion, and a page that shows it beside the unedited one.

    Raises:
        ValueError: if there is nothing to swap, or an input or the output is not usable.
        FileNotFoundError: if a sound or a checkpoint is missing.
    """
    if options.emotion is None and options.style is None:
        raise ValueError("nothing to swap; give --emotion, --emotion-from or --style-from")
    from s2glib.commands.job import Job
    from s2glib.commands.studio import perform

    perform(
        Job(
            options.speech,
            options.out,
            options.seed,
            options.checkpoints,
            options.emotion,
            options.style,
        )
    )
    return 0
