"""Connections to the web server: how many, what each waits for, and that none takes in more than is asked for."""
