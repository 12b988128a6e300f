#!/usr/bin/env python3
"""Counts lines of Rust without tests, comments and blank lines among them: of the published crates, and of lab/.

Run it at the root of the repository.

What `#[cfg(test)]` marks is left out, and with it the files of such modules; so are `tests.rs`, folders named `tests`, `benches`,
`examples` and `conformance`, and lab/testing, which is there for tests alone.
"""

import re
import subprocess
from pathlib import Path, PurePath

EXCLUDED = {"tests", "tests.rs", "benches", "examples", "conformance", "conformance.rs"}


def production_lines(file: str, of_tests: set[str]) -> int:
    """The lines of a file without its tests; adds the files and folders of its test modules to `of_tests`."""
    lines = Path(file).read_text().splitlines()
    path = PurePath(file)
    modules = path.parent if path.stem in ("mod", "lib", "main") else path.parent / path.stem
    count = at = 0
    while at < len(lines):
        if not re.match(r"\s*#\[cfg\((all\()?test", lines[at]):
            count, at = count + 1, at + 1
            continue
        item = at + 1
        while re.match(r"\s*(#\[|//)", lines[item]):
            item += 1
        named = [found[1] for line in lines[at:item] if (found := re.search(r'path = "(.*?)"', line))]
        if module := re.match(r"\s*(?:pub(?:\([^)]*\))? )?mod (\w+);", lines[item]):
            of_tests.update(str(path.parent / name) for name in named)
            of_tests.update(f"{modules / module[1]}{end}" for end in (".rs", "/"))
        elif lines[item].rstrip().endswith("{"):
            closing = re.match(r"\s*", lines[item])[0] + "}"
            while not lines[item].startswith(closing):
                item += 1
        at = item + 1
    return count


def main() -> None:
    files = subprocess.run(["git", "ls-files", "*.rs"], capture_output=True, check=True, text=True).stdout.split()
    of_tests: set[str] = set()
    counts = {file: production_lines(file, of_tests) for file in files}
    totals = {"product": 0, "lab": 0}
    for file, count in counts.items():
        is_test = EXCLUDED.intersection(PurePath(file).parts) or file.startswith("lab/testing/")
        is_test = is_test or any(file == one or (one.endswith("/") and file.startswith(one)) for one in of_tests)
        if not is_test:
            totals["lab" if file.startswith("lab/") else "product"] += count
    print(f"production Rust: {totals['product']:,} lines of the product, {totals['lab']:,} of the laboratory")


if __name__ == "__main__":
    main()
