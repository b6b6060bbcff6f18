"""One session: its scene, its stone in motion, what it showed, and what each event does to it."""
