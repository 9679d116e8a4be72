"""ARX models: prediction."""

from __future__ import annotations

from dataclasses import dataclass
from operator import index
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from cgheight._sampled import Array, SampledModel, filtered


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ArxModel(SampledModel):
    """A fitted ARX model ``A(q) y(t) = B(q) u(t) + e(t)`` in powers of the delay q⁻¹.

    Attributes
    ----------
    a : array, shape (na + 1,)
        ``1, a1 … a_na``: coefficients of y(t), y(t-1) …
    b : array, shape (nk + nb,)
        ``nk`` zeros, then ``b1 … b_nb``: coefficients of u(t), u(t-1) … (MATLAB's B).
    na, nb, nk : int
        Number of past outputs, number of input terms, delay of the input in samples.
    ts : float
        Sampling interval, s.
    covariance : array, shape (na + nb, na + nb)
        Covariance of ``a1 … a_na, b1 … b_nb``, in that order.
    noise_variance : float
        Sum of squared residuals divided by (rows - coefficients), in units of y squared.
    dc_gain, dc_gain_sd : float
        ``B(1)/A(1)`` and its standard deviation (first order), in units of y over u.
    fit_percent : float
        ``100 (1 - sqrt(noise_variance / variance of y))`` of the one-step-ahead prediction, %.
    rows : int
        Number of rows of the regression.
    """

    def _repr_html_(self) -> str:
        return self._table("ARX", "fit, one step ahead")

    def _residuals(self, u: Array, y: Array) -> Array:
        past = np.convolve(y, self.a)[self.memory : len(y)]
        drive = np.convolve(u, self.b)[self.memory : len(u)]
        return past - drive

    def predict(
        self,
        u: ArrayLike,
        y: ArrayLike,
        k: float = 1,
        *,
        start: Literal["measured", "fitted"] = "measured",
    ) -> Array:
        """Predict each output from the outputs up to k samples before it and the whole input.

        This is the best predictor if the noise is that of an ARX model. It starts as `free_run`
        does: the first rows that are predicted, less than k of them, have no output k samples
        before them to begin from, and are simulated from the start.

        Parameters
        ----------
        u, y : array, shape (n,)
            Input and output at the model's sampling interval.
        k : int, or infinity
            Samples ahead, 1 or more; with infinity, the prediction is `free_run`.
        start : {"measured", "fitted"}
            As for `free_run`.

        Returns
        -------
        array, shape (n,)
            The prediction, in units of y; NaN in the first `memory` rows.

        Raises
        ------
        ValueError
            `k` is less than 1, or the arrays differ in length, are too short or contain NaN.
        ImportError
            scipy is not installed.
        """
        inputs, outputs = self._data(u, y)
        if k == np.inf:
            return self.free_run(inputs, outputs, start=start)
        ahead = index(k)  # type: ignore[arg-type] # a float that is not infinite is a TypeError
        if ahead < 1:
            raise ValueError(f"k is {k}: it must be 1 or more")
        first = self.memory + ahead - 1
        if first >= len(outputs):
            return self.free_run(inputs, outputs, start=start)
        # 1/A = F + q^-k R/A with F of k terms, so y(t) is predicted by (1 - A F) y + F B u.
        weights = filtered([1.0], self.a, np.eye(1, ahead)[0])
        past = np.convolve(weights, self.a)[ahead:]
        drive = np.convolve(inputs, np.convolve(weights, self.b))[first : len(inputs)]
        predicted = np.full(len(outputs), np.nan)
        predicted[first:] = drive
        for place, weight in enumerate(past):
            begin = first - ahead - place
            predicted[first:] -= weight * outputs[begin : begin + len(drive)]
        if ahead > 1:
            predicted[:first] = self.free_run(inputs[:first], outputs[:first], start=start)
        return predicted

    def _one_step(self, u: Array, y: Array, start: Literal["measured", "fitted"]) -> Array:
        return self.predict(u, y, start=start)
