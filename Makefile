# Everything a developer runs. Each target does its own set-up: a virtual environment in .venv, locked
# dependencies, the native search kernel built in place.
PYTHON ?= python3
BIN := .venv/bin

PACKAGES := planner proxy utility_specs studies
SESSIONS := tests/proxy/bridge
DAEMONS := tests/ros2 $(addprefix tests/proxy/,commands test_daemon.py test_installations.py test_partition.py) tests/deploy
SEARCH := tests/planner

.PHONY: setup demo test lint bench study qualify test-system transparency lock clean FORCE

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

# Four at a time, for most wait for each other most of the time: what goes between daemons; between sessions, and then
# the searches; the studies; all else.
PYTEST := $(BIN)/python -m pytest -m "not system"
COVERED = COVERAGE_FILE=$(CURDIR)/build/coverage/$(1) $(PYTEST) --cov --cov-report=
test: setup
	@rm -rf build/coverage && mkdir -p build/coverage
	@$(PYTEST) tests/studies > build/test-studies.log 2>&1 & studies=$$!; \
	$(call COVERED,sessions) $(SESSIONS) $(SEARCH) > build/test-sessions.log 2>&1 & sessions=$$!; \
	$(call COVERED,daemons) $(DAEMONS) > build/test-daemons.log 2>&1 & daemons=$$!; \
	$(call COVERED,rest) $(addprefix --ignore=,$(SESSIONS) $(DAEMONS) $(SEARCH) tests/studies); failed=$$?; \
	wait $$sessions || failed=1; wait $$daemons || failed=1; wait $$studies || failed=1; \
	cat build/test-sessions.log build/test-daemons.log build/test-studies.log; \
	$(BIN)/coverage combine --quiet build/coverage/* && $(BIN)/coverage report --fail-under=95 || failed=1; exit $$failed

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: setup
	$(BIN)/python -m studies.benchmarks

# What teams reach on bad networks: writes studies/results/view.md anew.
study: setup
	$(BIN)/python -m studies.benchmarks view

test-system: setup
	tests/system/run

# Compares what applications see with what they see behind Zenoh routers, and writes deploy/TRANSPARENCY.md anew.
transparency: setup
	WRITE_TRANSPARENCY=1 ONLY=tests/transparency tests/system/run

# The long runs, an hour of them, or some (STAGES="soak kills"): writes studies/results/qualification.md anew, which tells
# when each was run last. Needs what test-system needs.
qualify: setup
	$(BIN)/python -m studies.qualification $(STAGES)

# Locks the dependencies of all platforms with their hashes; needs uv on the PATH.
lock:
	uv pip compile --quiet --universal --generate-hashes --python-version 3.11 --no-emit-index-url --no-header \
	    --no-annotate --extra study --extra ros2 --group dev --output-file requirements.lock pyproject.toml

clean:
	rm -rf .venv build dist
