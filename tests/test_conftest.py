"""In CI a skipped test fails the run, in one process and in workers; a missing GPU is forgiven."""

from pathlib import Path

import pytest

pytest_plugins = "pytester"
CONFTEST = Path(__file__).resolve().parents[1] / "conftest.py"
PLAIN = "import pytest\ndef test_it(): pytest.skip('because')"
WHOLE_FILE = "import pytest\npytest.importorskip('no_such_module')"
GPU = "import pytest\n@pytest.mark.gpu\ndef test_it(): pass"


@pytest.mark.parametrize(
    ("test", "workers", "ci", "status"),
    [
        (PLAIN, 0, "true", 1),
        (PLAIN, 1, "true", 1),
        (WHOLE_FILE, 0, "true", 1),
        (GPU, 0, "true", 0),
        (PLAIN, 0, "", 0),
    ],
    ids=["plain", "in a worker", "whole file", "gpu", "not in ci"],
)
def test_a_skip_fails_ci(pytester, monkeypatch, test, workers, ci, status):
    monkeypatch.setenv("CI", ci)
    pytester.makeconftest(CONFTEST.read_text() + "\nhas_gpu = bool  # torch loads only once\n")
    pytester.makeini("[pytest]\nmarkers = gpu")
    pytester.makepyfile(test_skip=test, test_more="def test_more(): pass")
    ran = pytester.runpytest_inprocess("-n", str(workers))
    assert ran.ret == status
    assert ("skipped in CI" in ran.stdout.str()) == (status == 1)
