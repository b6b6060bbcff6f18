"""Meshes, designs and skies that viewers have uploaded: read from a request, kept, and given to the engine again."""
