"""`culet bench`: its scenes, what a frame of them takes of the machine's limit, and two runs side by side."""
