"""Write the default scene, as the model has it, into its page of the documentation."""

from __future__ import annotations

import json
import re
from pathlib import Path

from culet.scene import Scene

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "scene.md"
BLOCK = re.compile(r"(?<=```json\n).*?(?=\n```)", re.DOTALL)
LINE = 110


def laid_out(value: object, key: str = "", depth: int = 0) -> str:
    """JSON with what fits on a line on one."""
    line = json.dumps(value)
    if depth and 2 * depth + len(key) + len(line) <= LINE:
        return line
    margin = "\n" + "  " * (depth + 1)
    match value:
        case dict():
            rows = [f'{margin}"{name}": {laid_out(part, name, depth + 1)}' for name, part in value.items()]
            return "{" + ",".join(rows) + "\n" + "  " * depth + "}"
        case list():
            rows = [margin + laid_out(part, depth=depth + 1) for part in value]
            return "[" + ",".join(rows) + "\n" + "  " * depth + "]"
    return line


def whole(value: object) -> object:
    """The same with 4.0 as 4."""
    match value:
        case dict():
            return {key: whole(part) for key, part in value.items()}
        case list():
            return [whole(part) for part in value]
        case float() if value.is_integer():
            return int(value)
    return value


def main() -> None:
    """Replace the first block of JSON."""
    text = laid_out(whole(Scene().model_dump(mode="json")))
    PAGE.write_text(BLOCK.sub(lambda _: text, PAGE.read_text(encoding="utf-8"), count=1), encoding="utf-8")


if __name__ == "__main__":
    main()
