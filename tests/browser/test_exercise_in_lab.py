"""An exercise in a real JupyterLab: failed by a known mistake, looked up, and solved."""

import json
from pathlib import Path

import jupytext
import pytest
from browser.lab import open_notebook, run_all_cells, write_notebook

pytestmark = pytest.mark.browser
SOURCE = Path(__file__).parents[2] / "notebooks" / "source" / "01_motion_and_sound.py"
SETUP = (
    "import os; os.environ['S2G_HOME'] = {home!r}\n"
    "import torch\nfrom s2glib.teaching import check, hint, report, show_solution"
)
LESSON = (
    "sixd_to_matrix = check('01-1', sixd_to_matrix)",
    "hint('01-1')",
    "show_solution('01-1')",
    "made = sixd_to_matrix(torch.randn(9, 6))\n"
    "report(a_turn=torch.allclose(made @ made.mT, torch.eye(3), atol=1e-5))",
)


def solution():
    """How notebook 01's source solves its first exercise."""
    cells = jupytext.read(SOURCE).cells
    (cell, *_) = (cell for cell in cells if "s2g-solution" in cell.metadata.get("tags", []))
    return cell.source


def test_a_mistake_is_named_and_the_lesson_goes_on_until_it_is_mended(
    watched, lab_folder, lab_address, tmp_path
):
    columns = solution().replace("dim=-2)", "dim=-1)")
    cells = (SETUP.format(home=str(tmp_path)), columns, *LESSON)
    write_notebook(lab_folder / "exercise.ipynb", cells)
    page, cell = watched.page, watched.page.locator(".jp-CodeCell")
    open_notebook(page, lab_address, "exercise.ipynb")

    assert run_all_cells(page) == []
    cell.nth(2).get_by_text("stand in columns").wait_for()
    cell.nth(3).get_by_text("Hint 1 of 3").wait_for()
    cell.nth(5).get_by_text("a turn : True").wait_for()  # by the package's function
    page.screenshot(path=tmp_path / "mistake.png")
    cell.nth(4).get_by_text("Solution", exact=True).click()
    cell.nth(4).get_by_text("def sixd_to_matrix").wait_for()
    page.screenshot(path=tmp_path / "solution.png")

    cell.nth(1).locator(".cm-content").click()
    page.keyboard.press("Control+A")
    page.keyboard.insert_text(solution())
    page.keyboard.press("Shift+Enter")
    page.keyboard.press("Shift+Enter")
    cell.nth(2).get_by_text("is solved").wait_for()
    page.screenshot(path=tmp_path / "solved.png")
    record = json.loads((tmp_path / "progress.json").read_text())
    assert record["exercise"]["01-1"] == {"tried": 1, "hint": 1, "solved": 1}
    assert (watched.complaints, watched.outside) == ([], [])
