"""Makes the files beside it: python make.py, with pyarrow 26.0.1 and pandas 3.1.1.

All hold the table of `written_by_others` in ../parquet.rs, each in another way to write it.
"""

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

ROWS = 6
SECS = [i / 100 for i in range(ROWS)]
COLUMNS = {
    "time": SECS,
    "root_x": [1.5 * t for t in SECS],
    "root_y": [0.0] * ROWS,
    "root_z": [0.95] * ROWS,
    "root_yaw": [-t for t in SECS],
    "left_elbow": [0.125, None, 0.375, 0.5, None, 0.75],
    "neck_x": [float("nan"), 0.25, 0.25, 0.25, 0.25, 0.25],
}
FLOATS = {name: pa.array(values, pa.float64()) for name, values in COLUMNS.items()}
TABLE = pa.table(FLOATS)


def write(name, table, **how):
    pq.write_table(table, f"{name}.parquet", store_schema=False, **how)


# The defaults: Snappy and dictionaries; here in two row groups.
write("snappy", TABLE, row_group_size=4)
write("pages_v2", TABLE, row_group_size=4, data_page_version="2.0")
write("split", TABLE, use_dictionary=False, use_byte_stream_split=True, compression="none")
narrow = pa.schema([(name, pa.float64() if name == "time" else pa.float32()) for name in COLUMNS])
write("floats", TABLE.cast(narrow))
whole = {"frame": pa.array(range(ROWS), pa.uint8())}
points = {f"head_{axis}": FLOATS[f"root_{axis}"] for axis in "xyz"}
write("frames", pa.table(whole | points))
# Rows of a larger table: pandas writes their old numbers beside them.
pd.DataFrame({"frame": range(ROWS)} | {n: COLUMNS[n.replace("head", "root")] for n in points}
             ).drop(index=[3]).to_parquet("pandas.parquet")
# pandas has no other type for a column of which nothing is there.
write("nothing", TABLE.set_column(5, "left_elbow", pa.nulls(ROWS)).drop_columns("neck_x"))

# What is refused: the table's first two rows, with one column of another kind.
SMALL = TABLE.slice(0, 2)


def refused(name, at, values, **how):
    write(name, SMALL.set_column(at, SMALL.column_names[at], values), compression="none", **how)


delta = {"frame": "DELTA_BINARY_PACKED"}
write("delta", pa.table({"frame": pa.array(range(ROWS), pa.int64())} | points),
      use_dictionary=False, column_encoding=delta)
write("zstd", SMALL, compression="zstd")
refused("texts", 5, pa.array(["a", "b"]))
refused("lists", 5, pa.array([[1.0, 2.0], []]))
refused("stamps", 0, pa.array([1, 2], pa.timestamp("ms")))
refused("infinite", 6, pa.array([0.0, float("inf")]))
write("others", pa.table({"frame": [1], "head_x": [0.5], "label": ["a"]}), compression="none")
