"""The errors and warnings this package raises at its boundary."""


class SceneError(ValueError):
    """A mesh, material or position that the tracer cannot work with; the message says why."""


class SceneWarning(UserWarning):
    """Something in a mesh that the tracer has put right; the message names the walls."""


class AntennaError(ValueError):
    """A pattern that is no antenna's: wrong columns, or not on a grid of the whole sphere."""


class MapFileError(ValueError):
    """A radio map file that is truncated, of another format or of another version."""
