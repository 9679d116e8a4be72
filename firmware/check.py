"""Checks the estimator on an emulated Cortex-M4F: its cost, its budgets, and that its answers are
bit-identical to the host's.

    python3 firmware/check.py                 checks; exit status 1 if anything is broken
    python3 firmware/check.py --update        writes the measured values into budgets.toml
    python3 firmware/check.py --markdown      checks; prints the table of docs/microcontroller.md and RESULTS.md
"""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
BUDGETS = HERE / "budgets.toml"
TARGET = "thumbv7em-none-eabihf"
IMAGES = HERE / "target" / TARGET / "release"

# None of these symbols may be linked: panics, unwinding, and any allocator.
FORBIDDEN = re.compile(r"panic|unwind|unwrap_failed|expect_failed|__rust_alloc|__rg_alloc|\bmalloc\b|_sbrk")

CLOCK_HZ = 168e6  # an STM32F4, the common M4F
CYCLES_PER_INSTRUCTION = 2.0  # a conservative assumption: loads and flash wait states included

WORDS = {
    "identify_mean": "identify, one row of one channel (13 unknowns), mean",
    "identify_worst": "identify, worst-case row (reduces a block of four)",
    "push_mean": "`push`, steer and lateral channel, mean",
    "pair_push_mean": "`push`, the suspensions of trailer and tractor, mean",
    "push_worst": "worst-case `push`, steer and lateral channel (two stages of the solution of a maneuver)",
    "pair_push_worst": "worst-case `push`, the suspensions of trailer and tractor",
    "finish": "`finish` at the end of a drive, in a maneuver (the whole solution at once)",
    "identify_jitter_mean": "identify, one row, mean, if the interval differs from row to row",
    "image": "image without the log",
    "ram": "RAM: state and maximum stack depth",
}


def run(*command: str, check: bool = True) -> str:
    """Standard output of a command that runs in firmware/."""
    done = subprocess.run(command, cwd=HERE, capture_output=True, text=True, timeout=600)
    if check and done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return done.stdout


def numbers(text: str) -> dict[str, str]:
    """The values in lines of the form `name = value unit`."""
    return dict(re.findall(r"^(\w+) = (\S+)", text, re.MULTILINE))


def maneuvers(text: str) -> list[str]:
    """The lines about maneuvers."""
    return [line for line in text.splitlines() if line.startswith("maneuver ")]


def symbols(image: str, *features: str) -> list[str]:
    """The symbols in an image."""
    run("cargo", "build", "--release", "--bin", image, *features)
    return run("arm-none-eabi-nm", "--demangle", str(IMAGES / image)).splitlines()


def same_as_host(chip: str) -> list[str]:
    """Differences between the answers of chip and host."""
    host_triple = re.search(r"^host: (\S+)", run("rustc", "-vV"), re.MULTILINE).group(1)
    host = run("cargo", "run", "--release", "--example", "host", "--target", host_triple)
    faults = [
        f"maneuver {k + 1}: host {ours!r}, chip {theirs!r}"
        for k, (ours, theirs) in enumerate(zip(maneuvers(host), maneuvers(chip), strict=True))
        if ours != theirs
    ]
    ours, theirs = numbers(host), numbers(chip)
    for name in ("samples", "hash", "can_hash", "pair_hash"):
        if ours[name] != theirs[name]:
            faults.append(f"{name}: host {ours[name]}, chip {theirs[name]}")
        print(f"{name}: host {ours[name]}, chip {theirs[name]}", file=sys.stderr)
    return faults


def linked() -> list[str]:
    """Panics and allocators in the images; also checks that the search can find one."""
    faults = []
    if not any(FORBIDDEN.search(line) for line in symbols("firmware", "--features", "control")):
        faults.append("the search for panics misses the one in the control image")
    for image in ("firmware", "identify", "can", "pair"):
        lines = symbols(image)
        faults += [f"{image} links {line}" for line in lines if FORBIDDEN.search(line)]
        if not any("cg_core::" in line for line in lines):
            faults.append(f"{image} has no symbols to search")
    return faults


def kept(measured: dict[str, int], budgets: dict) -> list[str]:
    """Exceeded limits, and growth beyond the tolerance."""
    faults = [
        f"{WORDS[name]}: {measured[name]} is over the limit of {limit}"
        for name, limit in budgets["limit"].items()
        if measured[name] > limit
    ]
    slack = 1 + budgets["tolerance_percent"] / 100
    for name, before in budgets.get("measured", {}).items():
        if measured[name] > before * slack:
            faults.append(
                f"{WORDS[name]}: {measured[name]}, was {before}; to accept it, run make firmware-budgets"
            )
    return faults


def write(measured: dict[str, int]) -> None:
    """Replaces the measured values in budgets.toml and keeps the rest."""
    head = BUDGETS.read_text(encoding="utf-8").split("[measured]")[0]
    lines = [f"{name} = {measured[name]}" for name in WORDS]
    BUDGETS.write_text(f"{head}[measured]\n" + "\n".join(lines) + "\n", encoding="utf-8")


def table(measured: dict[str, int], budgets: dict, said: dict[str, str]) -> str:
    """The Markdown table."""
    rows = ["| on a Cortex-M4F | measured | limit |", "|---|---|---|"]
    spaced = lambda value: f"{value:,.0f}".replace(",", " ")
    for name, words in WORDS.items():
        unit = "B" if name in ("image", "ram") else "instructions"
        limit = budgets["limit"].get(name)
        ceiling = f"{spaced(limit)} {unit}" if limit else ""
        rows.append(f"| {words} | {spaced(measured[name])} {unit} | {ceiling} |")
    rate = lambda instructions: CLOCK_HZ / (CYCLES_PER_INSTRUCTION * instructions)
    mean, worst = rate(measured["push_mean"]), rate(measured["push_worst"])
    rows.append(f"| samples/s at 168 MHz and two cycles per instruction, mean | {spaced(mean)} | |")
    rows.append(f"| the same, if the worst-case `push` must end before the next sample | {spaced(worst)} | |")
    rows.append(f"| all answers, over {spaced(int(said['samples']))} samples | bit-identical to the host | |")
    return "\n".join(rows)


def main() -> None:
    """Measures, compares with the budgets and with the host, and prints the result."""
    budgets = tomllib.loads(BUDGETS.read_text(encoding="utf-8"))
    faults = linked()
    chip = run("cargo", "run", "--release")
    said = numbers(chip)
    pair = run("cargo", "run", "--release", "--bin", "pair")
    faults += same_as_host(chip + run("cargo", "run", "--release", "--bin", "can") + pair)
    said |= numbers(pair)
    said |= numbers(run("cargo", "run", "--release", "--bin", "identify"))
    measured = {name: int(said[name]) for name in WORDS}
    if "--update" in sys.argv:
        write(measured)
        budgets = tomllib.loads(BUDGETS.read_text(encoding="utf-8"))
    faults += kept(measured, budgets)
    print(table(measured, budgets, said) if "--markdown" in sys.argv else chip.strip())
    for fault in faults:
        print(f"firmware: {fault}", file=sys.stderr)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
