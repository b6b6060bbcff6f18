"""The engine as a process: sockets, requests, memory and its end."""
