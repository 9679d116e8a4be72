"""ARX models: preparation of data, the fit, and the choice of the orders."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from operator import index
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cgheight import _native, _show
from cgheight._arrays import column, number
from cgheight._arx_model import ArxModel
from cgheight._extras import need
from cgheight._sampled import Array

if TYPE_CHECKING:
    import pandas as pd


def experiments(u: Any, y: Any) -> tuple[list[Array], list[Array]]:
    """Return inputs and outputs, one array for each experiment; arrays alone are one experiment."""
    several = [isinstance(side, list | tuple) and len(side) > 0 and np.ndim(side[0]) > 0
               for side in (u, y)]  # fmt: skip
    if not any(several):
        return [column("u", u)], [column("y", y)]
    if not all(several) or len(u) != len(y):
        counts = [len(side) if many else 1 for side, many in zip((u, y), several, strict=True)]
        raise ValueError(
            f"the number of experiments is {counts[0]} in u and {counts[1]} in y: "
            "give one array of each for every experiment"
        )
    inputs = [column(f"u[{place}]", one) for place, one in enumerate(u)]
    return inputs, [column(f"y[{place}]", one) for place, one in enumerate(y)]


def detrend(values: ArrayLike, *, order: int = 0) -> Array:
    """Remove the mean or a trend from a signal, as is done before a model is fitted.

    A model of this package goes through the origin: with an input of zero, its output decays to
    zero. Sensors have offsets and drift, so remove them from input and output before the fit.

    Parameters
    ----------
    values : array, shape (n,)
        A signal, equally spaced in time. NaN is left out and stays.
    order : int
        0 removes the mean, 1 a straight line (drift of a sensor), 2 a parabola; less than the
        number of values.

    Returns
    -------
    array, shape (n,)
        The signal without the polynomial that fits it best.

    Raises
    ------
    ValueError
        `order` is negative, or there are too few values for it.

    Examples
    --------
    >>> import cgheight
    >>> cgheight.detrend([1.0, 2.0, 3.0, 5.0]).sum()
    np.float64(0.0)
    """
    signal = column("values", values)
    seen = np.isfinite(signal)
    if not 0 <= index(order) < np.count_nonzero(seen):
        raise ValueError(
            f"order is {order}: it must be 0 or more, and less than the number of values, "
            f"{np.count_nonzero(seen)}"
        )
    # Between -1 and 1 the powers are well conditioned.
    place = np.linspace(-1.0, 1.0, len(signal))
    trend = np.polynomial.Polynomial.fit(place[seen], signal[seen], order, domain=[-1.0, 1.0])
    without: Array = signal - trend(place)
    return without


def arx(u: ArrayLike, y: ArrayLike, na: int, nb: int, nk: int, ts: float) -> ArxModel:
    """Fit an ARX model by least squares, as MATLAB's `arx` does.

    ``y(t) + a1 y(t-1) + … = b1 u(t-nk) + … + b_nb u(t-nk-nb+1) + e(t)``, by QR decomposition
    in double precision, over the rows whose regressors are all in the data.

    Parameters
    ----------
    u, y : array, shape (n,), or list of arrays
        Input and output, equally spaced in time. Several experiments (logs, or parts of a log with
        gaps between them) become one model if lists have one array for each experiment; no row
        contains values of two. Offsets are not removed (see `detrend`).
    na : int
        Number of past outputs, 0 or more.
    nb : int
        Number of input terms, 1 or more; ``na + nb`` at most 40.
    nk : int
        Delay of the input in samples, 0 or more; ``nk + nb`` at most 49.
    ts : float
        Sampling interval, s.

    Returns
    -------
    ArxModel
        Coefficients with their covariance, and the DC gain.

    Raises
    ------
    ValueError
        The arrays differ in length or contain NaN (the message gives the index), the orders are
        out of range, or the data determine no model (the message names the regressor).
    """
    return _native.fit_arx(*experiments(u, y), index(na), index(nb), index(nk), number("ts", ts))


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class OrderSelection:
    """Scores of ARX models of many orders, computed on the same rows.

    Attributes
    ----------
    na, nb, nk : int array, shape (m,)
        The orders tried, see `arx`.
    loss : array, shape (m,)
        Mean square of the residuals of the fit, in units of y squared; NaN where the data
        determine no model.
    aic, bic : array, shape (m,)
        ``n ln(loss) + 2 d`` and ``n ln(loss) + d ln(n)``, with n rows and d = na + nb coefficients.
    validation_loss : array, shape (m,)
        Mean square of the residuals on the validation data; NaN without such data.
    criterion : {"aic", "bic", "validation"}
        The score that was minimized.
    model : ArxModel
        The best model.
    """

    na: NDArray[np.int64]
    nb: NDArray[np.int64]
    nk: NDArray[np.int64]
    loss: NDArray[np.float64]
    aic: NDArray[np.float64]
    bic: NDArray[np.float64]
    validation_loss: NDArray[np.float64]
    criterion: Literal["aic", "bic", "validation"]
    model: ArxModel

    def to_frame(self) -> pd.DataFrame:
        """Return the scores as a pandas DataFrame, with the best model first."""
        names = ("na", "nb", "nk", "loss", "aic", "bic", "validation_loss")
        table = need("pandas", "pandas").DataFrame({name: getattr(self, name) for name in names})
        return table.sort_values(_KEYS[self.criterion], ignore_index=True)

    def __repr__(self) -> str:
        best = f"[{self.model.na} {self.model.nb} {self.model.nk}]"
        return f"OrderSelection({best} by {self.criterion} of {len(self.na)} tried)"

    def _repr_html_(self) -> str:
        scores = getattr(self, _KEYS[self.criterion])
        order = [k for k in np.argsort(scores) if np.isfinite(scores[k])][:10]
        rows = [
            (
                f"[{self.na[k]} {self.nb[k]} {self.nk[k]}]",
                f"{self.aic[k]:.1f}",
                f"{self.bic[k]:.1f}",
                f"{self.validation_loss[k]:.4g}",
            )
            for k in order
        ]
        header = ["na nb nk", "AIC", "BIC", "validation loss"]
        title = f"{self!r}, the best ten"
        return f"<p>{_show.escape(title)}</p>" + _show.grid(header, rows)


_KEYS = {"aic": "aic", "bic": "bic", "validation": "validation_loss"}


def select_order(
    u: ArrayLike,
    y: ArrayLike,
    ts: float,
    *,
    na: Iterable[int] = range(1, 9),
    nb: Iterable[int] = range(1, 9),
    nk: Iterable[int] = (1,),
    criterion: Literal["aic", "bic", "validation"] = "bic",
    validation: tuple[ArrayLike, ArrayLike] | None = None,
) -> OrderSelection:
    """Choose the orders of an ARX model.

    All models are fitted to the same rows, so that their scores are comparable: to those that the
    model with the longest memory can use. The best model is then fitted to all rows it can use.

    Parameters
    ----------
    u, y : array, shape (n,), or list of arrays
        Input and output, equally spaced in time; lists for several experiments, see `arx`.
    ts : float
        Sampling interval, s.
    na, nb, nk : iterable of int
        The orders to try, in all combinations; see `arx`.
    criterion : {"aic", "bic", "validation"}
        The score to minimize: Akaike's criterion (good predictions, but tends to high orders),
        Schwarz's criterion (finds the true order if there are enough data), or the mean square of
        the residuals on `validation`.
    validation : tuple of two arrays, shape (m,), optional
        Input and output of another log; needed for the criterion "validation".

    Returns
    -------
    OrderSelection
        The scores of all models, and the best model.

    Raises
    ------
    ValueError
        An order is out of range, the data determine none of the models, or there are no validation
        data for the criterion.

    Examples
    --------
    >>> import numpy as np, cgheight
    >>> random = np.random.default_rng(1)
    >>> u, e = random.standard_normal(2000), 0.1 * random.standard_normal(2000)
    >>> y = np.zeros(2000)
    >>> for t in range(2, 2000):
    ...     y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + u[t - 1] + e[t]
    >>> cgheight.select_order(u, y, 0.05)
    OrderSelection([2 1 1] by bic of 64 tried)
    """
    if criterion not in _KEYS:
        raise ValueError(f'criterion is {criterion!r}: it must be "aic", "bic" or "validation"')
    if criterion == "validation" and validation is None:
        raise ValueError("validation is missing: the criterion needs another log's (u, y)")
    inputs, outputs = experiments(u, y)
    orders = [(index(a), index(b), index(k)) for a in na for b in nb for k in nk]
    if not orders:
        raise ValueError("no orders to try: na, nb and nk must each contain at least one value")
    memory = max(max(a, b + k - 1) for a, b, k in orders)
    scores = np.full((4, len(orders)), np.nan)
    for place, (a, b, k) in enumerate(orders):
        start = memory - max(a, b + k - 1)
        try:
            model = arx(
                [one[start:] for one in inputs], [one[start:] for one in outputs], a, b, k, ts
            )
        except ValueError as error:
            if str(error).startswith("unexcited"):
                continue
            raise
        n, d = model.rows, a + b
        loss = model.noise_variance * (n - d) / n
        # The loss of an exact fit can be zero; its logarithm needs a positive number.
        size = n * np.log(max(loss, np.finfo(float).tiny))
        scores[:3, place] = loss, size + 2 * d, size + d * np.log(n)
        if validation is not None:
            scores[3, place] = np.mean(model.residuals(*validation) ** 2)
    row = {"aic": 1, "bic": 2, "validation": 3}[criterion]
    if np.all(np.isnan(scores[row])):
        raise ValueError("unexcited: the data determine none of these models; give a longer log")
    best = orders[int(np.nanargmin(scores[row]))]
    tried = np.array(orders, dtype=np.int64).T
    names = ("na", "nb", "nk", "loss", "aic", "bic", "validation_loss")
    columns: dict[str, Any] = dict(zip(names, [*tried, *scores], strict=True))
    return OrderSelection(**columns, criterion=criterion, model=arx(inputs, outputs, *best, ts=ts))
