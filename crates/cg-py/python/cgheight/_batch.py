"""Estimates of many logs."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from glob import glob
from typing import TYPE_CHECKING, Any, Literal, overload

from cgheight import _native, _show
from cgheight._columns import flips, maps
from cgheight._estimate import Estimator, EstimatorOptions, estimate_log
from cgheight._extras import need
from cgheight._results import Estimate, Maneuver, rejected

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True, repr=False)
class Estimates(Sequence[Estimate]):
    """The results for many logs, in the order of the logs.

    Attributes
    ----------
    logs : tuple of str
        Names of the logs: paths, or the keys of a dict; other tables are called
        ``table 0``, ``table 1``, … by their position.
    estimates : tuple of Estimate
        One result for each log.
    """

    logs: tuple[str, ...]
    estimates: tuple[Estimate, ...]

    def __len__(self) -> int:
        return len(self.estimates)

    @overload
    def __getitem__(self, index: int) -> Estimate: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Estimate, ...]: ...
    def __getitem__(self, index: int | slice) -> Estimate | tuple[Estimate, ...]:
        return self.estimates[index]

    def __iter__(self) -> Iterator[Estimate]:
        return iter(self.estimates)

    def to_frame(self) -> pd.DataFrame:
        """Return a pandas DataFrame with one row for each log.

        The columns are the name of the log and the attributes of `Estimate`, with the interval in
        two columns, the number of maneuvers, all messages in one text, and height and standard
        deviation of each channel alone. ``cg estimate --format csv`` has other columns.
        """
        frame = need("pandas", "pandas").DataFrame(self.to_rows(), columns=_column_names())
        return _numbers(frame).astype({"maneuvers": "int64"})

    def to_rows(self) -> list[dict[str, Any]]:
        """Return the rows of `to_frame` as dicts, with None where a number is absent."""
        return [_row(log, one) for log, one in zip(self.logs, self.estimates, strict=True)]

    def maneuvers_frame(self) -> pd.DataFrame:
        """Return a pandas DataFrame with one row for each maneuver: its log and its attributes."""
        names = [field.name for field in fields(Maneuver)]
        rows = [
            {"log": log} | {name: getattr(maneuver, name) for name in names}
            for log, one in zip(self.logs, self.estimates, strict=True)
            for maneuver in one.maneuvers
        ]
        pandas = need("pandas", "pandas")
        return _numbers(pandas.DataFrame(rows, columns=["log", *names]))

    def __repr__(self) -> str:
        good = sum(one.status == "ok" for one in self.estimates)
        return f"Estimates({good} of {len(self)} logs with a height)"

    def _repr_html_(self) -> str:
        header = ["log", "height", "±", "rollover threshold", "channel", "maneuvers", "messages"]
        rows = [
            (
                log,
                _show.number(one.height_m, 3, "m"),
                _show.number(one.height_sd_m, 3, "m"),
                _show.number(one.static_rollover_threshold_g, 2, "g"),
                one.channel or "–",
                str(len(one.maneuvers)),
                "; ".join(one.messages),
            )
            for log, one in zip(self.logs, self.estimates, strict=True)
        ]
        return f"<p>{_show.escape(repr(self))}</p>" + _show.grid(header, rows)


def _row(log: str, one: Estimate) -> dict[str, Any]:
    """Return the row of a log in the frame of all logs."""
    row: dict[str, Any] = {"log": log}
    for field in fields(one):
        value = getattr(one, field.name)
        if field.name == "channels":
            continue
        if "_ci95_" in field.name:
            name, unit = field.name.rsplit("_", 1)
            row[f"{name}_low_{unit}"], row[f"{name}_high_{unit}"] = value or (None, None)
        else:
            row[field.name] = value
    row |= {"maneuvers": len(one.maneuvers), "messages": "; ".join(one.messages)}
    alone = {each.channel: each for each in one.channels}
    for channel in ("steer", "lateral-acceleration", "suspension", "tractor"):
        name = channel.replace("-", "_")
        each = alone.get(channel)
        row[f"{name}_height_m"] = each and each.height_m
        row[f"{name}_height_sd_m"] = each and each.height_sd_m
    return row


def _column_names() -> list[str]:
    return list(_row("", rejected("", 0.0, {})))


def _numbers(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table with NaN where numbers are absent."""
    names = [name for name in table if str(name).endswith(_UNITS) or name == "ratio"]
    return table.astype(dict.fromkeys(names, "float64"))


_UNITS = ("_m", "_s", "_sd", "_mps", "_kg", "_db", "_percent", "_g", "_share")


