"""How far the memory of `swap` rises with the length of the speech, in a process of its own."""

import os
import subprocess
import sys

SHORT, LONG = 0.5, 2.5  # minutes
GIVE_BACK = {"MALLOC_MMAP_THRESHOLD_": "262144"}  # glibc gives freed arrays back at once
PROGRAM = """
import resource, sys
from s2glib.__main__ import main
unit = 2**20 if sys.platform == "darwin" else 2**10
for name in ("short.wav", "long.wav"):
    main(["swap", name, "--emotion", "anger", "--out", name + "-out"])
    print("peak", resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit)
"""


def test_a_minute_more_of_speech_takes_at_most_thirty_megabytes_more(record, here):
    """Samples, filterbank and motions are 9 MB, a step needs some more; we measured 22 MB.

    Without batches and blocks it was 75 MB.
    """
    record("short.wav", 60 * SHORT)
    record("long.wav", 60 * LONG)
    words = [sys.executable, "-c", PROGRAM]
    settings = os.environ | GIVE_BACK
    done = subprocess.run(words, capture_output=True, text=True, check=True, env=settings)
    peaks = [float(line.split()[1]) for line in done.stdout.splitlines() if line[:4] == "peak"]
    assert (here / "long.wav-out" / "gesture.html").exists()
    assert (peaks[1] - peaks[0]) / (LONG - SHORT) < 30
