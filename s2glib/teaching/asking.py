"""Questions in a notebook: choose an answer, read why it is right or what it overlooks.

Paper:    -
Notebook: -
"""

import html
from pathlib import Path

import anywidget
import traitlets

from s2glib.teaching.progress import record
from s2glib.teaching.questions import Option, Question, find_question

HERE = Path(__file__).parent


class Asked(anywidget.AnyWidget):
    """A question in view. The page answers by itself, so a kernel that computes delays nothing.

    Attributes:
        chosen: the place of the answer chosen last; None before the first choice.
    """

    _esm = (HERE / "asking.js").read_text("utf-8")
    _css = (HERE / "asking.css").read_text("utf-8")
    text = traitlets.Unicode().tag(sync=True)
    answers: traitlets.List[dict[str, str]] = traitlets.List().tag(sync=True)
    chosen = traitlets.Int(None, allow_none=True).tag(sync=True)

    def __init__(self, question: Question) -> None:
        self.question = question
        answers = [{"text": each.text, "verdict": each.verdict} for each in question.options]
        super().__init__(text=question.text, answers=answers)

    @traitlets.observe("chosen")
    def _record(self, change) -> None:
        """Note how the first choice went; whoever was wrong may then choose as often as needed."""
        if change["old"] is None:
            right = self.question.options[change["new"]].right
            record("question", self.question.id, "right" if right else "wrong first")

    def _repr_mimebundle_(self, **_: object) -> tuple[dict, dict]:
        """The view; and where no kernel runs, the question with its answers folded."""
        shown, metadata = super()._repr_mimebundle_() or ({}, {})
        return {**shown, "text/plain": repr(self), "text/html": folded(self.question)}, metadata

    def __repr__(self) -> str:
        answers = "\n".join(f"- {option.text}" for option in self.question.options)
        return f"Question {self.question.id}: {self.question.text}\n{answers}"


def ask(id: str) -> Asked:
    """Ask a question of the workbook; nothing is chosen yet.

    Args:
        id: such as "01-p1".

    Raises:
        ValueError: if there is no such question.
    """
    return Asked(find_question(id))


def folded(question: Question) -> str:
    """A question that needs no kernel: each answer opens to what is said of it."""
    answers = "".join(map(_fold, question.options))
    return f"<p><strong>{html.escape(question.text)}</strong></p><ul>{answers}</ul>"


def _fold(option: Option) -> str:
    text, verdict = html.escape(option.text), html.escape(option.verdict)
    return f"<li><details><summary>{text}</summary><p>{verdict}</p></details></li>"
