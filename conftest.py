"""Options that hold for every test run, wherever pytest is started."""

import os
import pathlib
import shutil
import tomllib

import pytest

HERE = pathlib.Path(__file__).parent
NO_GPU = "needs a GPU"
NO_CHROMIUM = "needs Chromium on the PATH (Debian, Ubuntu: apt install chromium)"


def kernel_environment():
    settings = tomllib.loads((HERE / "pyproject.toml").read_text())
    return settings["tool"]["s2glib"]["kernel-environment"]


def pytest_configure(config):
    """Give nbval its settings, so that a bare `pytest --nbval` does the right thing."""
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
