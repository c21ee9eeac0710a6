"""Shared by all tests: hypothesis without deadlines, the same examples in every run."""

from hypothesis import settings

settings.register_profile("rssnav", deadline=None, derandomize=True, print_blob=False)
settings.load_profile("rssnav")
