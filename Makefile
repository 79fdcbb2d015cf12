# Everything a developer runs. Each target does its own set-up: a virtual environment in .venv, locked
# dependencies, the native search kernel built in place.
PYTHON ?= python3
BIN := .venv/bin

# Without compiled modules every process that a test starts would compile all that it imports.
unexport PYTHONDONTWRITEBYTECODE

PACKAGES := planner proxy utility_specs studies
.PHONY: setup demo test test-full test-system lint bench study study-traffic qualify transparency wheel deb man lock clean FORCE

setup: .venv/ready .venv/compiled

.venv/bin/python:
	$(PYTHON) -m venv .venv

.venv/locked: requirements.lock | .venv/bin/python
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements.lock
	touch $@

# The editable installation knows the modules that there were; it is renewed when one comes or goes.
.venv/modules: FORCE | .venv/bin/python
	@find $(PACKAGES) -name '*.py' | sort > $@.new
	@if cmp -s $@ $@.new; then rm $@.new; else mv $@.new $@; fi

.venv/ready: .venv/locked .venv/modules pyproject.toml CMakeLists.txt $(wildcard planner/native/* proxy/profiling/native/*)
	$(BIN)/python -m pip install --quiet --no-build-isolation --no-deps -e .
	touch $@

# Tests are compiled here once: else each of the processes that run them would do so for itself, all at the same time.
.venv/compiled: | .venv/ready
	-@ls -d tests/*/ | grep -v __pycache__ | xargs -n 6 -P $$(nproc) $(BIN)/python -m pytest -qq --collect-only >/dev/null 2>&1
	@touch $@

# The network of the simulation study; its wheels are for x86_64 only, and nothing but studies needs them.
.venv/ns3: studies/ns3/requirements.txt | .venv/locked
	if [ "$$(uname -m)" = x86_64 ]; then $(BIN)/python -m pip install --quiet --require-hashes --no-deps -r $<; fi
	touch $@

demo: setup
	$(BIN)/sendworthy demo $(DEMO)

# More at a time than there are cores, for tests of sessions wait for each other most of the time. Tests of one module stay
# together: they may share a daemon. CONTRIBUTING.md says which test belongs where.
# One that hangs says after five minutes where.
WORKERS ?= $(shell expr 2 \* $$(nproc))
PYTEST := $(BIN)/python -m pytest --numprocesses $(WORKERS) --dist loadscope --no-loadscope-reorder \
	--override-ini faulthandler_timeout=300

test: setup
	$(PYTEST) -m "not system and not full"

# All that needs no root, with more examples, but for the short tests of the studies, which `test` has. What studies call is
# no proof of it, so it does not count as covered; nor does what takes long, as it would take three times as long.
test-full: setup .venv/ns3
	@rm -rf build/coverage && mkdir -p build/coverage
	COVERAGE_FILE=$(CURDIR)/build/coverage/data $(PYTEST) -m "not system and not full" --hypothesis-profile=full \
	    --ignore=tests/studies --cov --cov-fail-under=95
	$(PYTEST) -m "full and not system" --hypothesis-profile=full

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: setup
	$(BIN)/python -m studies.benchmarks

# The simulation study of the paper and beyond, on ns-3: writes studies/RESULTS.md and its figures anew. It says at first how
# many hours that takes, keeps what it has flown in build/study and goes on from there. QUICK=1 takes a minute and writes to
# build/study, DASK=ADDRESS sends the flights to a Dask cluster. At last it flies the benchmark, for its leaderboard.
study: setup .venv/ns3
	$(BIN)/python -m studies.study $(if $(QUICK),--extent quick --page build/study/quick/RESULTS.md) $(if $(DASK),--dask $(DASK))
	$(BIN)/sendworthy bench --policy studies.bench.example:Faded $(if $(QUICK),--missions paper-mixed) \
	    --leaderboard $(if $(QUICK),build/study/quick,studies)/results/leaderboard.md

# What teams reach on bad networks and with real traffic: writes studies/results/view.md, traffic.md, unknown.md, drawn.md,
# drawn_unequal.md and drawn_audiences.md anew. The second takes hours, and says how many at first.
study-traffic: setup
	$(BIN)/python -m studies.benchmarks view
	$(BIN)/python -m studies.simulation.traffic --output studies/results/traffic.md
	$(BIN)/python -m studies.simulation.traffic.unknown --output studies/results/unknown.md
	$(BIN)/python -m studies.simulation.traffic.drawn --output studies/results/drawn.md
	$(BIN)/python -m studies.simulation.traffic.drawn --unequal --seconds 110 --output studies/results/drawn_unequal.md
	$(BIN)/python -m studies.simulation.traffic.drawn --unequal --audiences --seconds 60 \
	    --output studies/results/drawn_audiences.md

test-system: setup .venv/ns3
	tests/system/run

# Compares what applications see with what they see behind Zenoh routers, and writes deploy/TRANSPARENCY.md anew.
transparency: setup
	WRITE_TRANSPARENCY=1 ONLY=tests/transparency tests/system/run

# The long runs, five hours of them, or some (STAGES="soak kills"): writes studies/results/qualification.md anew, which tells
# when each was run last. Needs what test-system needs.
qualify: setup
	$(BIN)/python -m studies.qualification $(STAGES)

# The wheel of this platform and this Python, in dist.
wheel: setup
	$(BIN)/python -m pip wheel --quiet --no-build-isolation --no-deps --wheel-dir dist .

# The Debian package, in dist; ARCH=arm64 for a Raspberry Pi needs g++-aarch64-linux-gnu. deploy/debian/build says what is in it.
deb: setup
	deploy/debian/build $(ARCH)

# Writes the manual page anew, from the parser of the command line.
man: setup
	$(BIN)/python -m studies.man_page deploy/man/sendworthy.1

# Locks the dependencies of all platforms with their hashes, of developers and of packages; needs uv on the PATH.
LOCK := uv pip compile --quiet --universal --generate-hashes --python-version 3.11 --no-emit-index-url --no-header \
    --no-annotate --no-strip-extras pyproject.toml
EXTRAS := completion page record ros2 top
lock:
	$(LOCK) --all-extras --group dev --output-file requirements.lock
	$(LOCK) $(EXTRAS:%=--extra %) --constraints requirements.lock --output-file deploy/debian/requirements.lock

clean:
	rm -rf .venv build dist
