"""The tables of the thesis, recomputed."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

from cgheight import _native
from cgheight._extras import need

if TYPE_CHECKING:
    import pandas as pd


def reproduce(table: str | None = None, *, runs: int = 1000, seed: int = 1) -> pd.DataFrame:
    """Recompute the tables of the thesis and compare them with the printed numbers.

    Parameters
    ----------
    table : str, optional
        One table, equation or figure, such as ``"5.11"``, ``"eq. 5.12"`` or ``"C"``; all of them
        if absent, which takes half a minute.
    runs : int
        Number of noise draws in each cell of a Monte-Carlo table, 1 or more.
    seed : int
        Seed of the first draw, 0 or more.

    Returns
    -------
    pandas.DataFrame
        ``table, item, thesis, ours, relative_error, criterion, criterion_reason, verdict,
        same_digits, note``, one row for each number. ``verdict`` is ``"same"`` if ``ours`` is at
        most ``criterion`` from ``thesis``, otherwise ``"differs"``, ``"not printed"`` or
        ``"cannot be computed"``; ``note`` says why. Units (given in ``item``) and signs are those
        of the thesis. NaN where the thesis or this package has no such number.

    Raises
    ------
    ValueError
        There is no such table (the message lists all tables), or `runs` or `seed` is out of range.
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
