"""Drive a real JupyterLab, and plain pages, in headless Chromium."""

import contextlib
import io
import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import nbformat
import numpy as np
from PIL import Image

TOKEN = "s2glib"
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
LOCAL = ("http://127.0.0.1", "ws://127.0.0.1", "data:", "blob:", "file:")
IDLE = """() => {
    const panel = window.jupyterapp?.shell.currentWidget;
    return !!panel?.context?.isReady && panel.sessionContext?.session?.kernel?.status === "idle";
}"""
ERRORS = """() => window.jupyterapp.shell.currentWidget.content.widgets
    .filter(cell => cell.model.type === "code")
    .flatMap(cell => cell.model.sharedModel.outputs)
    .filter(output => output.output_type === "error")
    .map(output => `${output.ename}: ${output.evalue}`)"""


class Watched(NamedTuple):
    """A page, with what it complained about and whom it called outside this machine."""

    page: object
    complaints: list[str]
    outside: list[str]


@contextlib.contextmanager
def open_browser(folder: Path) -> Iterator[Watched]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        context = driver.chromium.launch_persistent_context(
            folder / "profile",
            executable_path=os.environ.get("CHROMIUM") or shutil.which("chromium"),
            headless=True,
            args=FLAGS,
            viewport={"width": 1180, "height": 900},
        )
        watched = Watched(context.pages[0], [], [])
        watch(watched)
        try:
            yield watched
        finally:
            context.close()


def watch(watched: Watched) -> None:
    def console(message):
        if message.type == "error":
            watched.complaints.append(message.text)

    def request(asked):
        if not asked.url.startswith(LOCAL):
            watched.outside.append(asked.url)

    watched.page.on("console", console)
    watched.page.on("pageerror", lambda error: watched.complaints.append(str(error)))
    watched.page.on("request", request)


@contextlib.contextmanager
def serve_lab(root: Path, folder: Path) -> Iterator[str]:
    """Start JupyterLab on `root` with its settings in `folder`; yields the address."""
    port = free_port()
    switches = ["--no-browser", "--allow-root", "--ip=127.0.0.1", "--expose-app-in-browser"]
    options = {
        "ServerApp.port": port,
        "ServerApp.port_retries": 0,
        "IdentityProvider.token": TOKEN,
        "ServerApp.root_dir": root,
        "LabApp.check_for_updates_class": "jupyterlab.NeverCheckForUpdate",
    }
    switches += [f"--{name}={value}" for name, value in options.items()]
    command = [sys.executable, "-m", "jupyterlab", *switches]
    with open(folder / "lab.log", "wb") as log:
        server = subprocess.Popen(command, env=environment(folder), stdout=log, stderr=log)
        try:
            wait_for_server(server, port, folder / "lab.log")
            yield f"http://127.0.0.1:{port}"
        finally:
            stop(server)


def environment(folder: Path) -> dict[str, str]:
    settings = folder / "settings" / "@jupyterlab" / "apputils-extension"
    settings.mkdir(parents=True)
    quiet = {"fetchNews": "false", "checkForUpdates": False}
    (settings / "notification.jupyterlab-settings").write_text(json.dumps(quiet))
    places = {
        "JUPYTERLAB_SETTINGS_DIR": "settings",
        "JUPYTERLAB_WORKSPACES_DIR": "workspaces",
        "JUPYTER_RUNTIME_DIR": "runtime",
        "JUPYTER_CONFIG_DIR": "config",
    }
    return {**os.environ, **{name: str(folder / place) for name, place in places.items()}}


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_for_server(server: subprocess.Popen, port: int, log: Path, seconds: float = 60) -> None:
    address = f"http://127.0.0.1:{port}/api/status?token={TOKEN}"
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline and server.poll() is None:
        with contextlib.suppress(OSError):
            urllib.request.urlopen(address, timeout=2).close()
            return
        time.sleep(0.2)
    raise RuntimeError(f"JupyterLab did not start: {log.read_text()[-2000:]}")


def stop(server: subprocess.Popen) -> None:
    server.terminate()
    try:
        server.wait(15)
    except subprocess.TimeoutExpired:
        server.kill()
        server.wait()


def write_notebook(path: Path, sources: Sequence[str]) -> None:
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    nbformat.write(nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": kernel}), path)


def open_notebook(page, address: str, name: str) -> None:
    page.goto(f"{address}/lab/tree/{name}?token={TOKEN}&reset", wait_until="domcontentloaded")
    page.wait_for_function("() => window.jupyterapp !== undefined", timeout=60_000)
    page.evaluate("() => window.jupyterapp.restored")
    page.wait_for_selector(".jp-NotebookPanel .jp-Cell", timeout=60_000)
    page.wait_for_function(IDLE, timeout=60_000)


def run_all_cells(page, timeout: float = 120_000) -> list[str]:
    """Run the open notebook; returns the errors of its cells."""
    page.evaluate("() => window.jupyterapp.commands.execute('notebook:run-all-cells')")
    page.wait_for_function(IDLE, timeout=timeout)
    return page.evaluate(ERRORS)


def run_in_kernel(page, code: str) -> str | None:
    """Run code in the open notebook's kernel without a cell; returns its error, if any."""
    return page.evaluate(
        """async code => {
            const kernel = window.jupyterapp.shell.currentWidget.sessionContext.session.kernel;
            const reply = await kernel.requestExecute({ code }).done;
            return reply.content.status === "ok" ? null : reply.content.evalue;
        }""",
        code,
    )


def execute(page, code: str) -> None:
    """Run code in the kernel, where it must not fail."""
    assert run_in_kernel(page, code) is None


def pixels(place) -> np.ndarray:
    """What an element shows: (height, width, 3), 0 to 255."""
    png = io.BytesIO(place.screenshot())
    return np.asarray(Image.open(png).convert("RGB"), dtype=float)
