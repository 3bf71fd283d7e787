# Everything needs only make, a C++17 compiler and Python 3.11 or later; the rest comes from pip,
# into a virtual environment in $(VENV). The package is installed anew when its sources change.

PYTHON ?= python3
VENV ?= .venv

BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
SOURCES := pyproject.toml CMakeLists.txt $(wildcard lammps_inputs/*.in) \
           $(shell find plugins pyscripts -type f -name '*.cpp' -o -name '*.h' -o -name '*.py')

.PHONY: help demo test science lint clean

help:
	@echo "make demo      run the scene 'demo': division, crowding and removal of cells"
	@echo "make test      check everything but the long science runs"
	@echo "make science   the long science runs"
	@echo "make lint      ruff and mypy"
	@echo "make clean     remove the virtual environment, builds and caches, but no runs"
	@echo "Variables: PYTHON=$(PYTHON), the interpreter; VENV=$(VENV), the virtual environment"

demo: $(INSTALLED)
	$(BIN)/skin run demo -o runs/demo --force

test: $(INSTALLED)
	$(BIN)/python -m pytest

science: $(INSTALLED)
	$(BIN)/python -m pytest -m slow

lint: $(INSTALLED)
	$(BIN)/python -m ruff check .
	MYPYPATH=pyscripts $(BIN)/python -m mypy

clean:
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache
	find plugins pyscripts tests -type d -name __pycache__ -prune -exec rm -rf {} +

$(INSTALLED): $(BIN)/python $(SOURCES)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check ".[test]"
	@touch $@

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "error: PYTHON=$(PYTHON): must be Python 3.11 or later" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)
