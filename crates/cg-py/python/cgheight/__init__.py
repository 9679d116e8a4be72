"""Height of the centre of gravity (c.g.) of a semitrailer from ordinary driving.

The trailer rolls more in a curve the higher its load stands. From steer angle (or lateral
acceleration) and roll angle this package identifies how much, and solves for the height.

>>> import cgheight
>>> vehicle = cgheight.Vehicle.load("fixtures/vehicles/kraz.toml")
>>> answer = cgheight.estimate_log("fixtures/logs/A_p10_h170_v50_L.csv", vehicle=vehicle)
>>> answer.status
'ok'

Units are SI and part of every name. Signs are those of ISO 8855: x forward, y left, z up;
steer, yaw rate and lateral acceleration are positive to the left, roll is positive right side
down, so that a left turn gives all positive. Heights are of the trailer's sprung c.g. above
ground at rest; ``trailer_mass_kg`` is the whole semitrailer as weighed (sprung mass and axles).
"""

from cgheight._calibrate import calibrate
from cgheight._estimate import Estimator, estimate, estimate_log
from cgheight._models import arx
from cgheight._native import Vehicle, __version__, linear_model
from cgheight._results import (
    ArxModel,
    Estimate,
    LinearModel,
    Maneuver,
    RatioLine,
    ReducedModel,
    StaticBalance,
)

__all__ = [
    "ArxModel",
    "Estimate",
    "Estimator",
    "LinearModel",
    "Maneuver",
    "RatioLine",
    "ReducedModel",
    "StaticBalance",
    "Vehicle",
    "__version__",
    "arx",
    "calibrate",
    "estimate",
    "estimate_log",
    "linear_model",
]
