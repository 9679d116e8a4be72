# What CI does, a person can run: `make test` is everything but the long benches.
# Needs: Rust by rustup, Python 3.11 or later with venv, gcc, make. Installs the rest.

SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
LOGS := fixtures/logs

.PHONY: test tools fmt lint rust docs embedded python bench bench-short demo clean

test: tools fmt lint rust docs embedded python bench-short
	@echo "all checks passed"

tools:
	@command -v cargo >/dev/null || { echo "cargo is missing: install Rust with rustup"; exit 1; }
	@command -v gcc >/dev/null || { echo "gcc is missing: install it with your package manager"; exit 1; }
	@$(PYTHON) -c 'import sys, venv; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "Python 3.11 or later with venv is missing"; exit 1; }
	rustup target add thumbv7em-none-eabihf
	rustup component add clippy rustfmt

fmt:
	cargo fmt --all --check

lint:
	cargo clippy --workspace --all-targets -- -D warnings

# Unit, property, Monte-Carlo and command-line tests, and every example in the documentation.
rust:
	cargo test --workspace

docs:
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

# The core builds for a Cortex-M4F: no operating system, no heap to link with.
embedded:
	cargo build --release --package cg-core --target thumbv7em-none-eabihf

# The Python package in a fresh environment: build, tests, stubs against the binary, lint.
python:
	$(PYTHON) -m venv $(VENV)
	$(VENV)/bin/python -m pip install --quiet -r crates/cg-py/requirements-dev.txt
	VIRTUAL_ENV=$(CURDIR)/$(VENV) $(VENV)/bin/maturin develop --release -m crates/cg-py/Cargo.toml
	$(VENV)/bin/python -m pytest -q -c crates/cg-py/pyproject.toml crates/cg-py/tests
	$(VENV)/bin/python -m mypy.stubtest cgheight
	$(VENV)/bin/ruff check crates/cg-py
	$(VENV)/bin/ruff format --check crates/cg-py

# Every bench once on little data: shows that they run, measures nothing.
bench-short:
	CG_BENCH_ROWS=50000 cargo bench --package cg-bench -- --sample-count 1 --sample-size 1

# All benches, ten million rows; writes benches/RESULTS.md.
bench:
	benches/run.sh

demo:
	cargo run --release --package cg-cli -- estimate $(LOGS)/*.csv $(LOGS)/*.csv.gz \
	  --vehicle fixtures/vehicles/kraz.toml --truth $(LOGS)/truth.json

clean:
	cargo clean
	rm -rf $(VENV)
