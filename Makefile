# make setup | demo | test | check | bench | docs | clean.  `make demo` is the place to start.
SHELL := /bin/bash
VENV ?= .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.situgraph-setup

# Two processes are as fast as it gets: the numeric libraries are told to use one thread each.
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1
PYTEST_JOBS ?= 2

.DEFAULT_GOAL := help
.PHONY: help setup demo test check format bench docs lock clean

help:  ## what can be made
	@awk -F':.*## ' '/^[a-z]+:.*## /{printf "make %-8s %s\n", $$1, $$2}' Makefile

setup: $(STAMP)  ## the virtual environment .venv with the locked dependencies

$(STAMP): requirements/dev.txt pyproject.toml scripts/setup.sh
	@VENV='$(VENV)' scripts/setup.sh
	@touch $@

demo: $(STAMP)  ## the whole system on an embedded building; saves a report in out/demo
	@$(BIN)/situgraph demo -o out/demo

test: $(STAMP)  ## all tests (ARGS="..." goes to pytest)
	@$(BIN)/python -m pytest -n $(PYTEST_JOBS) --dist loadfile $(ARGS)

check: $(STAMP)  ## linter, formatter, types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(STAMP)  ## format the code and sort its imports
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(STAMP)  ## benchmarks
	@$(BIN)/python -m pytest $(or $(ARGS),benchmarks) --benchmark-enable --benchmark-only -p no:xdist

docs: $(STAMP)  ## the tables and figures of docs/ that commands of this repository print
	@$(BIN)/python scripts/docs.py

lock: $(STAMP)  ## the pinned dependencies anew, from pyproject.toml
	@scripts/lock.sh

clean:  ## everything that was made here, but not .venv
	@rm -rf out build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis .benchmarks
	@find src tests examples benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +
