"""Figures of a log and of its estimate over time."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from cgheight import _native
from cgheight._estimate import Estimator, estimate_log
from cgheight._extras import need
from cgheight._logs import signals
from cgheight._predict import predict_roll
from cgheight._results import Estimate
from cgheight.plot._style import BLUE, GREEN, GREY, RED, figure, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_STANDARD_GRAVITY_MPS2 = 9.80665
_QUANTILE_95 = 1.96
Channel = Literal["steer", "lateral-acceleration", "suspension", "tractor"]
_Table = dict[str, NDArray[np.float64]]


def log(
    log: Any,
    *,
    vehicle: _native.Vehicle,
    columns: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
    **options: Any,
) -> Figure:
    """Draw a log: its inputs, its measured and predicted roll angle, and their difference.

    How to read it: the model predicts the roll angle for the estimated height, and the offset of
    the roll sensor is added. In every shaded maneuver, the predicted roll angle should agree with
    the measured one, and the difference below should be noise without the shape of the turns. Green
    maneuvers gave a height, red ones were rejected.

    Parameters
    ----------
    log, columns, flip
        As for `estimate_log`.
    vehicle : Vehicle
        The vehicle.
    **options
        Further keywords of `estimate_log`.

    Returns
    -------
    matplotlib.figure.Figure
        Steer angle (degrees) or lateral acceleration (g), roll angle and difference (degrees),
        over time (s).

    Raises
    ------
    ValueError
        The log is not as described.
    ImportError
        matplotlib is not installed.
    """
    table = signals(log, columns, flip)
    answer = estimate_log(table, vehicle=vehicle, **options)
    time_s = table["time_s"]
    made, (top, middle, bottom) = figure(3, [1.9, 2.9, 1.5])
    with style():
        _inputs(top, table)
        channel = _shown(answer, table)
        roll_rad = _roll(table, vehicle, channel)
        label = "measured"
        if channel != "steer":
            roll_rad = _native.after_lags(time_s, roll_rad)
            label += ", after the channel's lags"
        middle.plot(time_s, np.degrees(roll_rad), color=BLUE, label=label)
        middle.set_ylabel("roll angle\nof the suspension (°)" if channel in _SUSPENSION else
                          "trailer roll\nangle (°)")  # fmt: skip
        if answer.height_m is not None:
            _prediction(middle, bottom, table, (channel, roll_rad), answer, vehicle, options)
        bottom.axhline(0.0, color=GREY, linewidth=0.8)
        bottom.set_ylabel("measured −\npredicted (°)")
        bottom.set_xlabel("time (s)")
        for axes in (top, middle, bottom):
            _shade(axes, answer)
        _label(middle, answer)
        low, high = middle.get_ylim()
        middle.set_ylim(low - 0.22 * (high - low), high)  # room for the legend
        middle.set_xlim(time_s[0], time_s[-1])
        middle.legend(loc="lower left", ncols=2)
        bottom.legend(handles=_keys(answer), loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2,
                      borderaxespad=0.1)  # fmt: skip
        top.set_title(_headline(answer, log))
    return made


def _inputs(axes: Axes, table: _Table) -> None:
    time_s = table["time_s"]
    lateral = table.get("lateral_acceleration_mps2")
    for name, label in (("steer_rad", "steer angle"), ("steering_wheel_rad", "steering wheel")):
        if name in table:
            axes.plot(time_s, np.degrees(table[name]), color=BLUE, label=f"{label} (°)")
            axes.set_ylabel(f"{label} (°)")
            break
    else:
        if lateral is not None:
            axes.plot(time_s, lateral / _STANDARD_GRAVITY_MPS2, color=GREEN)
            axes.set_ylabel("lateral\nacceleration (g)")
        return
    if lateral is not None:
        twin = axes.twinx()
        twin.plot(time_s, lateral / _STANDARD_GRAVITY_MPS2, color=GREEN, linewidth=1.0)
        twin.set_ylabel("lateral\nacceleration (g)", color=GREEN)
        twin.grid(visible=False)
        twin.spines["right"].set_visible(True)
        axes.yaxis.label.set_color(BLUE)


# The column of the roll angle of each channel that is not that of the trailer's body.
_SUSPENSION: dict[Channel, str] = {
    "suspension": "suspension_roll_rad",
    "tractor": "tractor_suspension_roll_rad",
}


def _shown(answer: Estimate, table: _Table) -> Channel:
    """Return the channel that is drawn: one that does not feel the bank, if it gave the height."""
    good = {each.channel for each in answer.channels if each.status == "ok"}
    for channel, column in _SUSPENSION.items():
        if channel in good and column in table and answer.channel in (channel, "combined"):
            return channel
    return "steer" if answer.channel == "steer" else "lateral-acceleration"


def _roll(table: _Table, vehicle: _native.Vehicle, channel: Channel) -> NDArray[np.float64]:
    """Return the measured roll angle, or the one that follows from the inclinometer's tilt."""
    for name in (_SUSPENSION.get(channel), "roll_rad", "roll_to_gravity_rad"):
        if name is not None and name in table:
            return table[name]
    lateral = table.get("lateral_acceleration_mps2")
    if lateral is None:
        speed = table.get("speed_mps", np.full_like(table["time_s"], vehicle.nominal_speed_mps))
        lateral = table.get("yaw_rate_radps", np.zeros_like(speed)) * speed
    return table["tilt_rad"] - lateral / _STANDARD_GRAVITY_MPS2


