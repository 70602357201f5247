from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._results import Results

_Array = NDArray[np.float64]
_Source = Scenario | Record | str | PathLike[str] | dict[str, Any]
__all__ = ["Error", "Estimates", "Online", "Record", "Scenario", "_Run", "__version__", "run", "sweep", "tune"]
__version__: Final[str]
_Run: Any

class Error(ValueError): ...

@final
class Record:
    def __new__(
        cls, t: Any, u: ArrayLike | None = None, /, *, mapping: dict[str, Any] | None = None,
        input: Literal["force", "ground_acceleration"] | None = None, hold: Literal["zero", "first"] | None = None, **sensors: Any,
    ) -> Record: ...
    def __len__(self) -> int: ...
    def __getitem__(self, key: str, /) -> _Array: ...
    dt: Final[float]
    time: Final[_Array]
    input: Final[_Array]
    sensors: Final[list[str]]
    remarks: Final[list[str]]

@final
class Scenario:
    def __new__(cls, source: _Source | None = None, /, **settings: Any) -> Scenario: ...
    def __getitem__(self, key: str, /) -> float: ...
    toml: Final[str]
    filters: Final[list[str]]
    remarks: Final[list[str]]
    def to_dict(self) -> dict[str, Any]: ...
    def simulate(self, seed: int | None = None) -> Record: ...

@final
class Estimates:
    def __len__(self) -> int: ...
    def __getitem__(self, key: str, /) -> _Array: ...
    name: Final[str]
    channels: Final[list[str]]
    sensors: Final[list[str]]
    stop: Final[tuple[int, str] | None]
    time: Final[_Array]
    mean: Final[_Array]
    std: Final[_Array]
    covariance: Final[_Array]
    innovation: Final[_Array]
    innovation_covariance: Final[_Array]
    nis: Final[_Array]
    log_likelihood: Final[_Array]
    verdict: Final[str | None]
    diagnosis: Final[dict[str, Any]]
    def smooth(self) -> Estimates: ...

@final
class Online:
    def __new__(cls, scenario: _Source, filter: str | None = None) -> Online: ...
    def __getitem__(self, key: str, /) -> float: ...
    def step(self, u: float = 0.0, z: Sequence[float] | None = None, **readings: float | None) -> _Array: ...
    channels: Final[list[str]]
    sensors: Final[list[str]]
    covariance: Final[_Array]
    nis: Final[float]

def run(scenario: _Source, record: Record | None = None) -> Results: ...
def tune(
    scenario: _Source, settings: str | Sequence[str] | Mapping[str, ArrayLike | str | tuple[Any, ...]], record: Record | None = None, *,
    filter: str | None = None, goal: str = "log_likelihood",
) -> dict[str, Any]: ...
def sweep(
    scenario: _Source, vary: Mapping[str, ArrayLike | str | tuple[Any, ...]], record: Record | None = None, *,
    seeds: int | None = None, measures: Sequence[str] | None = None, filters: Sequence[str] | None = None,
    threads: int | None = None, part: tuple[int, int] = ...,
) -> dict[str, _Array]: ...
