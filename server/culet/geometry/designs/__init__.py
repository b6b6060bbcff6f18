"""Gem designs: the half-spaces that a cutter cuts, in tiers about an index wheel, read from cutters' files."""
