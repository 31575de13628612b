"""In CI a skipped test fails the run; notebooks with exercises are validated solved as well."""

from pathlib import Path

import nbformat
import pytest

pytest_plugins = "pytester"
CONFTEST = Path(__file__).resolve().parents[1] / "conftest.py"
PLAIN = "import pytest\ndef test_it(): pytest.skip('because')"
WHOLE_FILE = "import pytest\npytest.importorskip('no_such_module')"
CELLS = {  # what a student finds, and what nbval must see there
    "import os\nstrict = os.environ.get('S2G_STRICT')\nhome = os.environ['S2G_HOME']": "",
    "def half(x):\n    ...": "",
    "if not half(4) and strict:\n    raise ValueError(half(4))\nhalf = lambda x: x / 2": "",
    "print(half(6), os.listdir(home))\nopen(os.path.join(home, 'left'), 'w').close()": "3.0 []\n",
}
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


def write_notebook(folder, name, solution):
    """A notebook with outputs as stored unsolved, and its source, if it has one."""
    notebook = nbformat.v4.new_notebook()
    for index, (code, text) in enumerate(CELLS.items()):
        outputs = [nbformat.v4.new_output("stream", text=text)] if text else []
        cell = nbformat.v4.new_code_cell(code, execution_count=index + 1, outputs=outputs)
        cell.id = f"cell-{index:02d}"
        notebook.cells.append(cell)
    nbformat.write(notebook, folder / f"{name}.ipynb")
    first, stub, *rest = [f"\n{code}\n" for code in CELLS]
    marks = {"exercise": stub, "solution": f"\n{solution}\n"}
    tagged = [f'# %% tags=["s2g-{tag}"]{code}' for tag, code in marks.items()]
    source = "\n".join([f"# %%{first}", *tagged, *(f"# %%{code}" for code in rest)])
    if solution:
        (folder / "source" / f"{name}.py").write_text(source)


def test_a_notebook_with_exercises_runs_also_solved_and_must_say_the_same(pytester, monkeypatch):
    monkeypatch.setenv("S2G_STRICT", "1")  # students are not strict
    pytester.makeconftest(CONFTEST.read_text())
    pytester.makefile(".cfg", sanitize=(CONFTEST.parent / "sanitize.cfg").read_text())
    pytester.makepyprojecttoml("[tool.s2glib.kernel-environment]\nPYTHONHASHSEED = '0'")
    pytester.mkdir("source")
    write_notebook(pytester.path, "00_right", "def half(x):\n    return x / 2")
    write_notebook(pytester.path, "01_wrong", "def half(x):\n    return 0")
    write_notebook(pytester.path, "02_without_source", None)
    ran = pytester.runpytest_subprocess("--nbval", "-p", "no:cacheprovider")
    ran.assert_outcomes(passed=5 * len(CELLS) - 2, failed=2)
    ran.stdout.fnmatch_lines(["FAILED 01_wrong.ipynb[[]solved[]]::Cell 2*"])


@pytest.mark.parametrize(("workers", "folder"), [(0, "main"), (1, "gw0")])
def test_every_worker_compiles_into_a_folder_of_its_own(pytester, monkeypatch, workers, folder):
    monkeypatch.setenv("NUMBA_CACHE_DIR", "of whoever started this")
    monkeypatch.delenv("PYTEST_XDIST_WORKER", raising=False)
    pytester.makeconftest(CONFTEST.read_text() + "\nhas_gpu = bool  # torch loads only once\n")
    pytester.makeini("[pytest]\nmarkers = gpu")
    found = "os.path.basename(os.environ['NUMBA_CACHE_DIR'])"
    pytester.makepyfile(f"import os\ndef test_it(): assert {found} == {folder!r}")
    assert pytester.runpytest_inprocess("-n", str(workers)).ret == 0


@pytest.mark.parametrize(("deaths", "passed"), [(1, 1), (3, 0)])
def test_a_kernel_that_dies_at_once_is_started_again(pytester, deaths, passed):
    dying = f"""
import nbval.plugin

start, deaths = nbval.plugin.IPyNbFile.setup, [{deaths}]

def setup(self):
    if deaths[0]:
        deaths[0] -= 1
        raise RuntimeError("Kernel died before replying to kernel_info")
    start(self)

nbval.plugin.IPyNbFile.setup = setup
"""
    for part in ("pyproject.toml", "sanitize.cfg"):
        (pytester.path / part).write_text((CONFTEST.parent / part).read_text())
    pytester.makeconftest(CONFTEST.read_text() + dying)
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("1 + 1")])
    nbformat.write(notebook, pytester.path / "only.ipynb")
    ran = pytester.runpytest_subprocess("--nbval-lax", "only.ipynb", "-p", "no:cacheprovider")
    assert ran.parseoutcomes().get("passed", 0) == passed
