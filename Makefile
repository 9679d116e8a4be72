# `make test` is what CI runs: everything except the long benches. `make dist` builds and checks what is published.
# Both need Rust from rustup, Python 3.11 or later with venv, gcc and make. They install everything else.

SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
TOOLS := target/tools
VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
STATIC := x86_64-unknown-linux-musl
ARM64 := aarch64-unknown-linux-musl
ARMHF := armv7-unknown-linux-gnueabihf
WINDOWS := x86_64-pc-windows-gnu
APPLE := aarch64-apple-darwin x86_64-apple-darwin
CHIP := thumbv7em-none-eabihf
LOGS := fixtures/logs
SUDO := $(shell [ "$$(id -u)" = 0 ] || echo sudo)

.PHONY: test tools packages browser fmt lint package rust rust-build rust-statistics docs \
  firmware firmware-tools firmware-budgets cg guest guest-image guest-tools venv python notebook bench-short \
  dist dist-clean dist-crates dist-program dist-arm dist-windows dist-deb dist-python dist-c dist-firmware semver deny msrv \
  windows arm armhf macos deb port-tools arm-tools armhf-tools \
  fuzz fuzz-tools mutants mutants-short mutants-decisions mutants-tool soak rollover-table bench demo clean

# The program, the Python package and the tests are one build, that of the dev profile, and each part of it is made once. The
# tests of one part run while another part is built. Cargo builds in one folder at a time, so what can be built beside that has
# a folder of its own, and there are more jobs than processors, because some of them only wait for their turn. Packages are
# installed beside the first build. The guest has to keep up with a bus, so only the tests in Rust run beside it, and yield to
# it and to what is still built.
test: tools fmt
	$(MAKE) --jobs=6 --output-sync=target $(PARTS)
	@echo "all checks passed"

# Those that the others need come first, then the longest ones.
LAST := rust rust-statistics guest
PARTS := packages cg venv firmware armhf rust-build $(LAST) python windows lint bench-short docs deb package guest-image

# What the parts install, one after the other, because apt cannot be called twice at a time.
packages: tools
	set -e; for part in browser port-tools armhf-tools firmware-tools guest-tools; do $(MAKE) $$part; done

browser port-tools arm-tools armhf-tools firmware-tools guest-tools: | $(filter packages,$(MAKECMDGOALS))

tools:
	@command -v cargo >/dev/null || { echo "cargo is missing: install Rust with rustup"; exit 1; }
	@command -v gcc >/dev/null || { echo "gcc is missing: install it with your package manager"; exit 1; }
	@$(PYTHON) -c 'import sys, venv; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "Python 3.11 or later with venv is missing"; exit 1; }
	rustup component add clippy rustfmt

# Installs packages whose command or file is missing: $(call install,command:package ...,options of apt-get).
install = @missing=; for need in $(1); do \
	command -v $${need%%:*} >/dev/null || [ -e $${need%%:*} ] || missing="$$missing $${need\#\#*:}"; done; \
	[ -z "$$missing" ] || { $(SUDO) apt-get update -qq && $(SUDO) apt-get install -y -qq $(2) $$missing; }

fmt:
	cargo fmt --all --check

lint: $(TOOLS) | $(filter venv,$(MAKECMDGOALS))
	$(LIKE_MATURIN) cargo clippy --workspace --all-targets -- -D warnings
	$(TOOLS)/bin/typos

$(TOOLS):
	$(PYTHON) -m venv $(TOOLS)
	$(TOOLS)/bin/python -m pip install --quiet 'typos>=1.38' 'maturin>=1.9,<2' || { rm -rf $(TOOLS); exit 1; }

# Packs the crates for crates.io without compiling them (`make dist` compiles them).
package:
	cargo package --quiet --no-verify $(if $(CI),,--allow-dirty)

