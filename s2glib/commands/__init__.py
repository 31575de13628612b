"""What the command line can do, one module a command; heavy imports wait until one runs."""

from types import ModuleType

from s2glib.commands import corpus, evaluate, generate, papers, swap, train

COMMANDS: dict[str, ModuleType] = {
    "swap": swap,
    "generate": generate,
    "train": train,
    "evaluate": evaluate,
    "corpus": corpus,
    "papers": papers,
}

__all__ = ["COMMANDS"]
