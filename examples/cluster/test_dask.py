#!/usr/bin/env python3
"""A worker that is killed loses no row of a sweep and doubles none.

    python test_dask.py        # needs distributed, and a built kalmanscope-cli

The program is `target/debug/kalmanscope-cli`, or what the variable KALMANSCOPE_CLI names.
"""

import os
import signal
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

from distributed import Client, LocalCluster

from sweep_dask import sweep

ROOT = Path(__file__).resolve().parents[2]
CLI = os.environ.get("KALMANSCOPE_CLI", str(ROOT / "target/debug/kalmanscope-cli"))
SHARDS = 8
ROWS = 10 * 12 * 4
ARGUMENTS = ["--vary", "filters.*.process_std=0.01:100:10:log"]
ARGUMENTS += ["--vary", "filters.EKF.initial_mean.natural_frequency=2:20:12"]
ARGUMENTS += ["--seeds", "4", "--score", "nis,verdict,error.natural_frequency"]


def kill_one(client: Client, folder: Path) -> list[str]:
    """Kill a worker process in the middle of a shard, once the data set has two parts. Returns the shards it had."""
    while len(list(folder.glob("*.csv"))) < 2:
        time.sleep(0.01)
    pids = client.run(os.getpid)
    while True:
        for address, pid in pids.items():
            # A worker that stands still finishes nothing between the look at its shards and its end.
            os.kill(pid, signal.SIGSTOP)
            time.sleep(0.3)
            if shards := list(client.processing()[address]):
                os.kill(pid, signal.SIGKILL)
                return shards
            os.kill(pid, signal.SIGCONT)


class Sweep(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
        cls.addClassCleanup(cluster.close)
        cls.client = Client(cluster)
        cls.addClassCleanup(cls.client.close)

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.scenario = self.folder / "scenario.toml"
        self.scenario.write_text("duration = 20.0\n[plant]\nnatural_frequency = 6.0\n")

    def test_a_killed_worker_loses_no_row_and_doubles_none(self) -> None:
        whole = self.folder / "whole.csv"
        command = [CLI, "sweep", str(self.scenario), *ARGUMENTS, "--out", str(whole)]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        parts = self.folder / "parts"
        client = self.client
        killed: list[str] = []
        killer = threading.Thread(target=lambda: killed.extend(kill_one(client, parts)))
        killer.start()
        run = sweep(client, parts, CLI, str(self.scenario), ARGUMENTS, SHARDS)
        killer.join()
        self.assertEqual(run, SHARDS)
        self.assertGreaterEqual(len(killed), 1, "the worker had a shard when it was killed")

        header, *expected = whole.read_text().splitlines()
        self.assertEqual(len(set(expected)), ROWS, "each cell once")

        def rows() -> list[str]:
            tables = [path.read_text().splitlines() for path in sorted(parts.glob("*.csv"))]
            self.assertEqual({table[0] for table in tables}, {header})
            return [row for table in tables for row in table[1:]]

        self.assertEqual(rows(), expected, "the rows of one call, in its order")

        # The same sweep again has nothing to do, and a missing part alone is run.
        self.assertEqual(sweep(client, parts, CLI, str(self.scenario), ARGUMENTS, SHARDS), 0)
        sorted(parts.glob("*.csv"))[3].unlink()
        self.assertEqual(sweep(client, parts, CLI, str(self.scenario), ARGUMENTS, SHARDS), 1)
        self.assertEqual(rows(), expected)
        with self.assertRaises(SystemExit):
            sweep(client, parts, CLI, str(self.scenario), ARGUMENTS, SHARDS + 1)

    def test_an_error_of_the_program_is_reported(self) -> None:
        with self.assertRaisesRegex(RuntimeError, "has no number `plant.mass` to vary"):
            sweep(self.client, self.folder / "parts", CLI, str(self.scenario), ["--vary", "plant.mass=1:2:3"], 2)
        self.assertEqual(list((self.folder / "parts").glob("*.csv")), [])


if __name__ == "__main__":
    unittest.main()
