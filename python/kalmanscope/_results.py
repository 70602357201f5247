"""The outcome of a run."""

from __future__ import annotations

from typing import Any

from ._kalmanscope import Estimates, Record


class Results(dict[str, Estimates]):
    """The estimates of each filter of a run by its name; a picture in a notebook.

    ``record`` is the record, simulated or given. ``remarks`` say what is to be known of the run, as why a motion ended early.
    """

    record: Record
    remarks: list[str]

    def __init__(self, run: Any) -> None:
        super().__init__((one.name, one) for one in run.estimates())
        self._run, self.record, self.remarks = run, run.record, run.remarks

    def __missing__(self, name: str) -> Estimates:
        raise KeyError(f"there is no filter `{name}`, but {', '.join(self)}")

    def free_run(self, record: Record) -> list[dict[str, Any]]:
        """How well each identified model follows each sensor of a record, from its input alone.

        A dict with ``filter``, ``sensor``, ``rms`` and ``percent`` for each.
        """
        return self._run.free_run(record)  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        return "\n".join(map(repr, self.values()))

    def _repr_html_(self) -> str:
        return str(self._run.svg())
