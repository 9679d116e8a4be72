"""What comes out: answers and models as frozen dataclasses."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]
_ComplexArray = NDArray[np.complex128]


def _metres(height_m: float, sd_m: float | None) -> str:
    return f"height {height_m:.2f} m" if sd_m is None else f"height {height_m:.2f} ± {sd_m:.2f} m"


@dataclass(frozen=True, slots=True, repr=False)
class Maneuver:
    """One maneuver of a log: a stretch with at least one turn.

    Attributes
    ----------
    start_s, end_s : float
        First and last time stamp used, as in the log, s.
    height_m, height_sd_m : float or None
        Height and its standard deviation from noise, m.
    ratio, ratio_sd : float or None
        DC ratio (see `Estimate`) and its standard deviation from noise.
    snr_db : float or None
        Signal to noise, dB.
    status : {"ok", "rejected"}
        Whether there is a height.
    reason : str or None
        Why there is none.
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
        return f"Maneuver({span}, {_metres(self.height_m, self.height_sd_m)})"


@dataclass(frozen=True, slots=True, repr=False)
class Estimate:
    """The answer for one log.

    Attributes
    ----------
    status : {"ok", "rejected"}
        Whether there is a height; if not, the first of the messages says why.
    height_m, height_sd_m : float or None
        Height of the trailer's sprung c.g. above ground at rest and its standard deviation,
        uncertainty of the vehicle model included, m.
    height_ci95_m : tuple of two floats, or None
        The 95 % interval of the height, m.
    ratio, ratio_sd : float or None
        DC ratio at `speed_mps`, rad of roll per rad of steer (steer channel) or per m/s²
        (lateral-acceleration channel), and its standard deviation from noise.
    method : {"filtered", "arx", "gain"}
        Identification used.
    channel : {"steer", "lateral-acceleration"} or None
        Input used.
    speed_mps : float or None
        Mean speed of the maneuvers, m/s.
    trailer_mass_kg : float
        Mass of the whole semitrailer taken, kg.
    snr_db, fit_percent : float or None
        Signal to noise (dB) and fit (%) of the best maneuver.
    static_rollover_threshold_g : float or None
        Lateral acceleration of wheel lift in a steady turn, in g.
    maneuvers : tuple of Maneuver
        Every maneuver, in the channel used.
    messages : tuple of str
        What a reader should know.
    """

    status: Literal["ok", "rejected"]
    height_m: float | None
    height_sd_m: float | None
    height_ci95_m: tuple[float, float] | None
    ratio: float | None
    ratio_sd: float | None
    method: Literal["filtered", "arx", "gain"]
    channel: Literal["steer", "lateral-acceleration"] | None
    speed_mps: float | None
    trailer_mass_kg: float
    snr_db: float | None
    fit_percent: float | None
    static_rollover_threshold_g: float | None
    maneuvers: tuple[Maneuver, ...]
    messages: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the answer as plain dicts and lists, ready for `json.dumps`."""
        plain = asdict(self)
        interval = self.height_ci95_m
        plain["height_ci95_m"] = None if interval is None else list(interval)
        plain["maneuvers"] = list(plain["maneuvers"])
        plain["messages"] = list(self.messages)
        return plain

    def __repr__(self) -> str:
        if self.height_m is None:
            reason = self.messages[0] if self.messages else "rejected"
            return f"Estimate({reason})"
        count = len(self.maneuvers)
        maneuvers = f"{count} maneuver" + ("" if count == 1 else "s")
        height = _metres(self.height_m, self.height_sd_m)
        return f"Estimate({height}, {self.channel} channel, {maneuvers})"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ArxModel:
    """A fitted ARX model ``A(q) y(t) = B(q) u(t) + e(t)`` in powers of the delay q⁻¹.

    Attributes
    ----------
    a : array, shape (na + 1,)
        ``1, a1 … a_na``: coefficients of y(t), y(t-1) …
    b : array, shape (nk + nb,)
        ``nk`` zeros, then ``b1 … b_nb``: coefficients of u(t), u(t-1) … (MATLAB's B).
    na, nb, nk : int
        Past outputs, input terms, samples until the input first acts.
    ts : float
        Sampling interval, s.
    covariance : array, shape (na + nb, na + nb)
        Covariance of ``a1 … a_na, b1 … b_nb``, in that order.
    noise_variance : float
        Sum of squared residuals over rows less coefficients, in units of y squared.
    dc_gain, dc_gain_sd : float
        ``B(1)/A(1)`` and its standard deviation (to first order), units of y over u.
    fit_percent : float
        ``100 (1 - sqrt(noise_variance / variance of y))``, one step ahead.
    rows : int
        Rows of the regression.
    """

    a: _Array
    b: _Array
    na: int
    nb: int
    nk: int
    ts: float
    covariance: _Array
    noise_variance: float
    dc_gain: float
    dc_gain_sd: float
    fit_percent: float
    rows: int

    def __repr__(self) -> str:
        orders = f"[{self.na} {self.nb} {self.nk}]"
        gain = f"DC gain {self.dc_gain:.4g} ± {self.dc_gain_sd:.2g}"
        return f"ArxModel({orders}, {self.ts:g} s, {gain}, {self.rows} rows)"


@dataclass(frozen=True, slots=True)
class RatioLine:
    """A DC ratio over height: ``(a1 h + a0) / (b1 h + b0)``, h in m.

    Attributes
    ----------
    a0, a1, b0, b1 : float
        The coefficients, scaled to ``b1 h + b0 = 1`` at the height of the model.
    """

    a0: float
    a1: float
    b0: float
    b1: float

    def ratio_at(self, height_m: float) -> float:
        """Return the ratio at a height of the sprung c.g. above ground, m."""
        return (self.a1 * height_m + self.a0) / (self.b1 * height_m + self.b0)


@dataclass(frozen=True, slots=True, eq=False)
class ReducedModel:
    """The reduced model from steer angle to trailer roll angle.

    Attributes
    ----------
    order : int
        Its order.
    method : {"pade", "slowest-poles"}
        How it came about: Padé approximant at s = 0, or the slowest poles of the full model.
    numerator, denominator : array, shape (order + 1,)
        Coefficients in descending powers of s; the denominator begins with one.
    """

    order: int
    method: Literal["pade", "slowest-poles"]
    numerator: _Array
    denominator: _Array


@dataclass(frozen=True, slots=True, eq=False)
class StaticBalance:
    """Static loads.

    Attributes
    ----------
    axle_load_n : array
        Vertical load of each axle on the road, tractor first, N.
    hitch_load_n : float
        Vertical load of the trailer on the fifth wheel, N.
    residual_nm : float
        What is left over in the trailer's balance of moments: rounding only, N m.
    """

    axle_load_n: _Array
    hitch_load_n: float
    residual_nm: float


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LinearModel:
    """The linear model at one speed and load, steer angle (rad) to trailer roll angle (rad).

    Attributes
    ----------
    vehicle : str
        Name of the vehicle.
    speed_mps, height_m, trailer_mass_kg : float
        Forward speed, height of the trailer's sprung c.g., mass of the whole semitrailer.
    numerator, denominator : array
        Coefficients in descending powers of s; the denominator begins with one.
    poles, zeros : complex array
        Roots of denominator and numerator, rad/s, the largest real part first.
    gain : float
        Leading coefficient of the numerator.
    dc_gain : float
        Value at s = 0, rad/rad.
    ratio, lateral_acceleration_ratio : RatioLine
        DC ratio over height, roll per steer angle (rad/rad) and per lateral acceleration
        (rad per m/s²).
    reduced : ReducedModel
        The reduced model.
    static_balance : StaticBalance
        Static loads.
    A, B, C, D : array, shapes (n, n), (n, 1), (1, n), (1, 1)
        State space of the same transfer function.
    """

    vehicle: str
    speed_mps: float
    height_m: float
    trailer_mass_kg: float
    numerator: _Array
    denominator: _Array
    poles: _ComplexArray
    zeros: _ComplexArray
    gain: float
    dc_gain: float
    ratio: RatioLine
    lateral_acceleration_ratio: RatioLine
    reduced: ReducedModel
    static_balance: StaticBalance
    A: _Array
    B: _Array
    C: _Array
    D: _Array

    def __repr__(self) -> str:
        load = f"{self.trailer_mass_kg:.0f} kg at {self.height_m:.3f} m"
        return (
            f"LinearModel({self.vehicle!r}, {self.speed_mps:.2f} m/s, trailer {load}, "
            f"order {len(self.poles)}, DC gain {self.dc_gain:.4f})"
        )
