"""Rebuild the shipped mannequin: `python -m s2glib.body.sculpture OUT`.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import argparse
import pathlib

from s2glib.body.mannequin import save_mannequin
from s2glib.body.sculpture import assemble

parser = argparse.ArgumentParser(prog="python -m s2glib.body.sculpture", description=__doc__)
parser.add_argument("out", type=pathlib.Path, help="file to write, e.g. mannequin.safetensors")
save_mannequin(assemble(), parser.parse_args().out)