# Unit, property, Monte-Carlo and command-line tests, and every example in the documentation, without those of
# `make rust-statistics`.
rust: rust-build firmware-tools
	$(YIELDING) $(LIKE_MATURIN) cargo test --workspace --no-fail-fast --lib --bins --examples $(addprefix --test ,$(filter-out $(STATISTICS),$(TESTS)))
	$(YIELDING) $(LIKE_MATURIN) cargo test --workspace --no-fail-fast --doc

# The longest statistics.
rust-statistics: rust-build
	$(YIELDING) $(LIKE_MATURIN) cargo test --workspace --no-fail-fast $(addprefix --test ,$(STATISTICS))

rust-build: cg | $(filter venv,$(MAKECMDGOALS))
	$(LIKE_MATURIN) cargo test --workspace --no-run

YIELDING := nice -n 19
# Cargo compiles PyO3 again whenever its environment is another one.
LIKE_MATURIN := crates/cg-py/like-maturin.sh
STATISTICS := plant thesis
TESTS := $(shell sed -n '/^\[\[test/ { n; s/^name = "\(.*\)"/\1/p }' crates/*/Cargo.toml)

docs: | $(filter venv,$(MAKECMDGOALS))
	RUSTDOCFLAGS="-D warnings" $(LIKE_MATURIN) cargo doc --workspace --no-deps

# The estimator on an emulated Cortex-M4F: budgets, no heap, no panic, results bit-identical to those of the
# host. (`make rust` tests the C library there.)
firmware: firmware-tools
	cd firmware && cargo fmt --check && cargo clippy --release --bins --lib -- -D warnings
	$(PYTHON) firmware/check.py

# Measures the costs again and writes them into firmware/budgets.toml; the limits remain.
firmware-budgets: firmware-tools
	$(PYTHON) firmware/check.py --update

firmware-tools:
	rustup target add $(CHIP)
	@command -v qemu-system-arm >/dev/null && command -v arm-none-eabi-gcc >/dev/null \
	  || { $(SUDO) apt-get update && $(SUDO) apt-get install --yes --no-install-recommends \
	  qemu-system-arm gcc-arm-none-eabi libnewlib-arm-none-eabi; }

# The program as the tests have it, and the library that `cg fmu` packs.
cg:
	$(LIKE_MATURIN) cargo build --workspace --bin cg --lib

# Programs for other systems give the answers of the one for this machine (ports/compare.py). They are compiled without
# optional features, whose libraries are half of the code and have nothing to do with the answers, and with less
# optimization (ports/cheap.toml), which the answers must not depend on. `make dist` compares what is handed out.
PORT := CARGO_TARGET_DIR=target/ports cargo build --package cg-cli --no-default-features --config ports/cheap.toml
COMPARE := $(PYTHON) ports/compare.py --left-out

# Not a part of `make test`: that runs a program of 64 bits on this machine and one for ARM, which has 32 bits.
arm: cg arm-tools
	$(PORT) --target $(ARM64)
	$(COMPARE) --quick target/debug/cg qemu-aarch64 target/ports/$(ARM64)/debug/cg

# ARM with 32 bits.
armhf: cg armhf-tools
	$(PORT) --target $(ARMHF)
	$(COMPARE) --quick target/debug/cg qemu-arm target/ports/$(ARMHF)/debug/cg

windows: cg port-tools
	$(PORT) --target $(WINDOWS)
	$(call wine-ready,target/ports/$(WINDOWS)/debug)
	$(COMPARE) target/debug/cg $(WINE) target/ports/$(WINDOWS)/debug/cg.exe

# Wine's debugger outlives a crash, and gives the program that crashed the exit status 0.
WINE := env WINEPREFIX=$(CURDIR)/target/wine WINEDEBUG=-all WINEDLLOVERRIDES=winedbg.exe=d wine
# The first start of Wine makes its folder and says so, which is no answer of the program. A folder that was only made in part, by
# a start that was interrupted, never becomes whole: it is made anew.
wine-ready = ($(WINE) wineboot --init || { rm -rf $(CURDIR)/target/wine; $(WINE) wineboot --init; }) 2>/dev/null && x86_64-w64-mingw32-gcc -shared -Wall -Werror -o $(1)/bcryptprimitives.dll ports/bcryptprimitives.c -ladvapi32

# Checks that `cg` compiles for macOS, without the features whose libraries need Apple's compiler for C. It cannot be run here.
macos:
	rustup target add $(APPLE)
	cargo check --package cg-cli --no-default-features --features plots $(addprefix --target ,$(APPLE))

# The package for Debian and Ubuntu, installed, run and purged in a folder of its own. `make dist` packs the static programs.
deb: cg
	@mkdir -p target/deb
	ports/deb/check.sh "$$(COMPRESSION=none ports/deb/build.sh target/debug/cg $$(dpkg --print-architecture) target/deb)"

port-tools:
	rustup target add $(WINDOWS)
	$(call install,x86_64-w64-mingw32-gcc:gcc-mingw-w64-x86-64-win32 wine:wine systemd-analyze:systemd,--no-install-recommends)

arm-tools:
	rustup target add $(ARM64)
	$(call install,qemu-aarch64:qemu-user,--no-install-recommends)

armhf-tools:
	rustup target add $(ARMHF)
	$(call install,qemu-arm:qemu-user arm-linux-gnueabihf-gcc:gcc-arm-linux-gnueabihf \
	  /usr/arm-linux-gnueabihf/lib/crt1.o:libc6-dev-armhf-cross,--no-install-recommends)

# `cg run` on real SocketCAN: a kernel with vcan in QEMU replays a drive and loads the bus, for a minute in `make bench`.
guest: guest-image | $(filter-out $(LAST),$(MAKECMDGOALS))
	guest/run.sh

guest-image: venv cg guest-tools
	CG_LOAD_SECONDS=20 guest/image.sh target/debug/cg $(VENV)

guest-tools:
	guest/fetch.sh

# The Python package in a fresh environment with every extra, and its wheel. `make venv PROFILE=release` builds it as users have it.
PROFILE := dev
IN_VENV := VIRTUAL_ENV=$(CURDIR)/$(VENV) PATH=$(CURDIR)/$(VENV)/bin:$$PATH
venv:
	$(PYTHON) -m venv $(VENV)
	$(VENV)/bin/python -m pip install --quiet uv
	$(IN_VENV) $(VENV)/bin/uv pip install --quiet -r crates/cg-py/requirements-dev.txt
	$(IN_VENV) $(VENV)/bin/maturin develop --uv --profile $(PROFILE) --extras all -m crates/cg-py/Cargo.toml
	rm -rf target/wheels
	$(IN_VENV) $(VENV)/bin/maturin build --quiet --profile $(PROFILE) --out target/wheels -m crates/cg-py/Cargo.toml

# The Python package: tests (also of the HTML report and the live page in Chromium, of Spark, of the FMUs and of the notebooks), comparison of the stubs
# with the binary, lint. Then a test of the wheel with only numpy installed. The libraries of the workspace must have been compiled
# once for the Python package and `cg`, see the end of the dependencies in crates/cg-py/Cargo.toml; a clean folder shows it.
python: venv cg browser
	@[ -z "$(CI)" ] || [ "$$(ls target/debug/deps/libcg_logs-*.rlib | wc -l)" = 1 ] || { echo "cg-logs was compiled twice"; exit 1; }
	CG=$(CURDIR)/target/debug/cg $(VENV)/bin/python -m pytest -q -c crates/cg-py/pyproject.toml crates/cg-py/tests
	$(VENV)/bin/python -m mypy --config-file crates/cg-py/pyproject.toml crates/cg-py/python/cgheight
	$(VENV)/bin/python -m mypy.stubtest cgheight._native --mypy-config-file crates/cg-py/pyproject.toml
	$(VENV)/bin/ruff check --config crates/cg-py/pyproject.toml crates/cg-py benches/python
	$(VENV)/bin/ruff format --config crates/cg-py/pyproject.toml --check crates/cg-py benches/python
	rm -rf $(VENV)/clean && $(PYTHON) -m venv $(VENV)/clean
	$(VENV)/clean/bin/python -m pip install --quiet target/wheels/*.whl
	$(VENV)/clean/bin/python -m doctest crates/cg-py/python/cgheight/__init__.py

# For the tests of pages in Chromium, and of Spark.
browser:
	$(call install,chromium:chromium chromedriver:chromium-driver java:default-jre-headless)

# Executes the notebooks and stores them with their output.
notebook: venv cg
	CG=$(CURDIR)/target/debug/cg $(VENV)/bin/python crates/cg-py/tests/test_notebook.py

# Builds and tests everything that is published, in dist (RELEASING.md). Needs a clean tree; the crates are compiled from
# their packages.
dist: dist-clean dist-crates dist-program dist-arm dist-windows dist-deb dist-python dist-c dist-firmware
	cd dist && sha256sum cg* firmware* > SHA256SUMS && ls -l

dist-clean:
	rm -rf dist

# Cargo keeps the packages of a path and version forever, so each call has a path of its own.
dist-crates:
	rm -rf target/verify
	CARGO_TARGET_DIR=target/verify/$$$$ cargo package --quiet

# The programs need no library of the system. Their one library in C (zstd) is compiled by gcc, so musl-tools is not needed
# (.cargo/config.toml).
dist-program:
	@mkdir -p dist
	rustup target add $(STATIC)
	cargo build --profile dist --package cg-fmi
	$(call dist-static,$(STATIC),-C $(CURDIR)/target/dist libcg_fmi.so)
	target/$(STATIC)/dist/cg estimate $(LOGS)/A_p20_h190_v50_L.csv --vehicle fixtures/vehicles/kraz.toml

dist-arm: dist-program port-tools arm-tools armhf-tools
	$(call install,aarch64-linux-gnu-gcc:gcc-aarch64-linux-gnu \
	  /usr/aarch64-linux-gnu/include/stdlib.h:libc6-dev-arm64-cross,--no-install-recommends)
	$(call dist-static,$(ARM64))
	$(call dist-static,$(ARMHF))
	$(PYTHON) ports/compare.py target/$(STATIC)/dist/cg qemu-aarch64 target/$(ARM64)/dist/cg
	$(PYTHON) ports/compare.py target/$(STATIC)/dist/cg qemu-arm target/$(ARMHF)/dist/cg

# Fails if the program needs shared libraries: $(call dist-static,target,further files).
dist-static = cargo build --profile dist --package cg-cli --target $(1) \
  && ! readelf --program-headers target/$(1)/dist/cg | grep INTERP \
  && tar -czf dist/cg-$(VERSION)-$(1).tar.gz LICENSE-MIT LICENSE-APACHE systemd -C $(CURDIR)/target/$(1)/dist cg $(2)

# Fails if the program needs a library that Windows does not have: those of the compiler begin with lib.
dist-windows: dist-program port-tools
	cargo build --profile dist --package cg-cli --target $(WINDOWS)
	! x86_64-w64-mingw32-objdump -p target/$(WINDOWS)/dist/cg.exe | grep 'DLL Name: lib'
	$(call wine-ready,target/$(WINDOWS)/dist)
	$(PYTHON) ports/compare.py target/$(STATIC)/dist/cg $(WINE) target/$(WINDOWS)/dist/cg.exe
	rm -f dist/cg-$(VERSION)-$(WINDOWS).zip
	$(PYTHON) -m zipfile -c dist/cg-$(VERSION)-$(WINDOWS).zip target/$(WINDOWS)/dist/cg.exe LICENSE-MIT LICENSE-APACHE

dist-deb: dist-program dist-arm
	ports/deb/check.sh "$$(ports/deb/build.sh target/$(STATIC)/dist/cg amd64 dist)"
	ports/deb/check.sh "$$(ports/deb/build.sh target/$(ARM64)/dist/cg arm64 dist)" qemu-aarch64
	ports/deb/check.sh "$$(ports/deb/build.sh target/$(ARMHF)/dist/cg armhf dist)" qemu-arm

# Wheel and source distribution, each tested in an empty environment. The files of a source distribution are old, so cargo
# would take what an earlier build left: it gets a folder of its own.
dist-python: $(TOOLS)
	@mkdir -p dist
	$(TOOLS)/bin/maturin build --quiet --profile dist --out dist -m crates/cg-py/Cargo.toml
	$(TOOLS)/bin/maturin sdist --out dist -m crates/cg-py/Cargo.toml
	set -e; for made in dist/cgheight-$(VERSION)*; do rm -rf target/clean target/sdist; $(PYTHON) -m venv target/clean; \
	  CARGO_TARGET_DIR=$(CURDIR)/target/sdist target/clean/bin/python -m pip install --quiet $$made; \
	  target/clean/bin/python -m doctest crates/cg-py/python/cgheight/__init__.py; done

dist-c:
	@mkdir -p dist
	cargo build --profile dist --package cg-ffi
	cargo build --profile dist --package cg-ffi --target $(CHIP)
	rm -rf target/c && mkdir -p target/c/lib/$(CHIP)
	cp target/dist/libcg_ffi.a target/c/lib && cp target/$(CHIP)/dist/libcg_ffi.a target/c/lib/$(CHIP)
	tar -czhf dist/cg-height-c-$(VERSION).tar.gz -C target/c lib \
	  -C $(CURDIR)/crates/cg-ffi include examples README.md LICENSE-MIT LICENSE-APACHE

dist-firmware: firmware-tools
	@mkdir -p dist
	$(PYTHON) firmware/check.py --markdown > dist/firmware-$(VERSION).md

# Compares the interface of the published crates with that of the last release. Before the first release, it is compared
# with the commit since which the interface has been kept stable.
SEMVER_BASE := $(or $(shell git describe --tags --abbrev=0 --match 'v*' 2>/dev/null),facb987)
semver:
	@cargo semver-checks --version >/dev/null 2>&1 || cargo install cargo-semver-checks --locked
	cargo semver-checks --baseline-rev $(SEMVER_BASE)

# Licenses, sources and duplicate versions of the dependencies, and known vulnerabilities if their database can be reached.
deny:
	@cargo deny --version >/dev/null 2>&1 || cargo install cargo-deny --locked
	cargo deny check bans licenses sources
	@if cargo deny fetch db; then cargo deny check --disable-fetch advisories; \
	else echo "the database of known vulnerabilities cannot be reached: they are not checked"; fi

# Checks the oldest compiler that the published crates support (rust-version in Cargo.toml).
MSRV := $(shell sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
msrv:
	@rustup run $(MSRV) rustc --version || rustup toolchain install $(MSRV) --profile minimal
	cargo +$(MSRV) check --locked

# Coverage-guided fuzzing of all code that reads external input, one minute per target. Findings are in fuzz/artifacts:
# fix the code, then add the input to fuzz/seeds. `make test` runs these seeds and hundreds of mutations of each.
FUZZ_SECONDS := 60
FUZZ_TARGETS := log_reader candump dbc vehicle_file calibration_file state_file estimator_push
fuzz: fuzz-tools
	@set -e; cd fuzz; for target in $(FUZZ_TARGETS); do mkdir -p corpus/$$target; \
	  cargo +nightly fuzz run -s none $$target corpus/$$target seeds/$$target -- \
	  -max_total_time=$(FUZZ_SECONDS) -timeout=10 -rss_limit_mb=1024; done

fuzz-tools:
	@rustup run nightly rustc --version >/dev/null 2>&1 || rustup toolchain install nightly --profile minimal
	@cargo fuzz --version >/dev/null 2>&1 || cargo install cargo-fuzz --locked

# Mutation test of cg-core (2200 mutants, some hours): its own tests must detect at least 90 % of them.
# A sample of 170: make mutants MUTANTS='--sharding round-robin --shard 3/13'
MUTANTS :=
SUBJECT := --package cg-core --test-package cg-core
LEAST_PERCENT := 90
mutants: mutants-tool
	rm -rf target/mutants.out
	CARGO_TARGET_DIR=$(CURDIR)/target/mutants cargo mutants $(SUBJECT) --output target $(MUTANTS) \
	  || [ $$? -le 3 ] # 2: some were missed, 3: some timed out; both are counted below
	@$(PYTHON) -c 'import json, sys; o = json.load(open("target/mutants.out/outcomes.json")); \
	  killed = o["caught"] + o["timeout"]; viable = killed + o["missed"]; \
	  print(killed, "of", viable, f"mutants killed ({100 * killed / viable:.1f} %);", o["unviable"], "do not compile"); \
	  sys.exit(100 * killed < $(LEAST_PERCENT) * viable)'

# A dozen mutants, to show that the test works. Such a small sample scatters, so a quarter may be missed.
mutants-short:
	$(MAKE) mutants MUTANTS='--sharding round-robin --shard 0/180' LEAST_PERCENT=75

# The decisions outside the core: the end of a log, and the session of `cg run` (470 mutants, some hours).
DECISIONS := $(addprefix --file crates/cg-logs/src/estimate/, finish.rs diagnosis.rs signals.rs intake.rs) \
  $(addprefix --file crates/cg-cli/src/run/, session.rs events.rs pace.rs presence.rs)
mutants-decisions:
	$(MAKE) mutants SUBJECT='$(DECISIONS) --test-package cg-logs --test-package cg-plant --test-package cg-cli'

mutants-tool:
	@cargo mutants --version >/dev/null 2>&1 || cargo install cargo-mutants --locked

# `cg run` with a month of driving, one hour a day: its memory must not grow (`make test`: some minutes a day).
soak:
	CG_SOAK_DRIVES=30 cargo test --release --package cg-cli --test cli a_month -- --nocapture

# The table of docs/plant.md: thresholds compared with the nonlinear plant, 144 cases per vehicle (`make test`: corner cases).
rollover-table:
	CG_ROLLOVER_TABLE=1 cargo test --workspace --test plant the_table -- --nocapture

# Runs every bench once on little data, to show that it works. It gives no valid measurements, so it takes the build of the
# tests.
bench-short: venv cg
	CG_BENCH_ROWS=50000 $(LIKE_MATURIN) cargo bench --profile dev --workspace --bench identify --bench batch --bench plant \
	  -- --sample-count 1 --sample-size 1
	CG_BENCH_LOGS=10 OPENBLAS_NUM_THREADS=1 POLARS_MAX_THREADS=1 $(VENV)/bin/python benches/python/logs.py >/dev/null
	CG_BENCH_TRIPS=10 CG=$(CURDIR)/target/debug/cg $(VENV)/bin/python benches/python/spark_trips.py >/dev/null
	CG_BENCH_SECONDS=4 CG=$(CURDIR)/target/debug/cg $(VENV)/bin/python benches/python/live_clients.py >/dev/null

# All benches with ten million rows and a thousand logs; writes benches/RESULTS.md.
bench: firmware-tools
	$(MAKE) venv PROFILE=dist
	benches/run.sh

demo:
	cargo run --release --package cg-cli -- estimate $(LOGS)/*.csv $(LOGS)/*.csv.gz \
	  --vehicle fixtures/vehicles/kraz.toml --truth $(LOGS)/truth.json

clean:
	cargo clean
	rm -rf $(VENV)
