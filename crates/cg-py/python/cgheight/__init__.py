"""Height of the center of gravity (c.g.) of a semitrailer from ordinary driving.

In a turn, a trailer rolls more if its load is higher. This package identifies how much the trailer
rolls for a steer angle or a lateral acceleration, and solves for the height.

>>> import cgheight
>>> vehicle = cgheight.Vehicle.load("fixtures/vehicles/kraz.toml")
>>> answer = cgheight.estimate_log("fixtures/logs/A_p10_h170_v50_L.csv", vehicle=vehicle)
>>> answer.status
'ok'

`cgheight.can` reads CAN logs and a live bus, `cgheight.plot` draws figures, and `cgheight.spark`
handles thousands of trips on a cluster. They need further packages:
``pip install 'cgheight[all]'``.

Units are SI and part of every name. Signs are those of ISO 8855: x forward, y left, z up. Steer
angle, yaw rate and lateral acceleration are positive to the left, and the roll angle is positive if
the right side is down, so all of them are positive in a left turn. Heights are those of the
trailer's sprung c.g. above ground at rest. ``trailer_mass_kg`` is the mass of the whole semitrailer
as weighed (sprung mass and axles).
"""

from importlib import import_module
from types import ModuleType

from cgheight._arx_model import ArxModel
from cgheight._batch import Estimates, estimate_logs
from cgheight._calibrate import calibrate
from cgheight._columns import SIGNALS
from cgheight._estimate import Arx, Estimator, estimate, estimate_log
from cgheight._learn import learn_log
from cgheight._logs import read_log, write_log
from cgheight._model_results import (
    CompensatedModel,
    LinearModel,
    RatioLine,
    ReducedModel,
    StaticBalance,
)
from cgheight._models import OrderSelection, arx, detrend, select_order
from cgheight._native import Plant, Vehicle, __version__, linear_model, rollover_measures
from cgheight._output_error import OutputErrorModel, output_error
from cgheight._predict import predict_roll
from cgheight._report import report
from cgheight._reproduce import reproduce
from cgheight._results import ChannelEstimate, Estimate, Maneuver
from cgheight._sampled import Comparison, FrequencyResponse, StepResponse
from cgheight._scenario import ChassisSensors, Scenario, Sensors
from cgheight._simulate import RoadTruth, SimulatedLog, Truth, accuracy_map, simulate
from cgheight._transfer import TransferFunction

__all__ = [
    "SIGNALS",
    "Arx",
    "ArxModel",
    "ChannelEstimate",
    "ChassisSensors",
    "Comparison",
    "CompensatedModel",
    "Estimate",
    "Estimates",
    "Estimator",
    "FrequencyResponse",
    "LinearModel",
    "Maneuver",
    "OrderSelection",
    "OutputErrorModel",
    "Plant",
    "RatioLine",
    "ReducedModel",
    "RoadTruth",
    "Scenario",
    "Sensors",
    "SimulatedLog",
    "StaticBalance",
    "StepResponse",
    "TransferFunction",
    "Truth",
    "Vehicle",
    "__version__",
    "accuracy_map",
    "arx",
    "calibrate",
    "detrend",
    "estimate",
    "estimate_log",
    "estimate_logs",
    "learn_log",
    "linear_model",
    "output_error",
    "predict_roll",
    "read_log",
    "report",
    "reproduce",
    "rollover_measures",
    "select_order",
    "simulate",
    "write_log",
]


def __getattr__(name: str) -> ModuleType:
    """Import `cgheight.can`, `cgheight.plot` and `cgheight.spark` when they are first used."""
    if name in ("can", "plot", "spark"):
        return import_module(f"cgheight.{name}")
    raise AttributeError(f"module 'cgheight' has no attribute {name!r}")
