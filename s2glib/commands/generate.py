"""Generate gestures for a recording, as it was spoken.

Paper:    AM Fig. A.4 (inference)
Notebook: -
"""

from argparse import ArgumentParser, Namespace

from s2glib.commands.arguments import add_gesturing

SYSTEMS = ("amuse", "probtalk", "mddiffusion")


def describe(parser: ArgumentParser) -> None:
    """Add the arguments."""
    add_gesturing(parser)
    parser.add_argument("--system", choices=SYSTEMS, required=True, help="who generates")


def run(options: Namespace) -> int:
    """Write the motion and a page that plays it.

    Raises:
        ValueError: if the system is not built yet, or an input or the output is not usable.
        FileNotFoundError: if the sound or a checkpoint is missing.
    """
    if options.system != "amuse":
        raise ValueError(f"{options.system} is not built yet; use --system amuse")
    from s2glib.commands.job import Job
    from s2glib.commands.studio import perform

    perform(Job(options.speech, options.out, options.seed, options.checkpoints))
    return 0
