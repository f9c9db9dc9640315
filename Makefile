# Everything runs in a virtual environment of its own; python3 with venv, and make, are all that it takes.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/ready
FLAGSHIP := scenarios/FlyingSaw/cyclic_cut

.PHONY: run line test build lint format references pictures benchmark clean

run: build ## build the FMUs and simulate the flagship scenario
	$(BIN)/motionsync run $(FLAGSHIP)

line: $(READY) ## wire a remote axis through RemoteSync into its followers, and tell the errors
	$(BIN)/motionsync line scenarios/line

test: lint ## everything that proves the project
	$(BIN)/python -m pytest --numprocesses auto --maxprocesses 4 --dist worksteal $(PYTEST)

build: $(READY) ## build/native/<FMU>.fmu and build/python/<FMU>.fmu
	$(BIN)/motionsync build

lint: $(READY) ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(READY)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

references: $(READY) ## the cross-check files of all scenarios, from the scripts and the oracles
	$(BIN)/python -m tests.regenerate

pictures: $(READY) ## the README's pictures
	$(BIN)/python -m motionsync_fmu.pages.pictures docs

benchmark: $(READY)
	$(BIN)/python benchmarks/step_cost.py
	$(BIN)/python benchmarks/native_cost.py
	$(BIN)/python benchmarks/batch_throughput.py
	$(BIN)/python benchmarks/plans.py
	$(BIN)/python benchmarks/accuracy.py

clean:
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find build -mindepth 1 ! -name README.md -delete
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(READY): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --editable '.[test]'
	touch $@
