import subprocess
import sys


def test_the_client_needs_nothing_of_the_server() -> None:
    code = (
        "import sys, culet_client, culet_client.view, culet_client.stream; "
        "print([name for name in sys.modules if name.split('.')[0] in ('culet', 'pyopencl', 'numpy', 'fastapi')])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    assert run.stdout.strip() == "[]"
