"""Estimates of thousands of trips on a cluster, with PySpark.

The heights are the same as on one machine: a worker gives each trip to `cgheight.estimate_log` as
Arrow columns. `learn_trips` and `learn_files` do the same with `cgheight.learn_log`, so that the
trips of a truck with the empty trailer become its calibration. This module needs ``pip install
'cgheight[spark]'`` on the driver and on the workers.
"""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from cgheight import _native
from cgheight._batch import Estimates
from cgheight._columns import SIGNALS
from cgheight._estimate import estimate_log
from cgheight._learn import learned
from cgheight._results import rejected

if TYPE_CHECKING:
    import pyarrow as pa
    from pyspark.sql import DataFrame

__all__ = ["estimate_files", "estimate_trips", "learn_files", "learn_trips"]

# The columns of `Estimates.to_frame` with their Spark types.
_COLUMNS = {
    "log": "string",
    "status": "string",
    "height_m": "double",
    "height_sd_m": "double",
    "height_ci95_low_m": "double",
    "height_ci95_high_m": "double",
    "ratio": "double",
    "ratio_sd": "double",
    "method": "string",
    "channel": "string",
    "speed_mps": "double",
    "trailer_mass_kg": "double",
    "lift_axle": "string",
    "snr_db": "double",
    "fit_percent": "double",
    "static_rollover_threshold_g": "double",
    "static_rollover_threshold_ci95_low_g": "double",
    "static_rollover_threshold_ci95_high_g": "double",
    "road_share": "double",
    "maneuvers": "bigint",
    "messages": "string",
    "steer_height_m": "double",
    "steer_height_sd_m": "double",
    "lateral_acceleration_height_m": "double",
    "lateral_acceleration_height_sd_m": "double",
    "suspension_height_m": "double",
    "suspension_height_sd_m": "double",
    "tractor_height_m": "double",
    "tractor_height_sd_m": "double",
}
# The columns of what trips teach.
_LEARNED = {"log": "string", "trips": "bigint", "learned": "string", "messages": "string"}

# The name of a log, which rows of a table may lack, and the log.
_Trip = tuple[str | None, Any]
# The rows of some logs, for a truck and the keywords of `estimate_log` or `learn_log`.
_Rows = Callable[[_native.Vehicle, list[_Trip], Mapping[str, Any]], list[dict[str, Any]]]


# What a worker does with its part of a table.
_Work = Callable[["Iterator[pa.RecordBatch]"], "Iterator[pa.RecordBatch]"]


@lru_cache(maxsize=8)
def _truck(pickled: bytes) -> _native.Vehicle:
    """Return the unpickled vehicle; all trips of a worker share it and its design."""
    vehicle: _native.Vehicle = pickle.loads(pickled)
    return vehicle


def _readable(log: Any) -> Any:
    """Return a log, or raise the reason why it is none."""
    if isinstance(log, ValueError):
        raise log
    return log


