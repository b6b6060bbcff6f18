"""What REST and WebSocket offer, a module for each kind of thing that is asked for."""
