"""Ratios between the benches of one run, from divan's raw output."""

import re
import sys

UNITS = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}
ROWS_PER_ITERATION = 4000  # benches/identify.rs


def medians(path: str) -> dict[str, float]:
    """Median time of each bench, seconds, by `name` or `name type`."""
    found: dict[str, float] = {}
    group = ""
    for line in open(path, encoding="utf-8"):
        match = re.match(r"^([ │]*)[├╰]─ (\S+)(.*)$", line)
        if not match:
            continue
        indent, name, rest = match.groups()
        key = f"{group} {name}" if indent.strip("") and indent else name
        if not indent:
            group = name
        times = re.findall(r"([\d.]+) (ns|µs|ms|s)\b", rest)
        if len(times) >= 3:
            value, unit = times[2]  # fastest, slowest, median
            found[key] = float(value) * UNITS[unit]
    return found


def main() -> None:
    m = medians(sys.argv[1])
    row = 1e9 / ROWS_PER_ITERATION
    print("## Summary\n\n| what | median | against |\n|---|---|---|")
    peer = m["nalgebra_qr_5_5_row"] * row
    print(f"| `FilteredArx`, f32, one row (12 unknowns) | {m['filtered_arx_row f32'] * row:.0f} ns | |")
    print(f"| `FilteredArx`, f64, one row | {m['filtered_arx_row f64'] * row:.0f} ns | |")
    arx = m["shift_form_arx_5_5_row f64"] * row
    print(f"| `Arx` [5 5 1], f64, one row, recursive | {arx:.0f} ns | nalgebra's batch QR: {peer:.0f} ns |")
    print(f"| `Estimator::push`, f32, both channels | {m['estimator_push f32'] * row:.0f} ns | |")
    for rate in (50, 100):
        names = ("csv_crate_parse_only", "log_reader", "cg_estimate")
        parse, read, whole = (m[f"{name} {rate}"] for name in names)
        print(f"| only parsing the log of {rate} Hz with the csv crate | {parse:.2f} s | |")
        print(f"| the log reader | {read:.2f} s | {parse / read:.2f} × its speed |")
        print(f"| `cg estimate` on it, one thread | {whole:.2f} s | {parse / whole:.2f} × its speed (target 0.4) |")
    second = m["simulated_second baseline-tables"]
    print(f"| nonlinear plant, five axles | {1 / second:.0f} × real time | target 500 |")
    print()


if __name__ == "__main__":
    main()
