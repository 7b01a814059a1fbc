"""Why kornia.nerf 0.8.2 differs where it differs. A difference is a convention (`key=value`) or a quirk."""

REASONS = {
    "product_eps=1e-10": "volume_renderer.py adds _eps = 1e-10 to every factor 1 - alpha of the transmittance",
    "ray0_spacing": "RegularRenderer takes |p_1 - p_0| of the first ray as the step of every sample of every ray",
    "frequency=one": "positional_encoder.py multiplies by 2^k, not by 2^k pi (its own FIXME asks)",
    "bands=linear": "PositionalEncoder spaces its bands evenly from 1 to 2^(L-1) unless log_space is set",
    "grid=ends_plus_spacing": "sample_lengths(irregular=False) is linspace(0, 1, N): both ends",
    "delta=differences": "IrregularRenderer takes the distances of neighboring points",
    "last_delta=1e10": "IrregularRenderer gives the last sample a step of _huge = 1e10",
    "pixel_center=integer": "UniformRaySampler counts pixels from 0 without half a pixel",
    "directions=depth": "RaySampler does not normalize its directions",
    "rays_from_near_to_far": "RaySampler puts the origin on the plane z = near and the tip on z = far: "
    "o + near d and (far - near) d of a ray with depth 1",
    "homogeneous_eps": "convert_points_from_homogeneous divides by 1 + 1e-8, and so every unprojected point",
    "origin_from_w2c": "NerfModelRenderer takes the translation of its world-to-camera extrinsics for the camera's center",
}
