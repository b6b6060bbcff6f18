"""How far a picture is from what it should be: in radiance, and to the eye."""
