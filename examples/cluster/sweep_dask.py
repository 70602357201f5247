#!/usr/bin/env python3
"""A sweep on a Dask cluster: each task calls the command line on one shard.

    python sweep_dask.py FOLDER SCENARIO.toml --shards 64 --scheduler tcp://HOST:8786 -- --vary KEY=FROM:TO:COUNT --seeds 100

The results are one data set of CSV files: FOLDER has one for each shard, and their names are in the order of the rows. This
program alone writes them, each under another name until it is complete. A shard that is run twice, because its worker was
lost, gives the same bytes, so no row is lost or doubled. The same command again runs only the shards that are missing.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from distributed import Client, LocalCluster, as_completed

RETRIES = 3
"""How often a shard is tried again after an error. The loss of a worker is no error; Dask's own limit for it is
`distributed.scheduler.allowed-failures`."""


def run_shard(cli: str, scenario: str, arguments: list[str], number: int, shards: int) -> bytes:
    """Run one shard and return its table, a CSV file. Runs on a worker.

    The file is in a folder of this attempt: a program that has outlived its lost worker writes elsewhere.
    """
    with tempfile.TemporaryDirectory(prefix="sweep-") as folder:
        table = Path(folder, "table.csv")
        # One thread: Dask gives each thread of a worker a shard.
        command = [cli, "sweep", scenario, "--threads", "1", *arguments]
        command += ["--shard", f"{number}/{shards}", "--out", str(table)]
        done = subprocess.run(command, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"shard {number}/{shards} ended with {done.returncode}: {done.stderr.strip()}")
        return table.read_bytes()


def write_whole(path: Path, content: bytes) -> None:
    """Write a file so that it is there with all its content or not at all."""
    unfinished = path.with_name(f".{path.name}.tmp")
    unfinished.write_bytes(content)
    os.replace(unfinished, path)


def prepare(folder: Path, sweep: dict) -> None:
    """Note in the folder which sweep it holds. Exits where it holds another one."""
    folder.mkdir(parents=True, exist_ok=True)
    note = folder / "_sweep.json"
    if note.exists():
        if json.loads(note.read_text()) != sweep:
            sys.exit(f"{folder} holds another sweep: choose another folder, or remove it")
    elif any(folder.glob("*.csv")):
        sys.exit(f"{folder} holds tables of something else: choose another folder")
    else:
        write_whole(note, json.dumps(sweep, indent=1).encode())


def sweep(client: Client, folder: Path, cli: str, scenario: str, arguments: list[str], shards: int) -> int:
    """Run all shards that the folder lacks and write them into it. Returns how many were run."""
    text = Path(scenario).read_text()
    prepare(folder, {"scenario": text, "arguments": arguments, "shards": shards})
    paths = {number: folder / f"part-{number:05}-of-{shards:05}.csv" for number in range(1, shards + 1)}
    missing = [number for number, path in paths.items() if not path.exists()]
    shard = {
        # Not pure: a result of an earlier call with the same arguments may be of another program.
        client.submit(run_shard, cli, scenario, arguments, number, shards, retries=RETRIES, pure=False): number
        for number in missing
    }
    for future in as_completed(shard):
        write_whole(paths[shard[future]], future.result())
        # The worker need not keep the table any longer.
        future.release()
    return len(missing)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__,
        usage="%(prog)s FOLDER SCENARIO --shards N [--scheduler ADDRESS] [--cli PROGRAM] -- [--vary …] [--seeds …]",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path, help="the data set to write")
    parser.add_argument("scenario", help="the scenario, at the same path on each worker, as are records that it names")
    parser.add_argument("--shards", type=int, required=True, help="a few for each thread of the cluster")
    parser.add_argument("--scheduler", help="the address of Dask's scheduler; a cluster on this machine if left out")
    parser.add_argument("--cli", default="kalmanscope-cli", help="the program, as each worker finds it")
    # argparse cannot tell arguments behind the two hyphens from its own where positional ones come first.
    words = sys.argv[1:] + ["--"]
    at = words.index("--")
    options, arguments = parser.parse_args(words[:at]), words[at + 1 : -1]
    cluster = options.scheduler or LocalCluster(threads_per_worker=1)
    with Client(cluster) as client:
        count = sweep(client, options.folder, options.cli, options.scenario, arguments, options.shards)
    print(f"{count} of {options.shards} shards were run; {options.folder} is complete")


if __name__ == "__main__":
    main()
