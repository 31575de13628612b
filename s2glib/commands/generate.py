"""Generate gestures for a recording, as it was spoken.

Paper:    AM Fig. A.4 (inference), PT A.2, A.3 (inference)
Notebook: -
"""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from s2glib.commands.arguments import add_gesturing, frame_spans, natural, part_names

SYSTEMS = ("amuse", "probtalk", "mddiffusion")
HOLISTIC = ("speaker", "keep", "frames", "parts")


def describe(parser: ArgumentParser) -> None:
    """Add the arguments."""
    add_gesturing(parser)
    parser.add_argument("--system", choices=SYSTEMS, required=True, help="who generates")
    holistic = parser.add_argument_group("with --system probtalk")
    holistic.add_argument("--speaker", type=natural, metavar="N", help="whose manner; 0 by default")
    holistic.add_argument("--keep", type=Path, metavar="NPZ", help="a motion to keep something of")
    holistic.add_argument(
        "--frames", type=frame_spans, metavar="A:B", help="kept frames: 0:60 or :30,90: or so"
    )
    holistic.add_argument(
        "--parts", type=part_names, metavar="PARTS", help="kept parts: hands, or body,face or so"
    )


def run(options: Namespace) -> int:
    """Write the motion and a page that plays it.

    Raises:
        ValueError: if the system is not built yet, or an input or the output is not usable.
        FileNotFoundError: if the sound or a checkpoint is missing.
    """
    if options.system == "mddiffusion":
        raise ValueError("mddiffusion is not built yet; use --system amuse or probtalk")
    asked = {name: vars(options)[name] for name in HOLISTIC if vars(options)[name] is not None}
    if options.system == "probtalk":
        _generate_holistic(options, asked)
        return 0
    if asked:
        raise ValueError(f"--{next(iter(asked))} is for --system probtalk only; leave it out")
    from s2glib.commands.job import Job
    from s2glib.commands.studio import perform

    perform(Job(options.speech, options.out, options.seed, options.checkpoints))
    return 0


def _generate_holistic(options: Namespace, asked: dict[str, Any]) -> None:
    if "keep" not in asked and asked.keys() - {"speaker"}:
        raise ValueError("--frames and --parts say what to keep; give a motion with --keep")
    from s2glib.commands.holistic import Order, perform

    order = Order(options.speech, options.out, options.seed, options.checkpoints)
    perform(order._replace(**asked))
