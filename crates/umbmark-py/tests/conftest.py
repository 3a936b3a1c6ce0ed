"""Settings of all tests."""

from hypothesis import settings

# A machine under load is slow, not wrong.
settings.register_profile("umbmark", deadline=None)
settings.load_profile("umbmark")
