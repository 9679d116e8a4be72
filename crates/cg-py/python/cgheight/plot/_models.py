"""Models: frequency response, roots, residuals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cgheight._arrays import column
from cgheight._model_results import ArxModel
from cgheight._transfer import TransferFunction
from cgheight.plot._style import BLUE, CYCLE, GREY, RED, figure, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_QUANTILE_95 = 1.96
_QUANTILE_99 = 2.576
_Array = NDArray[np.float64]


def _transfer(model: Any) -> TransferFunction:
    if isinstance(model, TransferFunction):
        return model
    own = getattr(model, "transfer_function", None)
    if isinstance(own, TransferFunction):
        return own
    if hasattr(model, "ninputs") and hasattr(model, "poles"):
        return TransferFunction.from_control(model)
    kind = type(model).__name__
    raise ValueError(f"a model of type {kind} has no transfer function: give one of this package's")


def _labels(models: Sequence[Any], labels: Sequence[str] | None) -> list[str]:
    if not models:
        raise ValueError("no model to draw: give one or more")
    if labels is not None:
        if len(labels) != len(models):
            raise ValueError(f"{len(labels)} labels for {len(models)} models: give one for each")
        return list(labels)
    return [_name(model) for model in models]


def _name(model: Any) -> str:
    if isinstance(model, ArxModel):
        return f"ARX [{model.na} {model.nb} {model.nk}], identified"
    vehicle = getattr(model, "vehicle", None)
    if vehicle is not None:
        return f"{vehicle}, {model.speed_mps:.1f} m/s, {model.height_m:.2f} m, analytic"
    order = getattr(model, "order", None)
    return type(model).__name__ if order is None else f"reduced, order {order}"


def bode(
    *models: Any, labels: Sequence[str] | None = None, frequency_hz: ArrayLike | None = None
) -> Figure:
    """Draw frequency responses: identified models with their confidence band beside analytic ones.

    How to read it: where the analytic line lies inside an identified model's band, data and vehicle
    file agree; the left end is the DC ratio that the height is solved from. Beyond the frequencies
    that the steering excites, nothing can be said. The band is 95 %, from the covariance of the ARX
    coefficients to first order (delta method) in the logarithm of the magnitude and in the phase:
    it knows the variance of white equation noise, not the bias that noise on the roll angle itself
    gives a classical ARX, which grows with frequency and as `residuals` shows it.

    Parameters
    ----------
    *models : ArxModel, LinearModel, ReducedModel, TransferFunction, or python-control objects
        With one input and one output, from steer angle (or lateral acceleration) to roll.
    labels : sequence of str, optional
        A name for each.
    frequency_hz : array, shape (n,), optional
        Frequencies, Hz; from 0.02 Hz to the lowest Nyquist frequency, 5 Hz at most, if absent.

    Returns
    -------
    matplotlib.figure.Figure
        Magnitude (units of output over input) and phase (degrees) over frequency (Hz).

    Raises
    ------
    ValueError
        There is no model, or one is of no known kind.
    ImportError
        matplotlib is not installed.
    """
    names = _labels(models, labels)
    transfers = [_transfer(model) for model in models]
    if frequency_hz is None:
        nyquist_hz = [0.5 / one.ts for one in transfers if one.ts is not None]
        hz = np.geomspace(0.02, min([5.0, *nyquist_hz]), 400)
    else:
        hz = column("frequency_hz", frequency_hz)
    made, (upper, lower) = figure(2, [3.2, 2.4])
    with style():
        for model, transfer, name, color in zip(
            models, transfers, names, _colors(), strict=False
        ):
            seen = hz if transfer.ts is None else hz[hz <= 0.5 / transfer.ts]
            line: dict[str, Any] = {
                "color": color,
                "linestyle": "-" if isinstance(model, ArxModel) else "--",
            }
            if isinstance(model, ArxModel):
                value, covariance = model.response(2 * np.pi * seen)
                _band(upper, lower, seen, value, covariance, color)
            else:
                value = transfer.response(2 * np.pi * seen)
            upper.plot(seen, np.abs(value), label=name, **line)
            lower.plot(seen, _phase_deg(value), **line)
        upper.set_xscale("log")
        upper.set_yscale("log")
        upper.set_ylabel("magnitude\n(roll over input, rad/rad)")
        lower.set_ylabel("phase (°)")
        lower.set_xlabel("frequency (Hz)")
        upper.set_title("Frequency response; band: 95 %, delta method on the ARX covariance")
        upper.legend(loc="lower left")
    return made


def _colors() -> list[str]:
    return list(CYCLE) * 4


def _phase_deg(value: NDArray[np.complex128]) -> _Array:
    phase = np.degrees(np.unwrap(np.angle(value)))
    # Unwrapping starts anywhere: the lowest frequency belongs between -180 and 180 degrees.
    shifted: _Array = phase - 360.0 * np.round(phase[0] / 360.0) if phase.size else phase
    return shifted


def _band(
    upper: Axes,
    lower: Axes,
    hz: _Array,
    value: NDArray[np.complex128],
    covariance: _Array,
    color: str,
) -> None:
    """Shade the 95 % band: G = x + iy, ln|G| along (x, y)/|G|², phase along (-y, x)/|G|²."""
    square = np.abs(value) ** 2
    along = np.stack([value.real, value.imag], axis=1) / square[:, None]
    across = np.stack([-value.imag, value.real], axis=1) / square[:, None]
    log_sd, phase_sd = (
        np.sqrt(np.maximum(np.einsum("ni,nij,nj->n", slope, covariance, slope), 0.0))
        for slope in (along, across)
    )
    # Beyond a factor of ten the first order says nothing more.
    factor = np.exp(np.minimum(_QUANTILE_95 * log_sd, np.log(10.0)))
    size, phase = np.abs(value), _phase_deg(value)
    shade: dict[str, Any] = {"color": color, "alpha": 0.18, "linewidth": 0}
    upper.fill_between(hz, size / factor, size * factor, **shade)
    wide = np.minimum(_QUANTILE_95 * np.degrees(phase_sd), 180.0)
    lower.fill_between(hz, phase - wide, phase + wide, **shade)


def pole_zero(
    *models: Any, labels: Sequence[str] | None = None, reach_radps: float = 15.0
) -> Figure:
    """Draw poles and zeros in the s plane.

    How to read it: poles (crosses) of an identified model should fall on the analytic ones that
    move slowly (near the origin); grey rays are lines of equal damping ratio, distance from the
    origin is the natural frequency. Roots to the right of the axis are unstable (poles) or make
    the response start the wrong way (zeros, circles). Discrete models are carried over by
    ``s = ln(z)/ts``, exact for poles; zeros that sampling adds mean nothing in time, and those at
    z = 0 are left out.

    Parameters
    ----------
    *models, labels
        As for `bode`.
    reach_radps : float
        How far from the origin the picture reaches, rad/s, above zero; a truck's yaw and roll modes
        lie within 15. Roots beyond are counted in the title.

    Returns
    -------
    matplotlib.figure.Figure
        Imaginary over real part (rad/s).

    Raises
    ------
    ValueError
        There is no model, one is of no known kind, or `reach_radps` is not positive.
    ImportError
        matplotlib is not installed.
    """
    names = _labels(models, labels)
    if not 0 < reach_radps < np.inf:
        raise ValueError(f"reach_radps is {reach_radps}: it must be positive and finite")
    made, (axes,) = figure(1, [5.6], width=7.5)
    with style():
        beyond = 0
        for model, name, color in zip(models, names, _colors(), strict=False):
            transfer = _transfer(model)
            poles, zeros = (
                _continuous(transfer.poles, transfer),
                _continuous(transfer.zeros, transfer),
            )
            crosses: dict[str, Any] = {"marker": "x", "s": 55, "color": color}
            circles: dict[str, Any] = {
                "marker": "o",
                "s": 42,
                "facecolors": "none",
                "edgecolors": color,
            }
            for roots, what, mark in ((poles, "poles", crosses), (zeros, "zeros", circles)):
                axes.scatter(roots.real, roots.imag, label=f"{name}: {what}", zorder=3, **mark)
            beyond += int(np.sum(np.abs(np.concatenate([poles, zeros])) > reach_radps))
        axes.set_xlim(-reach_radps, 0.45 * reach_radps)
        axes.set_ylim(-reach_radps, reach_radps)
        _damping(axes, reach_radps)
        axes.axvline(0.0, color=GREY, linewidth=0.9)
        axes.axhline(0.0, color=GREY, linewidth=0.9)
        axes.set_xlabel("real part (rad/s)")
        axes.set_ylabel("imaginary part (rad/s)")
        more = f"; {beyond} more beyond {reach_radps:g} rad/s" if beyond else ""
        axes.set_title(f"Poles (×) and zeros (○){more}")
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
    return made


def _continuous(
    roots: NDArray[np.complex128], transfer: TransferFunction
) -> NDArray[np.complex128]:
    if transfer.ts is None:
        return roots
    inside = roots[np.abs(roots) > 0]
    carried: NDArray[np.complex128] = np.log(inside.astype(complex)) / transfer.ts
    return carried


def _damping(axes: Axes, reach: float) -> None:
    """Draw rays of equal damping ratio and circles of equal natural frequency."""
    for ratio in (0.1, 0.3, 0.5, 0.7, 0.9):
        x, y = -ratio * reach, reach * np.sqrt(1 - ratio**2)
        for sign in (1, -1):
            axes.plot([0, x], [0, sign * y], color="#CCCCCC", linewidth=0.7, zorder=1)
        axes.annotate(f"{ratio}", (0.97 * x, 0.97 * y), fontsize=7, color=GREY, ha="right")
    angle = np.linspace(np.pi / 2, 3 * np.pi / 2, 91)
    for share in (1 / 3, 2 / 3, 1.0):
        axes.plot(share * reach * np.cos(angle), share * reach * np.sin(angle),
                  color="#CCCCCC", linewidth=0.7, zorder=1)  # fmt: skip


def residuals(model: ArxModel, u: ArrayLike, y: ArrayLike, *, lags: int = 25) -> Figure:
    """Draw whether a model leaves anything unsaid: correlations of its residuals.

    How to read it: above, the residuals with themselves; bars beyond the 99 % band at lags other
    than 0 say that the noise is not white, so that the stated standard deviations are too small.
    Below, with the input: bars beyond the band at positive lags say that the model misses
    dynamics (raise the orders), at negative lags that the output acts back on the input.

    Parameters
    ----------
    model : ArxModel
        The model.
    u, y : array, shape (n,)
        Input and output; better of a log that it was not fitted to.
    lags : int
        Greatest lag, samples, 1 or more and below the number of residuals.

    Returns
    -------
    matplotlib.figure.Figure
        Correlation coefficients (no unit) over lag (samples).

    Raises
    ------
    ValueError
        The arrays do not fit together, or `lags` is out of range.
    ImportError
        matplotlib is not installed.
    """
    rest = model.residuals(u, y)
    if not 1 <= lags < len(rest):
        raise ValueError(f"lags is {lags}: it must be from 1 to {len(rest) - 1}")
    drive = column("u", u)[-len(rest) :]
    own, both = _correlation(rest, rest, lags), _correlation(rest, drive, lags)
    n = len(rest)
    # Ljung, System Identification, 16.6: variance of a cross-correlation of independent signals.
    around_e, around_u = own, _correlation(drive, drive, lags)
    spread = np.sqrt(max(float(np.sum(around_e * around_u)), 1.0) / n)
    made, (upper, lower) = figure(2, [2.5, 2.5], sharex=False)
    with style():
        upper.axhspan(-_QUANTILE_99 / np.sqrt(n), _QUANTILE_99 / np.sqrt(n), color=BLUE, alpha=0.12,
                      linewidth=0, label="99 % band of white noise")  # fmt: skip
        at = np.arange(lags + 1)
        upper.vlines(at, 0, own[lags:], color=BLUE, linewidth=2)
        upper.set_ylabel("residuals with\nthemselves")
        lower.axhspan(-_QUANTILE_99 * spread, _QUANTILE_99 * spread, color=RED, alpha=0.12,
                      linewidth=0, label="99 % band of independence")  # fmt: skip
        lower.vlines(np.arange(-lags, lags + 1), 0, both, color=RED, linewidth=2)
        lower.set_ylabel("residuals with\nthe input")
        lower.set_xlabel(f"lag (samples of {model.ts:g} s)")
        beyond = int(np.sum(np.abs(own[lags + 1 :]) > _QUANTILE_99 / np.sqrt(n)))
        astray = int(np.sum(np.abs(both) > _QUANTILE_99 * spread))
        upper.set_title(f"{_name(model)}: {beyond} of {lags} lags outside the 99 % band")
        lower.set_title(f"with the input: {astray} of {2 * lags + 1} outside")
        for axes in (upper, lower):
            axes.axhline(0.0, color=GREY, linewidth=0.8)
            axes.legend(loc="upper right")
    return made


def _correlation(a: _Array, b: _Array, lags: int) -> _Array:
    """Return the correlation coefficient of a(t) with b(t - k), k from -lags to lags."""
    a, b = a - a.mean(), b - b.mean()
    size = np.sqrt(np.sum(a**2) * np.sum(b**2))
    if size == 0.0:
        return np.zeros(2 * lags + 1)
    n = len(a)
    values = [
        np.sum(a[max(k, 0) : n + min(k, 0)] * b[max(-k, 0) : n - max(k, 0)])
        for k in range(-lags, lags + 1)
    ]
    coefficients: _Array = np.array(values) / size
    return coefficients
