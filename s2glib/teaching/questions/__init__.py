"""The questions of all notebooks: one module a notebook, and a way to find them by id."""

from s2glib.teaching.questions import (
    notebook_00,
    notebook_01,
    notebook_02,
    notebook_03,
    notebook_04,
    notebook_05,
    notebook_06,
    notebook_07,
)
from s2glib.teaching.questions.question import Option, Question

__all__ = ["QUESTIONS", "Option", "Question", "find_question"]

QUESTIONS: tuple[Question, ...] = (
    *notebook_00.QUESTIONS,
    *notebook_01.QUESTIONS,
    *notebook_02.QUESTIONS,
    *notebook_03.QUESTIONS,
    *notebook_04.QUESTIONS,
    *notebook_05.QUESTIONS,
    *notebook_06.QUESTIONS,
    *notebook_07.QUESTIONS,
)


def find_question(id: str) -> Question:
    """Find a question by its id.

    Raises:
        ValueError: if there is none; says which ids the notebook has.
    """
    for question in QUESTIONS:
        if question.id == id:
            return question
    near = [each.id for each in QUESTIONS if each.id[:2] == str(id)[:2]]
    known = near or [each.id for each in QUESTIONS]
    raise ValueError(f"no question is called {id!r}; choose one of {', '.join(known)}")
