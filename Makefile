# make demo     install into .venv and run the main job on built-in input
# make docs     build the documentation as a site into site/; warnings are errors
# make test     install what the tests need, then lint, types, import layers, tests and doctests: the gate of every change
# make fix      write every generated file that tests compare; make fix STEPS="schema format" for some
# make test-changed   the tests that call what changed since the branch left main (BASE=COMMIT), at most two minutes
# make record-calls   which functions each test calls, for test-changed; once, then when many tests have changed
# make live     the tests that need a real clock, a browser, another program, a port or a kill; a failure is repeated once
# make test-room ROOM=core   the tests and doctests of one room
# make types    mypy for Linux, macOS and Windows; make lint checks Linux alone
# make sweeps   types on all systems, then the long tests: fuzzing, mutation, killed processes, every built-in trial in both worlds
# make soak     the tests that take longer than CI allows, and 2000 mutated files of every kind
# make flaky TESTS=tests/data   tests whose outcome differs in random orders, on a busy machine or without compiled kernels
# make smoke    build the wheel and the sdist, and try the wheel in bare environments
# Without its bytecode, each process of a test would compile the sources again.
unexport PYTHONDONTWRITEBYTECODE
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT ?= demo
ROOM ?= core
BASE ?= main
TESTS ?= tests
WORKERS ?= auto
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --retries 5 -c constraints.txt
PYTEST := $(BIN)/python -m pytest
PARALLEL := -n $(WORKERS) --maxprocesses 4

.PHONY: demo fix test test-changed record-calls flaky doctests live test-room sweeps soak lint types types-linux types-darwin types-win32 docs picture dist smoke rehearse clean

demo: $(VENV)/installed
	$(BIN)/crowdbot demo --out $(OUT) --force

# A test file goes to one worker as a whole, so that its fixtures are made once.
test: $(VENV)/installed-dev
	tests/system-packages gate
	$(MAKE) --jobs=2 --output-sync=target lint doctests
	$(PYTEST) $(PARALLEL) --dist loadfile --durations=30 --cache-clear -o cache_dir=.pytest_cache/gate tests

fix: $(VENV)/installed-dev
	$(BIN)/python tools/fix.py $(STEPS)

test-changed: $(VENV)/installed-dev
	$(BIN)/python tools/changed.py --base $(BASE)

record-calls: $(VENV)/installed-dev
	$(BIN)/python tools/changed.py --record $(RECORD)

flaky: $(VENV)/installed-dev
	$(BIN)/python tools/flaky.py $(TESTS)

# Before the tests: the examples compile most kernels, nine tenths of their time on an empty cache. A module goes to one
# worker as a whole, so that two workers rarely compile the same kernel.
doctests: $(VENV)/installed-dev
	$(PYTEST) $(PARALLEL) --dist loadfile --cache-clear -o cache_dir=.pytest_cache/doctests --doctest-modules src/crowdbot

live: $(VENV)/installed-dev
	tests/system-packages live
	$(BIN)/python tools/live.py --workers $(WORKERS)

test-room: $(VENV)/installed-dev
	$(PYTEST) $(PARALLEL) --doctest-modules src/crowdbot/$(ROOM) $(wildcard tests/$(ROOM))

sweeps: $(VENV)/installed-dev
	tests/system-packages live
	$(MAKE) --output-sync=target types
	$(PYTEST) $(PARALLEL) -m "sweep and not soak"

soak: $(VENV)/installed-dev
	tests/system-packages live
	$(PYTEST) $(PARALLEL) -m soak || test $$? -eq 5 # 5: no test has the marker
	$(BIN)/python tools/fuzz_readers.py --count 2000

lint: $(VENV)/installed-dev
	$(BIN)/ruff check src studies tests tools
	$(BIN)/ruff check --preview --select PLW1514 src studies tests tools # files of text without an encoding
	$(BIN)/ruff format --check src studies tests tools
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python tools/house.py

# A cache of one system is of no use to another.
types: types-linux types-darwin types-win32

types-linux: $(VENV)/installed-dev
	$(BIN)/mypy

types-darwin types-win32: types-%: $(VENV)/installed-dev
	$(BIN)/mypy --platform $* --cache-dir .mypy_cache/$*

docs: $(VENV)/installed-dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict

picture: $(VENV)/installed
	$(BIN)/python tools/picture.py docs/crossing-flows.png

dist: $(VENV)/installed-dev
	rm -rf dist
	$(BIN)/python -m build --outdir dist
	$(BIN)/python tools/release.py check dist

smoke: dist
	$(BIN)/python tools/smoke.py dist

rehearse: dist
	$(BIN)/python tools/release.py rehearse dist

$(VENV)/bin/python:
	tests/system-packages --venv $(PYTHON)
	$(PYTHON) -m venv $(VENV)

$(VENV)/installed: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(PIP) -e .
	touch $@

# JuPedSim comes without its viewer, 1.3 GB of Qt and VTK. Tests import a small part of the modules: no bytecode of the others.
$(VENV)/installed-dev: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(PIP) --no-compile -e ".[dev]"
	$(PIP) --no-deps jupedsim
	touch $(VENV)/installed $@

clean:
	rm -rf $(VENV) build dist site $(OUT) .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache src/*.egg-info
