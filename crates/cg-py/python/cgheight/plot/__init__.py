"""Figures for reports, drawn with matplotlib.

Every function draws a new figure and returns it: ``figure.savefig("roll.png")`` saves it, and
``matplotlib.pyplot.show()`` shows it. This module needs ``pip install 'cgheight[plot]'``.
"""

from cgheight.plot._accuracy import accuracy_map
from cgheight.plot._calibration import calibration
from cgheight.plot._heights import heights
from cgheight.plot._logs import height, log
from cgheight.plot._models import bode, pole_zero, residuals

__all__ = [
    "accuracy_map",
    "bode",
    "calibration",
    "height",
    "heights",
    "log",
    "pole_zero",
    "residuals",
]
