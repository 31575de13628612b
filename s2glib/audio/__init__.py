"""Sound in, arrays out: reading, spectra, rhythm, and the features the three papers use."""

from s2glib.audio.features import HANDCRAFTED_NAMES, handcrafted_features
from s2glib.audio.io import Waveform, load, resample, save, stream
from s2glib.audio.rhythm import FRAME_RATE, beat_times, onset_strength, onset_times
from s2glib.audio.spectral import (
    chroma,
    chroma_cens,
    filterbank,
    mel_filters,
    mfcc,
    standardize,
    tempogram,
)
from s2glib.audio.speech_models import load_speech_model, wav2vec2_features, wavlm_features

__all__ = [
    "FRAME_RATE",
    "HANDCRAFTED_NAMES",
    "Waveform",
    "beat_times",
    "chroma",
    "chroma_cens",
    "filterbank",
    "handcrafted_features",
    "load",
    "load_speech_model",
    "mel_filters",
    "mfcc",
    "onset_strength",
    "onset_times",
    "resample",
    "save",
    "standardize",
    "stream",
    "tempogram",
    "wav2vec2_features",
    "wavlm_features",
]
