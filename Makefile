# make demo   install into .venv and run the main job on built-in input
# make docs   build the documentation as a site into site/; warnings are errors
# make test   install what the tests need, then lint, types, floors and tests
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT ?= demo

.PHONY: demo test lint docs picture clean

demo: $(VENV)/installed
	$(BIN)/crowdbot demo --out $(OUT)

test: $(VENV)/installed-dev
	tests/system-packages
	$(MAKE) lint
	$(BIN)/python -m pytest -n auto --maxprocesses 4
	$(BIN)/python -m pytest --doctest-modules src/crowdbot

lint: $(VENV)/installed-dev
	$(BIN)/ruff check src tests tools
	$(BIN)/ruff format --check src tests tools
	$(BIN)/mypy
	$(BIN)/lint-imports

docs: $(VENV)/installed-dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict

picture: $(VENV)/installed
	$(BIN)/python tools/picture.py docs/crossing-flows.png

$(VENV)/installed: pyproject.toml constraints.txt
	tests/system-packages --venv $(PYTHON)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e .
	touch $@

$(VENV)/installed-dev: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[dev]"
	touch $@

clean:
	rm -rf $(VENV) build dist site $(OUT) .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache src/*.egg-info
