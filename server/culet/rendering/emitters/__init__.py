"""What throws light on floor and walls: lamps, skies and panoramas, unshaded, and where a light map's texels lie."""
