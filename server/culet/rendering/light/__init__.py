"""Light maps: what shadows and caustics add to the light of the room's matte surfaces, and how they are made."""
