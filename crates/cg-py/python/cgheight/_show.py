"""Results in a notebook: small HTML tables with escaped text and almost no styling."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape as escape
from typing import Any


def number(value: float | None, digits: int, unit: str = "") -> str:
    """Return a number with its unit, or a dash if there is no number."""
    if value is None or value != value:
        return "–"
    return f"{value:.{digits}f}" + (f" {unit}" if unit else "")


def pairs(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """Return a table with two columns: names and values."""
    body = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th>"
        f"<td style='text-align:left'>{escape(value)}</td></tr>"
        for name, value in rows
    )
    return f"<table><caption>{escape(title)}</caption><tbody>{body}</tbody></table>"


def grid(header: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table with a header row."""
    head = "".join(f"<th>{escape(name)}</th>" for name in header)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def messages(texts: Iterable[str]) -> str:
    """Return a list of messages, or an empty text if there are none."""
    items = "".join(f"<li>{escape(text)}</li>" for text in texts)
    return f"<ul>{items}</ul>" if items else ""


def vehicle(one: Any) -> str:
    """Return the table that represents a `Vehicle` in a notebook."""
    low_m, high_m = one.height_range_m
    return pairs(
        f"Vehicle {one.name}",
        [
            ("nominal speed", number(one.nominal_speed_mps, 2, "m/s")),
            ("reference trailer mass", number(one.reference_trailer_mass_kg, 0, "kg")),
            ("empty trailer", number(one.empty_trailer_mass_kg, 0, "kg")),
            ("reference c.g. height", number(one.reference_height_m, 3, "m")),
            ("range of c.g. heights", f"{low_m:.2f} to {high_m:.2f} m"),
            ("calibrated", "yes" if one.is_calibrated else "no"),
        ],
    )
