"""Sweeps: a scenario run with many values, on all cores or many computers; rows of results in Parquet files."""
