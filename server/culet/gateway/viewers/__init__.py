"""One viewer: what its link carries, which frames wait for it, and which pictures it is sent. No sockets."""
