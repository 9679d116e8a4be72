"""Results as frozen dataclasses."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from numbers import Real
from typing import Any, Literal

from cgheight import _show


def _meters(height_m: float, sd_m: float | None) -> str:
    return f"height {height_m:.2f} m" if sd_m is None else f"height {height_m:.2f} ± {sd_m:.2f} m"


@dataclass(frozen=True, slots=True, repr=False)
class Maneuver:
    """One maneuver of a log: a section with at least one turn.

    Attributes
    ----------
    start_s, end_s : float
        First and last time stamp of the maneuver, as in the log, s.
    height_m, height_sd_m : float or None
        Height and its standard deviation due to noise, m.
    ratio, ratio_sd : float or None
        DC ratio (see `Estimate`) and its standard deviation due to noise.
    snr_db : float or None
        Signal-to-noise ratio, dB.
    status : {"ok", "rejected"}
        Whether there is a height.
    reason : str or None
        The reason if there is no height.
    """

    start_s: float
    end_s: float
    height_m: float | None
    height_sd_m: float | None
    ratio: float | None
    ratio_sd: float | None
    snr_db: float | None
    status: Literal["ok", "rejected"]
    reason: str | None

    def __repr__(self) -> str:
        span = f"{self.start_s:.2f} to {self.end_s:.2f} s"
        if self.height_m is None:
            return f"Maneuver({span}, rejected: {self.reason})"
        return f"Maneuver({span}, {_meters(self.height_m, self.height_sd_m)})"


@dataclass(frozen=True, slots=True)
class ChannelEstimate:
    """The estimate of one channel on its own.

    Attributes
    ----------
    channel : {"steer", "lateral-acceleration", "suspension", "tractor"}
        The input of the channel.
    height_m, height_sd_m : float or None
        Height and its standard deviation, which includes the uncertainty of the vehicle model, m.
    status : {"ok", "rejected"}
        Whether there is a height.
    reason : str or None
        The reason if there is no height.
    """

    channel: Literal["steer", "lateral-acceleration", "suspension", "tractor"]
    height_m: float | None
    height_sd_m: float | None
    status: Literal["ok", "rejected"]
    reason: str | None


@dataclass(frozen=True, slots=True, repr=False)
class Estimate:
    """The result for one log.

    Attributes
    ----------
    status : {"ok", "rejected", "inconsistent"}
        Whether there is a height; if not, the first message gives the reason. "inconsistent":
        channels or sensors contradict each other; `channels` has the estimate of each channel.
    height_m, height_sd_m : float or None
        Height of the trailer's sprung c.g. above ground at rest and its standard deviation, which
        includes the uncertainty of the vehicle model, m.
    height_ci95_m : tuple of two floats, or None
        The 95 % interval of the height, m.
    ratio, ratio_sd : float or None
        DC ratio at `speed_mps`, rad of roll per rad of steer (steer channel) or per m/s²
        (lateral-acceleration channel), and its standard deviation due to noise.
    method : {"filtered", "arx", "gain"}
        The identification method.
    channel : {"steer", "lateral-acceleration", "suspension", "tractor", "combined"} or None
        The input used. "combined" means both inputs; ratio, fit and maneuvers are then those of the
        channel with more information.
    speed_mps : float or None
        Mean speed of the maneuvers, m/s.
    trailer_mass_kg : float
        Mass of the whole semitrailer that was used, kg.
    lift_axle : {"down", "raised"} or None
        Where the lift axles were; None if the trailer has none.
    snr_db, fit_percent : float or None
        Signal-to-noise ratio (dB) and fit (%) of the best maneuver.
    static_rollover_threshold_g : float or None
        Lateral acceleration at which the vehicle rolls over in a steady turn at `speed_mps`, in g.
    static_rollover_threshold_ci95_g : tuple of two floats, or None
        The 95 % interval of this threshold in a turn to one side, in g: the height, the model of
        the threshold, and the place of the load beside the middle are uncertain.
    road_share : float or None
        Share of the variance of the height that the unknown bank of the road makes, from 0 to 1.
    channels : tuple of ChannelEstimate
        The estimate of each channel on its own.
    maneuvers : tuple of Maneuver
        All maneuvers of the channel that was used.
    messages : tuple of str
        Reasons, warnings and remarks for the user.
    """

    status: Literal["ok", "rejected", "inconsistent"]
    height_m: float | None
    height_sd_m: float | None
    height_ci95_m: tuple[float, float] | None
    ratio: float | None
    ratio_sd: float | None
    method: Literal["filtered", "arx", "gain"]
    channel: Literal["steer", "lateral-acceleration", "suspension", "tractor", "combined"] | None
    speed_mps: float | None
    trailer_mass_kg: float
    lift_axle: Literal["down", "raised"] | None
    snr_db: float | None
    fit_percent: float | None
    static_rollover_threshold_g: float | None
    static_rollover_threshold_ci95_g: tuple[float, float] | None
    road_share: float | None
    channels: tuple[ChannelEstimate, ...]
    maneuvers: tuple[Maneuver, ...]
    messages: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain dicts and lists, which `json.dumps` accepts."""
        plain = asdict(self)
        for name in ("height_ci95_m", "static_rollover_threshold_ci95_g"):
            interval = plain[name]
            plain[name] = None if interval is None else list(interval)
        plain["channels"] = list(plain["channels"])
        plain["maneuvers"] = list(plain["maneuvers"])
        plain["messages"] = list(self.messages)
        return plain

    def __repr__(self) -> str:
        if self.height_m is None:
            reason = self.messages[0] if self.messages else "rejected"
            return f"Estimate({reason})"
        count = len(self.maneuvers)
        maneuvers = f"{count} maneuver" + ("" if count == 1 else "s")
        height = _meters(self.height_m, self.height_sd_m)
        return f"Estimate({height}, {self.channel} channel, {maneuvers})"

    def _repr_html_(self) -> str:
        interval = "–"
        if self.height_ci95_m is not None:
            interval = "{:.2f} to {:.2f} m".format(*self.height_ci95_m)
        threshold = _show.number(self.static_rollover_threshold_g, 2, "g")
        summary = _show.pairs(
            "Estimate",
            [
                ("status", self.status),
                ("c.g. height", "–" if self.height_m is None
                 else _meters(self.height_m, self.height_sd_m).removeprefix("height ")),
                ("95 % interval", interval),
                ("rollover threshold", threshold),
                ("channel", self.channel or "–"),
                ("speed", _show.number(self.speed_mps, 1, "m/s")),
                ("trailer mass", _show.number(self.trailer_mass_kg, 0, "kg")),
                *([] if self.lift_axle is None else [("lift axle", self.lift_axle)]),
            ],
        )  # fmt: skip
        header = ["from", "to", "height", "± from noise", "SNR", "status"]
        rows = [
            (
                _show.number(one.start_s, 1, "s"),
                _show.number(one.end_s, 1, "s"),
                _show.number(one.height_m, 3, "m"),
                _show.number(one.height_sd_m, 3, "m"),
                _show.number(one.snr_db, 1, "dB"),
                one.status if one.reason is None else f"{one.status}: {one.reason}",
            )
            for one in self.maneuvers
        ]
        table = _show.grid(header, rows) if rows else ""
        return summary + table + _show.messages(self.messages)


def _mass_kg(given: object, usual_kg: float) -> float:
    """Return a mass that was given, alone or with its standard deviation."""
    mass = given[0] if isinstance(given, tuple) and given else given
    return float(mass) if isinstance(mass, Real) else usual_kg


def rejected(message: str, trailer_mass_kg: float, options: dict[str, Any]) -> Estimate:
    """Return the result for a log that could not be read."""
    method = options.get("method", "filtered")
    absent: dict[str, Any] = dict.fromkeys(field.name for field in fields(Estimate))
    known: dict[str, Any] = {
        "status": "rejected",
        "method": method if isinstance(method, str) else "arx",
        "trailer_mass_kg": _mass_kg(options.get("trailer_mass_kg"), trailer_mass_kg),
        "channels": (),
        "maneuvers": (),
        "messages": (f"rejected: {message}",),
    }
    return Estimate(**(absent | known))
