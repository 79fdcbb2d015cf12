"""How long the property tests search: `--hypothesis-profile=qualify` is for the long run."""

from hypothesis import settings

settings.register_profile("default", deadline=None)
settings.register_profile("qualify", deadline=None, max_examples=3000)
settings.load_profile("default")
