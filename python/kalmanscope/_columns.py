"""Columns and settings of any kind as those of the extension module."""

from __future__ import annotations

import json
from typing import Any

import numpy as np


def column(values: Any) -> bytes:
    """A column as float64; NaN where a value is missing, seconds since the first one where they are times of day."""
    if np.ma.isMaskedArray(values):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    elif hasattr(values, "to_numpy"):
        try:
            values = values.to_numpy(na_value=np.nan)  # pandas, whose missing numbers may be no floats
        except TypeError:
            values = values.to_numpy()
    values = np.asarray(values)
    if values.dtype.kind == "M":
        values = (values - values[0]) / np.timedelta64(1, "s")
    values = np.asarray(values, dtype=np.float64)
    if values.ndim != 1:
        raise ValueError(f"a column has one dimension, not {values.ndim}")
    return values.tobytes()


def frame(table: Any) -> list[tuple[str, Any]]:
    """The columns of a data frame by name."""
    return [(str(name), table[name]) for name in table.columns]


def to_json(settings: Any) -> str:
    """Settings with numbers of NumPy and tuples as JSON."""
    return json.dumps(settings, allow_nan=False, default=lambda value: value.tolist())


def axis(values: Any) -> str:
    """The values of an axis as `FROM:TO:COUNT`, with `:log` behind it for equal ratios. Without a count it is only a range."""
    if isinstance(values, str):
        return values
    if isinstance(values, tuple):
        count = [] if len(values) > 2 and isinstance(values[2], int) else [2]
        return ":".join(map(str, [*map(float, values[:2]), *count, *values[2:]]))
    values = np.asarray(values, dtype=np.float64)
    ends = f"{float(values[0])!r}:{float(values[-1])!r}:{len(values)}"
    if np.allclose(values, np.linspace(values[0], values[-1], len(values)), rtol=1e-9, atol=0):
        return ends
    if (values > 0).all() and np.allclose(values, np.geomspace(values[0], values[-1], len(values)), rtol=1e-9, atol=0):
        return f"{ends}:log"
    raise ValueError("the values of an axis are evenly spaced, in differences or in ratios")
