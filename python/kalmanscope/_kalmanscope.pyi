from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._results import Results

Array = NDArray[np.float64]
Source = Scenario | Record | str | PathLike[str] | dict[str, Any]
__version__: Final[str]

class Error(ValueError): ...

class Record:
    def __init__(
        self, t: Any, u: ArrayLike | None = None, /, *, mapping: dict[str, Any] | None = None,
        input: Literal["force", "ground_acceleration"] | None = None, hold: Literal["zero", "first"] | None = None, **sensors: Any,
    ) -> None: ...
    def __len__(self) -> int: ...
    def __getitem__(self, key: str) -> Array: ...
    dt: Final[float]
    time: Final[Array]
    input: Final[Array]
    sensors: Final[list[str]]
    remarks: Final[list[str]]

class Scenario:
    def __init__(self, source: Source | None = None, /, **settings: Any) -> None: ...
    def __getitem__(self, key: str) -> float: ...
    toml: Final[str]
    filters: Final[list[str]]
    remarks: Final[list[str]]
    def to_dict(self) -> dict[str, Any]: ...
    def simulate(self, seed: int | None = None) -> Record: ...

class Estimates:
    def __len__(self) -> int: ...
    def __getitem__(self, key: str) -> Array: ...
    name: Final[str]
    channels: Final[list[str]]
    sensors: Final[list[str]]
    stop: Final[tuple[int, str] | None]
    time: Final[Array]
    mean: Final[Array]
    std: Final[Array]
    covariance: Final[Array]
    innovation: Final[Array]
    innovation_covariance: Final[Array]
    nis: Final[Array]
    log_likelihood: Final[Array]
    verdict: Final[str | None]
    diagnosis: Final[dict[str, Any]]
    def smooth(self) -> Estimates: ...

class Online:
    def __init__(self, scenario: Source, filter: str | None = None) -> None: ...
    def __getitem__(self, key: str) -> float: ...
    def step(self, u: float = 0.0, z: Sequence[float] | None = None, **readings: float | None) -> Array: ...
    channels: Final[list[str]]
    sensors: Final[list[str]]
    covariance: Final[Array]
    nis: Final[float]

def run(scenario: Source, record: Record | None = None) -> Results: ...
def tune(
    scenario: Source, settings: str | Sequence[str] | Mapping[str, ArrayLike | str | tuple[Any, ...]], record: Record | None = None, *,
    filter: str | None = None, goal: str = "log_likelihood",
) -> dict[str, Any]: ...
def sweep(
    scenario: Source, vary: Mapping[str, ArrayLike | str | tuple[Any, ...]], record: Record | None = None, *,
    seeds: int | None = None, measures: Sequence[str] | None = None, filters: Sequence[str] | None = None,
    threads: int | None = None, part: tuple[int, int] = (1, 1),
) -> dict[str, Array]: ...
