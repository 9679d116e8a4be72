"""ARX models."""

from __future__ import annotations

from operator import index

from numpy.typing import ArrayLike

from cgheight import _native
from cgheight._arrays import column, number
from cgheight._results import ArxModel


def arx(u: ArrayLike, y: ArrayLike, na: int, nb: int, nk: int, ts: float) -> ArxModel:
    """Fit an ARX model by least squares, as MATLAB's `arx` does.

    ``y(t) + a1 y(t-1) + … = b1 u(t-nk) + … + b_nb u(t-nk-nb+1) + e(t)``, by QR decomposition
    in double precision, over the rows in which every regressor is in the data.

    Parameters
    ----------
    u, y : array, shape (n,)
        Input and output, equally spaced in time. Offsets are not removed.
    na : int
        Number of past outputs, 0 or more.
    nb : int
        Number of input terms, 1 or more; ``na + nb`` at most 40.
    nk : int
        Samples until the input first acts, 0 or more; ``nk + nb`` at most 49.
    ts : float
        Sampling interval, s.

    Returns
    -------
    ArxModel
        Coefficients with their covariance, and the DC gain.

    Raises
    ------
    ValueError
        The arrays do not fit together or hold NaN (named with index), the orders are out of
        range, or the data determine no model (the message names the regressor).
    """
    return _native.fit_arx(
        column("u", u), column("y", y), index(na), index(nb), index(nk), number("ts", ts)
    )
