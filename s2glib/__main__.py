"""The command line: `python -m s2glib COMMAND`.

Paper:    -
Notebook: -
"""

import sys
from argparse import ArgumentParser
from collections.abc import Sequence
from typing import NoReturn

from s2glib.commands import COMMANDS


class OneSentenceParser(ArgumentParser):
    """Refuses in one line, as everything else here does."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong with the arguments and leave with exit code 2."""
        self.exit(2, f"{self.prog}: {message} (see --help)\n")


def build_parser() -> ArgumentParser:
    """Every command with its arguments; each brings the function that runs it."""
    parser = OneSentenceParser(prog="s2glib", description="How speech becomes gesture.")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, dest="command")
    for name, command in COMMANDS.items():
        what = (command.__doc__ or "").partition("\n")[0]
        subparser = commands.add_parser(name, help=what, description=what)
        command.describe(subparser)
        subparser.set_defaults(run=command.run)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        arguments: words after the program's name; by default those of this process.

    Returns:
        The exit code: 0 for done, 2 for refused with one sentence on stderr, 1 for a missed aim.
    """
    options = build_parser().parse_args(arguments)
    try:
        return options.run(options)
    except (ValueError, OSError, ImportError) as error:
        print(f"s2glib {options.command}: {' '.join(str(error).split())}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
