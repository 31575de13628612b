import pytest

from s2glib.teaching import ask
from s2glib.teaching.asking import Asked
from s2glib.teaching.progress import recorded
from s2glib.teaching.questions import Option, Question

SUM = Question(
    "99-p1",
    "How much is 1 < 2, as a number?",
    (
        Option("0 & nothing", "That would be <false>."),
        Option("1", "True counts as one.", right=True),
        Option("2", "That is the larger of the two."),
    ),
)
VIEW = "application/vnd.jupyter.widget-view+json"


@pytest.fixture(autouse=True)
def home(monkeypatch, tmp_path):
    """A student without progress."""
    monkeypatch.setenv("S2G_HOME", str(tmp_path))


def test_nothing_is_chosen_and_nothing_noted_before_the_student_chooses():
    asked = Asked(SUM)
    asked._repr_mimebundle_()
    assert asked.chosen is None
    assert recorded() == {}


def test_the_page_gets_every_answer_in_order_with_what_is_said_of_it():
    assert Asked(SUM).answers == [
        {"text": "0 & nothing", "verdict": "Not quite. That would be <false>."},
        {"text": "1", "verdict": "Yes. True counts as one."},
        {"text": "2", "verdict": "Not quite. That is the larger of the two."},
    ]


@pytest.mark.parametrize(
    ("choices", "state"),
    [([1], "right"), ([1, 0], "right"), ([0], "wrong first"), ([2, 0, 1, 1], "wrong first")],
)
def test_the_first_choice_counts_however_many_follow(choices, state):
    asked = Asked(SUM)
    for place in choices:
        asked.chosen = place
    assert recorded() == {"question": {"99-p1": {state: 1}}}


def test_a_burst_of_choices_ends_with_the_last_one():
    asked = Asked(SUM)
    for step in range(300):
        asked.set_state({"chosen": step % 3})  # as the page does
    assert asked.chosen == 2
    assert recorded() == {"question": {"99-p1": {"wrong first": 1}}}


def test_two_askings_of_one_question_share_no_choice():
    first, second = Asked(SUM), Asked(SUM)
    first.chosen = 1
    assert second.chosen is None


def test_the_stored_words_never_change():
    asked = Asked(SUM)
    before = asked._repr_mimebundle_()[0]
    asked.chosen = 1
    after = asked._repr_mimebundle_()[0]
    assert before == after
    assert before["text/plain"] == (
        "Question 99-p1: How much is 1 < 2, as a number?\n- 0 & nothing\n- 1\n- 2"
    )


def test_without_a_kernel_each_answer_opens_to_its_reason():
    data, _ = Asked(SUM)._repr_mimebundle_()
    assert "How much is 1 &lt; 2" in data["text/html"]
    assert data["text/html"].count("<li><details><summary>") == 3
    assert (
        "<summary>0 &amp; nothing</summary><p>Not quite. That would be &lt;false&gt;.</p>"
        in data["text/html"]
    )


def test_where_a_kernel_runs_there_is_a_view():
    asked = Asked(SUM)
    assert asked._repr_mimebundle_()[0][VIEW]["model_id"] == asked.model_id


def test_a_question_is_found_by_its_id():
    assert ask("01-p1").question.id == "01-p1"


@pytest.mark.parametrize(
    ("id", "known"), [("01-p99", "01-p1, 01-p2"), ("", "00-q1"), ("hop", "00-q1"), (3, "00-q1")]
)
def test_an_unknown_id_is_told_the_known_ones(without_type_hook, id, known):
    with pytest.raises(ValueError, match=f"no question is called {id!r}; .*{known}"):
        ask(id)


@pytest.mark.parametrize("right", [(), (0, 1)])
def test_a_question_has_one_right_answer(right):
    options = tuple(Option(str(n), "A reason.", right=n in right) for n in range(3))
    with pytest.raises(ValueError, match=f"{len(right)} right answers; mark exactly one"):
        Question("99-p1", "Which one?", options)
