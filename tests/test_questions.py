"""The questions of all notebooks: asked once, a reason for every answer, no help for guessers."""

import re
from collections import Counter
from pathlib import Path
from statistics import median

import jupytext
import pytest

from s2glib.teaching.questions import QUESTIONS, Option, Question

SOURCES = sorted((Path(__file__).parents[1] / "notebooks" / "source").glob("[0-9][0-9]_*.py"))
LENGTH = range(20, 301)  # characters
ASKED = re.compile(r"\bask\(\"([^\"]*)\"\)")


def place(question: Question) -> int:
    return next(place for place, option in enumerate(question.options) if option.right)


def stands_out(question: Question) -> bool:
    """Whether the right answer is longer than every other one."""
    lengths = [len(option.text) for option in question.options]
    right = lengths.pop(place(question))
    return right > max(lengths)


def asked_in(source: Path) -> list[str]:
    cells = jupytext.read(source).cells
    return [id for cell in cells if cell.cell_type == "code" for id in ASKED.findall(cell.source)]


def test_ids_are_unique_and_say_notebook_and_kind():
    ids = [question.id for question in QUESTIONS]
    assert len(ids) == len(set(ids))
    assert [id for id in ids if not re.fullmatch(r"[0-9]{2}-[pq][1-9]", id)] == []


def test_every_question_is_asked_once_in_the_notebook_of_its_number():
    asked = [(path.stem[:2], id) for path in SOURCES for id in asked_in(path)]
    assert sorted(asked) == sorted((question.id[:2], question.id) for question in QUESTIONS)


@pytest.mark.parametrize("question", QUESTIONS, ids=lambda question: question.id)
def test_its_texts_are_short_and_every_answer_has_a_reason_of_its_own(question):
    reasons = [option.reason for option in question.options]
    assert [text for text in (question.text, *reasons) if len(text) not in LENGTH] == []
    assert all(option.text.strip() for option in question.options)
    assert len(set(reasons)) == len({option.text for option in question.options}) >= 3


def test_the_place_of_the_right_answer_varies():
    places = Counter(map(place, QUESTIONS))
    assert {0, 1, 2} <= set(places)
    assert max(places.values()) <= len(QUESTIONS) / 2


def test_the_right_answer_is_not_told_by_its_length():
    assert sum(map(stands_out, QUESTIONS)) <= len(QUESTIONS) / 2
    right = [len(question.options[place(question)].text) for question in QUESTIONS]
    wrong = [len(o.text) for question in QUESTIONS for o in question.options if not o.right]
    assert median(right) <= 1.25 * median(wrong)


def test_a_right_answer_that_stands_out_is_found():
    options = (Option("short", "-"), Option("much longer", "-", right=True), Option("mid", "-"))
    question = Question("99-p1", "Which?", options)
    assert stands_out(question)
    assert place(question) == 1
