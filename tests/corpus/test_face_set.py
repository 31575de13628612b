import numpy as np

from s2glib.body import FACE_CURVES
from s2glib.corpus import build
from s2glib.corpus.script import Cell


def test_cached_faces_are_those_of_the_rendered_motion_beside_its_poses(monkeypatch, tmp_path):
    monkeypatch.setenv("S2G_CACHE", str(tmp_path))
    cell = Cell(1, "voice_01", "anger", 2)
    clock = build.Request(cell, "neutral")
    first = build.face_set([clock, cell], processes=1)
    monkeypatch.delattr(build, "_render_all")  # from here on there is only the cache
    second = build.face_set([clock, cell])
    for found, again, clock_of in zip(first, second, ("neutral", None), strict=True):
        face = build.render_motion(cell, clock_of=clock_of).motion.expression[:, : len(FACE_CURVES)]
        assert np.array_equal(found, face.numpy().astype(np.float16))
        assert np.array_equal(found, again)
