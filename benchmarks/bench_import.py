"""Starting Python with and without the package: the difference is what `import s2glib` costs."""

import subprocess
import sys

import pytest


@pytest.mark.benchmark(group="import")
@pytest.mark.parametrize("code", ["pass", "import s2glib"])
def test_start(benchmark, code):
    command = [sys.executable, "-c", code]
    benchmark.pedantic(subprocess.run, [command], {"check": True}, rounds=10, warmup_rounds=1)
