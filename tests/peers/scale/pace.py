"""Measures what a mechanism of a campaign costs, and plans a campaign of a million from it.

    python tests/peers/scale/pace.py target/release/counterpoise PROJECT SAMPLES [MECHANISMS]

Two shards of the project's campaign are run on one thread, one of a single sample and one of SAMPLES: the difference is the cost of the samples, and the
rest is the design that every shard makes first. Times are processor times, which other programs on the machine do not change much.
"""

import pathlib
import resource
import subprocess
import sys
import tempfile
import os

HOURS = 3600.0


def run(program, project, folder, shard):
    """Runs a shard; returns its processor time in seconds and the bytes of its file."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [program, "sweep", project, "-o", folder, "--shard", shard, "-q"],
        env={**os.environ, "RAYON_NUM_THREADS": "1"}, capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(done.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    (file,) = pathlib.Path(folder).glob("shard-*.parquet")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, file.stat().st_size


def samples_of(program, project):
    """Returns the number of samples of the project's campaign, from the names of its shards' ranges."""
    text = (pathlib.Path(project) / "project.toml" if pathlib.Path(project).is_dir() else pathlib.Path(project)).read_text()
    lines = text.split("[sweep]", 1)[1].splitlines() if "[sweep]" in text else []
    stated = [line.split("=")[1].split("#")[0] for line in lines if line.replace(" ", "").startswith("samples=")]
    return int(stated[0])


def main(program, project, count, mechanisms):
    all_samples = samples_of(program, project)
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as many:
        first_s, first_bytes = run(program, project, one, f"0/{all_samples}")
        shards = max(1, all_samples // count)
        in_shard = -(-all_samples // shards)
        whole_s, whole_bytes = run(program, project, many, f"0/{shards}")
    per_sample_s = (whole_s - first_s) / (in_shard - 1)
    per_sample_bytes = (whole_bytes - first_bytes) / (in_shard - 1)
    design_s = first_s - per_sample_s
    peak_mib = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    total_h = mechanisms * per_sample_s / HOURS
    print(f"{in_shard} samples of {project}: {per_sample_s:.3f} s of processor a mechanism, {design_s:.1f} s a shard for its design")
    print(f"{per_sample_bytes:.0f} bytes a mechanism, {peak_mib:.0f} MiB at most")
    print(f"{mechanisms} mechanisms: {total_h:.1f} processor hours, {mechanisms * per_sample_bytes / 2**20:.0f} MiB of samples")
    # as many samples in a shard as make its design a hundredth of its time
    fair = max(1, round(100 * design_s / per_sample_s))
    print(f"shards of {fair} mechanisms spend 1 % on designs: {-(-mechanisms // fair)} shards of {fair * per_sample_s / 60:.1f} processor minutes")


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]) if len(sys.argv) == 5 else 1_000_000)
