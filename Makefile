# make demo, make test: set up everything they need in .venv and run. Python 3.11+, pip and make are enough.
PYTHON ?= python3
VENV ?= .venv
BIN = $(VENV)/bin
# pytest rewrites assertions so that they tell what they compared, for 25 s of CPU in each worker: those that fail do
FAILED_AGAIN = $(BIN)/python -m pytest --last-failed --last-failed-no-failures none

.PHONY: demo test test-slow lint bench docs charts site wheel clean

demo: $(VENV)/ready-run
	$(BIN)/tline line hydraulic --radius "10 cm" --wave-speed 1500 --density 980
	$(BIN)/tline demo -o out

test: $(VENV)/ready-test
	$(BIN)/python -m pytest -n auto --dist worksteal --assert=plain || { $(FAILED_AGAIN); exit 1; }

test-slow: $(VENV)/ready-test
	$(BIN)/python -m pytest -n auto --dist worksteal -m slow

lint: $(VENV)/ready-dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/pyright --pythonpath $(BIN)/python
	$(BIN)/lint-imports

bench: $(VENV)/ready-bench
	$(BIN)/python -m benchmarks

docs: $(VENV)/ready-dev
	$(BIN)/python -m docs.generate

charts: $(VENV)/ready-dev
	$(BIN)/python -m docs.generate_charts

site: $(VENV)/ready-site
	$(BIN)/python docs/site/assemble.py out/site-source
	$(BIN)/python -m sphinx -q -W --keep-going -b html out/site-source out/site

wheel:
	PYTHON=$(PYTHON) .ci/wheel

clean:
	rm -rf $(VENV) out

$(VENV)/ready-run: EXTRA =
$(VENV)/ready-test: EXTRA = [test]
$(VENV)/ready-bench: EXTRA = [test,bench]
$(VENV)/ready-dev: EXTRA = [dev]
$(VENV)/ready-site: EXTRA = [site]
$(VENV)/ready-%: pyproject.toml
	test -d $(VENV) || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --editable ".$(EXTRA)"
	touch $@
