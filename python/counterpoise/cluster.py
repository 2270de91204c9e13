"""Campaigns on a Dask cluster: the shards of `counterpoise sweep` as tasks, merged into the bytes that one machine writes.

    from dask.distributed import Client
    from counterpoise.cluster import sweep_on_cluster

    with Client("scheduler:8786") as client:
        sweep_on_cluster(client, "project", "out/sweep", shards=64)

Every worker needs this package and must see the project's folder under the same path. The shards come back through the scheduler, so no other
storage is shared. A shard is a pure function of the project, the seed and its number: if a worker is killed, another one runs its shards
again, and if the whole cluster is, the same call goes on from the shards that are in the folder.
"""

from __future__ import annotations

import os
import pathlib
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from typing import Any

#: Exit codes of a command that did its work: all verdicts hold, or one fails.
DONE = (0, 1)


def sweep_on_cluster(
    client: Any,
    project: str | os.PathLike,
    folder: str | os.PathLike,
    *,
    shards: int,
    program: Sequence[str] | None = None,
    retries: int = 10,
    progress: Callable[[int, int], None] | None = None,
) -> pathlib.Path:
    """Runs the campaign of a project in so many shards on a cluster, merges them, and returns the path of `samples.parquet`.

    `client` is a `dask.distributed.Client`. `program` is the command line, by default that of this package. A shard that fails is run up to
    `retries` times more. `progress(done, of)` is called after each shard. Shards that are in the folder are not run again; the merge refuses
    those of another project or version and says which.
    """
    if shards < 1:
        raise ValueError(f"shards = {shards}: there must be at least 1 shard")
    # imported here, so that the package works without Dask
    from dask.distributed import as_completed

    project, folder = pathlib.Path(project).absolute(), pathlib.Path(folder)
    command = list(program) if program is not None else [sys.executable, "-m", "counterpoise"]
    folder.mkdir(parents=True, exist_ok=True)
    missing = [k for k in range(shards) if not (folder / shard_name(k, shards)).is_file()]
    futures = client.map(
        lambda k: run_shard(command, str(project), k, shards), missing, retries=retries, pure=False, key=f"shard-of-{shards}"
    )
    done = shards - len(missing)
    for future, (name, content) in as_completed(futures, with_results=True):
        write_whole(folder / name, content)
        future.release()
        done += 1
        if progress is not None:
            progress(done, shards)
    run_command([*command, "sweep", str(project), "-o", str(folder), "--merge", "-q"])
    return folder / "samples.parquet"


def map_commands(
    client: Any, commands: Sequence[Sequence[str]], *, program: Sequence[str] | None = None, retries: int = 10
) -> list[str]:
    """Runs commands of the command line on a cluster and returns what each printed, in their order.

    It spreads work that has no shards, for example a search of weights for each of many projects:
    `map_commands(client, [["synth", path, "--search", "--json", "-q"] for path in projects])`.
    """
    command = list(program) if program is not None else [sys.executable, "-m", "counterpoise"]
    futures = client.map(lambda words: run_command([*command, *words]), [list(words) for words in commands], retries=retries, pure=False)
    return client.gather(futures)


def shard_name(shard: int, shards: int) -> str:
    """Returns the name of the file of a shard."""
    return f"shard-{shard:06}-of-{shards:06}.parquet"


def run_shard(command: Sequence[str], project: str, shard: int, shards: int) -> tuple[str, bytes]:
    """Runs one shard in a folder of its own and returns the name and the bytes of its file. This is what a worker does."""
    with tempfile.TemporaryDirectory() as place:
        run_command([*command, "sweep", project, "-o", place, "--shard", f"{shard}/{shards}", "-q"])
        name = shard_name(shard, shards)
        return name, (pathlib.Path(place) / name).read_bytes()


def run_command(words: Sequence[str]) -> str:
    """Runs a command and returns what it printed. Raises `RuntimeError` with its message if it did not do its work."""
    done = subprocess.run(list(words), stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode not in DONE:
        raise RuntimeError(f"{' '.join(words)} ended with {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def write_whole(path: pathlib.Path, content: bytes) -> None:
    """Writes a file completely or not at all."""
    descriptor, temporary = tempfile.mkstemp(dir=path.parent, prefix=".shard-")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        pathlib.Path(temporary).unlink(missing_ok=True)
        raise
