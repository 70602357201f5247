"""System identification with Kalman filters.

>>> import kalmanscope as ks
>>> results = ks.run({"duration": 20.0, "filters": [{"kind": "ukf"}]})
>>> results["UKF"].mean.shape
(2001, 4)
>>> results["UKF"].verdict
'consistent'
"""

from ._kalmanscope import Error, Estimates, Online, Record, Scenario, __version__, run, sweep, tune
from ._results import Results

__all__ = ["Error", "Estimates", "Online", "Record", "Results", "Scenario", "__version__", "run", "sweep", "tune"]
