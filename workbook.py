#!/usr/bin/env python3
"""Set up and run the workbook with nothing but Python's standard library.

    python3 workbook.py lab            open notebook 00 in JupyterLab (sets up first)
    python3 workbook.py test [ARGS]    run every test and every notebook; ARGS go to pytest
    python3 workbook.py build [NN ...] execute notebooks/source into notebooks, and validate them;
                                       with --check, only say which notebooks are not built afresh
    python3 workbook.py book [--out DIR]  write the built notebooks as pages for a browser
    python3 workbook.py setup [--dev]  only install

The virtual environment is `.venv` beside this file, or the folder named by S2G_VENV.
"""

import argparse
import functools
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import time
import urllib.request
import venv

ROOT = pathlib.Path(__file__).resolve().parent
VENV = pathlib.Path(os.environ.get("S2G_VENV") or ROOT / ".venv").resolve()
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
STAMP = VENV / "s2glib.stamp"
READER_LOCK = ROOT / "requirements.lock"
DEV_LOCK = ROOT / "requirements-dev.lock"
TORCH_CPU_INDEX = "https://download.pytorch.org/whl/cpu"
QUIET_LAB = {  # JupyterLab asks on its first start; the workbook needs no network
    "@jupyterlab/apputils-extension:notification": {"fetchNews": "false", "checkForUpdates": False}
}
WARM_UP = (
    "import matplotlib.pyplot, torch, librosa, numpy as np;"
    "librosa.feature.melspectrogram(y=np.zeros(4096, 'f4'), sr=16000)"
)


def run(*arguments):
    """Run the environment's Python; an error ends the script."""
    subprocess.run([str(part) for part in (PYTHON, *arguments)], check=True, cwd=ROOT)


def pip_install(*arguments):
    """Install into the environment, without pip's chatter."""
    run("-m", "pip", "install", "-q", "--disable-pip-version-check", *arguments)


def has_pip():
    """Tell whether the environment exists and is whole enough to install into."""
    probe = [str(PYTHON), "-m", "pip", "--version"]
    return PYTHON.exists() and subprocess.run(probe, capture_output=True).returncode == 0


def create_environment():
    """Create the virtual environment; say what to do where Python cannot."""
    try:
        venv.create(VENV, with_pip=True)
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(
            f"could not create a virtual environment in {VENV} ({error}); "
            "on Debian or Ubuntu: apt install python3-venv"
        )


def torch_index():
    """Name PyTorch's CPU index where it answers; macOS wheels are CPU builds anyway."""
    if sys.platform == "darwin":
        return []
    try:
        urllib.request.urlopen(TORCH_CPU_INDEX + "/torch/", timeout=6).close()
    except OSError:
        return []
    return ["--extra-index-url", TORCH_CPU_INDEX]


def fingerprint(lock):
    """Hash what an installation depends on: the lock, pyproject.toml and this folder."""
    parts = lock.read_bytes(), (ROOT / "pyproject.toml").read_bytes(), str(ROOT).encode()
    return hashlib.sha256(b"\0".join(parts)).hexdigest()


def install(lock):
    """Install the locked packages and this one; the stamp is written last."""
    print(f"installing {lock.name} into {VENV} (once; takes minutes) ...", flush=True)
    start = time.monotonic()
    STAMP.unlink(missing_ok=True)
    torch = next(line for line in lock.read_text().splitlines() if line.startswith("torch=="))
    pip_install(torch, *torch_index())
    pip_install("-r", lock)
    pip_install("--no-deps", "-e", ROOT)
    run("-c", WARM_UP)
    settings = VENV / "share/jupyter/lab/settings"
    settings.mkdir(parents=True, exist_ok=True)
    (settings / "overrides.json").write_text(json.dumps(QUIET_LAB))
    STAMP.write_text(fingerprint(lock))
    print(f"installed in {time.monotonic() - start:.0f} s", flush=True)


def setup(dev=False):
    """Make the environment match its lock; return at once if it does. A dev one serves readers."""
    if sys.version_info < (3, 11):  # noqa: UP036  (the caller may be older than we support)
        sys.exit(f"Python 3.11 or newer is needed; this is {sys.version.split()[0]}")
    fitting = [DEV_LOCK] if dev else [READER_LOCK, DEV_LOCK]
    if PYTHON.exists() and STAMP.exists() and STAMP.read_text() in map(fingerprint, fitting):
        return
    if not has_pip():
        create_environment()
    install(fitting[0])


def call(*arguments):
    """Run the environment's Python to its end, through Ctrl-C, and return its exit status."""
    process = subprocess.Popen([str(part) for part in (PYTHON, *arguments)], cwd=ROOT)
    while True:
        try:
            return process.wait()
        except KeyboardInterrupt:
            continue  # the child got it too and decides what it means


def lab(arguments):
    """Open JupyterLab on notebook 00. Trusting our own notebooks lets them play their sound."""
    run("-m", "jupyter", "trust", *sorted((ROOT / "notebooks").glob("*.ipynb")))
    return call(
        *("-m", "jupyterlab", f"--ServerApp.root_dir={ROOT}"),
        "--LabApp.default_url=/lab/tree/notebooks/00_start_here.ipynb",
        *(
            "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
            "--LabApp.news_url=None",
        ),
        *arguments,
    )


def test(arguments):
    """Run tests and notebooks on two workers; skips are listed with what they need."""
    return call("-m", "pytest", "--nbval", "-n", "2", "--dist", "loadfile", "-rs", *arguments)


def build(arguments):
    """Execute the sources of the named notebooks, all without a name, or compare them."""
    return call("-m", "s2glib.teaching.build", *arguments)


def book(arguments):
    """Write the built notebooks as pages for a browser."""
    return call("-m", "s2glib.teaching.book", *arguments)


def out_option(folder):
    """The option for a program that runs in another folder than the caller."""
    return f"--out={pathlib.Path(folder).resolve()}"


def main(argv=None):
    """Read the command line, set up, and do what it asks; return the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.set_defaults(dev=True, names=[], flags=None)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    add = functools.partial(commands.add_parser, allow_abbrev=False)
    add("lab", help="open notebook 00 in JupyterLab").set_defaults(action=lab, dev=False)
    add("test", help="run tests and notebooks").set_defaults(action=test)
    builder = add("build", help="execute notebooks/source")
    builder.add_argument("names", nargs="*", metavar="NN")
    builder.add_argument("--check", action="append_const", dest="flags", const="--check")
    builder.set_defaults(action=build)
    writer = add("book", help="write the notebooks as pages for a browser")
    writer.add_argument("--out", action="append", dest="flags", metavar="DIR", type=out_option)
    writer.set_defaults(action=book)
    installer = add("setup", help="only install")
    installer.add_argument("--dev", action="store_true", help="what tests and builds need, too")
    installer.set_defaults(action=None)
    options, rest = parser.parse_known_args(argv)
    if rest and options.action not in (lab, test):
        parser.error(f"unknown arguments: {' '.join(rest)}")
    try:
        setup(dev=options.dev)
        arguments = [*(options.flags or []), *options.names, *rest]
        return options.action(arguments) if options.action else 0
    except subprocess.CalledProcessError as error:
        sys.exit(f"`{' '.join(error.cmd)}` failed (exit status {error.returncode}); see above")


if __name__ == "__main__":
    sys.exit(main())
