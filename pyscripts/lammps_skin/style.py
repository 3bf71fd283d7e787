"""How figures look: as matplotlib draws by itself, whatever a user's matplotlibrc says."""

from matplotlib import style

# decorates all that draws or saves a figure
plain = style.context("default")
