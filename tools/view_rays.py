"""Show cameras, rays and samples of `nerf-oracle inspect` in a browser.

    nerf-oracle inspect builtin:spheres --out out/spheres
    python tools/view_rays.py out/spheres/rays.npz [--port 8080]

Frustums carry their photographs (orange frames: validation); lines are rays from their cameras to far; dots are samples, in the
color of the pixel that their ray goes through.
"""

import argparse
import time

import numpy as np
import viser
import viser.transforms


def show(server: viser.ViserServer, rays: dict[str, np.ndarray]) -> None:
    """Add everything in `rays` (the arrays of rays.npz) to a server's scene."""
    c2ws = rays["c2ws"]
    centers = c2ws[:, :3, 3]
    middle = centers.mean(axis=0)
    spread = float(np.linalg.norm(centers - middle, axis=1).max())
    scale = 0.04 * spread
    # The cameras' own y axis points down.
    up = -c2ws[:, :3, 1].mean(axis=0)
    server.scene.set_up_direction(tuple(up))
    aside = np.cross(up, c2ws[0, :3, 2])
    away = 2.2 * aside / np.linalg.norm(aside) + up / np.linalg.norm(up)
    server.initial_camera.position = tuple(middle + spread * away)
    server.initial_camera.look_at = tuple(middle)
    for i, (c2w, (_, fy, _, _), (width, height)) in enumerate(zip(c2ws, rays["intrinsics"], rays["sizes"])):
        server.scene.add_camera_frustum(
            f"/cameras/{i:03d}",
            fov=2 * np.arctan(0.5 * height / fy),
            aspect=width / height,
            scale=scale,
            thickness=1.5,
            thickness_units="screen",
            color=(230, 120, 30) if rays["is_val"][i] else (60, 70, 80),
            image=rays["thumbnails"][i],
            wxyz=viser.transforms.SO3.from_matrix(c2w[:3, :3]).wxyz,
            position=c2w[:3, 3],
        )
    start = rays["rays_o"]
    end = start + rays["far"] * rays["rays_d"]
    segments = np.stack([start, end], axis=1)
    server.scene.add_line_segments("/rays", segments, colors=(150, 180, 215), thickness=1, thickness_units="screen")
    points = rays["points"]
    colors = np.repeat(rays["rays_rgb"], points.shape[1], axis=0)
    server.scene.add_point_cloud("/samples", points.reshape(-1, 3), colors=colors, point_size=0.15 * scale, point_shape="circle")


def main() -> None:
    """Serve until interrupted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rays", help="rays.npz of `nerf-oracle inspect`")
    parser.add_argument("--port", type=int, default=8080)
    arguments = parser.parse_args()
    with np.load(arguments.rays) as archive:
        rays = dict(archive)
    server = viser.ViserServer(port=arguments.port)
    show(server, rays)
    print("Stop with Ctrl+C.")
    try:
        while True:
            time.sleep(1)
    except KeyboardInterrupt:
        server.stop()


if __name__ == "__main__":
    main()
