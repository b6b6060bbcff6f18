"""What is around the stones: floor and walls, the studio, the sky's colours."""
