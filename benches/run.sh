#!/usr/bin/env bash
# Runs every bench and writes benches/RESULTS.md with date, commit, machine, summary and raw output.
# Everything is built with the profile of the published program (`dist`), the Python package in .venv by `make bench`.
set -euo pipefail
cd "$(dirname "$0")/.."
raw=$(mktemp)
trap 'rm -f "$raw" "$raw.python" "$raw.guest"' EXIT
cargo bench --profile dist --package cg-bench | tee "$raw"
cargo build --profile dist --package cg-cli
guest/image.sh target/dist/cg .venv
guest/run.sh | grep '^guest: ' > "$raw.guest"
OPENBLAS_NUM_THREADS=1 POLARS_MAX_THREADS=1 .venv/bin/python benches/python/logs.py > "$raw.python"
CG=$PWD/target/dist/cg .venv/bin/python benches/python/spark_trips.py >> "$raw.python"
CG=$PWD/target/dist/cg .venv/bin/python benches/python/live_clients.py >> "$raw.python"
{
  echo "# Bench results"
  echo
  echo "Written by \`make bench\`. The times are from one run on a shared machine; compare them only with each other."
  echo
  echo "| | |"
  echo "|---|---|"
  echo "| date | $(date -u +%Y-%m-%d) |"
  echo "| commit | $(git describe --always --dirty --exclude '*') |"
  echo "| compiler | $(rustc --version) |"
  echo "| machine | $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1), $(nproc) cores |"
  echo "| rows of the batch log | ${CG_BENCH_ROWS:-10000000} |"
  echo
  python3 benches/summary.py "$raw"
  echo "## On a Cortex-M4F"
  echo
  echo "QEMU counts instructions, so the result is the same on every machine; see firmware/budgets.toml."
  echo
  python3 firmware/check.py --markdown
  echo
  echo "## Live CAN"
  echo
  echo "\`cg run\` runs in a guest with vcan, on a CPU emulated by QEMU. The latency is measured from the kernel's time stamp to the last effect."
  echo
  sed 's/^guest: /- /' "$raw.guest"
  echo
  cat "$raw.python"
  echo "## Raw output"
  echo
  echo '```text'
  grep -E '^(Timer|identify|batch|plant|├|╰|│| )' "$raw"
  echo '```'
} > benches/RESULTS.md.new
mv benches/RESULTS.md.new benches/RESULTS.md
