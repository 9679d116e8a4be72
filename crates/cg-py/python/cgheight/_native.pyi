"""The compiled module of cgheight."""

import os
from collections.abc import Mapping, Sequence
from typing import Any, Final, Literal, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import disjoint_base

from cgheight._arx_model import ArxModel
from cgheight._model_results import LinearModel
from cgheight._results import Estimate
from cgheight._scenario import Scenario

__all__ = [
    "FrameStream",
    "FrameTable",
    "Plant",
    "Stream",
    "Vehicle",
    "__version__",
    "after_lags",
    "calibrate_files",
    "channel_factor",
    "copy_file",
    "estimate_arrays",
    "estimate_file",
    "fit_arx",
    "learn_arrays",
    "linear_model",
    "may_write",
    "may_write_report",
    "predict_roll",
    "prepare",
    "read_file",
    "read_frames",
    "reproduce_tables",
    "resolve_columns",
    "restore_plant",
    "restore_vehicle",
    "rollover_measures",
    "score_accuracy",
    "several_buses",
    "signals",
    "simulate_log",
    "trace_arrays",
    "write_file",
    "write_report",
]

__version__: Final[str]

@final
class Vehicle:
    """A tractor-semitrailer, read from a vehicle file (TOML) with `Vehicle.load`."""

    @staticmethod
    def load(path: str | os.PathLike[str], /) -> Vehicle:
        """Read and check a vehicle file."""
    @staticmethod
    def template(kind: Literal["4x2-3axle", "6x4-2axle", "6x4-3axle"], /) -> Vehicle:
        """Return a vehicle with typical values, which are to be replaced by those of your truck."""
    def with_(self, changes: Mapping[str, Any] | None = None, /, **keys: Any) -> Vehicle:
        """Return the same vehicle with other values in its file."""
    @property
    def toml(self) -> str:
        """Text of the vehicle file."""
    def calibrated(self, path: str | os.PathLike[str], /) -> Vehicle:
        """Return the same vehicle with a calibration."""
    def on_road(self, road: str | float, /) -> Vehicle:
        """Return the same vehicle on other roads."""
    def with_lift_axle(self, position: Literal["down", "raised"], /) -> Vehicle:
        """Return the same vehicle with its lift axles in a position."""
    @property
    def lift_axle(self) -> Literal["down", "raised"] | None:
        """Where the lift axles are, or None if only a log says it."""
    @property
    def is_calibrated(self) -> bool:
        """Whether the vehicle has a calibration, bool."""
    @property
    def name(self) -> str:
        """Name of the vehicle."""
    @property
    def nominal_speed_mps(self) -> float:
        """Speed that is used if no other is given, m/s."""
    @property
    def reference_trailer_mass_kg(self) -> float:
        """Mass of the whole semitrailer that is used if no other is given, kg."""
    @property
    def reference_height_m(self) -> float:
        """Height of the trailer's sprung c.g. above ground that is used if no other is given, m."""
    @property
    def empty_trailer_mass_kg(self) -> float:
        """Mass of the semitrailer without payload, kg."""
    @property
    def steering_ratio(self) -> float | None:
        """Steering-wheel angle divided by road-wheel angle, or None if the file has no ratio."""
    @property
    def height_range_m(self) -> tuple[float, float]:
        """Range of c.g. heights that the file allows (lowest, highest), m."""
    def __reduce__(self) -> tuple[Any, tuple[str, str, str | None]]: ...
    def _repr_html_(self) -> str: ...

@disjoint_base
class Stream:
    """Estimator that processes one row at a time; `cgheight.Estimator` sets its options."""

    def __new__(
        cls,
        vehicle: Vehicle,
        options: dict[str, Any],
        learned: str | None = None,
        state: bytes | None = None,
        /,
    ) -> Self:
        """Start a log, or go on from a state."""
    def _parts(self) -> tuple[Vehicle, dict[str, Any], str | None, bytes]:
        """Return what makes the same estimator again: the arguments of `Stream`."""
    def learned(self) -> str:
        """Return what the truck has learned, as if the log ended here; more rows may follow."""
    def push(
        self,
        time_s: float,
        steer_rad: float | None = ...,
        roll_rad: float | None = ...,
        **signals: float | None,
    ) -> Literal["absent", "straight", "turning"]:
        """Process one row. Absent signals are None or NaN."""
    def estimate(self) -> Estimate:
        """Return the estimate so far, as if the log ended here; more rows may follow."""

