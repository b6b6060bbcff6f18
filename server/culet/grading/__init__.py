"""Numbers of a stone's look by the trade's definitions: docs/reference/grading.md."""
