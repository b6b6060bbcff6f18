"""One stone by itself: the motion models `rigid` and `classic`, step by step."""
