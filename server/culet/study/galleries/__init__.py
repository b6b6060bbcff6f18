"""Pictures for the documentation: every preset and every cut, and the measures that presets are held to."""
