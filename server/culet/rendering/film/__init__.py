"""Samples as they add up: their sums, their error, what a screen shows of them, and their files."""
