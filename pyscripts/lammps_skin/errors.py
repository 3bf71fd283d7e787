"""The errors that a user sees: one line each, naming the key, the value and what is allowed."""


class SkinError(Exception):
    """Anything wrong with what the user gave or with a run; the text is one clear line."""


class SceneError(SkinError):
    """A scene that cannot be: unknown key, value out of range, parts that contradict."""


class ConfigurationError(SkinError):
    """Arrays or a file that describe no possible initial state."""


class SimulationError(SkinError):
    """A run that LAMMPS, or the watch over it, has stopped."""


class FigureError(SkinError):
    """A figure or snapshot that cannot be drawn from what is there."""
