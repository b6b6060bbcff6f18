"""For those who keep the service running: what is counted, the log of answers, and how a server is drained."""
