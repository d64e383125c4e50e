"""Takes the C++ programs out of the documents: documents.py ROOT FOLDER

Every block ```cpp of README.md and docs/*.md is a program of its own, PAGE-N.cpp; it prints their names for CMake. But for
what is meant for the library's own sources: such a block has to stand in tests/gait/extending's patch, line by line."""

import re
import sys
from pathlib import Path


def bare(line: str) -> str:
    return re.sub(r"\s+", "", line.split("//")[0])


def main() -> int:
    root, folder = map(Path, sys.argv[1:])
    folder.mkdir(parents=True, exist_ok=True)
    patches = [line for p in sorted((root / "tests/extending").glob("*.patch")) for line in p.read_text().splitlines()]
    added = {bare(line[1:]) for line in patches if line.startswith("+")}
    programs = []
    for page in [root / "README.md", *sorted((root / "docs").glob("*.md"))]:
        blocks = re.findall(r"^```cpp\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
        for number, block in enumerate(blocks, 1):
            if "int main()" in block:
                programs.append(f"{page.stem}-{number}")
                (folder / f"{programs[-1]}.cpp").write_text(block)
                continue
            missing = [line for line in block.splitlines() if bare(line) and bare(line) not in added]
            if missing:
                print(f"{page.name}, block {number}: neither a program nor in a patch: {missing[0]}", file=sys.stderr)
                return 1
    print(";".join(programs))
    return 0


if __name__ == "__main__":
    sys.exit(main())
