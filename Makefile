# `make test` is what CI runs: everything except the long benches.
# It needs Rust from rustup, Python 3.11 or later with venv, gcc and make, and installs the rest.

SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
LOGS := fixtures/logs
SUDO := $(shell [ "$$(id -u)" = 0 ] || echo sudo)

.PHONY: test tools fmt lint rust docs firmware firmware-tools firmware-budgets cg guest fuzz fuzz-tools mutants mutants-short mutants-tool soak rollover-table venv python bench bench-short demo clean

test: tools fmt lint rust docs firmware guest python bench-short
	@echo "all checks passed"

tools:
	@command -v cargo >/dev/null || { echo "cargo is missing: install Rust with rustup"; exit 1; }
	@command -v gcc >/dev/null || { echo "gcc is missing: install it with your package manager"; exit 1; }
	@$(PYTHON) -c 'import sys, venv; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "Python 3.11 or later with venv is missing"; exit 1; }
	rustup target add thumbv7em-none-eabihf
	rustup component add clippy rustfmt
	@missing=; for need in chromium:chromium chromedriver:chromium-driver java:default-jre-headless; do \
	  command -v $${need%%:*} >/dev/null || missing="$$missing $${need##*:}"; done; \
	if [ -n "$$missing" ]; then $(SUDO) apt-get update -qq && $(SUDO) apt-get install -y -qq $$missing; fi

fmt:
	cargo fmt --all --check

lint:
	cargo clippy --workspace --all-targets -- -D warnings

# Unit, property, Monte-Carlo and command-line tests, and every example in the documentation.
rust: firmware-tools
	cargo test --workspace --no-fail-fast

docs:
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

# The estimator on an emulated Cortex-M4F: budgets, no heap, no panic, answers bit-identical to the
# host's. (`make rust` tests the C library there.)
firmware: firmware-tools
	cd firmware && cargo fmt --check && cargo clippy --release --bins --lib -- -D warnings
	$(PYTHON) firmware/check.py

# Measures the costs again and writes them into firmware/budgets.toml; the limits remain.
firmware-budgets: firmware-tools
	$(PYTHON) firmware/check.py --update

firmware-tools:
	@command -v qemu-system-arm >/dev/null && command -v arm-none-eabi-gcc >/dev/null \
	  || { $(SUDO) apt-get update && $(SUDO) apt-get install --yes --no-install-recommends \
	  qemu-system-arm gcc-arm-none-eabi libnewlib-arm-none-eabi; }

# The program in the build that users have.
cg:
	cargo build --release --package cg-cli

# `cg run` on real SocketCAN: a kernel with vcan in QEMU plays a drive and loads the bus for a minute.
guest: venv cg
	guest/run.sh target/release/cg $(VENV)

# The Python package in a fresh environment with every extra.
venv:
	$(PYTHON) -m venv $(VENV)
	$(VENV)/bin/python -m pip install --quiet -r crates/cg-py/requirements-dev.txt
	VIRTUAL_ENV=$(CURDIR)/$(VENV) $(VENV)/bin/maturin develop --release --extras all -m crates/cg-py/Cargo.toml

# The Python package: tests (the HTML report in Chromium, Spark, the notebook), stubs against the
# binary, lint. Then its wheel with numpy alone.
python: venv cg
	CG=$(CURDIR)/target/release/cg $(VENV)/bin/python -m pytest -q -c crates/cg-py/pyproject.toml crates/cg-py/tests
	$(VENV)/bin/python -m mypy --config-file crates/cg-py/pyproject.toml crates/cg-py/python/cgheight
	$(VENV)/bin/python -m mypy.stubtest cgheight._native --mypy-config-file crates/cg-py/pyproject.toml
	$(VENV)/bin/ruff check --config crates/cg-py/pyproject.toml crates/cg-py benches/python
	$(VENV)/bin/ruff format --config crates/cg-py/pyproject.toml --check crates/cg-py benches/python
	rm -rf $(VENV)/clean && $(PYTHON) -m venv $(VENV)/clean
	$(VENV)/clean/bin/python -m pip install --quiet ./crates/cg-py
	$(VENV)/clean/bin/python -m doctest crates/cg-py/python/cgheight/__init__.py

