"""A page about the rows of a sweep: DuckDB puts them together to cells, curves and fronts; plotly.js draws these."""
