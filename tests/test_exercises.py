"""Every exercise: its check knows right from wrong, and its notebook asks what it checks."""

import ast
import copy
import inspect
import itertools
import re
from pathlib import Path

import jupytext
import numpy as np
import pytest

from s2glib.teaching import check
from s2glib.teaching.checking import attempt
from s2glib.teaching.comparison import difference
from s2glib.teaching.exercises import all_exercises, find_exercise

SOURCES = sorted((Path(__file__).parents[1] / "notebooks" / "source").glob("[0-9][0-9]_*.py"))
EXERCISES = list(all_exercises().values())
MUTANTS = [
    pytest.param(each, mutant, id=f"{each.id} {mutant.hint[:40]}")
    for each in EXERCISES
    for mutant in each.mutants
]
CHECKED = re.compile(r"^(\w+) = check\(\"([^\"]*)\", (\w+)\)$")


@pytest.fixture(params=EXERCISES, ids=lambda each: each.id)
def exercise(request):
    return request.param


def cases_of(exercise):
    return list(exercise.inputs(np.random.default_rng(0)))


def cells_of(exercise):
    """The header of an exercise, and its code cells by tag."""
    (path,) = (path for path in SOURCES if path.stem.startswith(exercise.id[:2]))
    cells = jupytext.read(path).cells
    at = next(i for i, cell in enumerate(cells) if f'check("{exercise.id}"' in cell.source)
    header = next(c.source for c in cells[at::-1] if f"Exercise {exercise.id}" in c.source)
    start = next(i for i in range(at, 0, -1) if "s2g-exercise" in tags(cells[i]))
    return header, {tags(cell)[0]: cell.source for cell in cells[start : at + 4] if tags(cell)}


def tags(cell):
    return cell.metadata.get("tags", [])


def function_in(exercise, tag):
    """What a cell defines, in a notebook that has made all its imports."""
    (path,) = (path for path in SOURCES if path.stem.startswith(exercise.id[:2]))
    tree = ast.parse(
        "\n".join(c.source for c in jupytext.read(path).cells if c.cell_type == "code")
    )
    imports = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    names = {}
    exec(compile(ast.Module(imports, []), "imports", "exec"), names)
    exec(cells_of(exercise)[1][tag], names)
    return names[exercise.reference.__name__]


def test_ids_count_up_in_every_notebook():
    ids = [exercise.id for exercise in EXERCISES]
    for notebook, group in itertools.groupby(ids, key=lambda id: id[:2]):
        mine = list(group)
        assert mine == [f"{notebook}-{i}" for i in range(1, len(mine) + 1)]


def test_an_unknown_exercise_is_refused_with_those_that_are_there(without_type_hook):
    with pytest.raises(ValueError, match="no exercise '01-9'; there are 01-1, 01-2, 01-3"):
        find_exercise("01-9")
    with pytest.raises(ValueError, match=r"no exercise 'abc'; there are .*01-1"):
        check("abc", print)
    for id in (None, 5, ["01-1"]):
        with pytest.raises(ValueError, match="there is no exercise"):
            find_exercise(id)


def test_it_is_well_described(exercise):
    assert exercise.title
    assert 1 <= exercise.difficulty <= 3
    assert 2 <= exercise.minutes <= 20
    assert 1 <= len(exercise.hints) <= 3
    assert all(
        text.endswith(".") for text in (*exercise.hints, *(m.hint for m in exercise.mutants))
    )
    assert len({mutant.hint for mutant in exercise.mutants}) == len(exercise.mutants) >= 2


def test_its_reference_is_the_packages_own_and_public(exercise):
    reference = exercise.reference
    room = reference.__module__.rpartition(".")[0]
    assert getattr(__import__(room, fromlist=["_"]), reference.__name__) is reference


def test_the_reference_agrees_with_an_independent_form_on_every_case(exercise):
    for case in cases_of(exercise):
        expected = exercise.oracle(*copy.deepcopy(case))
        assert difference(expected, exercise.reference(*case), exercise.tolerance) is None


def test_its_cases_are_always_the_same_and_stay_as_they_are(exercise):
    for first, second in zip(cases_of(exercise), cases_of(exercise), strict=True):
        assert not attempt(exercise.reference, first).changed
        assert difference(first, second, 0.0) is None


def test_a_function_that_does_the_same_is_right(exercise, capsys):
    def mine(*arguments):
        return exercise.reference(*arguments)

    assert check(exercise.id, mine) is mine
    assert "is solved" in capsys.readouterr().out


@pytest.mark.parametrize(("exercise", "mutant"), MUTANTS)
def test_a_mistake_is_rejected_with_its_own_hint(exercise, mutant, capsys):
    assert check(exercise.id, mutant.wrong) is exercise.reference
    said = " ".join(capsys.readouterr().out.split())
    assert f"is not right yet. {mutant.hint} The notebook goes on" in said


def test_what_students_find_is_not_attempted_yet(exercise, capsys, monkeypatch):
    stub = function_in(exercise, "s2g-exercise")
    monkeypatch.delenv("S2G_STRICT", raising=False)
    assert check(exercise.id, stub) is exercise.reference
    assert "is not attempted yet" in capsys.readouterr().out
    monkeypatch.setenv("S2G_STRICT", "1")
    with pytest.raises(AssertionError, match="is not attempted yet"):
        check(exercise.id, stub)


def test_the_solution_of_the_notebook_is_right(exercise, monkeypatch):
    monkeypatch.setenv("S2G_STRICT", "1")
    solution = function_in(exercise, "s2g-solution")
    assert check(exercise.id, solution) is solution


def test_stub_and_solution_take_what_the_package_takes(exercise):
    wanted = list(inspect.signature(exercise.reference).parameters)
    for tag in ("s2g-exercise", "s2g-solution"):
        assert list(inspect.signature(function_in(exercise, tag)).parameters) == wanted


def test_the_notebook_says_what_it_is(exercise):
    header, _ = cells_of(exercise)
    dots = "●" * exercise.difficulty + "○" * (3 - exercise.difficulty)
    where = "" if exercise.equation == "-" else f" · [{exercise.equation}]"
    assert f"### Exercise {exercise.id}: {exercise.title}\n" in header
    assert f"\n{dots} · {exercise.minutes} minutes{where}\n" in header


def test_check_and_solution_follow_the_exercise(exercise):
    _, cells = cells_of(exercise)
    assert list(cells) == ["s2g-exercise", "s2g-solution", "s2g-check", "s2g-source"]
    name = exercise.reference.__name__
    assert CHECKED.fullmatch(cells["s2g-check"]).groups() == (name, exercise.id, name)
    assert cells["s2g-source"] == f'show_solution("{exercise.id}")'


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_a_notebook_lists_and_checks_all_its_exercises_in_order(path):
    notebook = jupytext.read(path)
    code = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    checked = [match[2] for match in map(CHECKED.fullmatch, code) if match]
    assert checked == [each.id for each in EXERCISES if each.id[:2] == path.stem[:2]]
    assert checked == notebook.metadata["s2g"].get("exercises", [])
    assert sum("s2g-exercise" in tags(cell) for cell in notebook.cells) == len(checked)
