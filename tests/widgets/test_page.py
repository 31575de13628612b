import base64
import json
import re

import pytest

from s2glib.widgets import Player, write_html


@pytest.fixture
def write(tmp_path, motion, waveform, body):
    def write_page(**options):
        options = {"title": "A title", **options}
        write_html(
            tmp_path / "gesture.html",
            {"source": motion, "edited": motion},
            waveform,
            body,
            **options,
        )
        return (tmp_path / "gesture.html").read_text()

    return write_page


def test_the_page_holds_the_bytes_that_the_widget_sends(write, motion, waveform, body):
    content = json.loads(re.search(r'id="content">(.*?)</script>', write(), re.DOTALL)[1])
    player = Player({"source": motion, "edited": motion}, waveform, body)
    for name in ("mesh", "motion", "sound"):
        assert base64.b64decode(content[name]) == getattr(player, name)


def test_the_page_runs_the_script_of_the_widget(write):
    assert Player._esm.strip() in write()


def test_the_page_names_no_other_place(write):
    assert not re.search(r"https?://|src=|@import|url\(", write())


def test_words_are_words_and_not_markup(write):
    page = write(title="<b>x</b>", text="</script><script>alert(1)</script>")
    assert "<b>x" not in page
    assert "alert(1)</script>" not in page


def test_nothing_else_is_left_in_the_folder(write, tmp_path):
    write()
    assert [path.name for path in tmp_path.iterdir()] == ["gesture.html"]


def test_an_unknown_view_is_refused_before_anything_is_written(write, tmp_path):
    with pytest.raises(ValueError, match="no motion is called 'other'"):
        write(view="other")
    assert not list(tmp_path.iterdir())
