"""For how long tests wait for what must come."""

PATIENCE = 240.0
"""s until what should come true counts as failed. No test takes so long on an idle machine, and none asks how long it
took: a server that starts takes 3 s of a processor's time, a program that is compiled up to 10, and other work may
leave a test a tenth of a core."""