def _prediction(
    axes: Axes,
    below: Axes,
    table: _Table,
    shown: tuple[Channel, NDArray[np.float64]],
    answer: Estimate,
    vehicle: _native.Vehicle,
    options: Mapping[str, Any],
) -> None:
    assert answer.height_m is not None
    channel, roll_rad = shown
    calibration = options.get("calibration")
    truck = vehicle if calibration is None else vehicle.calibrated(calibration)
    known = {key: options[key] for key in ("speed_mps", "trailer_mass_kg", "model")
             if key in options}  # fmt: skip
    predicted_rad = predict_roll(table, answer.height_m, vehicle=truck, channel=channel, **known)
    offset_rad = float(np.nanmean(roll_rad - predicted_rad))
    label = f"predicted at {answer.height_m:.2f} m, from {channel.replace('-', ' ')}"
    label += f" (sensor offset {np.degrees(offset_rad):+.3f}°)"
    axes.plot(table["time_s"], np.degrees(predicted_rad + offset_rad), color=RED,
              linewidth=1.1, linestyle="--", label=label)  # fmt: skip
    rest = roll_rad - predicted_rad - offset_rad
    below.plot(table["time_s"], np.degrees(rest), color=GREY, linewidth=0.9)


def _shade(axes: Axes, answer: Estimate) -> None:
    for one in answer.maneuvers:
        color = GREEN if one.status == "ok" else RED
        axes.axvspan(one.start_s, one.end_s, color=color, alpha=0.10, linewidth=0)


def _keys(answer: Estimate) -> list[Any]:
    """Return the legend entries of the shades that occur."""
    patch = need("matplotlib.patches", "plot").Patch
    seen = {one.status for one in answer.maneuvers}
    known = (("ok", GREEN, "maneuver with a height"), ("rejected", RED, "rejected maneuver"))
    return [patch(color=color, alpha=0.15, linewidth=0, label=label)
            for status, color, label in known if status in seen]  # fmt: skip


def _label(axes: Axes, answer: Estimate) -> None:
    """Write the height of each maneuver above it if there is enough space."""
    if len(answer.maneuvers) > 12:
        return
    for one in answer.maneuvers:
        text = "rejected" if one.height_m is None else f"{one.height_m:.2f} m"
        axes.annotate(
            text,
            (0.5 * (one.start_s + one.end_s), 1.0),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="bottom",
            fontsize=8,
            color=GREEN if one.height_m is not None else RED,
        )


def _headline(answer: Estimate, log: Any) -> str:
    """Return the answer in a line, below the name of the log if it is a file."""
    name = f"{os.path.basename(log)}\n" if isinstance(log, str | os.PathLike) else ""
    if answer.height_m is None or answer.height_ci95_m is None:
        return name + (answer.messages[0] if answer.messages else "rejected")
    low_m, high_m = answer.height_ci95_m
    text = f"c.g. height {answer.height_m:.2f} m, 95 % interval {low_m:.2f} to {high_m:.2f} m"
    threshold = answer.static_rollover_threshold_g
    return name + (text if threshold is None else f"{text}, rollover at {threshold:.2f} g")


