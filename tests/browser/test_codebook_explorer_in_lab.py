"""The codebook explorer in a real JupyterLab."""

from pathlib import Path

import numpy as np
import pytest
from browser.lab import execute, open_browser, open_notebook, pixels, run_all_cells, write_notebook

pytestmark = pytest.mark.browser
CELLS = (
    f"import sys; sys.path.insert(0, {str(Path(__file__).parents[1])!r})\n"
    "from dataclasses import replace\n"
    "import torch\n"
    "from stand_in import capsule_body\n"
    "from s2glib.papers.probtalk import PQVAE, TEACHING_PQVAE\n"
    "from s2glib.widgets import CodebookExplorer\n"
    "small = replace(TEACHING_PQVAE, widths=(8, 8, 12, 16), straight=0, latent=16, codes=6)\n"
    "_ = torch.manual_seed(0)\n"
    "model = PQVAE(small)\n"
    "_ = model.quantizer.codebooks.mul_(20)\n"
    "codes = torch.zeros(5, 4, dtype=torch.int64)",
    "explorer = CodebookExplorer(model, codes, capsule_body())\nexplorer",
)


@pytest.fixture(scope="module")
def lab(lab_folder, lab_address, tmp_path_factory):
    """A notebook that shows the explorer, all cells run."""
    write_notebook(lab_folder / "explorer.ipynb", CELLS)
    with open_browser(tmp_path_factory.mktemp("explorer")) as watched:
        open_notebook(watched.page, lab_address, "explorer.ipynb")
        assert run_all_cells(watched.page) == []
        watched.page.wait_for_selector(".s2g-player[data-draws]")
        yield watched


@pytest.fixture
def page(lab):
    """The explorer, on the clip's own code of the first token."""
    execute(lab.page, "explorer.choose(token=0, group=0, code=0); explorer.player.seek(0)")
    lab.page.wait_for_selector(".s2g-player[data-frame='0']")
    lab.page.get_by_text("this is the clip's own code, 0.").wait_for()
    return lab.page


def picture(page):
    return pixels(page.locator(".s2g-player canvas"))


def slide(page, name, times):
    """Move a slider as a reader with a keyboard does."""
    handle = page.locator(".widget-slider", has_text=name).locator(".noUi-handle")
    handle.focus()
    for _ in range(times):
        page.keyboard.press("ArrowRight")


def test_both_bodies_stand_side_by_side_with_their_names(page):
    names = page.locator(".s2g-names span").all_text_contents()
    assert names == ["as it was coded", "with your code"]


def test_another_code_moves_the_right_body_only_and_says_how_far(page):
    before = picture(page)
    slide(page, "code", 3)
    page.get_by_text("code 3 instead of 0").wait_for()
    page.wait_for_timeout(500)
    changed = np.abs(picture(page) - before).max(axis=(0, 2)) > 50  # column by column
    middle = len(changed) // 2
    assert changed[middle:].any()
    assert not changed[: middle - 40].any()


def test_another_token_goes_to_its_time_and_begins_with_its_own_code(page):
    slide(page, "code", 2)
    slide(page, "token", 2)
    page.get_by_text("Token 2, group 0: this is the clip's own code, 0.").wait_for()
    page.wait_for_selector(".s2g-player[data-frame='16']")
    execute(page, "assert (explorer.code.value, explorer.player.frame) == (0, 16)")


def test_a_burst_of_choices_ends_with_the_last_one(page):
    execute(
        page,
        "for k in range(30): explorer.choose(token=k % 5, group=k % 4, code=k % 6)\n"
        "explorer.choose(token=1, group=2, code=4)",
    )
    page.get_by_text("Token 1, group 2: code 4 instead of 0").wait_for()
    page.wait_for_selector(".s2g-player[data-frame='8']")


def test_it_plays(page):
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("() => document.querySelector('.s2g-player').dataset.time > 0.3")
    page.locator(".s2g-play").click()


def test_nothing_was_complained_of_and_nobody_outside_was_asked(lab):
    assert lab.complaints == []
    assert lab.outside == []
