"""Output-error models: the refinement of an ARX model by the error of its free run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from cgheight._arx_model import ArxModel
from cgheight._extras import need
from cgheight._models import arx, experiments
from cgheight._sampled import (
    Array,
    SampledModel,
    filtered,
    measured_start,
    natural_responses,
    sensitivities,
)

# Steps of a search; a few dozen are usual.
_MOST_STEPS = 200
# Iterations of Steiglitz and McBride.
_ITERATIONS = 10
_EPSILON = np.finfo(float).eps


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class OutputErrorModel(SampledModel):
    """An output-error model ``y(t) = B(q)/A(q) u(t) + e(t)`` in powers of the delay q⁻¹.

    The noise e is on the output and is not fed back, so that the best prediction of any number of
    steps is the free run.

    Attributes
    ----------
    a : array, shape (na + 1,)
        ``1, a1 … a_na``: the denominator (MATLAB's F).
    b : array, shape (nk + nb,)
        ``nk`` zeros, then ``b1 … b_nb``: the numerator.
    na, nb, nk : int
        The orders, as of `ArxModel`.
    ts : float
        Sampling interval, s.
    covariance : array, shape (na + nb, na + nb)
        Covariance of ``a1 … a_na, b1 … b_nb`` for white noise.
    noise_variance : float
        Sum of squared errors divided by (rows - parameters), in units of y squared. The parameters
        are the coefficients, and ``na`` values of the state in which each experiment begins.
    dc_gain, dc_gain_sd : float
        ``B(1)/A(1)`` and its standard deviation (first order), in units of y over u.
    fit_percent : float
        ``100 (1 - sqrt(noise_variance / variance of y))`` of the free run, %.
    rows : int
        Number of rows that were compared.
    """

    def _repr_html_(self) -> str:
        return self._table("Output error", "fit, free run")

    def _residuals(self, u: Array, y: Array) -> Array:
        rest: Array = (y - self.free_run(u, y, start="fitted"))[self.memory :]
        return rest

    def _one_step(self, u: Array, y: Array, start: Literal["measured", "fitted"]) -> Array:
        return self.free_run(u, y, start=start)


def output_error(u: ArrayLike, y: ArrayLike, model: ArxModel) -> OutputErrorModel:
    """Refine an ARX model: minimize the error of its free run instead of that of one step.

    An ARX model takes all noise for noise of its equation. Noise of the sensor makes its
    coefficients wrong, however long the log is; the refined coefficients are right. The state in
    which each experiment begins is fitted too. The method is that of trust regions
    (`scipy.optimize.least_squares`) with exact derivatives, among stable models only. It begins
    from the ARX model, with unstable poles reflected into the unit circle, or from what the
    iteration of Steiglitz and McBride makes of it, whichever is better. If the noise is nearly as
    large as the signal, the search can end in a local minimum: compare the model with other data.

    Parameters
    ----------
    u, y : array, shape (n,), or list of arrays
        Input and output, preferably those of the ARX model; a list has one array for each
        experiment. Offsets are not removed (see `detrend`).
    model : ArxModel
        The model to begin from, which also gives orders and sampling interval.

    Returns
    -------
    OutputErrorModel

    Raises
    ------
    TypeError
        `model` is not a model of this package.
    ValueError
        The arrays differ in length, are too short or contain NaN, the data do not determine the
        coefficients, or the search does not end.
    ImportError
        scipy is not installed.
    """
    if not isinstance(model, SampledModel):
        kind = type(model).__name__
        raise TypeError(f"model is of type {kind}: give an ArxModel, from arx or select_order")
    data = [model._data(*one) for one in zip(*experiments(u, y), strict=True)]
    count = model.na + model.nb
    rows = sum(len(output) - model.memory for _, output in data)
    unknowns = count + model.na * len(data)
    if rows <= unknowns:
        raise ValueError(f"unexcited: {rows} rows for {unknowns} parameters; give a longer log")
    search = _Search(model, data)
    found = search.best()
    variance = 2 * float(found.cost) / (rows - unknowns)
    covariance = variance * _inverse(found.jac)[:count, :count]
    a, b = search.polynomials(found.x)
    gain = float(np.sum(b) / np.sum(a))
    by_gain: Array = np.concatenate([np.full(model.na, -gain), np.ones(model.nb)]) / np.sum(a)
    seen = np.concatenate([output[model.memory :] for _, output in data])
    return OutputErrorModel(
        a=a,
        b=b,
        na=model.na,
        nb=model.nb,
        nk=model.nk,
        ts=model.ts,
        covariance=covariance,
        noise_variance=variance,
        dc_gain=gain,
        dc_gain_sd=float(np.sqrt(by_gain @ covariance @ by_gain)),
        fit_percent=100 * (1 - float(np.sqrt(variance / np.var(seen)))),
        rows=rows,
    )


class _Search:
    """Errors of the free run and their slopes: coefficients, then the start of each experiment."""

    def __init__(self, model: ArxModel, data: list[tuple[Array, Array]]) -> None:
        self.model, self.data = model, data

    def polynomials(self, point: Array) -> tuple[Array, Array]:
        """Return A and B."""
        na, count = self.model.na, self.model.na + self.model.nb
        a = np.concatenate([[1.0], point[:na]])
        return a, np.concatenate([np.zeros(self.model.nk), point[na:count]])

    def best(self) -> Any:
        """Return the result of the search from the best start."""
        found = need("scipy.optimize", "identify").least_squares(
            self.errors,
            min(self._starts(), key=lambda point: float(np.sum(self.errors(point) ** 2))),
            jac=self.slopes,
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-15,
            max_nfev=_MOST_STEPS,
        )
        if found.status == 0:
            raise ValueError(
                f"the search has not ended after {_MOST_STEPS} steps: "
                "give lower orders or more data"
            )
        return found

    def _starts(self) -> list[Array]:
        """Return the points from which the search may begin."""
        model, a = self.model, _reflected(self.model.a)
        starts = [self._begun(a, model.b)]
        for _ in range(_ITERATIONS):
            sides = zip(*self.data, strict=True)
            us, ys = ([filtered([1.0], a, one) for one in side] for side in sides)
            try:
                better = arx(us, ys, model.na, model.nb, model.nk, model.ts)
            except ValueError:  # a model that the filtered data do not determine is no start
                break
            a = _reflected(better.a)
            starts.append(self._begun(a, better.b))
        return starts

    def _begun(self, a: Array, b: Array) -> Array:
        """Return the point with the starts that the measured outputs give."""
        begins = [measured_start(a, output[: self.model.memory]) for _, output in self.data]
        return np.concatenate([a[1:], b[self.model.nk :], *begins])

    def _runs(self, point: Array) -> list[Array]:
        a, b = self.polynomials(point)
        place, memory = self.model.na + self.model.nb, self.model.memory
        runs = []
        for drive, _ in self.data:
            forced = np.convolve(drive, b)[memory : len(drive)]
            begin = point[place : place + self.model.na][: len(forced)]
            forced[: len(begin)] += begin
            place += self.model.na
            runs.append(filtered([1.0], a, forced))
        return runs

    def errors(self, point: Array) -> Array:
        """Return output of the free run minus measured output; infinite if it is not stable."""
        memory = self.model.memory
        a, _ = self.polynomials(point)
        if np.any(np.abs(np.roots(a)) >= 1):
            return np.full(sum(len(output) - memory for _, output in self.data), np.inf)
        runs = self._runs(point)
        pairs = zip(runs, self.data, strict=True)
        return np.concatenate([run - output[memory:] for run, (_, output) in pairs])

    def slopes(self, point: Array) -> Array:
        """Return the derivatives of `errors`."""
        a, b = self.polynomials(point)
        now = _Now(a, b, self.model.na, self.model.nb, self.model.nk)
        blocks = []
        for place, (run, (drive, _)) in enumerate(zip(self._runs(point), self.data, strict=True)):
            begins = np.zeros((len(run), self.model.na * len(self.data)))
            own = slice(place * self.model.na, (place + 1) * self.model.na)
            begins[:, own] = natural_responses(a, len(run))
            slope = sensitivities(now, drive, run, self.model.memory)
            blocks.append(np.hstack([slope, begins]))
        return np.vstack(blocks)


@dataclass(frozen=True, slots=True)
class _Now:
    """The coefficients of a point."""

    a: Array
    b: Array
    na: int
    nb: int
    nk: int


def _reflected(a: Array) -> Array:
    """Return the polynomial with its unstable roots reflected into the unit circle."""
    roots: Any = np.roots(a).astype(complex)
    size = np.abs(roots)
    inside = np.where(size > 1, 1 / np.conj(np.where(size > 0, roots, 1)), roots)
    inside = np.where(
        np.abs(inside) > 0.999, inside * 0.999 / np.maximum(np.abs(inside), 0.999), inside
    )
    moved: Array = a if np.all(size < 1) else np.real(np.poly(inside)).reshape(-1)
    return np.concatenate([moved, np.zeros(len(a) - len(moved))])


def _inverse(slopes: Array) -> Array:
    """Return the inverse of the normal matrix, or raise an error if it has none."""
    size = np.linalg.norm(slopes, axis=0)
    if np.any(size == 0):
        raise ValueError("unexcited: a coefficient has no effect; give lower orders or other data")
    _, singular, right = np.linalg.svd(slopes / size, full_matrices=False)
    if singular[-1] < _EPSILON * len(slopes) * singular[0]:
        raise ValueError(
            "unexcited: the data do not determine the coefficients; give lower orders or data in "
            "which the input varies more"
        )
    weighted = right.T / singular / size[:, None]
    inverse: Array = weighted @ weighted.T
    return inverse
