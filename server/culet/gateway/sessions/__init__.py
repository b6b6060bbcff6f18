"""Sessions as the gateway knows them: their records and places, what the engine tells of them, and what it is told."""
