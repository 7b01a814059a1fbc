"""The renderer, held against the reference."""

import pytest
from renderer.march import Camera, over, to_bytes, volume_render


@pytest.mark.nerf_oracle("volume_render", dtype="f32")
def test_volume_render(sigmas, rgbs, deltas):
    return volume_render(sigmas, rgbs, deltas)


@pytest.mark.nerf_oracle("image_rays", dtype="f64", profile="cs180")
def test_rays(height, width, focal, c2w):
    return Camera(height, width, focal).rays(c2w)


@pytest.fixture
def kernels():
    return {"composite_background": over, "to_uint8": to_bytes}


@pytest.mark.nerf_oracle("composite_background", "to_uint8")
def test_pictures(kernels):
    return kernels


def test_of_the_usual_kind():
    assert volume_render.__doc__
