import inspect

import pytest

from s2glib.body import BodyModel, sixd_to_matrix
from s2glib.teaching import show_source


@pytest.fixture
def shown(monkeypatch):
    displayed = []
    monkeypatch.setattr("s2glib.teaching.source.display", lambda data, raw: displayed.append(data))
    return displayed


@pytest.mark.parametrize(
    ("thing", "file"),
    [(sixd_to_matrix, "s2glib/body/rotations.py"), (BodyModel, "s2glib/body/skinning.py")],
)
def test_it_shows_the_packages_own_code_and_its_file(shown, thing, file):
    show_source(thing)
    (only,) = shown
    code = inspect.getsource(thing).rstrip()
    assert only["text/plain"] == f"From {file}:\n{code}"
    assert f"```python\n{code}\n```" in only["text/markdown"]


def test_code_from_elsewhere_is_refused(shown):
    with pytest.raises(ValueError, match="cleandoc is not from s2glib"):
        show_source(inspect.cleandoc)
