"""Searchers that do not learn: policies (`rssnav.missions.Policy`) for any mission.

Some know the plan or radio maps beforehand, others nothing but the size of the building; each says
which. All know their own cell, so they fly with ``Observation(None, cell=True)``.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
