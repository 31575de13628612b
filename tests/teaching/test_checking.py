"""Checks, on a small exercise of their own: twice a number, with the sum of its rows."""

import dataclasses
import inspect
from typing import NamedTuple

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.body import Motion, sixd_to_matrix
from s2glib.teaching import check, checking, hint, show_solution
from s2glib.teaching.comparison import difference
from s2glib.teaching.exercises import Exercise, Mutant
from s2glib.teaching.progress import recorded

GOES_ON = "The notebook goes on with the package's function."


class Doubled(NamedTuple):
    twice: np.ndarray
    total: float


def double(x, n):
    return Doubled(2 * x, float(2 * x.sum()))


def inputs(rng):
    yield np.array([1.0, 2.0]), 1
    yield rng.normal(size=(4, 5)), 2


EXERCISE = Exercise(
    id="77-1",
    title="twice as much",
    reference=double,
    inputs=inputs,
    oracle=lambda x, n: Doubled(x + x, sum(2 * x.ravel())),
    mutants=(
        Mutant(lambda x, n: Doubled(x**2, float((x**2).sum())), "You square; double instead."),
        Mutant(lambda x, n: Doubled(2 * x, float(x.sum())), "Double before you add."),
    ),
    hints=("Think of two.", "It is 2 * x."),
    minutes=2,
    difficulty=1,
)


@pytest.fixture(autouse=True)
def exercise(monkeypatch, tmp_path):
    monkeypatch.setenv("S2G_HOME", str(tmp_path))
    monkeypatch.delenv("S2G_STRICT", raising=False)
    monkeypatch.setattr(checking, "find_exercise", {"77-1": EXERCISE}.__getitem__)
    monkeypatch.setattr(checking, "_hints_given", checking.Counter())


def states():
    return recorded().get("exercise", {}).get("77-1")


def spoken(capsys):
    """What was printed, before it was broken into lines."""
    return " ".join(capsys.readouterr().out.split())


def stub(x, n):
    """Twice as much."""
    ...  # your code


def returns_dots(x, n):
    return ...


def raises_not_implemented(x, n):
    raise NotImplementedError


def in_place(x, n):
    x *= 2
    return Doubled(x, float(x.sum()))


def stops(x, n):
    return x[99]


@pytest.mark.parametrize(
    "right",
    [
        lambda x, n: double(x, n),
        lambda x, n: (x + x, 2 * x.sum()),  # neither named, nor the very same float
        lambda x, n: [2 * x * (1 + 1e-9), 2 * float(x.sum())],
    ],
)
def test_a_right_answer_is_used_from_then_on(right, capsys):
    assert check("77-1", right) is right
    assert capsys.readouterr().out == (
        "Exercise 77-1 is solved.\nThe notebook goes on with your function.\n"
    )
    assert states() == {"solved": 1}


@pytest.mark.parametrize("empty", [stub, returns_dots, raises_not_implemented])
def test_what_is_not_written_yet_is_no_mistake(empty, capsys):
    assert check("77-1", empty) is double
    assert capsys.readouterr().out == (
        f"Exercise 77-1 is not attempted yet (nothing is returned).\n{GOES_ON}\n"
    )
    assert states() is None


def test_the_packages_function_itself_solves_nothing(capsys):
    assert check("77-1", double) is double
    assert "Run the cell with yours again" in spoken(capsys)
    assert states() is None


