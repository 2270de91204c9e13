"""Writes recordings that are damaged, odd or hostile, with the programs that people record with.

    pip install h5py scipy pyarrow
    python tests/peers/recordings/hostile.py recordings/tests/data/hostile

The small files are stored in that folder, and `recordings/tests/hostile.rs` reads them. With a second folder, the bombs (small
files that unfold to gigabytes) are written there as well; they are not stored.
"""

import sys
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io
import scipy.sparse

N = 40
TIME = np.arange(N) * 1e-3
RATE = 0.1 * np.sin(2 * np.pi * 25 * TIME)
CONTROL = 2.0 + RATE
GOOD = {"time": TIME, "hub_rate": RATE, "control": CONTROL}


def link(folder):
    """A symbolic link in a group of the older format: one named as a channel, beside three data sets."""
    time = np.arange(50) * 1e-3
    with h5py.File(folder / "link_old_group.h5", "w") as f:
        f["time"], f["hub_rate"], f["stored"] = time, np.sin(time), np.cos(time)
        f["control"] = h5py.SoftLink("/stored")


def hdf5(folder):
    """Data sets that are no columns of numbers beside three good ones."""
    with h5py.File(folder / "types.h5", "w") as f:
        for name, values in GOOD.items():
            f[name] = values
        f["half"] = RATE.astype(np.float16)
        f["complex"] = RATE + 1j * CONTROL
        f["texts"] = np.array([b"on"] * N)
        f["records"] = np.array([(1, 2.0)] * N, dtype=[("a", "i4"), ("b", "f8")])
        f["flag"] = RATE > 0
        f["short"] = RATE[:-1]
        f["cube"] = np.zeros((N, 2, 2))
        f["fs"] = 1000.0
        f["Hub_Position"] = RATE
    with h5py.File(folder / "matrix.h5", "w") as f:
        f["time"] = TIME
        f["w"] = np.column_stack([RATE, 2 * RATE, 3 * RATE])
        f["wide"] = np.vstack([CONTROL, -CONTROL])
        f["image"] = np.zeros((30, 70))
    with h5py.File(folder / "checksum.h5", "w") as f:
        for name, values in GOOD.items():
            f.create_dataset(name, data=values, chunks=(N,), fletcher32=True)
        place = f["control"].id.get_chunk_info(0).byte_offset
    spoil(folder / "checksum.h5", place + 17)


def spoil(path, place):
    """Turns one bit of a file."""
    data = bytearray(path.read_bytes())
    data[place] ^= 0x10
    path.write_bytes(data)


def matlab(folder):
    """Variables that are no columns of numbers beside three good ones."""
    odd = {
        "complex": RATE + 1j * CONTROL,
        "sparse": scipy.sparse.csc_matrix(np.eye(N)),
        "cells": np.array([RATE, "text"], dtype=object),
        "texts": np.array(["on", "no"]),
        "note": "recorded on a Monday",
        "cube": np.zeros((N, 2, 2)),
        "short": RATE[:-1],
        "image": np.zeros((30, 70)),
        "wide": np.vstack([CONTROL, -CONTROL]),
        "hub-rate": RATE,
    }
    good = {name: values for name, values in GOOD.items() if name != "hub_rate"}
    scipy.io.savemat(folder / "types.mat", {**good, **odd}, do_compression=True)
    scipy.io.savemat(folder / "damaged.mat", GOOD, do_compression=True)
    spoil(folder / "damaged.mat", (folder / "damaged.mat").stat().st_size - 2)
    scipy.io.savemat(folder / "version4.mat", GOOD, format="4")


def parquet(folder):
    """Columns by type, times by unit, codecs, and a page whose checksum does not match."""
    from decimal import Decimal

    numbers = pa.table({**GOOD, "half": RATE.astype(np.float16), "unsigned": np.full(N, 4_000_000_000, np.uint32)})
    odd = {
        "texts": pa.array(["on"] * N),
        "dates": pa.array([0] * N, pa.date32()),
        "lists": pa.array([[1.0, 2.0]] * N),
        "small": pa.array([Decimal("1.25")] * N, pa.decimal128(7, 2)),
        "large": pa.array([Decimal("1.25")] * N, pa.decimal128(30, 2)),
        "HubPosition": pa.array(RATE),
    }
    for name, values in odd.items():
        numbers = numbers.append_column(name, values)
    pq.write_table(numbers, folder / "types.parquet", store_decimal_as_integer=True)
    start = 1_700_000_000
    for unit, size in {"ms": 10**3, "us": 10**6, "ns": 10**9}.items():
        instants = start * size + np.round((0.25 + TIME) * size).astype(np.int64)
        time = pa.array(instants, pa.timestamp(unit, tz="UTC"))
        pq.write_table(pa.table({"time": time, "hub_rate": RATE}), folder / f"timestamp_{unit}.parquet")
    for codec in ["gzip", "lz4", "brotli"]:
        pq.write_table(pa.table(GOOD), folder / f"{codec}.parquet", compression=codec)
    options = {"compression": "none", "use_dictionary": False, "write_page_checksum": True}
    pq.write_table(pa.table(GOOD), folder / "checksum.parquet", **options)
    chunk = pq.ParquetFile(folder / "checksum.parquet").metadata.row_group(0).column(2)
    spoil(folder / "checksum.parquet", chunk.data_page_offset + chunk.total_compressed_size - 5)


def bombs(folder):
    """Small files that unfold to gigabytes."""
    rows = 300_000_000
    with h5py.File(folder / "bomb.h5", "w") as f:
        f.create_dataset("control", shape=(rows,), dtype="f8", chunks=(1 << 20,), compression="gzip")
    scipy.io.savemat(folder / "bomb.mat", {"control": np.zeros(rows, np.uint8)}, do_compression=True)
    writer = None
    for _ in range(30):
        part = pa.table({"control": np.zeros(rows // 30, np.int8)})
        writer = writer or pq.ParquetWriter(folder / "bomb.parquet", part.schema, compression="zstd")
        writer.write_table(part)
    writer.close()


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    hdf5(folder)
    link(folder)
    matlab(folder)
    parquet(folder)
    if len(sys.argv) > 2:
        Path(sys.argv[2]).mkdir(parents=True, exist_ok=True)
        bombs(Path(sys.argv[2]))


if __name__ == "__main__":
    main()
