"""Show cameras, rays and samples of `nerf-oracle inspect` in a browser.

    nerf-oracle inspect builtin:spheres --out out/spheres
    python tools/view_rays.py out/spheres/rays.npz [--port 8080]

Frustums carry their photographs (orange frames: validation); lines are rays from their cameras to far; dots are samples, in the
colour of the pixel that their ray goes through.
"""

import argparse
import time

import numpy as np
import viser
import viser.transforms


def show(server: viser.ViserServer, rays: dict[str, np.ndarray], scale: float) -> None:
    """Add everything in `rays` (the arrays of rays.npz) to a server's scene."""
    c2ws, (width, height) = rays["c2ws"], rays["size"]
    # The cameras' own y axis points down.
    server.scene.set_up_direction(tuple(-c2ws[:, :3, 1].mean(axis=0)))
    for i, (c2w, (_, fy, _, _)) in enumerate(zip(c2ws, rays["intrinsics"])):
        server.scene.add_camera_frustum(
            f"/cameras/{i:03d}",
            fov=2 * np.arctan(0.5 * height / fy),
            aspect=width / height,
            scale=scale,
            color=(230, 120, 30) if rays["is_val"][i] else (60, 70, 80),
            image=rays["thumbnails"][i],
            wxyz=viser.transforms.SO3.from_matrix(c2w[:3, :3]).wxyz,
            position=c2w[:3, 3],
        )
    start = rays["rays_o"]
    end = start + rays["far"] * rays["rays_d"]
    server.scene.add_line_segments("/rays", np.stack([start, end], axis=1), colors=(150, 180, 215))
    points = rays["points"]
    colors = np.repeat(rays["rays_rgb"], points.shape[1], axis=0)
    server.scene.add_point_cloud("/samples", points.reshape(-1, 3), colors=colors, point_size=0.1 * scale, point_shape="circle")


def main() -> None:
    """Serve until interrupted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rays", help="rays.npz of `nerf-oracle inspect`")
    parser.add_argument("--port", type=int, default=8080)
    arguments = parser.parse_args()
    with np.load(arguments.rays) as archive:
        rays = dict(archive)
    centres = rays["c2ws"][:, :3, 3]
    spread = float(np.linalg.norm(centres - centres.mean(axis=0), axis=1).max())
    server = viser.ViserServer(port=arguments.port)
    show(server, rays, scale=0.08 * spread)
    print("Stop with Ctrl+C.")
    try:
        while True:
            time.sleep(1)
    except KeyboardInterrupt:
        server.stop()


if __name__ == "__main__":
    main()
