"""What all models of sampled data have in common: simulation, responses, poles and zeros."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cgheight import _show
from cgheight._arrays import column, number
from cgheight._extras import need
from cgheight._transfer import TransferFunction

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Comparison:
    """Measured output next to that of a model: one step ahead, and free-running.

    Attributes
    ----------
    time_s : array, shape (n,)
        Time since the first row, s.
    measured, one_step, free_run : array, shape (n,)
        The output, its prediction from the row before, and its simulation from the input alone;
        NaN in the first rows, where the model begins.
    one_step_percent, free_run_percent : float
        ``100 (1 - |y - prediction| / |y - mean of y|)``, with root mean squares over the rows that
        are predicted, %. 100 is perfect, and 0 is no better than the mean.
    """

    time_s: Array
    measured: Array
    one_step: Array
    free_run: Array
    one_step_percent: float
    free_run_percent: float

    def __repr__(self) -> str:
        return (
            f"Comparison(one step ahead {self.one_step_percent:.1f} %, "
            f"free run {self.free_run_percent:.1f} %, {len(self.measured)} rows)"
        )

    def _repr_html_(self) -> str:
        rows = [("one step ahead", f"{self.one_step_percent:.1f} %"),
                ("free run", f"{self.free_run_percent:.1f} %"),
                ("rows", str(len(self.measured)))]  # fmt: skip
        return _show.pairs("Fit", rows)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FrequencyResponse:
    """Frequency response with standard deviations from the covariance, to first order.

    Attributes
    ----------
    frequency_radps : array, shape (n,)
        Angular frequencies, rad/s.
    magnitude, magnitude_sd : array, shape (n,)
        In units of output over input.
    phase_rad, phase_sd_rad : array, shape (n,)
        Without jumps, between -π and π at the first frequency, rad.
    """

    frequency_radps: Array
    magnitude: Array
    magnitude_sd: Array
    phase_rad: Array
    phase_sd_rad: Array

    def __repr__(self) -> str:
        omega = self.frequency_radps
        span = f", {omega.min():g} to {omega.max():g} rad/s" if omega.size else ""
        return f"FrequencyResponse({len(omega)} frequencies{span})"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StepResponse:
    """Response to a unit step of the input at the time 0, from rest.

    Attributes
    ----------
    time_s : array, shape (n,)
        Time since the step, s.
    response, response_sd : array, shape (n,)
        Output per unit of input, and its standard deviation from the covariance, to first order.
    """

    time_s: Array
    response: Array
    response_sd: Array

    def __repr__(self) -> str:
        return f"StepResponse({len(self.time_s)} samples, {self.time_s[-1]:g} s)"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SampledModel:
    """A rational model of sampled data, ``B/A``; the attributes are those of its subclasses."""

    a: Array
    b: Array
    na: int
    nb: int
    nk: int
    ts: float
    covariance: Array
    noise_variance: float
    dc_gain: float
    dc_gain_sd: float
    fit_percent: float
    rows: int

    def __repr__(self) -> str:
        orders = f"[{self.na} {self.nb} {self.nk}]"
        gain = f"DC gain {self.dc_gain:.4g} ± {self.dc_gain_sd:.2g}"
        return f"{type(self).__name__}({orders}, {self.ts:g} s, {gain}, {self.rows} rows)"

    @property
    def memory(self) -> int:
        """Number of rows before the first one that can be predicted, ``max(na, nb + nk - 1)``."""
        return max(self.na, self.nb + self.nk - 1)

    @property
    def transfer_function(self) -> TransferFunction:
        """``B/A`` as a discrete transfer function."""
        numerator, denominator = np.zeros(self.memory + 1), np.zeros(self.memory + 1)
        numerator[: len(self.b)], denominator[: len(self.a)] = self.b, self.a
        return TransferFunction.from_polynomials(numerator, denominator, ts=self.ts)

    @property
    def poles(self) -> ComplexArray:
        """Poles in the z plane; those at z = 0 are the delays that the poles do not cover."""
        return self.transfer_function.poles

    @property
    def zeros(self) -> ComplexArray:
        """Zeros in the z plane."""
        return self.transfer_function.zeros

    def simulate(self, u: ArrayLike, *, start: Literal["zero", "steady"] = "zero") -> Array:
        """Return the output for an input alone, without noise.

        Parameters
        ----------
        u : array, shape (n,)
            Input at the model's sampling interval.
        start : {"zero", "steady"}
            What was before the first row: input and output were zero, or the input had its first
            value for so long that the output was steady.

        Returns
        -------
        array, shape (n,)
            The output, in units of y.

        Raises
        ------
        ValueError
            `u` contains NaN or infinity, or the model has no steady state.
        ImportError
            scipy is not installed.
        """
        drive = finite("u", u)
        if start not in ("zero", "steady"):
            raise ValueError(f'start is {start!r}: it must be "zero" or "steady"')
        if start == "zero" or not drive.size:
            return self._filtered(self.b, drive)
        if not np.isfinite(self.dc_gain):
            raise ValueError('the model integrates and has no steady state: give start="zero"')
        steady: Array = self._filtered(self.b, drive - drive[0]) + self.dc_gain * drive[0]
        return steady

    def free_run(
        self, u: ArrayLike, y: ArrayLike, *, start: Literal["measured", "fitted"] = "measured"
    ) -> Array:
        """Return the simulated output next to measured data, which only the start is taken from.

        Parameters
        ----------
        u, y : array, shape (n,)
            Input and output at the model's sampling interval.
        start : {"measured", "fitted"}
            Where the simulation starts: at the measured outputs of the first `memory` rows, or at
            the state for which the whole simulation agrees best with the measured output. The
            former is worse if those rows are noisy.

        Returns
        -------
        array, shape (n,)
            The output, in units of y; NaN in the first `memory` rows.

        Raises
        ------
        ValueError
            The arrays differ in length, are too short or contain NaN.
        ImportError
            scipy is not installed.
        """
        inputs, outputs = self._data(u, y)
        if start not in ("measured", "fitted"):
            raise ValueError(f'start is {start!r}: it must be "measured" or "fitted"')
        drive = np.convolve(inputs, self.b)[self.memory : len(inputs)]
        if start == "measured":
            begin = measured_start(self.a, outputs[: self.memory])[: len(drive)]
            drive[: len(begin)] += begin
            ran = self._filtered([1.0], drive)
        else:
            forced = self._filtered([1.0], drive)
            natural = natural_responses(self.a, len(drive))
            rest = outputs[self.memory :] - forced
            ran = forced + natural @ np.linalg.lstsq(natural, rest, rcond=None)[0]
        return np.concatenate([np.full(self.memory, np.nan), ran])

    def residuals(self, u: ArrayLike, y: ArrayLike) -> Array:
        """Return the measured output minus what the model expects, in units of y.

        An ARX model expects it one step ahead; its residuals are ``A(q) y - B(q) u``. An
        output-error model expects its free run from the best start.

        Parameters
        ----------
        u, y : array, shape (n,)
            Input and output at the model's sampling interval.

        Returns
        -------
        array, shape (n - max(na, nb + nk - 1),)
            One residual for each row after the first `memory` rows.

        Raises
        ------
        ValueError
            The arrays differ in length, contain NaN or are shorter than the model's memory.
        ImportError
            scipy is not installed (output-error models only).
        """
        return self._residuals(*self._data(u, y))

    def _residuals(self, u: Array, y: Array) -> Array:
        raise NotImplementedError

    def _one_step(self, u: Array, y: Array, start: Literal["measured", "fitted"]) -> Array:
        raise NotImplementedError

    def compare(
        self, u: ArrayLike, y: ArrayLike, *, start: Literal["measured", "fitted"] = "measured"
    ) -> Comparison:
        """Compare the model with data, one step ahead and free-running.

        Use data that the model was not fitted to. A model with a good fit one step ahead can fail
        in the free run: at a high sampling rate, the last output alone predicts the next one.

        Parameters
        ----------
        u, y, start
            As for `free_run`.

        Returns
        -------
        Comparison

        Raises
        ------
        ValueError
            The arrays differ in length, are too short or contain NaN, or the output is constant.
        ImportError
            scipy is not installed.
        """
        inputs, outputs = self._data(u, y)
        runs = self._one_step(inputs, outputs, start), self.free_run(inputs, outputs, start=start)
        seen = outputs[self.memory :]
        spread = float(np.linalg.norm(seen - seen.mean()))
        if spread == 0.0:
            raise ValueError("y is constant: there is nothing to compare")
        fits = [100 * (1 - float(np.linalg.norm(seen - run[self.memory :])) / spread)
                for run in runs]  # fmt: skip
        time_s: Array = np.arange(len(outputs), dtype=np.float64) * self.ts
        return Comparison(time_s, outputs, *runs, *fits)

    def response(self, frequency_radps: ArrayLike) -> tuple[ComplexArray, Array]:
        """Return the frequency response and the covariance of its real and imaginary part.

        The covariance follows from that of the coefficients to first order (delta method).

        Parameters
        ----------
        frequency_radps : array, shape (n,)
            Angular frequencies, rad/s, from zero to the Nyquist frequency ``pi / ts``.

        Returns
        -------
        response : complex array, shape (n,)
            In units of y over u.
        covariance : array, shape (n, 2, 2)
            Covariance of real and imaginary part at each frequency.

        Raises
        ------
        ValueError
            A frequency is negative or above the Nyquist frequency.
        """
        omega = column("frequency_radps", frequency_radps)
        if omega.size and (omega.min() < 0 or omega.max() > np.pi / self.ts * (1 + 1e-12)):
            raise ValueError(
                f"frequency_radps must lie between 0 and {np.pi / self.ts:g} (Nyquist)"
            )
        delay = np.exp(-1j * np.outer(omega * self.ts, np.arange(max(len(self.a), len(self.b)))))
        past = delay[:, : len(self.a)] @ self.a
        value = delay[:, : len(self.b)] @ self.b / past
        # dG/da_k = -G q^-k / A,  dG/db_k = q^-k / A
        by_a = -value[:, None] * delay[:, 1 : self.na + 1]
        slope = np.hstack([by_a, delay[:, self.nk : self.nk + self.nb]]) / past[:, None]
        parts = np.stack([slope.real, slope.imag], axis=1)
        return value, parts @ self.covariance @ parts.transpose(0, 2, 1)

    def bode(self, frequency_radps: ArrayLike | None = None) -> FrequencyResponse:
        """Return magnitude and phase over frequency; `plot.bode` draws them.

        Parameters
        ----------
        frequency_radps : array, shape (n,), optional
            As for `response`; if absent, 200 frequencies over three decades up to Nyquist.

        Returns
        -------
        FrequencyResponse

        Raises
        ------
        ValueError
            A frequency is negative or above the Nyquist frequency.
        """
        nyquist = np.pi / self.ts
        if frequency_radps is None:
            omega: Array = np.geomspace(1e-3 * nyquist, nyquist, 200)
        else:
            omega = column("frequency_radps", frequency_radps)
        value, covariance = self.response(omega)
        size = np.abs(value)
        # G = x + iy: |G| changes along (x, y)/|G|, the phase along (-y, x)/|G|².
        along = np.stack([value.real, value.imag], axis=1) / size[:, None]
        across = np.stack([-value.imag, value.real], axis=1) / size[:, None] ** 2
        size_sd, phase_sd = (
            np.sqrt(np.maximum(np.einsum("ni,nij,nj->n", slope, covariance, slope), 0.0))
            for slope in (along, across)
        )
        return FrequencyResponse(omega, size, size_sd, np.unwrap(np.angle(value)), phase_sd)

    def step(self, duration_s: float | None = None) -> StepResponse:
        """Return the response to a unit step of the input.

        Parameters
        ----------
        duration_s : float, optional
            Duration, s. If absent, until the slowest mode has decayed to a thousandth: 20 to 5000
            samples, and 100 if the model is not stable.

        Returns
        -------
        StepResponse

        Raises
        ------
        ValueError
            `duration_s` is not positive.
        ImportError
            scipy is not installed.
        """
        if duration_s is None:
            slowest = float(np.max(np.abs(self.poles), initial=0.0))
            settled = self.memory + (np.log(1e-3) / np.log(slowest) if 0 < slowest < 1 else 0.0)
            count = 100 if slowest >= 1 else int(np.clip(np.ceil(settled), 20, 5000))
        else:
            if not 0 < number("duration_s", duration_s) < np.inf:
                raise ValueError(f"duration_s is {duration_s}: it must be positive and finite")
            count = int(np.floor(duration_s / self.ts * (1 + 1e-12))) + 1
        drive = np.ones(count)
        response = self._filtered(self.b, drive)
        slope = sensitivities(self, drive, response, 0)
        spread = np.sqrt(np.maximum(np.sum((slope @ self.covariance) * slope, axis=1), 0.0))
        time_s: Array = np.arange(count, dtype=np.float64) * self.ts
        return StepResponse(time_s, response, spread)

    def to_control(self) -> Any:
        """Return the model as a discrete `control.TransferFunction`.

        Raises
        ------
        ImportError
            python-control is not installed.
        """
        return self.transfer_function.to_control()

    def _filtered(self, numerator: ArrayLike, values: Array) -> Array:
        return filtered(numerator, self.a, values)

    def _data(self, u: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
        """Return input and output, of the same length and long enough for one row."""
        inputs, outputs = finite("u", u), finite("y", y)
        if len(inputs) != len(outputs):
            raise ValueError(
                f"y has {len(outputs)} values and u has {len(inputs)}: "
                "they must have the same length"
            )
        if len(inputs) <= self.memory:
            least = self.memory + 1
            raise ValueError(f"u has {len(inputs)} values: this model needs {least} or more")
        return inputs, outputs

    def _title(self, kind: str) -> str:
        return f"{kind} [{self.na} {self.nb} {self.nk}]"

    def _table(self, kind: str, fit: str) -> str:
        sd = np.sqrt(np.diag(self.covariance))
        names = [f"a{k}" for k in range(1, self.na + 1)] + [f"b{k}" for k in range(1, self.nb + 1)]
        values = np.concatenate([self.a[1:], self.b[self.nk :]])
        rows = [(n, f"{v:.6g}", f"{s:.2g}") for n, v, s in zip(names, values, sd, strict=True)]
        summary = [
            ("sampling interval", f"{self.ts:g} s"),
            ("DC gain", f"{self.dc_gain:.5g} ± {self.dc_gain_sd:.2g}"),
            (fit, f"{self.fit_percent:.1f} %"),
            ("rows", str(self.rows)),
        ]
        return _show.pairs(self._title(kind), summary) + _show.grid(["", "value", "± 1 sd"], rows)


def finite(name: str, values: ArrayLike) -> Array:
    """Return `values` as an array, or raise a ValueError that gives the first index without one."""
    array = column(name, values)
    absent = np.flatnonzero(~np.isfinite(array))
    if absent.size:
        raise ValueError(f"{name}[{absent[0]}] is {array[absent[0]]}: the model needs every value")
    return array


def filtered(numerator: ArrayLike, denominator: Array, values: Array) -> Array:
    """Return ``numerator/denominator`` applied to values, from rest."""
    result: Array = need("scipy.signal", "identify").lfilter(numerator, denominator, values)
    return result


def measured_start(a: Array, past: Array) -> Array:
    """Return what measured past outputs add to the first ``na`` values of the equation."""
    order = len(a) - 1
    reversed_past = past[::-1][:order]
    return np.array([-(a[j + 1 :] @ reversed_past[: order - j]) for j in range(order)])


def natural_responses(a: Array, rows: int) -> Array:
    """Return the responses ``q^-j/A``, j from 0 to ``na - 1``, shape (rows, na)."""
    first = filtered([1.0], a, np.eye(1, rows)[0])
    return delayed(first, range(len(a) - 1))


def delayed(values: Array, by: range) -> Array:
    """Return the columns ``values(t - k)`` for each k, from zero, shape (n, len(by))."""
    columns = np.zeros((len(values), len(by)))
    for place, k in enumerate(by):
        columns[k:, place] = values[: max(len(values) - k, 0)]
    return columns


def sensitivities(model: Any, drive: Array, output: Array, first: int) -> Array:
    """Return the derivatives of a simulated output by ``a1 … a_na, b1 … b_nb``.

    `output` begins with the row `first` of `drive` and is zero before:
    ``dy/da_k = -q^-k/A y`` and ``dy/db_k = q^-k/A u``.
    """
    by_a = -delayed(filtered([1.0], model.a, output), range(1, model.na + 1))
    columns = delayed(drive, range(model.nk, model.nk + model.nb))[first:]
    if not columns.size:
        return np.hstack([by_a, columns])
    by_b: Array = need("scipy.signal", "identify").lfilter([1.0], model.a, columns, axis=0)
    return np.hstack([by_a, by_b])
