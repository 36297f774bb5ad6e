"""The answer of a case in a file of its own, sealed so that nobody reads it by accident."""

import base64
import json
import zlib
from pathlib import Path
from typing import Any


def write_answer(answer: dict[str, Any], path: Path, sealed: bool = True) -> None:
    """Write an answer; sealed, it cannot be read by accident."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(answer, indent=1)
    if sealed:
        text = json.dumps({"sealed": base64.b64encode(zlib.compress(text.encode())).decode()})
    path.write_text(text + "\n", encoding="utf-8")


def read_answer(path: Path) -> dict[str, Any]:
    """An answer, sealed or not."""
    answer: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    if "sealed" not in answer:
        return answer
    opened: dict[str, Any] = json.loads(zlib.decompress(base64.b64decode(answer["sealed"])))
    return opened
