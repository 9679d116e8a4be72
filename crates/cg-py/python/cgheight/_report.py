"""The report of many logs: the page of `cg estimate --report`."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Literal

from cgheight import _native
from cgheight._batch import Estimates, check_options, check_work, named_logs
from cgheight._estimate import calibrated, estimate_log, stream_options
from cgheight._logs import signals
from cgheight._results import Estimate, rejected

# A log of the page: its name, its result as JSON, its known height, and its signals or the reason
# why it could not be read.
_Entry = tuple[str, str | None, float | None, str]


def report(
    logs: Iterable[str | os.PathLike[str] | Any] | str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    vehicle: _native.Vehicle,
    true_heights_m: Mapping[str, float] | None = None,
    calibration: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    errors: Literal["raise", "reject"] = "raise",
    force: bool = False,
    **options: Any,
) -> Estimates:
    """Estimate many logs and write the page that ``cg estimate --report`` writes.

    The page is one HTML file that loads nothing from the network: a table of all logs, and for
    each its signals, its maneuvers and its messages. Only the names of options in messages differ
    from those of the command line.

    Parameters
    ----------
    logs : iterable of str, os.PathLike, or data frame; or one of them
        As for `estimate_logs`.
    path : str or os.PathLike
        The page, ``.html``. It appears only when it is complete.
    vehicle : Vehicle
        The vehicle.
    true_heights_m : dict of str to float, optional
        The known height of a log (m) by its name, or by the last component of its path.
    calibration : str or os.PathLike, optional
        A calibration file of this vehicle.
    jobs : int, optional
        Number of threads, 1 or more; the number of processors if absent.
    errors : {"raise", "reject"}
        What to do with a log that cannot be read: raise the error, or list it with the reason.
    force : bool
        Whether `path` may replace a file that is not a report. Logs, the vehicle file and the
        calibration are never replaced.
    **options
        Further keywords of `estimate_log`.

    Returns
    -------
    Estimates
        The results, in the order of the logs.

    Raises
    ------
    FileExistsError
        `path` exists, is not a report, and `force` is false.
    FileNotFoundError, ValueError
        As for `estimate_logs`.
    OSError
        The file cannot be written.
    """
    check_work(jobs, errors)
    names, known = named_logs(logs)
    request: dict[str, Any] = {
        "path": os.fspath(path),
        "logs": [os.fspath(log) for log in known if isinstance(log, str | os.PathLike)],
        "calibration": None if calibration is None else os.fspath(calibration),
        "vehicle": vehicle,
        "force": bool(force),
    }
    _native.may_write_report(request)
    truck = calibrated(vehicle, calibration)
    check_options(truck, options)
    heights_m = true_heights_m or {}
    if heights_m and not {*names, *map(os.path.basename, names)} & heights_m.keys():
        raise ValueError(
            f"true_heights_m: none of its names ({', '.join(list(heights_m)[:3])}, …) is that of a "
            f"log ({', '.join(names[:3])}, …)"
        )

    def work(name: str, log: Any) -> tuple[Estimate, _Entry]:
        try:
            answer, seen = _estimated(log, truck, options, len(known))
        except (OSError, ValueError) as error:
            if errors == "raise":
                raise
            refused = rejected(str(error), truck.reference_trailer_mass_kg, options)
            return refused, (name, None, None, str(error))
        true_m = heights_m.get(name, heights_m.get(os.path.basename(name)))
        text = json.dumps(answer.to_dict(), allow_nan=False)
        return answer, (name, text, None if true_m is None else float(true_m), seen)

    pool = ThreadPoolExecutor(jobs or os.cpu_count())
    try:
        done = list(pool.map(work, names, known))
    finally:
        pool.shutdown(cancel_futures=True)
    # The command line has the logs that could not be read at the end.
    entries = sorted((entry for _, entry in done), key=lambda entry: entry[1] is None)
    named = request["calibration"]
    if named is None and truck.is_calibrated:
        named = "the calibration of this vehicle"
    _native.write_report(request, truck.name, named, entries)
    return Estimates(tuple(names), tuple(answer for answer, _ in done))


def _estimated(
    log: Any, truck: _native.Vehicle, options: Mapping[str, Any], logs: int
) -> tuple[Estimate, str]:
    """Return the result of a log, and its signals as JSON."""
    answer = estimate_log(log, vehicle=truck, **options)
    table = signals(log, options.get("columns"), options.get("flip", ()))
    shared: Any = options
    return answer, _native.trace_arrays(truck, table, stream_options(shared), logs)