def check_options(vehicle: _native.Vehicle, options: Mapping[str, Any]) -> None:
    """Refuse options that no log can be estimated with."""
    known = EstimatorOptions.__annotations__
    Estimator(vehicle, **{name: value for name, value in options.items() if name in known})
    maps(options.get("columns"))
    flips(options.get("flip", ()))


def check_work(jobs: int | None, errors: str) -> None:
    """Refuse numbers of threads and words for errors that there are not."""
    if errors not in ("raise", "reject"):
        raise ValueError(f'errors is {errors!r}: it must be "raise" or "reject"')
    if jobs is not None and jobs < 1:
        raise ValueError(f"jobs is {jobs}: it must be 1 or more")


def named_logs(logs: Any) -> tuple[list[str], list[Any]]:
    """Return the names of logs and the logs, with the files that match a pattern in its place."""
    if isinstance(logs, Mapping) and all(_is_log(log) for log in logs.values()):
        return [str(name) for name in logs], list(logs.values())
    one = _is_log(logs) or not isinstance(logs, Iterable)
    found: list[Any] = []
    for log in [logs] if one else logs:
        path = os.fspath(log) if isinstance(log, str | os.PathLike) else ""
        if not set(path) & set("*?[") or os.path.exists(path):
            found.append(log)
            continue
        files = sorted(glob(path, recursive=True))
        if not files:
            raise FileNotFoundError(f"{path}: no file matches this pattern; check the path")
        found.extend(files)
    names = [
        os.fspath(log) if isinstance(log, str | os.PathLike) else f"table {place}"
        for place, log in enumerate(found)
    ]
    return names, found


def _is_log(log: Any) -> bool:
    known = isinstance(log, str | os.PathLike | Mapping)
    return known or hasattr(log, "columns") or hasattr(log, "signals")


def estimate_logs(
    logs: Iterable[str | os.PathLike[str] | Any] | str | os.PathLike[str],
    *,
    vehicle: _native.Vehicle,
    jobs: int | None = None,
    progress: bool = False,
    errors: Literal["raise", "reject"] = "raise",
    calibration: str | os.PathLike[str] | None = None,
    **options: Any,
) -> Estimates:
    """Estimate many logs in parallel threads, which run without the global interpreter lock.

    Parameters
    ----------
    logs : iterable of str, os.PathLike, or data frame; or one of them
        The logs, each in a form that `estimate_log` accepts. A path may be a pattern of files,
        ``"logs/*.csv"``, or ``"logs/**/*.csv"`` for all folders below. A dict gives the logs names.
    vehicle : Vehicle
        The vehicle.
    jobs : int, optional
        Number of threads, 1 or more; the number of processors if absent.
    progress : bool
        Whether to show a progress bar (needs tqdm).
    errors : {"raise", "reject"}
        What to do with a log that cannot be read: raise the error, or continue and return the
        status "rejected" with the error as message.
    calibration : str or os.PathLike, optional
        A calibration file of this vehicle; it is read only once.
    **options
        Further keywords of `estimate_log`.

    Returns
    -------
    Estimates
        The results, in the order of the logs.

    Raises
    ------
    FileNotFoundError, ValueError
        No file matches a pattern; or as for `estimate_log`, if `errors` is "raise"; logs
        that were not started are skipped.
    ImportError
        `progress` is true and tqdm is not installed.

    Examples
    --------
    >>> import cgheight
    >>> truck = cgheight.Vehicle.load("fixtures/vehicles/kraz.toml")
    >>> logs = [f"fixtures/logs/A_p20_h{h}_v50_L.csv" for h in (150, 190, 220)]
    >>> cgheight.estimate_logs(logs, vehicle=truck)
    Estimates(3 of 3 logs with a height)
    """
    check_work(jobs, errors)
    names, known = named_logs(logs)
    truck = vehicle if calibration is None else vehicle.calibrated(calibration)
    check_options(truck, options)
    bar = need("tqdm.auto", "progress").tqdm(total=len(known), unit="log") if progress else None

    def work(name: str, log: Any) -> Estimate:
        try:
            answer = estimate_log(log, vehicle=truck, **options)
        except (OSError, ValueError) as error:
            if errors == "raise":
                if isinstance(log, str | os.PathLike):
                    raise  # the error has the path
                raise ValueError(f"{name}: {error}") from error
            answer = rejected(str(error), truck.reference_trailer_mass_kg, options)
        if bar is not None:
            bar.update()
        return answer

    pool = ThreadPoolExecutor(jobs or os.cpu_count())
    try:
        return Estimates(tuple(names), tuple(pool.map(work, names, known)))
    finally:
        pool.shutdown(cancel_futures=True)
        if bar is not None:
            bar.close()
