"""What every test shares."""

import jaxtyping
import pytest
from hypothesis import settings

settings.register_profile("s2glib", deadline=None)  # a deadline would be a timed test
settings.load_profile("s2glib")


@pytest.fixture
def without_type_hook():
    """What a reader meets: no shape checks at run time, only our own refusals."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.fixture(scope="session", autouse=True)
def a_home_of_its_own(tmp_path_factory):
    """No test writes into a reader's home."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("S2G_HOME", str(tmp_path_factory.mktemp("home")))
        yield
