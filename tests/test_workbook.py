"""The set-up script: when it installs, what it refuses, and that any Python can read it."""

import ast
import importlib.util
import io
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "workbook.py"


def load_script():
    spec = importlib.util.spec_from_file_location("workbook", SOURCE)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    return script


@pytest.fixture
def workbook(tmp_path, monkeypatch):
    """The script with a folder of its own, where installing is only written down."""
    script = load_script()
    for name in ("READER_LOCK", "DEV_LOCK"):
        monkeypatch.setattr(script, name, tmp_path / f"{name}.lock")
        getattr(script, name).write_text(f"torch==2.13.0\n{name}\n")
    (tmp_path / "pyproject.toml").write_text("[project]")
    for name, value in {"ROOT": tmp_path, "VENV": tmp_path / "env"}.items():
        monkeypatch.setattr(script, name, value)
    monkeypatch.setattr(script, "PYTHON", tmp_path / "env" / "python")
    monkeypatch.setattr(script, "STAMP", tmp_path / "env" / "stamp")
    script.ran = []

    def create(folder, with_pip):
        folder.mkdir(exist_ok=True)
        script.PYTHON.touch()

    monkeypatch.setattr(script, "run", lambda *arguments: script.ran.append(arguments))
    monkeypatch.setattr(script, "has_pip", script.PYTHON.exists)
    monkeypatch.setattr(script.venv, "create", create)
    monkeypatch.setattr(script, "torch_index", lambda: ["--extra-index-url", "cpu"])
    return script


def installs(script, **options):
    """Whether one more set-up installs anything."""
    script.ran.clear()
    script.setup(**options)
    return bool(script.ran)


def test_only_the_standard_library_is_imported():
    tree = ast.parse(SOURCE.read_text())
    names = {
        alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
    }
    assert {name.split(".")[0] for name in names} <= sys.stdlib_module_names
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]


def test_an_old_python_can_read_the_script_and_its_refusal():
    assert ast.parse(SOURCE.read_text(), feature_version=(3, 7))


def test_an_old_python_is_refused(workbook, monkeypatch):
    monkeypatch.setattr(workbook.sys, "version_info", (3, 10, 4))
    with pytest.raises(SystemExit, match=r"3\.11 or newer"):
        workbook.setup()


def test_a_second_setup_installs_nothing(workbook):
    assert installs(workbook)
    assert not installs(workbook)


def test_a_developers_environment_serves_readers_and_not_the_reverse(workbook):
    assert installs(workbook)
    assert installs(workbook, dev=True)
    assert not installs(workbook)
    assert not installs(workbook, dev=True)


@pytest.mark.parametrize("changed", ["READER_LOCK.lock", "pyproject.toml"])
def test_a_changed_lock_or_project_installs_again(workbook, tmp_path, changed):
    assert installs(workbook)
    (tmp_path / changed).write_text("torch==2.14.0\n")
    assert installs(workbook)


def test_torch_comes_first_with_its_index_and_the_package_last(workbook):
    workbook.setup()
    torch, lock, package, _ = workbook.ran
    assert torch[-3:] == ("torch==2.13.0", "--extra-index-url", "cpu")
    assert lock[-2:] == ("-r", workbook.READER_LOCK)
    assert package[-3:] == ("--no-deps", "-e", workbook.ROOT)


def test_jupyterlab_is_told_not_to_look_for_news(workbook):
    workbook.setup()
    (settings,) = workbook.VENV.rglob("overrides.json")
    assert json.loads(settings.read_text()) == workbook.QUIET_LAB


def test_an_interrupted_installation_leaves_no_stamp(workbook, monkeypatch):
    workbook.setup()

    def fail(*arguments):
        raise subprocess.CalledProcessError(1, ["pip"])

    monkeypatch.setattr(workbook, "run", fail)
    with pytest.raises(SystemExit, match=r"`pip` failed \(exit status 1\)"):
        workbook.main(["setup", "--dev"])
    assert not workbook.STAMP.exists()


def test_a_missing_venv_module_is_explained(workbook, monkeypatch):
    def fail(*arguments, **options):
        raise subprocess.CalledProcessError(1, ["ensurepip"])

    monkeypatch.setattr(workbook.venv, "create", fail)
    with pytest.raises(SystemExit, match="apt install python3-venv"):
        workbook.setup()


@pytest.mark.parametrize(
    ("platform", "answers", "uses_index"),
    [
        ("linux", True, True),
        ("linux", False, False),
        ("win32", True, True),
        ("darwin", True, False),
    ],
)
def test_the_cpu_index_is_used_where_it_answers(monkeypatch, platform, answers, uses_index):
    script = load_script()

    def urlopen(url, timeout):
        if not answers:
            raise TimeoutError
        return io.BytesIO()

    monkeypatch.setattr(script.sys, "platform", platform)
    monkeypatch.setattr(script.urllib.request, "urlopen", urlopen)
    assert bool(script.torch_index()) == uses_index


@pytest.mark.parametrize(
    ("arguments", "status"),
    [(["--help"], 0), ([], 2), (["dance"], 2), (["setup", "--fast"], 2), (["build", "--x"], 2)],
)
def test_the_command_line_answers(workbook, capsys, arguments, status):
    with pytest.raises(SystemExit) as stopped:
        workbook.main(arguments)
    assert stopped.value.code == status
    assert "COMMAND" in "".join(capsys.readouterr())
    assert workbook.ran == []


@pytest.mark.parametrize(
    ("arguments", "passed"),
    [
        (["test", "-k", "tps", "tests/warping"], ("-k", "tps", "tests/warping")),
        (["lab", "--no-browser"], ("--no-browser",)),
        (["build", "00", "01"], ("s2glib.teaching.build", "00", "01")),
        (["build", "00", "--check"], ("s2glib.teaching.build", "--check", "00")),
        (["book"], ("-m", "s2glib.teaching.book")),
        (["book", "--out", "pages"], ("s2glib.teaching.book", f"--out={Path.cwd() / 'pages'}")),
    ],
)
def test_arguments_reach_the_program(workbook, monkeypatch, arguments, passed):
    called = []
    monkeypatch.setattr(workbook, "call", lambda *words: called.append(words) or 7)
    assert workbook.main(arguments) == 7
    assert called[0][-len(passed) :] == passed
