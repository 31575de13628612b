"""What every test shares."""

from hypothesis import settings

settings.register_profile("s2glib", deadline=None)  # a deadline would be a timed test
settings.load_profile("s2glib")
