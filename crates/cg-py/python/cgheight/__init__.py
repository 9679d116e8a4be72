"""Height of the center of gravity (c.g.) of a semitrailer from ordinary driving.

The trailer rolls more in a curve the higher its load stands. From steer angle (or lateral
acceleration) and roll angle this package identifies how much, and solves for the height.

>>> import cgheight
>>> vehicle = cgheight.Vehicle.load("fixtures/vehicles/kraz.toml")
>>> answer = cgheight.estimate_log("fixtures/logs/A_p10_h170_v50_L.csv", vehicle=vehicle)
>>> answer.status
'ok'

CAN logs and a live bus: `cgheight.can`. Pictures: `cgheight.plot`. Thousands of trips on a cluster:
`cgheight.spark`. These three need further packages: ``pip install 'cgheight[all]'``.

Units are SI and part of every name. Signs are those of ISO 8855: x forward, y left, z up;
steer, yaw rate and lateral acceleration are positive to the left, roll is positive right side
down, so that a left turn gives all positive. Heights are of the trailer's sprung c.g. above
ground at rest; ``trailer_mass_kg`` is the whole semitrailer as weighed (sprung mass and axles).
"""

from importlib import import_module
from types import ModuleType

from cgheight._batch import Estimates, estimate_logs
from cgheight._calibrate import calibrate
from cgheight._columns import SIGNALS
from cgheight._estimate import Arx, Estimator, estimate, estimate_log
from cgheight._logs import read_log, write_log
from cgheight._model_results import (
    ArxModel,
    LinearModel,
    RatioLine,
    ReducedModel,
    StaticBalance,
)
from cgheight._models import OrderSelection, arx, select_order
from cgheight._native import Vehicle, __version__, linear_model
from cgheight._predict import predict_roll
from cgheight._reproduce import reproduce
from cgheight._results import ChannelEstimate, Estimate, Maneuver
from cgheight._scenario import Scenario, Sensors
from cgheight._simulate import SimulatedLog, accuracy_map, simulate
from cgheight._transfer import TransferFunction

__all__ = [
    "SIGNALS",
    "Arx",
    "ArxModel",
    "ChannelEstimate",
    "Estimate",
    "Estimates",
    "Estimator",
    "LinearModel",
    "Maneuver",
    "OrderSelection",
    "RatioLine",
    "ReducedModel",
    "Scenario",
    "Sensors",
    "SimulatedLog",
    "StaticBalance",
    "TransferFunction",
    "Vehicle",
    "__version__",
    "accuracy_map",
    "arx",
    "calibrate",
    "estimate",
    "estimate_log",
    "estimate_logs",
    "linear_model",
    "predict_roll",
    "read_log",
    "reproduce",
    "select_order",
    "simulate",
    "write_log",
]


def __getattr__(name: str) -> ModuleType:
    """Import `cgheight.can`, `cgheight.plot` and `cgheight.spark` when they are first used."""
    if name in ("can", "plot", "spark"):
        return import_module(f"cgheight.{name}")
    raise AttributeError(f"module 'cgheight' has no attribute {name!r}")