@pytest.mark.parametrize("mutant", EXERCISE.mutants, ids=lambda mutant: mutant.hint)
def test_a_mistake_that_is_known_is_named(mutant, capsys):
    assert check("77-1", mutant.wrong) is double
    first, second = capsys.readouterr().out.splitlines()
    assert first == f"Exercise 77-1 is not right yet. {mutant.hint}"
    assert second == f"{GOES_ON} Stuck? Open a hint below."
    assert states() == {"tried": 1}


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (
            lambda x, n: (3 * x, 6.0),
            "For x = (1, 2), n = 1, answer.twice[0] should be 2, yours is 3.",
        ),
        (lambda x, n: (2 * x, 7), "answer.total should be 6, yours is 7."),
        (lambda x, n: (x * np.nan, 6.0), "answer.twice[0] should be 2, yours is nan."),
        (lambda x, n: 2 * x, "answer should be ((2, 4), 6), yours is (2, 4)."),
        (lambda x, n: (2 * x[:1], 6.0), "answer.twice should have shape (2,), yours has (1,)."),
        (
            lambda x, n: ((2 * x).astype(np.float32), 6.0),
            "answer.twice should hold float64, yours holds float32.",
        ),
        (lambda x, n: ([2, 4], 6.0), "answer.twice should be a numpy array, yours is (2, 4)."),
        (
            lambda x, n: (2 * x, None) if n == 1 else double(x, n),
            "total should be 6, yours is None.",
        ),
        (lambda x, n: None if n == 1 else double(x, n), "should be ((2, 4), 6), yours is None."),
        (lambda x, n: (torch.tensor(2 * x), 6.0), "should be a numpy array, yours is a tensor."),
        (
            lambda x, n: double(x, n) if n == 1 else (x, 0.0),
            "For x = array of shape (4, 5), n = 2, ",
        ),
        (in_place, "The answer is right, but you changed the input; work on a copy."),
        (lambda x: x, "it stops with TypeError: "),
    ],
)
def test_another_mistake_is_told_by_what_it_does(wrong, said, capsys):
    assert check("77-1", wrong) is double
    assert said in spoken(capsys)
    assert states() == {"tried": 1}


def through(z):
    return z + (z.round() - z).detach()


def asking_for_a_gradient(rng):
    yield (torch.tensor([0.4, 1.7], requires_grad=True),)


ROUNDING = dataclasses.replace(
    EXERCISE,
    reference=through,
    inputs=asking_for_a_gradient,
    mutants=(Mutant(torch.round, "Your gradient is zero."), Mutant(torch.sign, "A sign.")),
)


def test_gradients_are_compared_where_inputs_ask_for_them(monkeypatch, capsys):
    monkeypatch.setattr(checking, "find_exercise", {"77-1": ROUNDING}.__getitem__)
    assert check("77-1", lambda z: through(z)).__name__ == "<lambda>"
    assert check("77-1", lambda z: z.round()) is through
    assert "Your gradient is zero." in spoken(capsys)
    check("77-1", lambda z: through(z) + z - z.detach())
    assert "answer.gradient.0[0] should be 1, yours is 2" in spoken(capsys)


def test_an_error_is_told_with_its_line(capsys):
    assert check("77-1", stops) is double
    line = inspect.getsourcelines(stops)[1] + 1
    assert f"it stops in line {line} with IndexError: index 99 " in spoken(capsys)


class Unspeakable:
    def __str__(self):
        raise RuntimeError("no words")


def itself():
    loop = []
    loop.append(loop)
    return loop


@pytest.mark.parametrize(
    "made",
    [
        Unspeakable,
        itself,
        lambda: Unspeakable,
        lambda: torch.ones(2).to_sparse(),
        lambda: torch.ones(2, device="meta"),
        lambda: (torch.ones(2, requires_grad=True) * 2, 6.0),
        lambda: np.array(["a", None], dtype=object),
        lambda: (np.array(["a", "b"]), 6.0),
        lambda: (iter("ab"), 6.0),
        lambda: ({}, set()),
    ],
)
def test_whatever_comes_back_the_notebook_goes_on(made, capsys):
    assert check("77-1", lambda x, n: made()) is double
    assert "is not right yet" in spoken(capsys)


def test_what_is_no_function_is_told(without_type_hook, capsys):
    assert check("77-1", None) is double
    assert "TypeError: 'NoneType' object is not callable." in spoken(capsys)


@settings(max_examples=30)
@given(st.recursive(st.none() | st.floats() | st.text(), st.lists))
def test_nothing_that_comes_back_raises(value):
    state, words = checking.judge(EXERCISE, lambda x, n: value)
    assert state in ("tried", "untried")
    assert "77-1" in words


