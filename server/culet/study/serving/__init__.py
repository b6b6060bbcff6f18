"""Whole servers: whether the governor holds its rate, which settings it chooses from, and what a crowd costs."""
