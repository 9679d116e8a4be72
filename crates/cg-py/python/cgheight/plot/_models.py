"""Figures of models: frequency response, poles and zeros, residuals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cgheight._arrays import column
from cgheight._arx_model import ArxModel
from cgheight._model_results import LinearModel, ReducedModel
from cgheight._output_error import OutputErrorModel
from cgheight._sampled import FrequencyResponse, SampledModel
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
    raise ValueError(f"a model of type {kind} has no transfer function: give one of this package")


def _labels(models: Sequence[Any], labels: Sequence[str] | None) -> list[str]:
    if not models:
        raise ValueError("no model to draw: give at least one")
    if labels is not None:
        if len(labels) != len(models):
            raise ValueError(f"{len(labels)} labels for {len(models)} models: give one for each")
        return list(labels)
    return [_name(model) for model in models]


def _name(model: Any) -> str:
    if isinstance(model, SampledModel):
        kind = "ARX" if isinstance(model, ArxModel) else "output error"
        return f"{kind} [{model.na} {model.nb} {model.nk}], identified"
    vehicle = getattr(model, "vehicle", None)
    if vehicle is not None:
        return f"{vehicle}, {model.speed_mps:.1f} m/s, {model.height_m:.2f} m, analytic"
    order = getattr(model, "order", None)
    return type(model).__name__ if order is None else f"reduced, order {order}"


def bode(
    *models: Any,
    labels: Sequence[str] | None = None,
    frequency_hz: ArrayLike | None = None,
    unit: str | None = None,
) -> Figure:
    """Draw frequency responses of identified models, with confidence bands, and analytic models.

    How to read it: where the analytic line is inside the band of an identified model, the data and
    the vehicle file agree. The left end is the DC ratio, from which the height is computed. The
    figure shows nothing about frequencies that the input does not excite. The 95 % band follows
    from the covariance of the coefficients to first order (delta method), for the logarithm of
    the magnitude and for the phase. It includes the variance due to white noise, of the equation
    for an ARX model and of the output for an output-error model. It does not include the bias that
    noise on the output causes in an ARX model; this bias grows with frequency, and `residuals`
    shows it.

    Parameters
    ----------
    *models : ArxModel, OutputErrorModel, LinearModel, ReducedModel, TransferFunction, …
        Models with one input and one output, also python-control objects, all from the same input
        to the same output.
    labels : sequence of str, optional
        A label for each model.
    frequency_hz : array, shape (n,), optional
        Frequencies, Hz; if absent, up to the lowest Nyquist frequency, 5 Hz at most, from 0.02 Hz
        or a hundredth of that.
    unit : str, optional
        Unit of the magnitude, such as ``"rad per m/s²"``. If absent, "rad of roll per rad of steer"
        if a model is one of the vehicle, otherwise "output per input".

    Returns
    -------
    matplotlib.figure.Figure
        Magnitude (units of output over input) and phase (degrees) over frequency (Hz).

    Raises
    ------
    ValueError
        There is no model, or a model has an unknown type.
    ImportError
        matplotlib is not installed.
    """
    names = _labels(models, labels)
    transfers = [_transfer(model) for model in models]
    nyquist_hz = [0.5 / one.ts for one in transfers if one.ts is not None]
    if frequency_hz is None:
        highest = min([5.0, *nyquist_hz])
        hz = np.geomspace(min(0.02, 0.01 * highest), highest, 400)
    else:
        hz = column("frequency_hz", frequency_hz)
    if unit is None:
        ours = any(isinstance(model, LinearModel | ReducedModel) for model in models)
        unit = "rad of roll per rad of steer" if ours else "output per input"
    made, (upper, lower) = figure(2, [3.2, 2.4])
    with style():
        for model, transfer, name, color in zip(models, transfers, names, _colors(), strict=False):
            seen = hz if transfer.ts is None else hz[hz <= 0.5 / transfer.ts]
            identified = isinstance(model, SampledModel)
            line: dict[str, Any] = {"color": color, "linestyle": "-" if identified else "--"}
            omega = 2 * np.pi * seen
            value = model.response(omega)[0] if identified else transfer.response(omega)
            upper.plot(seen, np.abs(value), label=name, **line)
            lower.plot(seen, _phase_deg(value), **line)
            if identified:
                _band(upper, lower, model.bode(omega), color)
        upper.set_xscale("log")
        upper.set_yscale("log")
        upper.set_ylabel(f"magnitude\n({unit})")
        lower.set_ylabel("phase (°)")
        lower.set_xlabel("frequency (Hz)")
        upper.set_title("Frequency response; band: 95 %, delta method on the covariance")
        upper.legend(loc="lower left")
    return made


def _colors() -> list[str]:
    return list(CYCLE) * 4


def _phase_deg(value: NDArray[np.complex128]) -> _Array:
    phase = np.degrees(np.unwrap(np.angle(value)))
    # Shift the phase so that it is between -180 and 180 degrees at the lowest frequency.
    shifted: _Array = phase - 360.0 * np.round(phase[0] / 360.0) if phase.size else phase
    return shifted


def _band(upper: Axes, lower: Axes, seen: FrequencyResponse, color: str) -> None:
    """Shade the 95 % band of the logarithm of the magnitude, and of the phase."""
    hz, size = seen.frequency_radps / (2 * np.pi), seen.magnitude
    # The first order is not valid beyond a factor of ten.
    factor = np.exp(np.minimum(_QUANTILE_95 * seen.magnitude_sd / size, np.log(10.0)))
    shade: dict[str, Any] = {"color": color, "alpha": 0.18, "linewidth": 0}
    upper.fill_between(hz, size / factor, size * factor, **shade)
    phase = np.degrees(seen.phase_rad)
    wide = np.minimum(_QUANTILE_95 * np.degrees(seen.phase_sd_rad), 180.0)
    lower.fill_between(hz, phase - wide, phase + wide, **shade)


def pole_zero(
    *models: Any, labels: Sequence[str] | None = None, reach_radps: float = 15.0
) -> Figure:
    """Draw the poles and zeros of models in the s plane.

    How to read it: the poles (crosses) of an identified model should agree with the slow poles of
    the analytic model, which are near the origin. Gray rays are lines of equal damping ratio, and
    the distance from the origin is the natural frequency. Poles to the right of the imaginary axis
    are unstable. Zeros (circles) to the right of it make the response start in the wrong direction.
    Discrete models are converted with ``s = ln(z)/ts``, which is exact for poles. Zeros that
    sampling adds have no meaning in continuous time, and zeros at z = 0 are not drawn.

    Parameters
    ----------
    *models, labels
        As for `bode`.
    reach_radps : float
        Range of the figure from the origin, rad/s, above zero; the yaw and roll modes of a truck
        are within 15 rad/s. The title gives the number of roots outside the range.

    Returns
    -------
    matplotlib.figure.Figure
        Imaginary part over real part (rad/s).

    Raises
    ------
    ValueError
        There is no model, a model has an unknown type, or `reach_radps` is not positive.
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


def residuals(
    model: ArxModel | OutputErrorModel, u: ArrayLike, y: ArrayLike, *, lags: int = 25
) -> Figure:
    """Draw the correlations of the residuals of a model, which show what it does not explain.

    How to read it: the upper panel is the autocorrelation of the residuals. Bars outside the 99 %
    band at lags other than 0 show that the noise is not white, so that the stated standard
    deviations are too small. The lower panel is the correlation with the input. Bars outside the
    band at positive lags show that the model lacks dynamics (use higher orders); at negative lags
    they show feedback from the output to the input.

    Parameters
    ----------
    model : ArxModel or OutputErrorModel
        The model.
    u, y : array, shape (n,)
        Input and output, preferably from a log that the model was not fitted to.
    lags : int
        Largest lag in samples, at least 1 and less than the number of residuals.

    Returns
    -------
    matplotlib.figure.Figure
        Correlation coefficients (without unit) over lag (samples).

    Raises
    ------
    ValueError
        The arrays differ in length, or `lags` is out of range.
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
