import json

import jaxtyping
import numpy as np
import pytest
from stand_in import capsule_body, tone, waving_motion


def unpack(data: bytes) -> dict:
    """The container read back, the way `unpack` in pose.js reads it."""
    length = int.from_bytes(data[:4], "little")
    header = json.loads(data[4 : 4 + length])
    content = dict(header["facts"])
    for entry in header["arrays"]:
        start, count = 4 + length + entry["offset"], int(np.prod(entry["shape"]))
        values = np.frombuffer(data, "<" + entry["kind"], count, start)
        content[entry["name"]] = values.reshape(entry["shape"])
    return content


@pytest.fixture(scope="session")
def read():
    return unpack


@pytest.fixture(scope="session")
def body():
    return capsule_body()


@pytest.fixture
def motion():
    return waving_motion()


@pytest.fixture
def waveform():
    return tone()


@pytest.fixture
def without_type_hook():
    """What a reader meets: no shape checks at run time, only our own refusals."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)
