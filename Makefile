# Everything a developer runs. Each target does its own set-up: a virtual environment in .venv, locked
# dependencies, the native search kernel built in place.
PYTHON ?= python3
BIN := .venv/bin

PACKAGES := planner proxy utility_specs studies

.PHONY: setup demo test lint bench qualify test-system transparency lock clean FORCE

setup: .venv/ready

.venv/bin/python:
	$(PYTHON) -m venv .venv

.venv/locked: requirements.lock | .venv/bin/python
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements.lock
	touch $@

# The editable installation knows the modules that there were; it is renewed when one comes or goes.
.venv/modules: FORCE | .venv/bin/python
	@find $(PACKAGES) -name '*.py' | sort > $@.new
	@if cmp -s $@ $@.new; then rm $@.new; else mv $@.new $@; fi

.venv/ready: .venv/locked .venv/modules pyproject.toml CMakeLists.txt $(wildcard planner/native/*)
	$(BIN)/python -m pip install --quiet --no-build-isolation --no-deps -e .
	touch $@

demo: setup
	$(BIN)/sendworthy demo $(DEMO)

# On both cores: the studies beside what is measured for coverage. Their output follows.
test: setup
	@mkdir -p build
	@$(BIN)/python -m pytest -m "not system" tests/studies > build/test-studies.log 2>&1 & studies=$$!; \
	$(BIN)/python -m pytest -m "not system" --ignore=tests/studies --cov --cov-report=term --cov-fail-under=95; \
	failed=$$?; wait $$studies || failed=1; cat build/test-studies.log; exit $$failed

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: setup
	$(BIN)/python -m studies.benchmarks

test-system: setup
	tests/system/run

# Compares what applications see with what they see behind Zenoh routers, and writes deploy/TRANSPARENCY.md anew.
transparency: setup
	WRITE_TRANSPARENCY=1 ONLY=tests/transparency tests/system/run

# The long run: every property with thousands of examples, and a long flight of the demo.
qualify: setup
	$(BIN)/python -m pytest -m "not system" --hypothesis-profile=qualify tests/planner tests/fuzz tests/proxy/core tests/utility_specs
	$(BIN)/sendworthy demo --seconds 120 --json build/qualify-demo.json --picture build/qualify-demo.png

# Locks the dependencies of all platforms with their hashes; needs uv on the PATH.
lock:
	uv pip compile --quiet --universal --generate-hashes --python-version 3.11 --no-emit-index-url --no-header \
	    --no-annotate --extra study --group dev --output-file requirements.lock pyproject.toml

clean:
	rm -rf .venv build dist
