"""The web process: REST and WebSocket in front of the engine. It imports neither OpenCL nor the renderer."""
