"""Every shipped clip is the file whose checksum the manifest holds, and none is unlisted."""

import hashlib
import json

from s2glib.folders import data_folder


def test_the_shipped_clips_are_those_of_the_manifest():
    clips = json.loads((data_folder() / "manifest.json").read_text(encoding="utf-8"))["clips"]
    listed = {
        f"{name}.{kind}": sha for name, c in clips.items() for kind, sha in c["sha256"].items()
    }
    files = sorted((data_folder() / "clips").iterdir())
    assert {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in files} == listed
