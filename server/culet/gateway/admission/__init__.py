"""What stands between a request and its route: who may do what, what may come in, and how often."""
