"""Vehicle models as frozen dataclasses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cgheight import _show
from cgheight._extras import need
from cgheight._transfer import TransferFunction

_Array = NDArray[np.float64]
_ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class RatioLine:
    """A DC ratio as a function of height: ``(a1 h + a0) / (b1 h + b0)``, h in m.

    Attributes
    ----------
    a0, a1, b0, b1 : float
        The coefficients, scaled so that ``b1 h + b0 = 1`` at the height of the model.
    """

    a0: float
    a1: float
    b0: float
    b1: float

    def ratio_at(self, height_m: float) -> float:
        """Return the ratio at a height.

        Parameters
        ----------
        height_m : float
            Height of the sprung c.g. above ground, m.

        Returns
        -------
        float
            The ratio, in the units of this line.

        Raises
        ------
        ZeroDivisionError
            The denominator is zero at this height.
        """
        return (self.a1 * height_m + self.a0) / (self.b1 * height_m + self.b0)


@dataclass(frozen=True, slots=True, eq=False)
class ReducedModel:
    """The reduced model from steer angle to trailer roll angle.

    Attributes
    ----------
    order : int
        Its order.
    method : {"pade", "slowest-poles"}
        Reduction method: Padé approximant at s = 0, or the slowest poles of the full model.
    numerator, denominator : array, shape (order + 1,)
        Coefficients in descending powers of s; the denominator begins with 1.
    """

    order: int
    method: Literal["pade", "slowest-poles"]
    numerator: _Array
    denominator: _Array

    @property
    def transfer_function(self) -> TransferFunction:
        """The model as poles, zeros and gain."""
        return TransferFunction.from_polynomials(self.numerator, self.denominator)

    def to_control(self) -> Any:
        """Return the model as a `control.TransferFunction`.

        Raises
        ------
        ImportError
            python-control is not installed.
        """
        return self.transfer_function.to_control()


@dataclass(frozen=True, slots=True, eq=False)
class StaticBalance:
    """Static loads.

    Attributes
    ----------
    axle_load_n : array, shape (axles,)
        Vertical load of each axle on the road, tractor first, N.
    hitch_load_n : float
        Vertical load of the trailer on the fifth wheel, N.
    residual_nm : float
        Residual of the moment balance of the trailer, N m; only rounding errors.
    """

    axle_load_n: _Array
    hitch_load_n: float
    residual_nm: float


@dataclass(frozen=True, slots=True, eq=False)
class CompensatedModel:
    """The compensated model of a channel of a calibrated vehicle, with a DC gain of one.

    Attributes
    ----------
    channel : {"steer", "lateral-acceleration", "suspension", "tractor"}
        The channel.
    order : int
        Order of the compensation function; 0 if none makes every calibration run better.
    function : TransferFunction
        The compensation function F(s).
    product : TransferFunction
        The reduced model of the calibrated truck times F(s).
    reduced : TransferFunction
        The product reduced to order 5, which runs on board.
    change : float
        How much F(s) changes the response to a rounded step, rms as a share of the response.
    reduction_error : float
        What the reduction leaves of the response of the product, likewise.
    """

    channel: str
    order: int
    function: TransferFunction
    product: TransferFunction
    reduced: TransferFunction
    change: float
    reduction_error: float


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LinearModel:
    """The linear model from steer angle (rad) to trailer roll angle (rad) at one speed and load.

    Attributes
    ----------
    vehicle : str
        Name of the vehicle.
    speed_mps, height_m, trailer_mass_kg : float
        Forward speed (m/s), height of the trailer's sprung c.g. above ground (m), mass of the whole
        semitrailer (kg).
    numerator, denominator : array, shapes (zeros + 1,), (poles + 1,)
        Coefficients in descending powers of s; the denominator begins with 1.
    poles, zeros : complex array, shapes (n,), (m,)
        Roots of denominator and numerator, rad/s, the largest real part first.
    gain : float
        Leading coefficient of the numerator.
    dc_gain : float
        Value at s = 0, rad/rad.
    ratio, lateral_acceleration_ratio : RatioLine
        DC ratio as a function of height: roll angle per steer angle (rad/rad), and per lateral
        acceleration (rad per m/s²).
    suspension_ratio, tractor_ratio : RatioLine
        The same for the suspension roll per specific force (rad per m/s²) of trailer and tractor.
    reduced : ReducedModel
        The reduced model.
    static_balance : StaticBalance
        Static loads.
    responses : dict of str to TransferFunction
        From the steer angle to lateral velocity (m/s), yaw angle and roll angle (rad) of the
        tractor, yaw and roll angle of the trailer and the roll angle of each axle. A yaw angle has
        a pole at zero: it grows in a steady turn.
    compensated : tuple of CompensatedModel
        For a calibrated vehicle, the model that runs on board for each channel; otherwise empty.
    A, B, C, D : array, shapes (n, n), (n, 1), (1, n), (1, 1)
        State-space form of the same transfer function.
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
    suspension_ratio: RatioLine
    tractor_ratio: RatioLine
    reduced: ReducedModel
    static_balance: StaticBalance
    responses: dict[str, TransferFunction]
    compensated: tuple[CompensatedModel, ...]
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

    def _repr_html_(self) -> str:
        axles = ", ".join(f"{load / 1e3:.1f}" for load in self.static_balance.axle_load_n)
        rows = [
            ("speed", _show.number(self.speed_mps, 2, "m/s")),
            ("trailer mass", _show.number(self.trailer_mass_kg, 0, "kg")),
            ("c.g. height", _show.number(self.height_m, 3, "m")),
            ("DC gain, roll per steer", f"{self.dc_gain:.4f} rad/rad"),
            ("order", str(len(self.poles))),
            ("slowest pole", f"{self.poles[0]:.3f} rad/s"),
            ("axle loads", f"{axles} kN"),
        ]
        return _show.pairs(f"Linear model of {self.vehicle}", rows)

    @property
    def transfer_function(self) -> TransferFunction:
        """Transfer function from steer angle (rad) to trailer roll angle (rad)."""
        return TransferFunction(self.zeros, self.poles, self.gain, None)

    def to_control(self) -> Any:
        """Return the model as a `control.StateSpace` from ``steer_rad`` to ``roll_rad``.

        Raises
        ------
        ImportError
            python-control is not installed.
        """
        names = {"inputs": "steer_rad", "outputs": "roll_rad", "name": self.vehicle}
        return need("control", "control").ss(self.A, self.B, self.C, self.D, **names)