@pytest.mark.parametrize("wrong", [stub, EXERCISE.mutants[0].wrong, stops, in_place])
def test_strictly_whatever_is_not_right_raises(wrong, monkeypatch):
    monkeypatch.setenv("S2G_STRICT", "1")
    with pytest.raises(AssertionError, match="Exercise 77-1 is not"):
        check("77-1", wrong)


def test_strictly_a_right_answer_passes(monkeypatch):
    monkeypatch.setenv("S2G_STRICT", "1")
    assert check("77-1", in_two := lambda x, n: double(x, n)) is in_two


def test_hints_come_one_after_the_other(capsys):
    for _ in range(3):
        hint("77-1")
    assert capsys.readouterr().out.splitlines() == [
        "Hint 1 of 2: Think of two.",
        "Hint 2 of 2: It is 2 * x.",
        'Those were all 2 hints. show_solution("77-1") shows the code.',
    ]
    assert states() == {"hint": 2}


def test_the_solution_is_the_packages_code_folded_below_its_hints(monkeypatch):
    shown = []
    monkeypatch.setattr(checking, "display", lambda data, raw: shown.append(data))
    ours = dataclasses.replace(EXERCISE, reference=sixd_to_matrix, helpers=(Motion,))
    monkeypatch.setattr(checking, "find_exercise", lambda id: ours)
    show_solution("77-1")
    (only,) = shown
    code = inspect.getsource(sixd_to_matrix).rstrip()
    assert f"\n```python\n{code}\n```\n\n" in only["text/markdown"]
    assert code in only["text/plain"]
    assert "class Motion:" in only["text/plain"]
    folds = only["text/markdown"].split("<details>")[1:]
    assert [fold.partition("</summary>")[0] for fold in folds] == [
        f"<summary>{name}" for name in ("Hint 1", "Hint 2", "Solution")
    ]
    assert all(fold.rstrip().endswith("</details>") for fold in folds)


@pytest.mark.parametrize(
    ("expected", "got"),
    [
        (float("nan"), float("nan")),
        (torch.tensor([1.0, float("nan")]), torch.tensor([1.0, float("nan")])),
        (torch.tensor(3), torch.tensor(3)),
        (np.array([True, False]), np.array([True, False])),
        ((1, "a", None), (1.0, "a", None)),
        ([], ()),
        (torch.zeros(0, 3), torch.zeros(0, 3)),
    ],
)
def test_the_same_is_no_difference(expected, got):
    assert difference(expected, got, 1e-6) is None


@pytest.mark.parametrize(
    ("expected", "got", "said"),
    [
        (1.0, float("nan"), "answer should be 1, yours is nan"),
        (1.0, 1.1, "answer should be 1, yours is 1.1"),
        (1.0, torch.tensor(1.0), "answer should be 1, yours is 1"),
        ("a", None, "answer should be a, yours is None"),
        ((), (1,), "answer should be (), yours is (1)"),
        ([1], [1, 2], "answer should be (1), yours is (1, 2)"),
        (torch.tensor(3), torch.tensor(4), "answer should be 3, yours is 4"),
        (torch.eye(2), torch.eye(2) + 1e-3, "answer[0, 0] should be 1, yours is 1.001"),
        (list(range(20)), 3, "answer should be list of 20, yours is 3"),
    ],
)
def test_a_difference_is_said_in_few_words(expected, got, said):
    assert difference(expected, got, 1e-6) == said


def test_dataclasses_are_compared_field_by_field():
    still = Motion(torch.zeros(2, 55, 3), torch.zeros(2, 3), torch.zeros(2, 100), 30)
    assert difference(still, dataclasses.replace(still), 1e-6) is None
    slower = dataclasses.replace(still, fps=25)
    assert difference(still, slower, 1e-6) == "answer.fps should be 30, yours is 25"
    assert "answer should be Motion(" in difference(still, (1, 2, 3, 4), 1e-6)
