"""Options that hold for every test run, wherever pytest is started."""

import gc
import os
import pathlib
import shutil
import tempfile
import tomllib
import warnings

import pytest
from nbval.plugin import IPyNbFile

HERE = pathlib.Path(__file__).parent
NO_GPU = "needs a GPU"
NO_CHROMIUM = "needs Chromium on the PATH (Debian, Ubuntu: apt install chromium)"


def kernel_environment():
    settings = tomllib.loads((HERE / "pyproject.toml").read_text())
    return settings["tool"]["s2glib"]["kernel-environment"]


def keep_compiled_code_apart():
    """A folder for each worker: two that compile librosa's loops into one crash now and then."""
    worker = os.environ.get("PYTEST_XDIST_WORKER", "main")
    os.environ["NUMBA_CACHE_DIR"] = str(HERE / ".cache" / "numba" / worker)


def pytest_configure(config):
    """Give nbval its settings, so that a bare `pytest --nbval` does the right thing."""
    keep_compiled_code_apart()
    option = config.option
    if option.nbval or option.nbval_lax:
        os.environ.update(kernel_environment())
        if option.nbval_sanitize_with is None:
            option.nbval_sanitize_with = str(HERE / "sanitize.cfg")
        if option.nbval_kernel_name is None:
            option.nbval_current_env = True  # whatever kernels else the user has
        if option.nbval_cell_timeout == 2000:
            option.nbval_cell_timeout = 300
    if getattr(option, "dist", "no") == "load":
        option.dist = "loadfile"  # or one notebook's cells go to several kernels


class Notebook(IPyNbFile):
    """A notebook as a newcomer runs it: no progress is known, and no exercise is solved."""

    strict = ""

    def setup(self):
        self.home = tempfile.TemporaryDirectory()
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("S2G_HOME", self.home.name)
            patch.setenv("S2G_STRICT", self.strict)
            self.start_kernel()

    def start_kernel(self, tries=3):
        """Start it again if it dies at once: between choosing its ports and taking them, another
        kernel may have taken them."""
        try:
            super().setup()
        except RuntimeError:
            if tries == 1:
                raise
            with warnings.catch_warnings(action="ignore", category=ResourceWarning):
                gc.collect()  # what nbval left open for the dead one
            self.start_kernel(tries - 1)

    def teardown(self):
        super().teardown()
        self.home.cleanup()


class SolvedNotebook(Notebook):
    """The same with its solutions; every check must pass, and no output may change."""

    strict = "1"

    def collect(self):
        pytest.importorskip("jupytext")  # readers do not install it
        from s2glib.teaching.build import read_source

        solved = read_source(source_of(self.path), solved=True)
        code = {cell.id: cell.source for cell in solved.cells}
        for item in super().collect():
            item.cell.source = code.get(item.cell.id, item.cell.source)
            yield item


def source_of(notebook):
    return notebook.parent / "source" / f"{notebook.stem}.py"


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(file_path, parent):
    """Collect the notebooks that nbval would, and those with exercises once more, solved."""
    collected = yield
    if not any(isinstance(each, IPyNbFile) for each in collected):
        return collected
    notebooks = [Notebook.from_parent(parent, path=file_path)]
    source = source_of(file_path)
    if source.exists() and "s2g-solution" in source.read_text(encoding="utf-8"):
        name = f"{file_path.relative_to(parent.config.rootpath).as_posix()}[solved]"
        notebooks.append(SolvedNotebook.from_parent(parent, path=file_path, nodeid=name))
    return notebooks


def has_gpu():
    import torch

    return torch.cuda.is_available()


def pytest_collection_modifyitems(items):
    """Skip what this machine cannot run, and say what is missing."""
    needs = (
        ("gpu", has_gpu, NO_GPU),
        ("browser", lambda: shutil.which("chromium"), NO_CHROMIUM),
    )
    for marker, is_there, reason in needs:
        marked = [item for item in items if item.get_closest_marker(marker)]
        if marked and not is_there():
            for item in marked:
                item.add_marker(pytest.mark.skip(reason=reason))


def pytest_sessionfinish(session, exitstatus):
    """In CI a skipped test is a failure, unless it needs a GPU."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None or os.environ.get("CI") != "true" or exitstatus != pytest.ExitCode.OK:
        return
    reporter.ensure_newline()
    for report in reporter.stats.get("skipped", []):
        if NO_GPU not in str(report.longrepr):
            reporter.write_line(f"skipped in CI: {report.nodeid} {report.longrepr}", red=True)
            session.exitstatus = pytest.ExitCode.TESTS_FAILED