# Coverage-guided fuzzing of all code that reads foreign input, one minute each. Findings are in fuzz/artifacts:
# fix the code, then keep the input in fuzz/seeds. `make test` runs the kept seeds and hundreds of mutations of each.
FUZZ_SECONDS := 60
FUZZ_TARGETS := log_reader candump dbc vehicle_file calibration_file state_file estimator_push
fuzz: fuzz-tools
	@set -e; cd fuzz; for target in $(FUZZ_TARGETS); do mkdir -p corpus/$$target; \
	  cargo +nightly fuzz run -s none $$target corpus/$$target seeds/$$target -- \
	  -max_total_time=$(FUZZ_SECONDS) -timeout=10 -rss_limit_mb=1024; done

fuzz-tools:
	@rustup run nightly rustc --version >/dev/null 2>&1 || rustup toolchain install nightly --profile minimal
	@cargo fuzz --version >/dev/null 2>&1 || cargo install cargo-fuzz --locked

# Mutation test of cg-core (2200 mutants; some hours): its own tests must notice at least 90 %.
# A sample of 170: make mutants MUTANTS='--sharding round-robin --shard 3/13'
MUTANTS :=
LEAST_PERCENT := 90
mutants: mutants-tool
	rm -rf target/mutants.out
	CARGO_TARGET_DIR=$(CURDIR)/target/mutants cargo mutants --package cg-core --test-package cg-core --output target $(MUTANTS) \
	  || [ $$? -le 3 ] # 2: some were missed, 3: some timed out; both are counted below
	@$(PYTHON) -c 'import json, sys; o = json.load(open("target/mutants.out/outcomes.json")); \
	  killed = o["caught"] + o["timeout"]; viable = killed + o["missed"]; \
	  print(killed, "of", viable, f"mutants killed ({100 * killed / viable:.1f} %);", o["unviable"], "do not compile"); \
	  sys.exit(100 * killed < $(LEAST_PERCENT) * viable)'

# A dozen mutants, to show that the test works. Such a small sample scatters, so a quarter may be missed.
mutants-short:
	$(MAKE) mutants MUTANTS='--sharding round-robin --shard 0/180' LEAST_PERCENT=75

mutants-tool:
	@cargo mutants --version >/dev/null 2>&1 || cargo install cargo-mutants --locked

# A month with one hour of driving a day through `cg run`: its memory must not grow (`make test`: some minutes a day).
soak:
	CG_SOAK_DRIVES=30 cargo test --release --package cg-cli --test cli a_month -- --nocapture

# The table of docs/plant.md: thresholds compared with the nonlinear plant, 96 cases per vehicle (`make test`: its corners).
rollover-table:
	CG_ROLLOVER_TABLE=1 cargo test --workspace --test rollover the_table -- --nocapture

# Runs every bench once on little data, to show that it works. Measures nothing.
bench-short: venv cg
	CG_BENCH_ROWS=50000 cargo bench --package cg-bench -- --sample-count 1 --sample-size 1
	CG_BENCH_LOGS=10 OPENBLAS_NUM_THREADS=1 $(VENV)/bin/python benches/python/logs.py >/dev/null
	CG_BENCH_TRIPS=10 CG=$(CURDIR)/target/release/cg $(VENV)/bin/python benches/python/spark_trips.py >/dev/null

# All benches with ten million rows and a thousand logs; writes benches/RESULTS.md. Run `make python` first.
bench: firmware-tools
	benches/run.sh

demo:
	cargo run --release --package cg-cli -- estimate $(LOGS)/*.csv $(LOGS)/*.csv.gz \
	  --vehicle fixtures/vehicles/kraz.toml --truth $(LOGS)/truth.json

clean:
	cargo clean
	rm -rf $(VENV)
