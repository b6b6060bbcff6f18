"""What is sent: bytes, time and likeness of still and moving pictures and of video."""