def _estimated(
    truck: _native.Vehicle, logs: list[_Trip], options: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Estimate logs: one row for each log, even if it cannot be read."""
    answers = []
    for _, log in logs:
        try:
            answers.append(estimate_log(_readable(log), vehicle=truck, **options))
        except (OSError, ValueError) as error:
            mass_kg = truck.reference_trailer_mass_kg
            answers.append(rejected(str(error), mass_kg, dict(options)))
    rows = Estimates(tuple(str(name) for name, _ in logs), tuple(answers)).to_rows()
    return [row | {"log": name} for row, (name, _) in zip(rows, logs, strict=True)]


def _taught(
    truck: _native.Vehicle, logs: list[_Trip], options: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Learn from logs: one row for each log, even if it cannot be read."""
    rows = []
    for name, log in logs:
        try:
            text, messages = learned(_readable(log), truck, **options)
        except (OSError, ValueError) as error:
            rows.append({"log": name, "trips": 0, "learned": None, "messages": str(error)})
            continue
        trips = len(json.loads(text)["trips"])
        said = "; ".join(messages)
        rows.append({"log": name, "trips": trips, "learned": text, "messages": said})
    return rows


def _columns_of(rows: _Rows) -> dict[str, str]:
    return _LEARNED if rows is _taught else _COLUMNS


def _schema(rows: _Rows) -> str:
    return ", ".join(f"{name} {kind}" for name, kind in _columns_of(rows).items())


def _table(rows: _Rows, pickled: bytes, logs: list[_Trip], options: Mapping[str, Any]) -> pa.Table:
    """Return the rows of some logs on a worker."""
    import pyarrow as pa

    kinds = {"string": pa.string(), "double": pa.float64(), "bigint": pa.int64()}
    schema = pa.schema([(name, kinds[kind]) for name, kind in _columns_of(rows).items()])
    return pa.Table.from_pylist(rows(_truck(pickled), logs, options), schema=schema)


def estimate_trips(
    trips: DataFrame,
    *,
    vehicle: _native.Vehicle,
    trip: str = "trip",
    time: str = "time_s",
    **options: Any,
) -> DataFrame:
    """Estimate trips that are stored as rows of one table.

    Parameters
    ----------
    trips : pyspark.sql.DataFrame
        One row for each sample: a column with the name of the trip, and the columns of a log that
        `cgheight.estimate_log` accepts. The order of the rows does not matter.
    vehicle : Vehicle
        The vehicle, with its calibration; it is sent to the workers as text.
    trip, time : str
        The columns with the name of the trip and with the time stamp, by which rows are sorted.
    **options
        Keywords of `cgheight.estimate_log`: ``channel``, ``method``, ``columns``, ….

    Returns
    -------
    pyspark.sql.DataFrame
        One row for each trip, evaluated lazily: the columns of `Estimates.to_frame`, with the name
        of the trip in ``log``. A trip that cannot be estimated has the status "rejected" and the
        reason in ``messages``.

    Raises
    ------
    ValueError
        A column is missing in the table.
    ImportError
        PySpark or PyArrow is not installed.
    """
    return _of_trips(_estimated, trips, vehicle, (trip, time), options)


def learn_trips(
    trips: DataFrame,
    *,
    vehicle: _native.Vehicle,
    trip: str = "trip",
    time: str = "time_s",
    **options: Any,
) -> DataFrame:
    """Learn from trips that are stored as rows of one table.

    Parameters
    ----------
    trips, trip, time
        As for `estimate_trips`; the time should be Unix time.
    vehicle : Vehicle
        The vehicle; it is sent to the workers as text.
    **options
        Keywords of `cgheight.learn_log`: ``columns``, ``flip``.

    Returns
    -------
    pyspark.sql.DataFrame
        One row for each trip, evaluated lazily: its name in ``log``, in ``trips`` how many trips
        with the empty trailer in it count, in ``learned`` the text of `cgheight.learn_log`, and in
        ``messages`` the reason why it cannot be read, or what became of the trips. The texts of one
        truck, of rows with trips, are `from_state` of `cgheight.calibrate`.

    Raises
    ------
    ValueError
        A column is missing in the table.
    ImportError
        PySpark or PyArrow is not installed.
    """
    return _of_trips(_taught, trips, vehicle, (trip, time), options)


def _of_trips(
    rows: _Rows,
    trips: DataFrame,
    vehicle: _native.Vehicle,
    names: tuple[str, str],
    options: Mapping[str, Any],
) -> DataFrame:
    for name in names:
        if name not in trips.columns:
            raise ValueError(f"the table has no column {name}; it has {', '.join(trips.columns)}")
    trip, time = names
    work = _trip_worker(rows, pickle.dumps(vehicle), (trip, time), dict(options))
    # Rows travel many trips at a time. Spark's groups would travel one by one, at half the speed.
    together = trips.repartition(trip).sortWithinPartitions(trip)
    return together.mapInArrow(work, schema=_schema(rows))


def _trip_worker(
    rows: _Rows, pickled: bytes, names: tuple[str, str], options: dict[str, Any]
) -> _Work:
    def work(batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        for logs in _complete_trips(batches, *names):
            yield from _table(rows, pickled, logs, options).to_batches()

    return work


def _complete_trips(
    batches: Iterator[pa.RecordBatch], trip: str, time: str
) -> Iterator[list[_Trip]]:
    """Return the trips that end in each batch, with their columns in the order of time.

    The rows of a trip follow each other, in one batch or several. Rows without a trip may be of
    many, and are none.
    """
    import pyarrow.compute as pc

    def complete_trip() -> _Trip:
        if name is None:
            rows = sum(piece.num_rows for piece in pieces)
            return None, ValueError(
                f"the column {trip} is null in {rows} rows, so nothing says of which trips they are"
            )
        return name, _columns_in_time(pieces, time)

    name: str | None = ""
    pieces: list[pa.RecordBatch] = []
    for batch in batches:
        signals = batch.drop_columns([trip])
        runs = pc.run_end_encode(batch.column(trip))
        complete, start = [], 0
        for value, end in zip(runs.values.to_pylist(), runs.run_ends.to_pylist(), strict=True):
            of_value = None if value is None else str(value)
            if pieces and of_value != name:
                complete.append(complete_trip())
                pieces = []
            name = of_value
            pieces.append(signals.slice(start, end - start))
            start = end
        if complete:
            yield complete
    if pieces:
        yield [complete_trip()]


def _columns_in_time(pieces: list[pa.RecordBatch], time: str) -> dict[str, Any]:
    import numpy as np
    import pyarrow as pa

    rows = pa.Table.from_batches(pieces)
    columns = {}
    for name, kind in zip(rows.column_names, rows.schema.types, strict=True):
        column = rows.column(name)
        if pa.types.is_string(kind):
            # Numbers as text, as of a CSV file without a schema; other text is no signal.
            with suppress(pa.ArrowInvalid):
                column = column.cast(pa.float64())
        if _has_values(column.type) or name in (time, *SIGNALS):
            columns[name] = column.to_numpy()
    when = columns[time]
    if np.all(when[1:] >= when[:-1]):
        return columns
    order = np.argsort(when, kind="stable")
    return {name: values[order] for name, values in columns.items()}


def _has_values(kind: Any) -> bool:
    """Return whether a column may be a signal: numbers, points in time, durations."""
    from pyarrow import types

    tests = (types.is_floating, types.is_integer, types.is_decimal, types.is_timestamp,
             types.is_duration)  # fmt: skip
    return any(test(kind) for test in tests)


def estimate_files(
    files: DataFrame, *, vehicle: _native.Vehicle, path: str = "path", **options: Any
) -> DataFrame:
    """Estimate log files that every worker can open.

    Parameters
    ----------
    files : pyspark.sql.DataFrame
        One row for each file, in at least as many partitions as there are workers.
    vehicle : Vehicle
        The vehicle, with its calibration; it is sent to the workers as text.
    path : str
        The column with the path of the log, in any format that `cgheight.estimate_log` reads.
    **options
        Keywords of `cgheight.estimate_log`.

    Returns
    -------
    pyspark.sql.DataFrame
        One row for each file, evaluated lazily: the columns of `Estimates.to_frame`. A file that
        cannot be read has the status "rejected" and the reason in ``messages``.

    Raises
    ------
    ValueError
        A column is missing in the table.
    ImportError
        PySpark or PyArrow is not installed.
    """
    return _of_files(_estimated, files, vehicle, path, options)


def learn_files(
    files: DataFrame, *, vehicle: _native.Vehicle, path: str = "path", **options: Any
) -> DataFrame:
    """Learn from log files that every worker can open.

    Parameters
    ----------
    files, path
        As for `estimate_files`.
    vehicle : Vehicle
        The vehicle; it is sent to the workers as text.
    **options
        Keywords of `cgheight.learn_log`: ``columns``, ``flip``.

    Returns
    -------
    pyspark.sql.DataFrame
        One row for each file, evaluated lazily: the columns of `learn_trips`.

    Raises
    ------
    ValueError
        A column is missing in the table.
    ImportError
        PySpark or PyArrow is not installed.
    """
    return _of_files(_taught, files, vehicle, path, options)


def _of_files(
    rows: _Rows,
    files: DataFrame,
    vehicle: _native.Vehicle,
    path: str,
    options: Mapping[str, Any],
) -> DataFrame:
    if path not in files.columns:
        raise ValueError(f"the table has no column {path}; it has {', '.join(files.columns)}")
    work = _file_worker(rows, pickle.dumps(vehicle), dict(options))
    return files.select(path).mapInArrow(work, schema=_schema(rows))


def _file_worker(rows: _Rows, pickled: bytes, options: dict[str, Any]) -> _Work:
    def work(batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        for batch in batches:
            for name in batch.column(0).to_pylist():
                yield from _table(rows, pickled, [(name, name)], options).to_batches()

    return work
