"""What a job did and how long each step took, printed as it goes and kept for its report.

Paper:    -
Notebook: -
"""

import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager


class Diary:
    """The steps of a job.

    Attributes:
        seconds: how long each step took, by name.
        warnings: what a step complained about.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.warnings: list[str] = []

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Time a step, and say each of its warnings in one line."""
        began = time.perf_counter()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", UserWarning)
            yield
        self.seconds[name] = round(time.perf_counter() - began, 3)
        print(f"{name:<18}{self.seconds[name]:7.2f} s")
        for warning in caught:
            self.warnings.append(str(warning.message))
            print(f"warning: {warning.message}", file=sys.stderr)
