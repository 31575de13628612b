"""A question in a real JupyterLab: shown twice, answered with mouse and keys, also in a hurry."""

import json

import pytest
from browser.lab import open_browser, open_notebook, run_all_cells, run_in_kernel, write_notebook

from s2glib.teaching.questions import find_question

pytestmark = pytest.mark.browser
QUESTION = find_question("01-p2")
ANSWERS = [option.text for option in QUESTION.options]
(RIGHT,) = (option for option in QUESTION.options if option.right)
WRONG = QUESTION.options[0]
CHOSEN = ".s2g-question [aria-pressed=true]"
CELLS = (
    "import os; os.environ['S2G_HOME'] = {home!r}\nfrom s2glib.teaching import ask",
    "question = ask('01-p2')\nquestion",
    "question",
)


@pytest.fixture(scope="module")
def lab(lab_folder, lab_address, tmp_path_factory):
    """A notebook that shows one question twice, all cells run, and the student's home."""
    home = tmp_path_factory.mktemp("home")
    write_notebook(lab_folder / "question.ipynb", [cell.format(home=str(home)) for cell in CELLS])
    with open_browser(tmp_path_factory.mktemp("question")) as watched:
        open_notebook(watched.page, lab_address, "question.ipynb")
        assert run_all_cells(watched.page) == []
        watched.page.locator(".s2g-question").nth(1).wait_for()
        yield watched, home


@pytest.fixture
def page(lab):
    """The notebook, with nothing chosen."""
    assert run_in_kernel(lab[0].page, "question.chosen = None") is None
    lab[0].page.wait_for_function(f"() => !document.querySelector({CHOSEN!r})")
    return lab[0].page


def recorded(home):
    file = home / "progress.json"
    return json.loads(file.read_text())["question"]["01-p2"] if file.exists() else {}


def view(page, place=0):
    return page.locator(".s2g-question").nth(place)


def button(view, text):
    return view.get_by_role("button", name=text, exact=True)


def verdict(page, text):
    """Wait until both views say it."""
    for place in (0, 1):
        view(page, place).get_by_role("status").get_by_text(text).wait_for()


def test_a_question_shows_its_answers_in_order_and_chooses_none(page):
    group = view(page).get_by_role("group", name=QUESTION.text)
    assert group.get_by_role("button").all_text_contents() == ANSWERS
    assert view(page).get_by_role("status").text_content() == ""
    assert page.locator(CHOSEN).count() == 0


def test_a_wrong_answer_gets_its_reason_and_another_try(page, tmp_path):
    button(view(page), WRONG.text).click()
    verdict(page, f"Not quite. {WRONG.reason}")
    page.screenshot(path=tmp_path / "wrong.png")
    button(view(page, 1), RIGHT.text).click()  # in the other view
    verdict(page, f"Yes. {RIGHT.reason}")
    assert page.locator(CHOSEN).all_text_contents() == [RIGHT.text] * 2
    page.screenshot(path=tmp_path / "right.png")


def test_the_first_choice_is_in_the_students_record(page, lab):
    before = recorded(lab[1])
    button(view(page), WRONG.text).click()
    button(view(page), RIGHT.text).click()
    verdict(page, "Yes.")
    assert run_in_kernel(page, "assert question.chosen == 3") is None
    after = recorded(lab[1])
    assert after.pop("wrong first") == before.pop("wrong first", 0) + 1
    assert after == before


@pytest.mark.parametrize("key", ["Enter", "Space"])
def test_keys_choose_without_moving_the_notebook(page, key):
    cell = page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex")
    button(view(page), ANSWERS[0]).focus()
    page.keyboard.press("Tab")
    outline = page.evaluate("() => getComputedStyle(document.activeElement).outlineWidth")
    assert float(outline.removesuffix("px")) >= 2
    page.keyboard.press(key)
    verdict(page, QUESTION.options[1].reason)
    assert page.evaluate("() => document.activeElement.textContent") == ANSWERS[1]
    assert page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex") == cell


def test_a_burst_of_choices_ends_alike_everywhere(page):
    page.evaluate(
        """() => {
            const views = [...document.querySelectorAll(".s2g-question")];
            for (let k = 0; k < 200; k++) views[k % 2].querySelectorAll("button")[k % 4].click();
            views[0].querySelectorAll("button")[2].click();
        }"""
    )
    verdict(page, QUESTION.options[2].reason)
    page.wait_for_timeout(500)
    assert page.locator(CHOSEN).all_text_contents() == [ANSWERS[2]] * 2
    assert run_in_kernel(page, "assert question.chosen == 2, question.chosen") is None


def test_a_question_answers_while_the_kernel_computes(page):
    page.evaluate(
        """() => { window.computing = jupyterapp.shell.currentWidget.sessionContext.session.kernel
            .requestExecute({ code: "import time; time.sleep(3)" }).done; }"""
    )
    button(view(page), RIGHT.text).click()
    verdict(page, "Yes.")
    status = "() => jupyterapp.shell.currentWidget.sessionContext.session.kernel.status"
    assert page.evaluate(status) == "busy"
    page.evaluate("() => computing")


def test_nothing_was_complained_of_and_nobody_outside_was_asked(lab):
    assert lab[0].complaints == []
    assert lab[0].outside == []
