"""Columns and settings of any kind as those of the extension module."""

from __future__ import annotations

import json
from datetime import datetime, timezone
from os import fspath
from typing import Any

import numpy as np

from ._kalmanscope import Error


def plain(name: str, values: Any) -> Any:
    """One dimension of float64, NaN where a value is missing; of datetime64 where they are dates with times."""
    try:
        if hasattr(values, "to_numpy"):
            try:
                values = values.to_numpy(na_value=np.nan)  # pandas, whose missing numbers may be no floats
            except (TypeError, ValueError):
                values = values.to_numpy()
        if np.ma.isMaskedArray(values):
            is_time = values.dtype.kind in "mM"
            masked: Any = values if is_time else values.astype(np.float64)
            values = masked.filled(np.array("NaT", values.dtype) if is_time else np.nan)
        values = np.asarray(values)
        kinds = {type(value) for value in values.flat} if values.dtype.kind == "O" else set()
        if any(issubclass(kind, datetime) for kind in kinds):
            utc = [it.astimezone(timezone.utc).replace(tzinfo=None) if getattr(it, "tzinfo", None) else it for it in values]
            values = np.array(utc, dtype="datetime64[us]")
        elif values.dtype.kind in "cSUV" or any(issubclass(kind, (str, bytes)) for kind in kinds):
            raise TypeError("there is text, or a complex number")
        if values.dtype.kind == "m":
            values = values / np.timedelta64(1, "s")
        values = values if values.dtype.kind == "M" else np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise Error(f"`{name}` is no column of numbers: {str(problem).split('. ')[0]}") from None
    if values.ndim != 1:
        raise Error(f"`{name}` must have one dimension, not {values.ndim}")
    return values


def column(name: str, values: Any, since: list[Any] | None = None) -> Any:
    """Numbers, or times: in seconds since the first of all where they are dates with times."""
    values = plain(name, values)
    is_date = values.dtype.kind == "M"
    if since is not None and not since:
        since.append(values[0] if is_date and len(values) else None)
    if is_date != (since is not None and since[0] is not None):
        raise Error(f"`{name}` has dates where there are numbers elsewhere, or numbers where there are dates")
    return (values - since[0]) / np.timedelta64(1, "s") if is_date and since else values


def table(source: Any, u: Any, sensors: dict[str, Any] | None) -> tuple[str, list[tuple[str, bytes]], list[str], str | None]:
    """The columns of a data frame, and what is left out; or those of arrays, and what they mean."""
    if not hasattr(source, "columns"):
        columns = arrays(source, u, sensors or {})
        meant = {name: {"column": name} for name in sensors or {} if name[:5] != "true_"}
        forces = {name: meant.pop(name) for name in list(meant) if name[:9] == "force_on_"}
        mapping: dict[str, Any] = {"time": {"column": "time"}, "sensors": meant, "forces": forces}
        if u is not None:
            mapping["input"] = {"column": "input"}
        return "", [(name, values.tobytes()) for name, values in columns], [], json.dumps(mapping)
    if u is not None or sensors:
        raise Error("a data frame has all columns: `mapping` says what they mean")
    named = [(str(name), source[name]) for name in source.columns]
    index = getattr(source, "index", None)
    if index is not None and type(index).__name__ != "RangeIndex":
        named.insert(0, (str(index.name or "time"), index))
    since: list[Any] = []
    found, remarks = [], []
    for name, values in named:
        try:
            is_date = plain(name, values).dtype.kind == "M"
            found.append((f"{name} (s)" if is_date else name, column(name, values, since if is_date else None).tobytes()))
        except Error as problem:
            remarks.append(f"{problem}; it is left out")
    return "a data frame", found, remarks, None


def arrays(t: Any, u: Any, sensors: dict[str, Any]) -> list[tuple[str, Any]]:
    """Main times, columns at these, and behind them each column with times of its own; all as long as the longest."""
    since: list[Any] = [] if np.ndim(t) else [None]
    times = column("t", t, since) if np.ndim(t) else None
    columns = [] if u is None else [("input", column("input", u))]
    clocks: list[tuple[str, Any]] = []
    for name, values in sensors.items():
        if not (isinstance(values, tuple) and len(values) == 2 and np.ndim(values[0])):  # two numbers are two readings
            columns.append((name, column(name, values)))
            continue
        own, readings = column(f"times of {name}", values[0], since), column(name, values[1])
        if len(own) != len(readings):
            raise Error(f"`{name}` has {len(own)} times, but {len(readings)} readings")
        if len(own) < 2 or not (np.diff(own) > 0).all():
            raise Error(f"the times of `{name}` are two or more, and must rise")
        clocks += [(f"time {len(clocks)} (s)", own), (name, readings)]
    if not sensors or (times is None and not columns):
        raise Error("a record needs readings of a sensor, and times, an input or readings at each sample")
    if times is None:
        if not 0 < (dt := float(t)) < np.inf:
            raise Error(f"the time between samples is {dt} s, but must be positive and finite")
        times = np.arange(len(columns[0][1])) * dt
    for name, values in columns:
        if len(values) != len(times):
            raise Error(f"column `{name}` has {len(values)} values, but there are {len(times)} samples")
    columns = [("time (s)", times), *columns, *clocks]
    rows = max(len(values) for _, values in columns)
    return [(name, np.pad(values, (0, rows - len(values)), constant_values=np.nan)) for name, values in columns]


def to_json(settings: Any) -> str:
    """Settings with numbers of NumPy, paths and tuples as JSON."""
    return json.dumps(settings, allow_nan=False, default=lambda it: it.tolist() if hasattr(it, "tolist") else fspath(it))


def axis(key: str, values: Any) -> str:
    """The values of an axis as `FROM:TO:COUNT`, with `:log` behind it for equal ratios. Without a count it is only a range."""
    if isinstance(values, str):
        return values
    if isinstance(values, tuple) and 2 <= len(values) <= 4:
        count = [] if len(values) > 2 and isinstance(values[2], (int, np.integer)) else [2]
        return ":".join(map(str, [*map(float, values[:2]), *count, *values[2:]]))
    values = plain(key, values)
    if values.dtype.kind == "f" and len(values) and np.isfinite(values).all():
        first, last, size = float(values[0]), float(values[-1]), len(values)
        if np.allclose(values, np.linspace(first, last, size), rtol=1e-9, atol=1e-9 * abs(last - first)):
            return f"{first!r}:{last!r}:{size}"
        if (values > 0).all() and np.allclose(values, np.geomspace(first, last, size), rtol=1e-9, atol=0):
            return f"{first!r}:{last!r}:{size}:log"
    raise Error(f"`{key}`: values are evenly spaced, in differences or in ratios, or (from, to, count)")
