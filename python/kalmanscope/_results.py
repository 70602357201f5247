"""The outcome of a run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ._kalmanscope import Estimates, Record


class Results(dict[str, Estimates]):
    """The estimates of each filter of a run by its name; a picture in a notebook.

    ``record`` is the record, simulated or given. ``remarks`` say what is to be known of the run, as why a motion ended early.
    ``free_run(record)`` says how well each identified model follows each sensor of a record, from its input alone: a list of dicts
    with ``filter``, ``sensor``, ``rms`` and ``percent``.
    """

    def __init__(self, run: Any, record: Record, remarks: list[str]) -> None:
        super().__init__((one.name, one) for one in run.estimates())
        self._run, self.record, self.remarks = run, record, remarks
        self.free_run: Callable[[Record], list[dict[str, Any]]] = run.free_run

    def __missing__(self, name: str) -> Estimates:
        raise KeyError(f"there is no filter `{name}`, but {', '.join(self)}")

    def __repr__(self) -> str:
        return "\n".join(map(repr, self.values()))

    def _repr_html_(self) -> str:
        return str(self._run.svg())
