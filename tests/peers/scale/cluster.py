"""Runs a campaign on a local Dask cluster of two workers, kills one while it computes, and compares the merged bytes with those of one machine.

    pip install "dask[distributed]"
    python tests/peers/scale/cluster.py target/release/counterpoise PROJECT SHARDS

The script fails if the bytes differ, or if the kill came too late to interrupt anything.
"""

import hashlib
import importlib
import os
import pathlib
import shutil
import signal
import sys
import tempfile
import threading
import time

from dask.distributed import Client, LocalCluster

ROOT = pathlib.Path(__file__).resolve().parents[3]


def helper(place):
    """Returns the module of the package without its compiled part, which it does not need. Workers import it from a folder in their path."""
    name = "counterpoise_cluster"
    shutil.copy(ROOT / "python/counterpoise/cluster.py", place / f"{name}.py")
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(place), os.environ.get("PYTHONPATH")]))
    sys.path.insert(0, str(place))
    return importlib.import_module(name)


def kill_worker_later(cluster, first_shard, killed):
    """Kills one of the workers after the first shard has come back."""
    first_shard.wait()
    worker = next(iter(cluster.workers.values()))
    killed.append((worker.process.pid, time.perf_counter()))
    os.kill(worker.process.pid, signal.SIGKILL)


def main(program, project, shards):
    command = [str(pathlib.Path(program).absolute())]
    os.environ["RAYON_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        cluster_module = helper(place)
        started = time.perf_counter()
        cluster_module.run_command([*command, "sweep", project, "-o", str(place / "one"), "-q"])
        alone_s = time.perf_counter() - started
        expected = (place / "one/samples.parquet").read_bytes()

        first_shard, killed, finished = threading.Event(), [], []
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            def progress(done, of):
                finished.append(time.perf_counter())
                print(f"{done} of {of} shards", flush=True)
                first_shard.set()

            threading.Thread(target=kill_worker_later, args=(cluster, first_shard, killed), daemon=True).start()
            started = time.perf_counter()
            merged = cluster_module.sweep_on_cluster(
                client, project, place / "many", shards=shards, program=command, progress=progress)
            cluster_s = time.perf_counter() - started
        found = merged.read_bytes()
        assert killed, "no worker was killed"
        after = sum(moment > killed[0][1] for moment in finished)
        assert after > 0, "the kill came after the last shard: use more shards"
        assert found == expected, "the merged bytes differ from those of one machine"
        print(f"one machine {alone_s:.1f} s, two workers with one killed {cluster_s:.1f} s, {after} of {shards} shards after the kill")
        print(f"the same {len(found)} bytes, SHA-256 {hashlib.sha256(found).hexdigest()[:16]}")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
