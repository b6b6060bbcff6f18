import subprocess
import sys

import pytest


@pytest.mark.parametrize(
    ("module", "forbidden"),
    [("culet.engine.serve", "fastapi"), ("culet.engine.serve", "uvicorn"), ("culet.engine.upload_reader", "pyopencl")],
)
def test_the_engine_loads_no_web_server_and_the_reader_no_device(module: str, forbidden: str) -> None:
    code = f"import sys, {module}; sys.exit({forbidden!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