@final
class FrameStream:
    """Estimator that processes one CAN frame at a time."""

    def __new__(cls, vehicle: Vehicle, reading: dict[str, Any], options: dict[str, Any], /) -> Self:
        """Start a drive."""
    def push(
        self, place: tuple[float, int], identifier: int, extended: bool, data: bytes, /
    ) -> bool:
        """Process a frame, with time in seconds and bus; return whether a turn has ended."""
    def finish(self) -> int:
        """End the log and return the number of rows."""
    def remarks(self) -> list[str]:
        """Return the remarks about doubtful values and frames so far."""
    def estimate(self) -> Estimate:
        """Return the estimate so far, as if the log ended here; more frames may follow."""
    @property
    def counts(self) -> tuple[int, int, int]:
        """Number of frames received, of frames with a value that is used, and of rows."""

@final
class FrameTable:
    """Converts frames to the rows of a log."""

    def __new__(cls, reading: dict[str, Any], /) -> Self:
        """Start a log."""
    def push(
        self, place: tuple[float, int], identifier: int, extended: bool, data: bytes, /
    ) -> None:
        """Add a frame, with time in seconds and bus."""
    def finish(self) -> dict[str, NDArray[np.float64]]:
        """End the log and return a dict of SI column names to arrays, without absent signals."""
    def remarks(self) -> list[str]:
        """Return the remarks about doubtful values and frames so far."""
    @property
    def frames(self) -> tuple[int, int]:
        """Number of frames received, and of frames with a value that is used."""

@final
class Plant:
    """The nonlinear plant of a loaded vehicle that drives, step by step."""

    def __new__(
        cls,
        vehicle: Vehicle,
        *,
        height_m: float | None = None,
        trailer_mass_kg: float | None = None,
        payload_kg: float | None = None,
        payload_behind_hitch_m: float | None = None,
        payload_left_m: float = 0.0,
        speed_mps: float | None = None,
        bank_rad: float = 0.0,
        grade_rad: float = 0.0,
        path_m: Sequence[Sequence[float]] | NDArray[np.float64] | None = None,
    ) -> Self:
        """Start straight ahead."""
    def step(
        self,
        steer_rad: float | None,
        interval_s: float,
        *,
        speed_mps: float | None = None,
        bank_rad: float | None = None,
        grade_rad: float | None = None,
    ) -> dict[str, float]:
        """Drive on for a time."""
    def drive(
        self,
        steer_rad: ArrayLike,
        interval_s: float,
        *,
        speed_mps: ArrayLike | None = None,
        bank_rad: ArrayLike | None = None,
        grade_rad: ArrayLike | None = None,
    ) -> dict[str, NDArray[np.float64]]:
        """Drive on through traces of your own: a `step` for each element."""
    @property
    def signals(self) -> dict[str, float]:
        """What perfect sensors show now, with the time, by the names in `cgheight.SIGNALS`."""
    @property
    def states(self) -> dict[str, float]:
        """The true states now: a dict of names with units to values. Axles count from one."""
    @property
    def time_s(self) -> float:
        """Time since the start, s."""
    @property
    def rolled_over(self) -> bool:
        """Whether a unit has rolled beyond 0.6 rad. The vehicle then does not move any more."""
    def __copy__(self) -> Plant: ...
    def __deepcopy__(self, _memo: Any, /) -> Plant: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

def estimate_arrays(
    vehicle: Vehicle,
    signals: dict[str, NDArray[np.float64]],
    options: dict[str, Any],
    /,
) -> Estimate:
    """Estimate from a dict of SI column names to 1-D contiguous float64 arrays."""

def estimate_file(
    vehicle: Vehicle,
    path: str | os.PathLike[str],
    columns: list[str],
    flip: list[str],
    options: dict[str, Any],
    /,
) -> Estimate:
    """Estimate from a log file (CSV, CSV in gzip, parquet, candump)."""

def prepare(
    signals: dict[str, NDArray[np.float64]], vehicle: Vehicle | None, apart: bool, /
) -> tuple[dict[str, NDArray[np.float64]], list[str]] | None:
    """Align channels of different rasters, and make roll angles of a roll rate."""

def channel_factor(signal: str, name: str, unit: str, flip: list[str], /) -> tuple[str, float]:
    """Return the SI column of a signal, and the factor from the unit of a channel to SI."""

def resolve_columns(
    names: list[str], units: list[str], columns: list[str], flip: list[str], /
) -> dict[str, tuple[int, float]]:
    """Find the columns of a log among the column names of a table."""

def fit_arx(
    u: list[NDArray[np.float64]],
    y: list[NDArray[np.float64]],
    na: int,
    nb: int,
    nk: int,
    ts: float,
    /,
) -> ArxModel:
    """Fit an ARX model to experiments: lists of 1-D contiguous float64 arrays."""

def linear_model(
    vehicle: Vehicle,
    *,
    model: Literal["complete", "as-printed"] = "complete",
    speed_mps: float | None = None,
    height_m: float | None = None,
    trailer_mass_kg: float | None = None,
) -> LinearModel:
    """Return the linear model of a vehicle at one speed and load."""

