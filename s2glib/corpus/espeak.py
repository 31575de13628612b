"""espeak-ng through ctypes: one sentence in, samples with word and phoneme times out.

The library's noise generator keeps state between calls, so every synthesis runs in a process of
its own: the same words give the same samples. Some breathy variants (Alicia, f2, f3, f5, victor)
seed their noise by the clock all the same; the script has none of them.

Paper:    AM F (the same sentences spoken by every subject)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import ctypes
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

NATIVE_RATE = 22050
_RETRIEVE_AUDIO, _PHONEME_EVENTS, _IPA, _UTF8 = 1, 1, 2, 1
_WORD, _PHONEME = 1, 7
_RATE, _VOLUME, _PITCH, _RANGE = 1, 2, 3, 4


class _EventId(ctypes.Union):
    _fields_ = (
        ("number", ctypes.c_int),
        ("name", ctypes.c_char_p),
        ("string", ctypes.c_char * 8),
    )


class _Event(ctypes.Structure):
    _fields_ = (
        ("type", ctypes.c_int),
        ("unique_identifier", ctypes.c_uint),
        ("text_position", ctypes.c_int),
        ("length", ctypes.c_int),
        ("audio_position", ctypes.c_int),
        ("sample", ctypes.c_int),
        ("user_data", ctypes.c_void_p),
        ("id", _EventId),
    )


_Callback = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.POINTER(_Event)
)


@dataclass(frozen=True)
class Utterance:
    """What espeak-ng says: samples at 22 050 Hz, and when each word and phoneme starts (s)."""

    samples: Float[np.ndarray, " n"]
    words: tuple[tuple[str, float], ...]
    phonemes: tuple[tuple[str, float], ...]

    @property
    def duration(self) -> float:
        """Seconds."""
        return len(self.samples) / NATIVE_RATE


def synthesize(text: str, variant: str, *, pitch: int = 50, rate: int = 150) -> Utterance:
    """Speak `text` with an espeak-ng voice variant of American English, in a fresh process.

    Args:
        text: plain words.
        variant: a name from espeak-ng's `voices/!v` folder.
        pitch: 0 to 99, espeak-ng's base pitch.
        rate: words per minute.

    Raises:
        ImportError: without the extra `corpus`.
        ValueError: if espeak-ng does not know the variant.
    """
    request = json.dumps({"text": text, "variant": variant, "pitch": pitch, "rate": rate})
    done = subprocess.run(
        [sys.executable, "-P", __file__, request], capture_output=True, check=False
    )
    if done.returncode:
        message = done.stderr.decode().strip().splitlines()[-1]
        if "ModuleNotFoundError" in message:
            raise ImportError(
                "making speech needs espeak-ng; install the extra: pip install s2glib[corpus]"
            )
        raise ValueError(f"espeak-ng could not speak {text!r} with variant {variant!r}: {message}")
    head, _, body = done.stdout.partition(b"\n")
    events = json.loads(head)
    return Utterance(
        samples=np.frombuffer(body, "<i2").astype(np.float32) / 32768,
        words=tuple((word, start) for word, start in events["words"]),
        phonemes=tuple((phoneme, start) for phoneme, start in events["phonemes"]),
    )


def _speak(text: str, variant: str, pitch: int, rate: int) -> tuple[bytes, list, list]:
    import espeakng_loader

    library = ctypes.CDLL(espeakng_loader.get_library_path())
    data = espeakng_loader.get_data_path()
    library.espeak_Initialize(_RETRIEVE_AUDIO, 0, data.encode(), _PHONEME_EVENTS | _IPA)
    known = Path(data, "voices", "!v", variant).is_file()  # or espeak-ng speaks without a variant
    if not known or library.espeak_SetVoiceByName(f"en-us+{variant}".encode()) != 0:
        raise ValueError("unknown voice variant")
    chunks, words, phonemes = [], [], []

    def receive(samples, count, events):
        if samples and count > 0:
            chunks.append(np.ctypeslib.as_array(samples, (count,)).tobytes())
        index = 0
        while events[index].type != 0:
            event = events[index]
            if event.type == _WORD:
                begin = event.text_position - 1
                words.append((text[begin : begin + event.length], event.audio_position / 1000))
            elif event.type == _PHONEME:
                name = bytes(event.id.string).split(b"\0")[0].decode("utf8", "replace")
                phonemes.append((name, event.audio_position / 1000))
            index += 1
        return 0

    callback = _Callback(receive)
    library.espeak_SetSynthCallback(callback)
    for parameter, value in ((_RATE, rate), (_VOLUME, 90), (_PITCH, pitch), (_RANGE, 50)):
        library.espeak_SetParameter(parameter, value, 0)
    encoded = text.encode()
    library.espeak_Synth(encoded, len(encoded) + 1, 0, 1, 0, _UTF8, None, None)
    library.espeak_Synchronize()
    return b"".join(chunks), words, phonemes


if __name__ == "__main__":
    _audio, _words, _phonemes = _speak(**json.loads(sys.argv[1]))
    sys.stdout.buffer.write(json.dumps({"words": _words, "phonemes": _phonemes}).encode() + b"\n")
    sys.stdout.buffer.write(_audio)