def height(
    log: Any,
    *,
    vehicle: _native.Vehicle,
    true_height_m: float | None = None,
    columns: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
    **options: Any,
) -> Figure:
    """Draw the height over time: the estimate after each turn, and that of each single turn.

    How to read it: the line is the estimate from all turns so far, and the band is its 95 %
    interval. A turn in which the log ends counts from its beginning on, so that a log of one turn
    has a line too. The band becomes narrower with each turn until only the uncertainty of model and
    calibration is left, and it should contain the true height. Points are single maneuvers with the
    95 % interval of their noise alone; they should scatter about the line as much as their bars
    show.

    Parameters
    ----------
    log, columns, flip
        As for `estimate_log`.
    vehicle : Vehicle
        The vehicle.
    true_height_m : float, optional
        Known height, m, which is drawn as a dashed line.
    **options
        Keywords of `Estimator`.

    Returns
    -------
    matplotlib.figure.Figure
        Height of the trailer's sprung c.g. (m) over time (s).

    Raises
    ------
    ValueError
        The log is not as described.
    ImportError
        matplotlib is not installed.
    """
    table = signals(log, columns, flip)
    steps, answer = _history(table, vehicle, options)
    made, (axes,) = figure(1, [3.6])
    with style():
        if steps:
            time_s, height_m, low_m, high_m = np.array(steps).T
            ends_s = np.append(time_s, table["time_s"][-1])
            stairs = [np.append(values, values[-1]) for values in (height_m, low_m, high_m)]
            axes.fill_between(ends_s, stairs[1], stairs[2], step="post", color=BLUE, alpha=0.18,
                              linewidth=0, label="95 % interval")  # fmt: skip
            axes.step(ends_s, stairs[0], where="post", color=BLUE, label="all turns so far")
        good = [one for one in answer.maneuvers if one.height_m is not None]
        if good:
            noise_m = [_QUANTILE_95 * (one.height_sd_m or 0.0) for one in good]
            axes.errorbar(
                [one.end_s for one in good],
                [one.height_m or 0.0 for one in good],
                yerr=noise_m,
                fmt="o",
                markersize=4,
                color=GREY,
                elinewidth=1,
                label="single maneuver (95 % of its noise)",
            )
        if true_height_m is not None:
            axes.axhline(true_height_m, color=RED, linestyle="--",
                         label=f"true height {true_height_m:.2f} m")  # fmt: skip
        first_s, last_s = table["time_s"][0], table["time_s"][-1]
        axes.set_xlim(first_s, last_s + 0.02 * (last_s - first_s))  # room for the last point
        axes.set_xlabel("time (s)")
        axes.set_ylabel("c.g. height (m)")
        axes.set_title(_headline(answer, log))
        axes.legend(loc="best")
    return made


def _history(
    table: _Table, vehicle: _native.Vehicle, options: Mapping[str, Any]
) -> tuple[list[tuple[float, float, float, float]], Estimate]:
    """Return (time, height, low, high) after each turn, and the final estimate."""
    stream = Estimator(vehicle, **options)
    names = list(table)
    steps: list[tuple[float, float, float, float]] = []

    def ask(time_s: float) -> Estimate:
        answer = stream.estimate()
        if answer.height_m is not None and answer.height_ci95_m is not None:
            steps.append((time_s, answer.height_m, *answer.height_ci95_m))
        return answer

    turning = False
    for row in zip(*(table[name].tolist() for name in names), strict=True):
        status = stream.push(**dict(zip(names, row, strict=True)))
        if turning and status == "straight":
            ask(row[names.index("time_s")])
        turning = status == "turning" or (turning and status == "absent")
    answer = ask(float(table["time_s"][-1]))
    if turning and steps and answer.maneuvers:
        # The log ends in this turn: its estimate is drawn over the turn.
        before = steps[-2][0] if len(steps) > 1 else -np.inf
        steps[-1] = (max(answer.maneuvers[-1].start_s, before), *steps[-1][1:])
    return steps, answer
