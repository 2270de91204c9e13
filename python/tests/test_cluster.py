"""Campaigns on a cluster: the same bytes as on one machine, and what is said of a shard that cannot be run."""

import pathlib

import pytest

from counterpoise import cluster

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"

CAMPAIGN = """
[sweep]
samples = 12
seed = 5
[[sweep.variation]]
parameter = "inertia"
low = 0.8
high = 1.25
"""


@pytest.fixture
def project(tmp_path):
    text = (EXAMPLES / "direct-gimbal/project.toml").read_text()
    (tmp_path / "project.toml").write_text(text.replace("[verify]\n", "[verify]\nduration = 1.0\nsettle = 0.3\n") + CAMPAIGN)
    return tmp_path


def test_shards_of_a_cluster_make_the_bytes_of_one_machine(project):
    distributed = pytest.importorskip("dask.distributed")
    command = [cluster.sys.executable, "-m", "counterpoise"]
    cluster.run_command([*command, "sweep", str(project), "-o", str(project / "one"), "-q"])
    done = []
    with distributed.Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client:
        merged = cluster.sweep_on_cluster(client, project, project / "many", shards=3, progress=lambda *how: done.append(how))
        again = cluster.sweep_on_cluster(client, project, project / "many", shards=3, progress=lambda *how: done.append(how))
        said = cluster.map_commands(client, [["check", str(project), "--json", "-q"]] * 2)
    assert done == [(1, 3), (2, 3), (3, 3)], "the second call runs no shard again"
    assert merged.read_bytes() == again.read_bytes() == (project / "one/samples.parquet").read_bytes()
    assert said[0] == said[1] and '"schema"' in said[0]


def test_a_shard_that_cannot_be_run_is_named_with_its_reason(project):
    command = [cluster.sys.executable, "-m", "counterpoise"]
    with pytest.raises(RuntimeError, match="the last is 2"):
        cluster.run_shard(command, str(project), 3, 3)
    with pytest.raises(ValueError, match="at least 1 shard"):
        cluster.sweep_on_cluster(None, project, project / "none", shards=0)


def test_a_file_is_written_whole_or_not_at_all(tmp_path):
    cluster.write_whole(tmp_path / "shard", b"whole")
    with pytest.raises(TypeError):
        cluster.write_whole(tmp_path / "shard", "text")
    assert (tmp_path / "shard").read_bytes() == b"whole"
    assert [path.name for path in tmp_path.iterdir()] == ["shard"]
