"""How much one engine may take: its limits, its memory and who holds it, the machine's."""
