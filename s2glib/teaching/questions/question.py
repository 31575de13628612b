"""What a question is: its words, and answers with a reason each, one of them right.

Paper:    -
Notebook: -
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Option:
    """One answer that can be chosen.

    Attributes:
        text: the answer.
        reason: why it is right, or what it overlooks.
        right: whether it is the right one.
    """

    text: str
    reason: str
    right: bool = False

    @property
    def verdict(self) -> str:
        """What is said to whoever chose it."""
        return f"{'Yes.' if self.right else 'Not quite.'} {self.reason}"


@dataclass(frozen=True)
class Question:
    """A question with answers to choose from, always in this order.

    Attributes:
        id: the notebook's number, then p and a number for a question to answer before a cell is
            run, or q and a number for one to check yourself with, such as "01-p1".
        text: what is asked.
        options: the answers.

    Raises:
        ValueError: unless exactly one answer is right.
    """

    id: str
    text: str
    options: tuple[Option, ...]

    def __post_init__(self) -> None:
        right = sum(option.right for option in self.options)
        if right != 1:
            raise ValueError(f"question {self.id} has {right} right answers; mark exactly one")
