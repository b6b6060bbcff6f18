import pytest

from culet.engine.capacity.limits import Limits, check_still_size, live_size
from culet.errors import InputError

LIMITS = Limits()


@pytest.mark.parametrize("size", [(1, 1), (8192, 4096), (5792, 5792)])
def test_sizes_within_the_limits_pass(size: tuple[int, int]) -> None:
    check_still_size(*size, LIMITS)


@pytest.mark.parametrize(
    ("width", "height", "field"),
    [(0, 10, "width"), (10, 0, "height"), (-1, 10, "width"), (10, 100_000, "height"), (8192, 8192, "width")],
)
def test_a_size_beyond_the_limits_is_refused_by_name(width: int, height: int, field: str) -> None:
    with pytest.raises(InputError, match=field) as caught:
        check_still_size(width, height, LIMITS)
    assert caught.value.field == field


def test_a_large_live_frame_is_scaled_down_and_keeps_its_shape() -> None:
    assert live_size(1280, 720, LIMITS) == (1280, 720)
    assert live_size(3840, 2160, LIMITS) == (2560, 1440)
    width, height = live_size(8192, 16, Limits(max_live_pixels=1000))
    assert width * height <= 1000
    assert height >= 1
