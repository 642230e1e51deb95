# make demo, make test: set up everything they need in .venv and run. Python 3.11+, pip and make are enough.
PYTHON ?= python3
VENV ?= .venv
BIN = $(VENV)/bin

.PHONY: demo test lint bench docs charts wheel clean

demo: $(VENV)/ready-run
	$(BIN)/tline line hydraulic --radius "10 cm" --wave-speed 1500 --density 980
	$(BIN)/tline demo -o out

test: $(VENV)/ready-test
	$(BIN)/python -m pytest -n auto --dist worksteal

lint: $(VENV)/ready-dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/pyright --pythonpath $(BIN)/python
	$(BIN)/lint-imports

bench: $(VENV)/ready-bench
	$(BIN)/python -m benchmarks.time_to_answer
	$(BIN)/python -m benchmarks.kernel
	$(BIN)/python -m benchmarks.cheapest_grid
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m benchmarks.sweeps
	$(BIN)/python -m benchmarks.large_network
	$(BIN)/python -m benchmarks.circuits
	$(BIN)/python -m benchmarks.shipped_networks
	$(BIN)/python -m benchmarks.settling_networks
	$(BIN)/python -m benchmarks.passivity
	$(BIN)/python -m benchmarks.touchstone
	$(BIN)/python -m benchmarks.friction

docs: $(VENV)/ready-dev
	$(BIN)/python docs/generate.py
	$(BIN)/python docs/generate_drives.py
	$(BIN)/python docs/generate_losses.py
	$(BIN)/python docs/generate_measured.py
	$(BIN)/python docs/generate_tasks.py

charts: $(VENV)/ready-dev
	$(BIN)/python docs/generate_charts.py

wheel:
	PYTHON=$(PYTHON) .ci/wheel

clean:
	rm -rf $(VENV) out

$(VENV)/ready-run: EXTRA =
$(VENV)/ready-test: EXTRA = [test]
$(VENV)/ready-bench: EXTRA = [test,bench]
$(VENV)/ready-dev: EXTRA = [dev]
$(VENV)/ready-%: pyproject.toml
	test -d $(VENV) || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --editable ".$(EXTRA)"
	touch $@
