"""The estimator on an emulated Cortex-M4F: what it costs, whether it keeps its budgets, whether it
answers as the host does.

    python3 firmware/check.py                 checks; exit status 1 if anything is broken
    python3 firmware/check.py --update        writes what was measured into budgets.toml
    python3 firmware/check.py --markdown      checks, and prints the table of README and RESULTS.md
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

# Nothing of this may be linked: panics, unwinding, and any allocator.
FORBIDDEN = re.compile(r"panic|unwind|unwrap_failed|expect_failed|__rust_alloc|__rg_alloc|\bmalloc\b|_sbrk")

CLOCK_HZ = 168e6  # an STM32F4, the common M4F
CYCLES_PER_INSTRUCTION = 2.0  # assumed, on the safe side: loads and flash wait states included

WORDS = {
    "identify_mean": "identify, a row of one channel (13 unknowns)",
    "identify_worst": "identify, dearest row (folds a block of five)",
    "push_mean": "whole push, both channels, mean",
    "push_running_worst": "dearest push inside a drive (filters made anew)",
    "push_closing_worst": "dearest push of all (maneuver ends: solve, judge, fuse)",
    "identify_jitter_mean": "identify, a row whose interval differs from the last",
    "image": "image without the log",
    "ram": "RAM: state and deepest stack",
}


def run(*command: str, check: bool = True) -> str:
    """Standard output of a command that runs in firmware/."""
    done = subprocess.run(command, cwd=HERE, capture_output=True, text=True, timeout=600)
    if check and done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return done.stdout


def numbers(text: str) -> dict[str, str]:
    """`name = value unit` lines."""
    return dict(re.findall(r"^(\w+) = (\S+)", text, re.MULTILINE))


def maneuvers(text: str) -> list[str]:
    """What was said of each maneuver."""
    return [line for line in text.splitlines() if line.startswith("maneuver ")]


def symbols(image: str, *features: str) -> list[str]:
    """What is linked into an image."""
    run("cargo", "build", "--release", "--bin", image, *features)
    return run("arm-none-eabi-nm", "--demangle", str(IMAGES / image)).splitlines()


def same_as_host(chip: str) -> list[str]:
    """Where the answers of chip and host part."""
    host_triple = re.search(r"^host: (\S+)", run("rustc", "-vV"), re.MULTILINE).group(1)
    host = run("cargo", "run", "--release", "--example", "host", "--target", host_triple)
    faults = [
        f"maneuver {k + 1}: host says {ours!r}, chip says {theirs!r}"
        for k, (ours, theirs) in enumerate(zip(maneuvers(host), maneuvers(chip), strict=True))
        if ours != theirs
    ]
    ours, theirs = numbers(host), numbers(chip)
    for name in ("samples", "hash", "can_hash"):
        if ours[name] != theirs[name]:
            faults.append(f"{name}: host {ours[name]}, chip {theirs[name]}")
        print(f"{name}: host {ours[name]}, chip {theirs[name]}", file=sys.stderr)
    return faults


def linked() -> list[str]:
    """Panics and allocators in the image; and whether the search would find one."""
    faults = []
    if not any(FORBIDDEN.search(line) for line in symbols("firmware", "--features", "control")):
        faults.append("the search for panics finds none where there is one")
    for image in ("firmware", "identify", "can"):
        lines = symbols(image)
        faults += [f"{image} links {line}" for line in lines if FORBIDDEN.search(line)]
        if not any("cg_core::" in line for line in lines):
            faults.append(f"{image} has no symbols to search")
    return faults


def kept(measured: dict[str, int], budgets: dict) -> list[str]:
    """Limits broken, and growth beyond the tolerance."""
    faults = [
        f"{WORDS[name]}: {measured[name]} is over the limit of {limit}"
        for name, limit in budgets["limit"].items()
        if measured[name] > limit
    ]
    slack = 1 + budgets["tolerance_percent"] / 100
    for name, before in budgets.get("measured", {}).items():
        if measured[name] > before * slack:
            faults.append(
                f"{WORDS[name]}: {measured[name]}, was {before}; if it must be, make firmware-budgets"
            )
    return faults


def write(measured: dict[str, int]) -> None:
    """Replaces what was measured in budgets.toml, keeps the rest."""
    head = BUDGETS.read_text(encoding="utf-8").split("[measured]")[0]
    lines = [f"{name} = {measured[name]}" for name in WORDS]
    BUDGETS.write_text(f"{head}[measured]\n" + "\n".join(lines) + "\n", encoding="utf-8")


def table(measured: dict[str, int], budgets: dict, said: dict[str, str]) -> str:
    """Markdown."""
    rows = ["| on a Cortex-M4F | measured | limit |", "|---|---|---|"]
    spaced = lambda value: f"{value:,.0f}".replace(",", " ")
    for name, words in WORDS.items():
        unit = "B" if name in ("image", "ram") else "instructions"
        limit = budgets["limit"].get(name)
        ceiling = f"{spaced(limit)} {unit}" if limit else ""
        rows.append(f"| {words} | {spaced(measured[name])} {unit} | {ceiling} |")
    rate = lambda instructions: CLOCK_HZ / (CYCLES_PER_INSTRUCTION * instructions)
    mean, worst = rate(measured["push_mean"]), rate(measured["push_closing_worst"])
    rows.append(f"| samples/s at 168 MHz, two cycles an instruction: on average | {spaced(mean)} | |")
    rows.append(f"| the same if even the dearest push must end before the next sample | {spaced(worst)} | |")
    rows.append(f"| every bit of every answer, over {spaced(int(said['samples']))} samples | as on the host | |")
    return "\n".join(rows)


def main() -> None:
    """Measures, compares, says."""
    budgets = tomllib.loads(BUDGETS.read_text(encoding="utf-8"))
    faults = linked()
    chip = run("cargo", "run", "--release")
    said = numbers(chip)
    faults += same_as_host(chip + run("cargo", "run", "--release", "--bin", "can"))
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