def rollover_measures(
    vehicle: Vehicle,
    *,
    speed_mps: float | None = None,
    height_m: float | None = None,
    trailer_mass_kg: float | None = None,
    radius_m: float | None = None,
    share: float = 0.6,
    height_sd_m: float = 0.0,
) -> dict[str, float | None]:
    """Return all rollover measures of a loaded vehicle."""

def calibrate_files(
    vehicle: Vehicle,
    runs: list[
        tuple[
            tuple[str, bool, tuple[float, float | None] | None, tuple[float, float | None] | None],
            Any,
        ]
    ],
    states: list[tuple[str, str | None]],
    output: str | os.PathLike[str],
    request: dict[str, object],
    /,
) -> None:
    """Calibrate with log files and states, and write the calibration file."""

def read_file(
    path: str | os.PathLike[str], columns: list[str], flip: list[str], /
) -> dict[str, NDArray[np.float64]]:
    """Read a log file (CSV, CSV in gzip, parquet) into a dict of SI column names to arrays."""

def read_frames(
    path: str | os.PathLike[str], reading: dict[str, Any], /
) -> tuple[dict[str, NDArray[np.float64]], list[str]]:
    """Read a candump log: a dict of SI column names to arrays, and the remarks about it."""

def several_buses(name: str, only: str | None, buses: list[str], /) -> str | None:
    """Refuse a bus that a log does not have; return the remark on several of which all are used."""

def signals() -> dict[str, str]:
    """Return the signals of logs: a dict of SI column names to their meanings."""

def learn_arrays(
    vehicle: Vehicle, signals: dict[str, NDArray[np.float64]], /
) -> tuple[str, list[str]]:
    """Return what a truck learns from a log of it: JSON text, and a message for each trip."""

def predict_roll(
    vehicle: Vehicle,
    signals: dict[str, NDArray[np.float64]],
    channel: str,
    height_m: float,
    options: dict[str, Any],
    /,
) -> NDArray[np.float64]:
    """Predict the roll angle for a height with the model."""

def after_lags(
    time_s: NDArray[np.float64], roll_rad: NDArray[np.float64], /
) -> NDArray[np.float64]:
    """Return the roll angle after the lags of a channel whose input is an acceleration."""

def simulate_log(
    vehicle: Vehicle,
    request: Scenario,
    /,
    *,
    on_bus: bool = False,
) -> tuple[dict[str, NDArray[np.float64]], str, dict[str, NDArray[np.float64]] | None]:
    """Simulate a log: columns, the truth as JSON, and on a road the places on the way."""

def score_accuracy(
    vehicle: Vehicle,
    request: Scenario,
    truck: str,
    channel: str,
    method: str,
    runs: int,
    /,
) -> dict[str, Any]:
    """Estimate the same scenario many times with new noise, and score the heights."""

def reproduce_tables(name: str | None, runs: int, seed: int, /) -> dict[str, list[Any]]:
    """Recompute one table of the thesis, or all: a dict of columns."""

def restore_plant(
    version: str,
    vehicle: Vehicle,
    start: Sequence[float],
    path_m: Sequence[Sequence[float]] | None,
    state: bytes,
    /,
) -> Plant:
    """Return a plant in the state in which it was pickled."""

def restore_vehicle(
    text: str,
    file: str,
    calibration: str | None,
    bank_sd_rad: float | None,
    lift_axle: str | None,
    /,
) -> Vehicle:
    """Return a vehicle from the text of its file and of its calibration, if it has one."""

def may_write(request: dict[str, Any], /) -> None:
    """Raise an error if the log may not be written; called before the work begins."""

def copy_file(source: str | os.PathLike[str], request: dict[str, Any], /) -> None:
    """Copy a file to the path of the request, where it appears only when it is complete."""

def write_file(
    request: dict[str, Any],
    signals: dict[str, NDArray[np.float64]],
    comments: list[str],
    /,
) -> tuple[int, list[str]]:
    """Write arrays to a log.

    Return how many values are outside their J1939 range, and the columns that J1939 lacks.
    """

def may_write_report(request: dict[str, Any], /) -> None:
    """Raise an error if the report may not be written; called before the work begins."""

def trace_arrays(
    vehicle: Vehicle,
    signals: dict[str, NDArray[np.float64]],
    options: dict[str, Any],
    logs: int,
    /,
) -> str:
    """Return the signals of a log as JSON text, with the points of a report of that many logs."""

def write_report(
    request: dict[str, Any],
    vehicle: str,
    calibration: str | None,
    logs: list[tuple[str, str | None, float | None, str]],
    /,
) -> None:
    """Write the report: for each log name, result, known height, and signals or a reason."""
