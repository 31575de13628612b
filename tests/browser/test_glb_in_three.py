"""Our GLB in other people's programs: Khronos' validator and three.js."""

import functools
import http.server
import io
import json
import shutil
import subprocess
import threading
from pathlib import Path

import numpy as np
import pytest
from browser.lab import open_browser
from PIL import Image
from stand_in import waving_motion

from s2glib.body import FACE_CURVES, joint, joint_positions, mannequin, write_glb

pytestmark = pytest.mark.browser
HERE = Path(__file__).parent
BONES = ("left_wrist", "right_wrist", "head", "left_index3", "right_foot")
FPS, FRAMES = 30, 60


@pytest.fixture(scope="module")
def node_modules() -> Path:
    """three.js and the validator, installed once as package-lock.json pins them."""
    if not shutil.which("npm"):
        pytest.skip("needs npm (Debian, Ubuntu: apt install npm)")
    if not (HERE / "node_modules" / "three").exists():
        command = ["npm", "ci", "--no-audit", "--no-fund"]
        subprocess.run(command, cwd=HERE, check=True, capture_output=True)
    return HERE / "node_modules"


@pytest.fixture(scope="module")
def folder(tmp_path_factory, node_modules) -> Path:
    """What the browser sees: a page, three.js and a motion."""
    folder = tmp_path_factory.mktemp("glb")
    shutil.copy(HERE / "glb_page.html", folder / "index.html")
    (folder / "three").symlink_to(node_modules / "three")
    write_glb(folder / "motion.glb", waving_motion(FRAMES), mannequin())
    return folder


@pytest.fixture(scope="module")
def page(folder, tmp_path_factory):
    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *args):
            pass

    handler = functools.partial(Quiet, directory=folder)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        with open_browser(tmp_path_factory.mktemp("browser")) as watched:
            watched.page.goto(f"http://127.0.0.1:{server.server_port}/")
            watched.page.wait_for_function("() => window.faceCurves !== undefined")
            yield watched.page
            assert watched.outside == []
            assert watched.complaints == []
        server.shutdown()


def picture(page) -> np.ndarray:
    shot = page.locator("canvas").screenshot()
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int)


def test_khronos_validator_has_nothing_to_say(folder, node_modules):
    done = subprocess.run(
        ["node", "validate.mjs", folder / "motion.glb"],
        cwd=HERE,
        check=True,
        capture_output=True,
        text=True,
    )
    report = json.loads(done.stdout)
    assert report["issues"]["messages"] == []
    assert report["info"]["animationCount"] == 1
    assert report["info"]["hasMorphTargets"]
    assert report["info"]["hasSkins"]


@pytest.mark.parametrize("frame", [0, 11, 37, FRAMES - 1])
def test_bones_are_where_forward_kinematics_puts_them(page, frame):
    shown = np.array(page.evaluate("args => show(...args)", [frame / FPS, BONES]))
    expected = joint_positions(waving_motion(FRAMES), mannequin())[frame].numpy()
    np.testing.assert_allclose(shown, expected[[joint(name) for name in BONES]], atol=0.01)


def test_face_curves_play(page):
    page.evaluate("args => show(...args)", [20 / FPS, []])
    curves = page.evaluate("() => faceCurves()")
    assert curves["names"] == list(FACE_CURVES)
    expected = waving_motion(FRAMES).expression[20, : len(FACE_CURVES)]
    np.testing.assert_allclose(curves["shares"], expected, atol=1e-3)


def test_the_picture_moves(page):
    pictures = []
    for seconds in (0.0, 0.0, 0.7):
        page.evaluate("args => show(...args)", [seconds, []])
        pictures.append(picture(page))
    first, again, later = pictures
    assert np.abs(first - first[0, 0]).max() > 100  # somebody stands there
    assert (first == again).all()
    assert (np.abs(first - later).max(axis=2) > 30).mean() > 0.01
