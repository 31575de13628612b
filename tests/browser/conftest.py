import shutil

import pytest
from browser.lab import open_browser, serve_lab


@pytest.fixture(scope="session", autouse=True)
def chromium():
    pytest.importorskip("playwright.sync_api")
    if not shutil.which("chromium"):
        pytest.skip("no chromium on this machine")


@pytest.fixture(scope="session")
def lab_folder(tmp_path_factory):
    """The folder that JupyterLab shows; tests put their notebooks there."""
    return tmp_path_factory.mktemp("notebooks")


@pytest.fixture(scope="session")
def lab_address(lab_folder, tmp_path_factory):
    with serve_lab(lab_folder, tmp_path_factory.mktemp("lab")) as address:
        yield address


@pytest.fixture
def watched(tmp_path):
    """A fresh browser."""
    with open_browser(tmp_path) as watched:
        yield watched
