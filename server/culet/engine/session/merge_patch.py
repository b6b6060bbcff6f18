"""JSON merge patch (RFC 7396), but for objects that change their kind."""

from __future__ import annotations

from typing import Any


def merge_patch(target: Any, patch: Any) -> Any:  # noqa: ANN401 - whatever JSON holds
    """`target` with `patch` applied, after the pseudocode of RFC 7396 section 2; neither argument is changed.

    Unlike there, an object whose `kind` the patch changes is replaced and not merged: a light sky has no use for the
    lamps of the studio before it, and would be refused with them.
    """
    if not isinstance(patch, dict):
        return patch
    merged = dict(target) if isinstance(target, dict) and not _of_another_kind(target, patch) else {}
    for name, value in patch.items():
        if value is None:
            merged.pop(name, None)
        else:
            merged[name] = merge_patch(merged.get(name), value)
    return merged


def _of_another_kind(target: dict[str, Any], patch: dict[str, Any]) -> bool:
    return "kind" in target and patch.get("kind", target["kind"]) != target["kind"]
