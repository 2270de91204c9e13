"""Opens the samples of a campaign with pandas, Polars and DuckDB, and compares what each finds.

    pip install pandas pyarrow polars duckdb
    counterpoise sweep PROJECT -o FOLDER --json=FOLDER/result.json
    python tests/peers/scale/parquet.py FOLDER

The script fails if a reader finds other columns or other numbers, if a row is missing, or if the shares and quantiles of the JSON result do not follow
from the samples.
"""

import json
import pathlib
import sys

import duckdb
import numpy as np
import pandas
import polars


def main(folder):
    path = folder / "samples.parquet"
    by_pandas = pandas.read_parquet(path)
    by_polars = polars.read_parquet(path)
    by_duckdb = duckdb.sql(f"select * from read_parquet('{path}')").fetchnumpy()
    columns = list(by_pandas.columns)
    assert list(by_polars.columns) == columns and list(by_duckdb) == columns, "the readers find different columns"
    for name in columns:
        one = by_pandas[name].to_numpy()
        others = [by_polars[name].to_numpy(), np.ma.filled(by_duckdb[name], np.nan)]
        assert all(one.tobytes() == other.astype(one.dtype).tobytes() for other in others), f"{name}: the readers find different numbers"
    samples = by_pandas["sample"].to_numpy()
    assert (samples == np.arange(len(samples))).all(), "a sample is missing or out of order"
    figures = [name for name in columns[1:] if not name.startswith("factor_")]
    shards = sorted(folder.glob("shard-*.parquet"))
    together = polars.concat([polars.read_parquet(shard) for shard in shards]).sort("sample")
    assert together.equals(by_polars, null_equal=True) or np.array_equal(together.to_numpy(), by_polars.to_numpy(), equal_nan=True)
    checked = 0
    for row, name in zip(json.loads((folder / "result.json").read_text())["figures"], figures):
        values = by_pandas[name].dropna().to_numpy()
        inside = (values >= row["q05"]).mean(), (values <= row["q95"]).mean(), (values <= row["median"]).mean()
        assert inside[0] >= 0.94 and inside[1] >= 0.94 and inside[2] >= 0.49, (name, inside)
        checked += 1
    print(f"{len(samples)} samples, {len(columns)} columns, {len(shards)} shards, {checked} figures: pandas, Polars and DuckDB agree to the last bit")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]))
