"""The thesis's tables beside ours."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

from cgheight import _native
from cgheight._extras import need

if TYPE_CHECKING:
    import pandas as pd


def reproduce(table: str | None = None, *, runs: int = 1000, seed: int = 1) -> pd.DataFrame:
    """Compute the thesis's tables anew and set ours beside the printed numbers.

    Parameters
    ----------
    table : str, optional
        One table, equation or figure, such as ``"5.11"``, ``"eq. 5.12"`` or ``"C"``; all if absent
        (half a minute).
    runs : int
        Draws of the noise in each cell of a Monte-Carlo table, 1 or more.
    seed : int
        Seed of the first draw, 0 or more.

    Returns
    -------
    pandas.DataFrame
        ``table, item, thesis, ours, relative_error, same_digits, note``, one row for each number;
        units (in ``item``) and signs are the thesis's. NaN where a side has no such number.

    Raises
    ------
    ValueError
        There is no such table (the message lists them), or `runs` is below 1.
    ImportError
        pandas is not installed.

    Examples
    --------
    >>> import cgheight
    >>> rows = cgheight.reproduce("eq. 5.19")
    >>> print(f"{rows.ours[0]:.4f}, printed {rows.thesis[0]}")
    1.4894, printed 1.4894
    """
    pandas = need("pandas", "pandas")
    for name, value, least in (
        ("runs", operator.index(runs), 1),
        ("seed", operator.index(seed), 0),
    ):
        if not least <= value < 2**32:
            raise ValueError(f"{name} is {value}: it must be from {least} to {2**32 - 1}")
    return pandas.DataFrame(_native.reproduce_tables(table, runs, seed))
