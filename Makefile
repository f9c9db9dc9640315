# Everything runs in a virtual environment of its own; python3 with venv, and make, are all that it takes.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/ready-native
TESTABLE := $(VENV)/ready-test
ALIVE = while sleep 1; do printf .; done & dots=$$!; trap "kill $$dots; echo" EXIT;
FLAGSHIP := CutToLength/cyclic_orders
# Compiled modules are kept, whatever the environment says: a test run starts hundreds of processes that import them.
unexport PYTHONDONTWRITEBYTECODE
BLOCKS := $(patsubst model/motionsync/%/block.py,%,$(wildcard model/motionsync/*/block.py))

.PHONY: run line quick check test soak build lint types words style imports format references pictures docs benchmark release clean help

run: $(READY) ## simulate the flagship scenario, in an FMU for this machine
	$(BIN)/motionsync run $(FLAGSHIP)

line: $(READY) ## wire a remote axis through RemoteSync into its followers, and print the errors
	$(BIN)/motionsync line

quick: $(TESTABLE) ## what the blocks do, without an FMU: half a minute
	$(BIN)/python -m pytest --quick --numprocesses 2 --dist worksteal tests/model \
		tests/compiler $(PYTEST)

check: $(TESTABLE) ## one block, B=gearing say: its part of quick, and its compiled code
	@$(if $(filter $(B),$(BLOCKS)),:,echo "make check B=<block>: the blocks are $(BLOCKS)" >&2; exit 2)
	$(BIN)/python -m pytest --quick --block $(B) tests/model/$(B) tests/model/test_scenarios.py \
		tests/native/test_same_bits.py::test_compiled_code_gives_the_bits_of_python_in_every_field $(PYTEST)

test: lint ## everything that proves the project; PYTEST="-k edge" passes options on
	$(BIN)/python -m pytest --numprocesses auto --maxprocesses 4 --dist worksteal $(PYTEST)

soak: $(TESTABLE) ## the random tests alone, with ten times as many examples: hours
	$(BIN)/python -m pytest --soak --numprocesses auto --maxprocesses 4 --dist worksteal $(PYTEST)

build: $(READY) ## build/native/<FMU>.fmu and build/python/<FMU>.fmu
	$(BIN)/motionsync build

lint: $(TESTABLE) ## style, types, words, and whether all tests can be imported, side by side
	@$(MAKE) --no-print-directory --jobs=2 --output-sync types words style imports

types:
	$(BIN)/mypy

words:
	$(BIN)/python -m tools.words

style:
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

imports: # pytest keeps the tests that it has compiled, for all processes of a run
	@found=$$($(BIN)/python -m pytest --collect-only --quiet 2>&1) || { echo "$$found"; exit 1; }

format: $(TESTABLE) ## repair the style
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

references: $(TESTABLE) ## the references of all scenarios, or of B=flying_saw alone, from the oracles
	@$(if $(filter-out $(BLOCKS),$(B)),echo "make references B=<block>: the blocks are $(BLOCKS)" >&2; exit 2,:)
	$(BIN)/python -m tests.regenerate $(B)

pictures: $(READY) ## the pictures of the README and of docs/
	$(BIN)/python -m motionsync_fmu.pages.pictures docs
	$(BIN)/python -m tools.first_picture docs
	$(BIN)/python -m tools.shortest_length_picture docs
	$(BIN)/python -m tools.measured_line_pictures docs

docs: $(VENV)/ready-docs ## build/site: the documentation, which opens from the folder
	@$(BIN)/python -m tools.site

benchmark: $(TESTABLE) ## what a step, a batch, a sweep and a report cost
	$(BIN)/python benchmarks/step_cost.py
	$(BIN)/python benchmarks/native_cost.py
	$(BIN)/python benchmarks/batch_throughput.py
	$(BIN)/python benchmarks/sweeps.py
	$(BIN)/python benchmarks/report.py

release: $(VENV)/ready-release ## build/release: package, FMUs with their pages, site, notes, checksums
	@$(ALIVE) $(BIN)/python -m tools.release

clean: ## remove whatever was made
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find build -mindepth 1 ! -path build/README.md -delete
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

help: ## these lines
	@sed -n 's/^\([a-z]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 12

.SECONDARY:
$(VENV)/ready-%: pyproject.toml # the extra of that name
	@echo "installing motionsync[$*] into $(VENV)"
	@$(ALIVE) $(PYTHON) -m venv $(VENV) && $(BIN)/python -m pip install --quiet --no-compile --editable '.[$*]'
	@touch $@
