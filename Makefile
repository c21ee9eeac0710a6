# Everything runs in a virtual environment that make sets up itself: Python 3.11 and make suffice.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
RESULTS ?= results
QUICK ?=
SECONDS ?= 60
SEED ?= 0
KILLS ?= 200
PEERS ?= .venv-peers

.DEFAULT_GOAL := help
.PHONY: help install maps experiments test test-lowest lint types contracts fuzz torture bench bench-peers bench-growth bench-evaluation bench-fields bench-loss bench-policies docs dist clean

help: ## list these targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1|/' | \
		awk -F'|' '{ printf "  make %-12s %s\n", $$1, $$2 }'

install: $(VENV)/installed ## make the virtual environment and install everything into it

$(VENV)/installed: pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "rssnav needs Python 3.11 or newer, this is " + sys.version.split()[0] + ": call make PYTHON=python3.11")'
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo 'installing into $(VENV), which takes one to two minutes'
	$(BIN)/python -m pip install $$(test -t 1 || echo --quiet) --disable-pip-version-check --constraint constraints.txt --editable '.[dev,docs]'
	@touch $@

maps: install ## compute the RSS maps of both scenarios that are not current
	$(BIN)/rssnav maps --out $(RESULTS)/maps

experiments: install ## the whole paper: maps, training, figures, tables, report (QUICK=1: fewer runs)
	$(BIN)/rssnav experiments --out $(RESULTS) $(if $(QUICK),--quick)

test: install ## run the tests, on up to four processors
	$(BIN)/python -m pytest -n auto --maxprocesses 4 --dist loadfile

test-lowest: ## run the tests on the oldest versions of all libraries, in an environment of their own
	test -x $(VENV)-lowest/bin/python || $(PYTHON) -m venv $(VENV)-lowest
	$(VENV)-lowest/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints-lowest.txt --editable '.[test]'
	$(VENV)-lowest/bin/python -m pytest -W ignore::DeprecationWarning -W ignore::PendingDeprecationWarning

lint: install ## check style and format
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: install ## check types
	$(BIN)/basedpyright

contracts: install ## check that the packages keep their layers
	$(BIN)/lint-imports

fuzz: install ## attack readers, options and the library with mutated inputs (SECONDS=60, SEED=0)
	PYTHONPATH=tests:tests/helpers $(BIN)/python -m fuzz --seconds $(SECONDS) --seed $(SEED)

torture: install ## kill, interrupt, starve and double every command that writes (KILLS=200, SEED=0)
	PYTHONPATH=tests:tests/helpers $(BIN)/python -m torture --kills $(KILLS) --seed $(SEED)

bench: install ## measure the speed of tracer and learning, side by side with plain C
	$(BIN)/python -m pytest tests/benchmarks --benchmark-enable --benchmark-only

bench-peers: install ## trace the same plans with Sionna RT and pyroomacoustics, for docs/performance.md
	test -x $(PEERS)/bin/python || $(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check 'sionna-rt>=1.0' || \
		echo 'bench-peers: sionna-rt cannot be installed here; the table goes without it'
	$(BIN)/python tests/benchmarks/peers.py --sionna $(PEERS)/bin/python

bench-growth: install ## measure time and memory against cells, rooms and order, for docs/performance.md
	$(BIN)/python tests/benchmarks/growth.py

bench-evaluation: install ## measure evaluations of known paths beside a new trace, for docs/performance.md
	$(BIN)/python tests/benchmarks/evaluation.py

bench-fields: install ## measure an unknown polarisation and a further frequency, for docs/performance.md
	$(BIN)/python tests/benchmarks/fields.py

bench-loss: install ## measure limits by loss beside a number of transmissions, for docs/performance.md
	$(BIN)/python tests/benchmarks/loss_limits.py

bench-policies: install ## fly the benchmark's policies in all its buildings, for docs/benchmark.md (an hour; QUICK=1: 3 minutes)
	$(BIN)/rssnav benchmark --out $(RESULTS)/benchmark $(if $(QUICK),--quick)
	$(BIN)/python tests/benchmarks/leaderboard.py $(RESULTS)/benchmark/results.json

docs: install ## build the documentation into docs/_build/html
	@rm -rf docs/api/generated
	$(BIN)/sphinx-build -W --keep-going -b html docs docs/_build/html

dist: install ## build wheel and source archive into dist/
	$(BIN)/python -m pip install --quiet --disable-pip-version-check build
	$(BIN)/python -m build

clean: ## remove the environment, results and caches
	rm -rf $(VENV) $(VENV)-lowest $(PEERS) $(RESULTS) build dist docs/_build docs/api/generated docs/examples docs/sg_execution_times.rst
	rm -rf .pytest_cache .ruff_cache .import_linter_cache .hypothesis .benchmarks
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
