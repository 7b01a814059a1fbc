"""Written by `python -m nerf_oracle.stubs`."""

from typing import Any, Literal, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import NDArray

# Arrays of numpy, torch, jax, cupy; lists; numbers.
Array = Any
Profile = Optional[Literal["cs180", "nerf2020", "kornia-0.8.2", "nerfstudio", "multinerf", "nerfacc", "ngp", "tiny-cuda-nn", "gsplat", "3dgs"]]
Dtype = Literal["f64", "f32", "tf32", "bf16", "f16"]
Float = NDArray[np.float64]


class TransformGradients(NamedTuple):
    grad_c2w: Float
    grad_x_c: Float

class _Transform:
    def __call__(self, c2w: Array, x_c: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: x_w = R x_c + o, with R and o the upper 3x4 of c2w

        homogeneous coordinates; Hartley and Zisserman 2004, section 6.1. Conventions: those of `profile`, cs180 if None.

        Args:
            c2w (M,4,4): camera to world; the upper 3x4 is used
            x_c (M,3): points in camera space

        Returns:
            x_w (M,3): points in world space
        """
    def vjp(self, c2w: Array, x_c: Array, *, grad_x_w: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> TransformGradients:
        """The error bound of the gradient: x_w = R x_c + o, with R and o the upper 3x4 of c2w

        homogeneous coordinates; Hartley and Zisserman 2004, section 6.1. Conventions: those of `profile`, cs180 if None.

        Args:
            c2w (M,4,4): camera to world; the upper 3x4 is used
            x_c (M,3): points in camera space
            grad_x_w (M,3): of the loss, by x_w; zeros where left off

        Returns:
            grad_c2w (M,4,4): of the loss, by c2w
            grad_x_c (M,3): of the loss, by x_c
        """

transform: _Transform


class PixelToCameraGradients(NamedTuple):
    grad_K: Float
    grad_uv: Float
    grad_s: Float

class _PixelToCamera:
    def __call__(self, K: Array, uv: Array, s: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: x_c = s K^-1 (u, v, 1) = s ((u - cx) / fx, (v - cy) / fy, 1)

        pinhole camera; Hartley and Zisserman 2004, section 6.1. Conventions: those of `profile`, cs180 if None.

        Args:
            K (3,3): intrinsics in pixels: fx, fy, cx, cy alone
            uv (M,2): pixel positions, u right, v down
            s (M): depths along the camera's axis

        Returns:
            x_c (M,3): points in camera space
        """
    def vjp(self, K: Array, uv: Array, s: Array, *, grad_x_c: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> PixelToCameraGradients:
        """The error bound of the gradient: x_c = s K^-1 (u, v, 1) = s ((u - cx) / fx, (v - cy) / fy, 1)

        pinhole camera; Hartley and Zisserman 2004, section 6.1. Conventions: those of `profile`, cs180 if None.

        Args:
            K (3,3): intrinsics in pixels: fx, fy, cx, cy alone
            uv (M,2): pixel positions, u right, v down
            s (M): depths along the camera's axis
            grad_x_c (M,3): of the loss, by x_c; zeros where left off

        Returns:
            grad_K (3,3): of the loss, by K
            grad_uv (M,2): of the loss, by uv
            grad_s (M): of the loss, by s
        """

pixel_to_camera: _PixelToCamera


class LensDistortGradients(NamedTuple):
    grad_points: Float
    grad_coefficients: Float

class _LensDistort:
    def __call__(self, points: Array, coefficients: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: x' = x radial + 2 p1 x y + p2 (r^2 + 2 x^2), y' = y radial + p1 (r^2 + 2 y^2) + 2 p2 x y, radial = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)

        OpenCV, Camera Calibration and 3D Reconstruction; Brown 1966. Conventions: those of `profile`, cs180 if None.

        Args:
            points (M,2): ideal points, x/z and y/z in camera space
            coefficients (C): of the lens in OpenCV's order: k1, k2, p1, p2; k3 where there are 5; k4, k5, k6 where there are 8

        Returns:
            distorted (M,2): where they land, in the same units
        """
    def vjp(self, points: Array, coefficients: Array, *, grad_distorted: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> LensDistortGradients:
        """The error bound of the gradient: x' = x radial + 2 p1 x y + p2 (r^2 + 2 x^2), y' = y radial + p1 (r^2 + 2 y^2) + 2 p2 x y, radial = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)

        OpenCV, Camera Calibration and 3D Reconstruction; Brown 1966. Conventions: those of `profile`, cs180 if None.

        Args:
            points (M,2): ideal points, x/z and y/z in camera space
            coefficients (C): of the lens in OpenCV's order: k1, k2, p1, p2; k3 where there are 5; k4, k5, k6 where there are 8
            grad_distorted (M,2): of the loss, by distorted; zeros where left off

        Returns:
            grad_points (M,2): of the loss, by points
            grad_coefficients (C): of the loss, by coefficients
        """

lens_distort: _LensDistort


class LensUndistortGradients(NamedTuple):
    grad_distorted: Float
    grad_coefficients: Float

class _LensUndistort:
    def __call__(self, distorted: Array, coefficients: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: the point before every fold of the lens for which lens_distort(points, coefficients) = distorted

        OpenCV, Camera Calibration and 3D Reconstruction; its inverse, which has no formula. Conventions: those of `profile`, cs180 if None.

        Args:
            distorted (M,2): points of the distorted picture, (u - cx) / fx and (v - cy) / fy
            coefficients (C): of the lens in OpenCV's order: k1, k2, p1, p2; k3 where there are 5; k4, k5, k6 where there are 8

        Returns:
            points (M,2): ideal points, x/z and y/z in camera space
        """
    def vjp(self, distorted: Array, coefficients: Array, *, grad_points: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> LensUndistortGradients:
        """The error bound of the gradient: the point before every fold of the lens for which lens_distort(points, coefficients) = distorted

        OpenCV, Camera Calibration and 3D Reconstruction; its inverse, which has no formula. Conventions: those of `profile`, cs180 if None.

        Args:
            distorted (M,2): points of the distorted picture, (u - cx) / fx and (v - cy) / fy
            coefficients (C): of the lens in OpenCV's order: k1, k2, p1, p2; k3 where there are 5; k4, k5, k6 where there are 8
            grad_points (M,2): of the loss, by points; zeros where left off

        Returns:
            grad_distorted (M,2): of the loss, by distorted
            grad_coefficients (C): of the loss, by coefficients
        """

lens_undistort: _LensUndistort


class FisheyeDistortGradients(NamedTuple):
    grad_points: Float
    grad_coefficients: Float

class _FisheyeDistort:
    def __call__(self, points: Array, coefficients: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: (x', y') = (theta_d / r) (x, y), theta = atan r, theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)

        OpenCV, Fisheye camera model; Kannala and Brandt 2006, equation 6. Conventions: those of `profile`, cs180 if None.

        Args:
            points (M,2): ideal points, x/z and y/z in camera space
            coefficients (4): k1, k2, k3, k4 of the angle's polynomial

        Returns:
            distorted (M,2): where they land, in the same units
        """
    def vjp(self, points: Array, coefficients: Array, *, grad_distorted: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> FisheyeDistortGradients:
        """The error bound of the gradient: (x', y') = (theta_d / r) (x, y), theta = atan r, theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)

        OpenCV, Fisheye camera model; Kannala and Brandt 2006, equation 6. Conventions: those of `profile`, cs180 if None.

        Args:
            points (M,2): ideal points, x/z and y/z in camera space
            coefficients (4): k1, k2, k3, k4 of the angle's polynomial
            grad_distorted (M,2): of the loss, by distorted; zeros where left off

        Returns:
            grad_points (M,2): of the loss, by points
            grad_coefficients (4): of the loss, by coefficients
        """

fisheye_distort: _FisheyeDistort


class FisheyeUndistortGradients(NamedTuple):
    grad_distorted: Float
    grad_coefficients: Float

class _FisheyeUndistort:
    def __call__(self, distorted: Array, coefficients: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: (x, y) = (tan theta / theta_d) (x', y'), theta the angle before every fold with theta_d = |(x', y')|

        OpenCV, Fisheye camera model; its inverse, which has no formula. Conventions: those of `profile`, cs180 if None.

        Args:
            distorted (M,2): points of the fisheye's picture, (u - cx) / fx and (v - cy) / fy
            coefficients (4): k1, k2, k3, k4 of the angle's polynomial

        Returns:
            points (M,2): ideal points, x/z and y/z in camera space
        """
    def vjp(self, distorted: Array, coefficients: Array, *, grad_points: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> FisheyeUndistortGradients:
        """The error bound of the gradient: (x, y) = (tan theta / theta_d) (x', y'), theta the angle before every fold with theta_d = |(x', y')|

        OpenCV, Fisheye camera model; its inverse, which has no formula. Conventions: those of `profile`, cs180 if None.

        Args:
            distorted (M,2): points of the fisheye's picture, (u - cx) / fx and (v - cy) / fy
            coefficients (4): k1, k2, k3, k4 of the angle's polynomial
            grad_points (M,2): of the loss, by points; zeros where left off

        Returns:
            grad_distorted (M,2): of the loss, by distorted
            grad_coefficients (4): of the loss, by coefficients
        """

fisheye_undistort: _FisheyeUndistort


class PoseFromColmapGradients(NamedTuple):
    grad_q: Float
    grad_t: Float

class _PoseFromColmap:
    def __call__(self, q: Array, t: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: c2w = [R^T, -R^T t; 0, 0, 0, 1] with R = R(q), q = (w, x, y, z) and x_c = R x_w + t; columns 2 and 3 negative for OpenGL's axes

        COLMAP documentation, Output Format (images.txt); Shepperd 1978 for R(q). Conventions: those of `profile`, cs180 if None.

        Args:
            q (M,4): unit quaternions of the way from the world to the camera: w, x, y, z
            t (M,3): translations of the same way

        Returns:
            c2w (M,4,4): camera to world, last row 0, 0, 0, 1
        """
    def vjp(self, q: Array, t: Array, *, grad_c2w: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> PoseFromColmapGradients:
        """The error bound of the gradient: c2w = [R^T, -R^T t; 0, 0, 0, 1] with R = R(q), q = (w, x, y, z) and x_c = R x_w + t; columns 2 and 3 negative for OpenGL's axes

        COLMAP documentation, Output Format (images.txt); Shepperd 1978 for R(q). Conventions: those of `profile`, cs180 if None.

        Args:
            q (M,4): unit quaternions of the way from the world to the camera: w, x, y, z
            t (M,3): translations of the same way
            grad_c2w (M,4,4): of the loss, by c2w; zeros where left off

        Returns:
            grad_q (M,4): of the loss, by q
            grad_t (M,3): of the loss, by t
        """

pose_from_colmap: _PoseFromColmap



class _So3Exp:
    def __call__(self, w: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: R = I + sin(theta) / theta K + (1 - cos theta) / theta^2 K^2, K = [w]_x, theta = |w|; at 0 the factors are 1 and 1/2

        Rodrigues 1840; Murray, Li and Sastry 1994, equation 2.14; nerfstudio/cameras/lie_groups.py exp_map_SO3xR3, BARF camera.py so3_to_SO3. Conventions: those of `profile`, cs180 if None.

        Args:
            w (P,3): rotation vectors: axis times angle in radians

        Returns:
            rotations (P,3,3): matrices that turn columns
        """
    def vjp(self, w: Array, *, grad_rotations: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: R = I + sin(theta) / theta K + (1 - cos theta) / theta^2 K^2, K = [w]_x, theta = |w|; at 0 the factors are 1 and 1/2

        Rodrigues 1840; Murray, Li and Sastry 1994, equation 2.14; nerfstudio/cameras/lie_groups.py exp_map_SO3xR3, BARF camera.py so3_to_SO3. Conventions: those of `profile`, cs180 if None.

        Args:
            w (P,3): rotation vectors: axis times angle in radians
            grad_rotations (P,3,3): of the loss, by rotations; zeros where left off

        Returns:
            grad_w (P,3): of the loss, by w
        """

so3_exp: _So3Exp



class _Se3Exp:
    def __call__(self, twists: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: [R, V rho; 0, 0, 0, 1] of a twist (rho, w): R = so3_exp(w), V = I + (1 - cos theta) / theta^2 K + (theta - sin theta) / theta^3 K^2; at 0 the factors are 1/2 and 1/6

        Murray, Li and Sastry 1994, equation 2.36; Blanco 2010, section 10.1; nerfstudio/cameras/lie_groups.py exp_map_SE3, BARF camera.py se3_to_SE3. Conventions: those of `profile`, cs180 if None.

        Args:
            twists (P,6): translational and rotational halves: rho in the scene's units, w in radians

        Returns:
            motions (P,4,4): matrices for columns, last row 0, 0, 0, 1
        """
    def vjp(self, twists: Array, *, grad_motions: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: [R, V rho; 0, 0, 0, 1] of a twist (rho, w): R = so3_exp(w), V = I + (1 - cos theta) / theta^2 K + (theta - sin theta) / theta^3 K^2; at 0 the factors are 1/2 and 1/6

        Murray, Li and Sastry 1994, equation 2.36; Blanco 2010, section 10.1; nerfstudio/cameras/lie_groups.py exp_map_SE3, BARF camera.py se3_to_SE3. Conventions: those of `profile`, cs180 if None.

        Args:
            twists (P,6): translational and rotational halves: rho in the scene's units, w in radians
            grad_motions (P,4,4): of the loss, by motions; zeros where left off

        Returns:
            grad_twists (P,6): of the loss, by twists
        """

se3_exp: _Se3Exp

class PixelToRay(NamedTuple):
    rays_o: Float
    rays_d: Float

class PixelToRayGradients(NamedTuple):
    grad_K: Float
    grad_c2w: Float
    grad_uv: Float

class _PixelToRay:
    def __call__(self, K: Array, c2w: Array, uv: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> PixelToRay:
        """The error bound: o = translation of c2w, d = R K^-1 (u, v, 1) / |R K^-1 (u, v, 1)|

        NeRF (Mildenhall et al. 2020) section 4; CS180 project 4, part 2.1. Conventions: those of `profile`, cs180 if None.

        Args:
            K (3,3): intrinsics in pixels: fx, fy, cx, cy alone
            c2w (M,4,4): camera to world; the upper 3x4 is used
            uv (M,2): pixel positions, u right, v down

        Returns:
            rays_o (M,3): origins, world space
            rays_d (M,3): directions, world space
        """
    def vjp(self, K: Array, c2w: Array, uv: Array, *, grad_rays_o: Optional[Array] = None, grad_rays_d: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> PixelToRayGradients:
        """The error bound of the gradient: o = translation of c2w, d = R K^-1 (u, v, 1) / |R K^-1 (u, v, 1)|

        NeRF (Mildenhall et al. 2020) section 4; CS180 project 4, part 2.1. Conventions: those of `profile`, cs180 if None.

        Args:
            K (3,3): intrinsics in pixels: fx, fy, cx, cy alone
            c2w (M,4,4): camera to world; the upper 3x4 is used
            uv (M,2): pixel positions, u right, v down
            grad_rays_o (M,3): of the loss, by rays_o; zeros where left off
            grad_rays_d (M,3): of the loss, by rays_d; zeros where left off

        Returns:
            grad_K (3,3): of the loss, by K
            grad_c2w (M,4,4): of the loss, by c2w
            grad_uv (M,2): of the loss, by uv
        """

pixel_to_ray: _PixelToRay

class ImageRays(NamedTuple):
    uv: Float
    rays_o: Float
    rays_d: Float


class _ImageRays:
    def __call__(self, height: Array, width: Array, focal: Array, cx: Array, cy: Array, c2w: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> ImageRays:
        """The error bound: pixel_to_ray at uv[j, i] = (i + 0.5, j + 0.5), with fx = fy = focal

        bmild/nerf run_nerf_helpers.py get_rays; CS180 project 4, part 2.2. Conventions: those of `profile`, cs180 if None.

        Args:
            height (a number): rows of pixels
            width (a number): columns of pixels
            focal (a number): focal length in pixels
            cx (a number): principal point, u
            cy (a number): principal point, v
            c2w (4,4): camera to world

        Returns:
            uv (H,W,2): pixel positions
            rays_o (H,W,3): origins
            rays_d (H,W,3): directions
        """

image_rays: _ImageRays

class NdcRays(NamedTuple):
    rays_o_ndc: Float
    rays_d_ndc: Float

class NdcRaysGradients(NamedTuple):
    grad_rays_o: Float
    grad_rays_d: Float

class _NdcRays:
    def __call__(self, rays_o: Array, rays_d: Array, width: Array, height: Array, focal: Array, near: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> NdcRays:
        """The error bound: p = o + t d at depth near; o' = (2f/W p_x/near, 2f/H p_y/near, -1), d' = (2f/W (d_x/|d_z| - p_x/near), 2f/H (d_y/|d_z| - p_y/near), 2)

        NeRF (Mildenhall et al. 2020), appendix C, equations 25 and 26. Conventions: those of `profile`, cs180 if None.

        Args:
            rays_o (R,3): origins
            rays_d (R,3): directions, as they come, not across the axis (d_z = 0)
            width (a number): width of the picture, in pixels
            height (a number): height of the picture, in pixels
            focal (a number): focal length, in pixels
            near (a number): depth of the near plane

        Returns:
            rays_o_ndc (R,3): where rays meet the near plane, z = -1
            rays_d_ndc (R,3): from there to where they meet infinity, z = 2; not unit
        """
    def vjp(self, rays_o: Array, rays_d: Array, width: Array, height: Array, focal: Array, near: Array, *, grad_rays_o_ndc: Optional[Array] = None, grad_rays_d_ndc: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> NdcRaysGradients:
        """The error bound of the gradient: p = o + t d at depth near; o' = (2f/W p_x/near, 2f/H p_y/near, -1), d' = (2f/W (d_x/|d_z| - p_x/near), 2f/H (d_y/|d_z| - p_y/near), 2)

        NeRF (Mildenhall et al. 2020), appendix C, equations 25 and 26. Conventions: those of `profile`, cs180 if None.

        Args:
            rays_o (R,3): origins
            rays_d (R,3): directions, as they come, not across the axis (d_z = 0)
            width (a number): width of the picture, in pixels
            height (a number): height of the picture, in pixels
            focal (a number): focal length, in pixels
            near (a number): depth of the near plane
            grad_rays_o_ndc (R,3): of the loss, by rays_o_ndc; zeros where left off
            grad_rays_d_ndc (R,3): of the loss, by rays_d_ndc; zeros where left off

        Returns:
            grad_rays_o (R,3): of the loss, by rays_o
            grad_rays_d (R,3): of the loss, by rays_d
        """

ndc_rays: _NdcRays

class SampleAlongRays(NamedTuple):
    t: Float
    points: Float


class _SampleAlongRays:
    def __call__(self, rays_o: Array, rays_d: Array, near: Array, far: Array, u: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> SampleAlongRays:
        """The error bound: D = (far - near) / N, t_i = near + (i + u_i) D, points = o + t d

        NeRF (Mildenhall et al. 2020) equation 2. Conventions: those of `profile`, cs180 if None.

        Args:
            rays_o (R,3): origins
            rays_d (R,3): directions, as they come
            near (a number): where rays begin
            far (a number): where rays end
            u (R,N): numbers in [0, 1), one for every sample

        Returns:
            t (R,N): positions along the ray
            points (R,N,3): o + t d
        """

sample_along_rays: _SampleAlongRays



class _StepSizes:
    def __call__(self, t: Array, near: Array, far: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: delta = (far - near) / N; by convention t_{i+1} - t_i, with a stated last one

        NeRF (Mildenhall et al. 2020) equation 3; CS180 project 4, part 2.5. Conventions: those of `profile`, cs180 if None.

        Args:
            t (R,N): positions along the ray
            near (a number): where rays begin
            far (a number): where rays end

        Returns:
            deltas (R,N): step lengths
        """

step_sizes: _StepSizes

class ConicalFrustum(NamedTuple):
    t_mean: Float
    t_variance: Float
    r_variance: Float
    means: Float
    variances: Float

class ConicalFrustumGradients(NamedTuple):
    grad_origins: Float
    grad_directions: Float
    grad_radii: Float
    grad_starts: Float
    grad_ends: Float

class _ConicalFrustum:
    def __call__(self, origins: Array, directions: Array, radii: Array, starts: Array, ends: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> ConicalFrustum:
        """The error bound: mean o + t_mean d, variances t_variance d_i^2 + r_variance (1 - d_i^2 / |d|^2); with s = start + end, d = end - start and q = d^2 / (3 s^2 + d^2): t_mean = s (1/2 + q), t_variance = d^2 (5 - 16 q + 20 q^2) / 60, r_variance = r^2 (s^2 / 16 + d^2 (5/48 - q / 15))

        mip-NeRF (Barron et al. 2021) equations 7 and 8; google/mipnerf internal/mip.py conical_frustum_to_gaussian, lift_gaussian. Conventions: those of `profile`, cs180 if None.

        Args:
            origins (M,3): where rays begin
            directions (M,3): of any length but 0, in which t counts
            radii (M): a cone's at t = 1, or a cylinder's
            starts (M): first t of the intervals, not below 0
            ends (M): last t, not below the first

        Returns:
            t_mean (M): mean of t
            t_variance (M): variance of t
            r_variance (M): variance across the ray
            means (M,3): means in space
            variances (M,3): diagonals of the covariances in space
        """
    def vjp(self, origins: Array, directions: Array, radii: Array, starts: Array, ends: Array, *, grad_t_mean: Optional[Array] = None, grad_t_variance: Optional[Array] = None, grad_r_variance: Optional[Array] = None, grad_means: Optional[Array] = None, grad_variances: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> ConicalFrustumGradients:
        """The error bound of the gradient: mean o + t_mean d, variances t_variance d_i^2 + r_variance (1 - d_i^2 / |d|^2); with s = start + end, d = end - start and q = d^2 / (3 s^2 + d^2): t_mean = s (1/2 + q), t_variance = d^2 (5 - 16 q + 20 q^2) / 60, r_variance = r^2 (s^2 / 16 + d^2 (5/48 - q / 15))

        mip-NeRF (Barron et al. 2021) equations 7 and 8; google/mipnerf internal/mip.py conical_frustum_to_gaussian, lift_gaussian. Conventions: those of `profile`, cs180 if None.

        Args:
            origins (M,3): where rays begin
            directions (M,3): of any length but 0, in which t counts
            radii (M): a cone's at t = 1, or a cylinder's
            starts (M): first t of the intervals, not below 0
            ends (M): last t, not below the first
            grad_t_mean (M): of the loss, by t_mean; zeros where left off
            grad_t_variance (M): of the loss, by t_variance; zeros where left off
            grad_r_variance (M): of the loss, by r_variance; zeros where left off
            grad_means (M,3): of the loss, by means; zeros where left off
            grad_variances (M,3): of the loss, by variances; zeros where left off

        Returns:
            grad_origins (M,3): of the loss, by origins
            grad_directions (M,3): of the loss, by directions
            grad_radii (M): of the loss, by radii
            grad_starts (M): of the loss, by starts
            grad_ends (M): of the loss, by ends
        """

conical_frustum: _ConicalFrustum



class _Contraction:
    def __call__(self, x: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: x for |x| <= 1, (2 - 1/|x|) x/|x| beyond; which norm, and the scale of the result, by convention

        mip-NeRF 360 (Barron et al. 2022), equation 10; MERF (Reiser et al. 2023), equation 4. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M,3): points; what is near lies within length 1

        Returns:
            contracted (M,3): where they come to lie, within 2 of the origin, or scaled
        """
    def vjp(self, x: Array, *, grad_contracted: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: x for |x| <= 1, (2 - 1/|x|) x/|x| beyond; which norm, and the scale of the result, by convention

        mip-NeRF 360 (Barron et al. 2022), equation 10; MERF (Reiser et al. 2023), equation 4. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M,3): points; what is near lies within length 1
            grad_contracted (M,3): of the loss, by contracted; zeros where left off

        Returns:
            grad_x (M,3): of the loss, by x
        """

contraction: _Contraction

class ContractGaussians(NamedTuple):
    contracted_means: Float
    contracted_covariances: Float

class ContractGaussiansGradients(NamedTuple):
    grad_means: Float
    grad_covariances: Float

class _ContractGaussians:
    def __call__(self, means: Array, covariances: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> ContractGaussians:
        """The error bound: f(mean), J Sigma J^T; J the Jacobian of the contraction f at the mean

        mip-NeRF 360 (Barron et al. 2022), section 3.1 and equation 10; multinerf internal/coord.py track_linearize. Conventions: those of `profile`, cs180 if None.

        Args:
            means (M,3): what is near lies within length 1
            covariances (M,3,3): symmetric; a gradient has all nine entries

        Returns:
            contracted_means (M,3): within 2 of the origin, or scaled
            contracted_covariances (M,3,3): of the contraction's tangents at the means
        """
    def vjp(self, means: Array, covariances: Array, *, grad_contracted_means: Optional[Array] = None, grad_contracted_covariances: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> ContractGaussiansGradients:
        """The error bound of the gradient: f(mean), J Sigma J^T; J the Jacobian of the contraction f at the mean

        mip-NeRF 360 (Barron et al. 2022), section 3.1 and equation 10; multinerf internal/coord.py track_linearize. Conventions: those of `profile`, cs180 if None.

        Args:
            means (M,3): what is near lies within length 1
            covariances (M,3,3): symmetric; a gradient has all nine entries
            grad_contracted_means (M,3): of the loss, by contracted_means; zeros where left off
            grad_contracted_covariances (M,3,3): of the loss, by contracted_covariances; zeros where left off

        Returns:
            grad_means (M,3): of the loss, by means
            grad_covariances (M,3,3): of the loss, by covariances
        """

contract_gaussians: _ContractGaussians



class _PositionalEncoding:
    def __call__(self, x: Array, L: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: x, then sin(2^k pi x), cos(2^k pi x) for k = 0, ..., L - 1

        NeRF (Mildenhall et al. 2020) equation 4. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M,D): points, period 2 in band 0
            L (a number): number of bands

        Returns:
            encoding (M,D+2LD): identity, then the bands
        """
    def vjp(self, x: Array, L: Array, *, grad_encoding: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: x, then sin(2^k pi x), cos(2^k pi x) for k = 0, ..., L - 1

        NeRF (Mildenhall et al. 2020) equation 4. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M,D): points, period 2 in band 0
            L (a number): number of bands
            grad_encoding (M,D+2LD): of the loss, by encoding; zeros where left off

        Returns:
            grad_x (M,D): of the loss, by x
        """

positional_encoding: _PositionalEncoding


class IntegratedEncodingGradients(NamedTuple):
    grad_means: Float
    grad_variances: Float

class _IntegratedEncoding:
    def __call__(self, means: Array, variances: Array, L: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: sin(2^k pi x) e, cos(2^k pi x) e with e = exp(-(2^k pi)^2 v / 2), for k = 0, ..., L - 1

        mip-NeRF (Barron et al. 2021) equations 11 to 16; google/mipnerf internal/mip.py integrated_pos_enc. Conventions: those of `profile`, cs180 if None.

        Args:
            means (M,D): of Gaussians, period 2 in band 0
            variances (M,D): diagonals of their covariances
            L (a number): number of bands

        Returns:
            encoding (M,2LD): the bands; identity, where it is kept
        """
    def vjp(self, means: Array, variances: Array, L: Array, *, grad_encoding: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> IntegratedEncodingGradients:
        """The error bound of the gradient: sin(2^k pi x) e, cos(2^k pi x) e with e = exp(-(2^k pi)^2 v / 2), for k = 0, ..., L - 1

        mip-NeRF (Barron et al. 2021) equations 11 to 16; google/mipnerf internal/mip.py integrated_pos_enc. Conventions: those of `profile`, cs180 if None.

        Args:
            means (M,D): of Gaussians, period 2 in band 0
            variances (M,D): diagonals of their covariances
            L (a number): number of bands
            grad_encoding (M,2LD): of the loss, by encoding; zeros where left off

        Returns:
            grad_means (M,D): of the loss, by means
            grad_variances (M,D): of the loss, by variances
        """

integrated_encoding: _IntegratedEncoding



class _Mlp:
    def __call__(self, x: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False, **layers: Array) -> Float:
        """The error bound: h_0 = x, z_n = w_n h_n + b_n, h_{n+1} = max(z_n, 0), y = sigmoid(z_last)

        Berkeley CS180 project 4, part 1; Tancik et al. 2020. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M,D): points
            w* (out,in): weights of layer 0, 1, ...
            b* (out): biases of layer 0, 1, ...

        Returns:
            y (M,O): colors in [0, 1]
        """
    def vjp(self, x: Array, *, grad_y: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False, **layers: Array) -> dict[str, Float]:
        """The error bound of the gradient: h_0 = x, z_n = w_n h_n + b_n, h_{n+1} = max(z_n, 0), y = sigmoid(z_last)

        Berkeley CS180 project 4, part 1; Tancik et al. 2020. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M,D): points
            w* (out,in): weights of layer 0, 1, ...
            b* (out): biases of layer 0, 1, ...
            grad_y (M,O): of the loss, by y; zeros where left off

        Returns:
            grad_x (M,D): of the loss, by x
            grad_w* (out,in): of the loss, by w*
            grad_b* (out): of the loss, by b*
        """

mlp: _Mlp

class NerfMlp(NamedTuple):
    sigmas: Float
    rgbs: Float

class NerfMlpGradients(NamedTuple):
    grad_positions: Float
    grad_trunk0_w: Float
    grad_trunk0_b: Float
    grad_trunk1_w: Float
    grad_trunk1_b: Float
    grad_trunk2_w: Float
    grad_trunk2_b: Float
    grad_trunk3_w: Float
    grad_trunk3_b: Float
    grad_trunk4_w: Float
    grad_trunk4_b: Float
    grad_trunk5_w: Float
    grad_trunk5_b: Float
    grad_trunk6_w: Float
    grad_trunk6_b: Float
    grad_trunk7_w: Float
    grad_trunk7_b: Float
    grad_sigma_w: Float
    grad_sigma_b: Float
    grad_feature_w: Float
    grad_feature_b: Float
    grad_color0_w: Float
    grad_color0_b: Float
    grad_color1_w: Float
    grad_color1_b: Float

class _NerfMlp:
    def __call__(self, positions: Array, directions: Array, trunk0_w: Array, trunk0_b: Array, trunk1_w: Array, trunk1_b: Array, trunk2_w: Array, trunk2_b: Array, trunk3_w: Array, trunk3_b: Array, trunk4_w: Array, trunk4_b: Array, trunk5_w: Array, trunk5_b: Array, trunk6_w: Array, trunk6_b: Array, trunk7_w: Array, trunk7_b: Array, sigma_w: Array, sigma_b: Array, feature_w: Array, feature_b: Array, color0_w: Array, color0_b: Array, color1_w: Array, color1_b: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> NerfMlp:
        """The error bound: h = trunk(encode(x)), the encoding again in trunk 4; sigma = max(w h + b, 0); rgb = sigmoid(color1 relu(color0 [feature h, encode(d)]))

        NeRF (Mildenhall et al. 2020) figure 7. Conventions: those of `profile`, cs180 if None.

        Args:
            positions (M,3): positions in scene units
            directions (M,3): viewing directions
            trunk0_w (out,in): weights
            trunk0_b (out): biases
            trunk1_w (out,in): weights
            trunk1_b (out): biases
            trunk2_w (out,in): weights
            trunk2_b (out): biases
            trunk3_w (out,in): weights
            trunk3_b (out): biases
            trunk4_w (out,in): weights
            trunk4_b (out): biases
            trunk5_w (out,in): weights
            trunk5_b (out): biases
            trunk6_w (out,in): weights
            trunk6_b (out): biases
            trunk7_w (out,in): weights
            trunk7_b (out): biases
            sigma_w (out,in): weights
            sigma_b (out): biases
            feature_w (out,in): weights
            feature_b (out): biases
            color0_w (out,in): weights
            color0_b (out): biases
            color1_w (out,in): weights
            color1_b (out): biases

        Returns:
            sigmas (M): densities, 1 / length
            rgbs (M,3): colors in [0, 1]
        """
    def vjp(self, positions: Array, directions: Array, trunk0_w: Array, trunk0_b: Array, trunk1_w: Array, trunk1_b: Array, trunk2_w: Array, trunk2_b: Array, trunk3_w: Array, trunk3_b: Array, trunk4_w: Array, trunk4_b: Array, trunk5_w: Array, trunk5_b: Array, trunk6_w: Array, trunk6_b: Array, trunk7_w: Array, trunk7_b: Array, sigma_w: Array, sigma_b: Array, feature_w: Array, feature_b: Array, color0_w: Array, color0_b: Array, color1_w: Array, color1_b: Array, *, grad_sigmas: Optional[Array] = None, grad_rgbs: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> NerfMlpGradients:
        """The error bound of the gradient: h = trunk(encode(x)), the encoding again in trunk 4; sigma = max(w h + b, 0); rgb = sigmoid(color1 relu(color0 [feature h, encode(d)]))

        NeRF (Mildenhall et al. 2020) figure 7. Conventions: those of `profile`, cs180 if None.

        Args:
            positions (M,3): positions in scene units
            directions (M,3): viewing directions
            trunk0_w (out,in): weights
            trunk0_b (out): biases
            trunk1_w (out,in): weights
            trunk1_b (out): biases
            trunk2_w (out,in): weights
            trunk2_b (out): biases
            trunk3_w (out,in): weights
            trunk3_b (out): biases
            trunk4_w (out,in): weights
            trunk4_b (out): biases
            trunk5_w (out,in): weights
            trunk5_b (out): biases
            trunk6_w (out,in): weights
            trunk6_b (out): biases
            trunk7_w (out,in): weights
            trunk7_b (out): biases
            sigma_w (out,in): weights
            sigma_b (out): biases
            feature_w (out,in): weights
            feature_b (out): biases
            color0_w (out,in): weights
            color0_b (out): biases
            color1_w (out,in): weights
            color1_b (out): biases
            grad_sigmas (M): of the loss, by sigmas; zeros where left off
            grad_rgbs (M,3): of the loss, by rgbs; zeros where left off

        Returns:
            grad_positions (M,3): of the loss, by positions
            grad_trunk0_w (out,in): of the loss, by trunk0_w
            grad_trunk0_b (out): of the loss, by trunk0_b
            grad_trunk1_w (out,in): of the loss, by trunk1_w
            grad_trunk1_b (out): of the loss, by trunk1_b
            grad_trunk2_w (out,in): of the loss, by trunk2_w
            grad_trunk2_b (out): of the loss, by trunk2_b
            grad_trunk3_w (out,in): of the loss, by trunk3_w
            grad_trunk3_b (out): of the loss, by trunk3_b
            grad_trunk4_w (out,in): of the loss, by trunk4_w
            grad_trunk4_b (out): of the loss, by trunk4_b
            grad_trunk5_w (out,in): of the loss, by trunk5_w
            grad_trunk5_b (out): of the loss, by trunk5_b
            grad_trunk6_w (out,in): of the loss, by trunk6_w
            grad_trunk6_b (out): of the loss, by trunk6_b
            grad_trunk7_w (out,in): of the loss, by trunk7_w
            grad_trunk7_b (out): of the loss, by trunk7_b
            grad_sigma_w (out,in): of the loss, by sigma_w
            grad_sigma_b (out): of the loss, by sigma_b
            grad_feature_w (out,in): of the loss, by feature_w
            grad_feature_b (out): of the loss, by feature_b
            grad_color0_w (out,in): of the loss, by color0_w
            grad_color0_b (out): of the loss, by color0_b
            grad_color1_w (out,in): of the loss, by color1_w
            grad_color1_b (out): of the loss, by color1_b
        """

nerf_mlp: _NerfMlp



class _HashGrid:
    def __call__(self, x: Array, base: Array, finest: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False, **layers: Array) -> Float:
        """The error bound: level l of L tables has N_l = round(base (finest / base)^(l / (L - 1))) cells along an edge; x N_l = cell + fraction, at x = 1 in the last cell; sum over the cell's 8 corners of trilinear weight times entry; entry x + (N + 1) (y + (N + 1) z) where (N + 1)^3 <= E, else (x xor 2654435761 y xor 805459861 z) mod E

        Instant-NGP (Mueller et al. 2022) equations 1 to 4, N rounded to nearest; by convention as tiny-cuda-nn, torch-ngp or nerfstudio have it. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M,3): points of the unit box, [0, 1]
            table* (E,F): E entries of level 0, 1, ..., a power of two; dense where (N + 1)^3 <= E
            base (a number): cells along an edge of the coarsest level, a whole number
            finest (a number): cells along an edge of the finest level, a whole number

        Returns:
            encoding (M,LF): features, level by level
        """
    def vjp(self, x: Array, base: Array, finest: Array, *, grad_encoding: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False, **layers: Array) -> dict[str, Float]:
        """The error bound of the gradient: level l of L tables has N_l = round(base (finest / base)^(l / (L - 1))) cells along an edge; x N_l = cell + fraction, at x = 1 in the last cell; sum over the cell's 8 corners of trilinear weight times entry; entry x + (N + 1) (y + (N + 1) z) where (N + 1)^3 <= E, else (x xor 2654435761 y xor 805459861 z) mod E

        Instant-NGP (Mueller et al. 2022) equations 1 to 4, N rounded to nearest; by convention as tiny-cuda-nn, torch-ngp or nerfstudio have it. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M,3): points of the unit box, [0, 1]
            table* (E,F): E entries of level 0, 1, ..., a power of two; dense where (N + 1)^3 <= E
            base (a number): cells along an edge of the coarsest level, a whole number
            finest (a number): cells along an edge of the finest level, a whole number
            grad_encoding (M,LF): of the loss, by encoding; zeros where left off

        Returns:
            grad_x (M,3): of the loss, by x
            grad_table* (E,F): of the loss, by table*
        """

hash_grid: _HashGrid



class _SphericalHarmonics:
    def __call__(self, d: Array, degree: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: Y_l^m(d) for l = 0, ..., degree and m = -l, ..., l, real, orthonormal, sign (-1)^m (none by convention)

        Sloan, Stupid Spherical Harmonics Tricks (2008), A2; Instant-NGP (Mueller et al. 2022) section 5.3. Conventions: those of `profile`, cs180 if None.

        Args:
            d (M,3): directions of length 1, components in [-1, 1]
            degree (a number): last band, 0 to 4

        Returns:
            harmonics (M,(degree+1)^2): band by band, m ascending
        """
    def vjp(self, d: Array, degree: Array, *, grad_harmonics: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: Y_l^m(d) for l = 0, ..., degree and m = -l, ..., l, real, orthonormal, sign (-1)^m (none by convention)

        Sloan, Stupid Spherical Harmonics Tricks (2008), A2; Instant-NGP (Mueller et al. 2022) section 5.3. Conventions: those of `profile`, cs180 if None.

        Args:
            d (M,3): directions of length 1, components in [-1, 1]
            degree (a number): last band, 0 to 4
            grad_harmonics (M,(degree+1)^2): of the loss, by harmonics; zeros where left off

        Returns:
            grad_d (M,3): of the loss, by d
        """

spherical_harmonics: _SphericalHarmonics



class _TruncExp:
    def __call__(self, x: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: sigma = e^x, or e^clamp(x, -15, 15) by convention; the gradient is stated, not derived: grad_x = grad_sigma e^clamp(x, -15, 15), by convention e^min(x, 15)

        Instant-NGP (Mueller et al. 2022) src/testbed_nerf.cu network_to_density_derivative; torch-ngp activation.py. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M): what the network says about density

        Returns:
            sigmas (M): densities, 1 / length
        """
    def vjp(self, x: Array, *, grad_sigmas: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: sigma = e^x, or e^clamp(x, -15, 15) by convention; the gradient is stated, not derived: grad_x = grad_sigma e^clamp(x, -15, 15), by convention e^min(x, 15)

        Instant-NGP (Mueller et al. 2022) src/testbed_nerf.cu network_to_density_derivative; torch-ngp activation.py. Conventions: those of `profile`, cs180 if None.

        Args:
            x (M): what the network says about density
            grad_sigmas (M): of the loss, by sigmas; zeros where left off

        Returns:
            grad_x (M): of the loss, by x
        """

trunc_exp: _TruncExp

class VolumeRender(NamedTuple):
    colors: Float
    weights: Float
    opacity: Float
    transmittance: Float

class VolumeRenderGradients(NamedTuple):
    grad_sigmas: Float
    grad_rgbs: Float
    grad_deltas: Float

class _VolumeRender:
    def __call__(self, sigmas: Array, rgbs: Array, deltas: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> VolumeRender:
        """The error bound: alpha_i = 1 - exp(-sigma_i delta_i), T_i = exp(-sum_{j<i} sigma_j delta_j), w_i = T_i alpha_i, C = sum w_i c_i

        NeRF (Mildenhall et al. 2020) equation 3. Conventions: those of `profile`, cs180 if None.

        Args:
            sigmas (R,N): densities, 1 / length
            rgbs (R,N,3): colors
            deltas (R,N): step lengths

        Returns:
            colors (R,3): sum of w c
            weights (R,N): T alpha
            opacity (R): sum of w
            transmittance (R): T behind the last sample
        """
    def vjp(self, sigmas: Array, rgbs: Array, deltas: Array, *, grad_colors: Optional[Array] = None, grad_weights: Optional[Array] = None, grad_opacity: Optional[Array] = None, grad_transmittance: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> VolumeRenderGradients:
        """The error bound of the gradient: alpha_i = 1 - exp(-sigma_i delta_i), T_i = exp(-sum_{j<i} sigma_j delta_j), w_i = T_i alpha_i, C = sum w_i c_i

        NeRF (Mildenhall et al. 2020) equation 3. Conventions: those of `profile`, cs180 if None.

        Args:
            sigmas (R,N): densities, 1 / length
            rgbs (R,N,3): colors
            deltas (R,N): step lengths
            grad_colors (R,3): of the loss, by colors; zeros where left off
            grad_weights (R,N): of the loss, by weights; zeros where left off
            grad_opacity (R): of the loss, by opacity; zeros where left off
            grad_transmittance (R): of the loss, by transmittance; zeros where left off

        Returns:
            grad_sigmas (R,N): of the loss, by sigmas
            grad_rgbs (R,N,3): of the loss, by rgbs
            grad_deltas (R,N): of the loss, by deltas
        """

volume_render: _VolumeRender

class VolumeRenderAlpha(NamedTuple):
    colors: Float
    weights: Float
    opacity: Float
    transmittance: Float

class VolumeRenderAlphaGradients(NamedTuple):
    grad_alphas: Float
    grad_rgbs: Float

class _VolumeRenderAlpha:
    def __call__(self, alphas: Array, rgbs: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> VolumeRenderAlpha:
        """The error bound: T_i = prod_{j<i} (1 - alpha_j), w_i = T_i alpha_i, C = sum w_i c_i

        NeRF (Mildenhall et al. 2020) equation 3, with alpha given. Conventions: those of `profile`, cs180 if None.

        Args:
            alphas (R,N): opacities in [0, 1]
            rgbs (R,N,3): colors

        Returns:
            colors (R,3): sum of w c
            weights (R,N): T alpha
            opacity (R): sum of w
            transmittance (R): T behind the last sample
        """
    def vjp(self, alphas: Array, rgbs: Array, *, grad_colors: Optional[Array] = None, grad_weights: Optional[Array] = None, grad_opacity: Optional[Array] = None, grad_transmittance: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> VolumeRenderAlphaGradients:
        """The error bound of the gradient: T_i = prod_{j<i} (1 - alpha_j), w_i = T_i alpha_i, C = sum w_i c_i

        NeRF (Mildenhall et al. 2020) equation 3, with alpha given. Conventions: those of `profile`, cs180 if None.

        Args:
            alphas (R,N): opacities in [0, 1]
            rgbs (R,N,3): colors
            grad_colors (R,3): of the loss, by colors; zeros where left off
            grad_weights (R,N): of the loss, by weights; zeros where left off
            grad_opacity (R): of the loss, by opacity; zeros where left off
            grad_transmittance (R): of the loss, by transmittance; zeros where left off

        Returns:
            grad_alphas (R,N): of the loss, by alphas
            grad_rgbs (R,N,3): of the loss, by rgbs
        """

volume_render_alpha: _VolumeRenderAlpha


class CompositeBackgroundGradients(NamedTuple):
    grad_colors: Float
    grad_opacity: Float
    grad_background: Float

class _CompositeBackground:
    def __call__(self, colors: Array, opacity: Array, background: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: C' = C + (1 - A) b

        Porter and Duff 1984, premultiplied over. Conventions: those of `profile`, cs180 if None.

        Args:
            colors (R,3): rendered colors, premultiplied
            opacity (R): A
            background (3): b

        Returns:
            colors_out (R,3): colors over b
        """
    def vjp(self, colors: Array, opacity: Array, background: Array, *, grad_colors_out: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> CompositeBackgroundGradients:
        """The error bound of the gradient: C' = C + (1 - A) b

        Porter and Duff 1984, premultiplied over. Conventions: those of `profile`, cs180 if None.

        Args:
            colors (R,3): rendered colors, premultiplied
            opacity (R): A
            background (3): b
            grad_colors_out (R,3): of the loss, by colors_out; zeros where left off

        Returns:
            grad_colors (R,3): of the loss, by colors
            grad_opacity (R): of the loss, by opacity
            grad_background (3): of the loss, by background
        """

composite_background: _CompositeBackground


class DepthGradients(NamedTuple):
    grad_weights: Float
    grad_t: Float

class _Depth:
    def __call__(self, weights: Array, t: Array, far: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: z = sum w_i t_i / sum w_i, far where the ray meets nothing (by convention 0, the first t or the last)

        bmild/nerf run_nerf.py raw2outputs (undivided); nerfstudio renderers.py (divided). Conventions: those of `profile`, cs180 if None.

        Args:
            weights (R,N): w
            t (R,N): distances
            far (a number): depth of an empty ray

        Returns:
            depth (R): expected distance
        """
    def vjp(self, weights: Array, t: Array, far: Array, *, grad_depth: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> DepthGradients:
        """The error bound of the gradient: z = sum w_i t_i / sum w_i, far where the ray meets nothing (by convention 0, the first t or the last)

        bmild/nerf run_nerf.py raw2outputs (undivided); nerfstudio renderers.py (divided). Conventions: those of `profile`, cs180 if None.

        Args:
            weights (R,N): w
            t (R,N): distances
            far (a number): depth of an empty ray
            grad_depth (R): of the loss, by depth; zeros where left off

        Returns:
            grad_weights (R,N): of the loss, by weights
            grad_t (R,N): of the loss, by t
        """

depth: _Depth

class PackInfo(NamedTuple):
    starts: Float
    counts: Float


class _PackInfo:
    def __call__(self, ray_ids: Array, rays: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> PackInfo:
        """The error bound: count_r = the number of samples of ray r, start_r = sum_{q<r} count_q

        nerfacc (Li et al. 2023), pack_info. Conventions: those of `profile`, cs180 if None.

        Args:
            ray_ids (S): the ray of each sample, ascending
            rays (a number): the number of rays, with those that have no samples

        Returns:
            starts (R): a ray's first sample; of an empty ray, the next one's
            counts (R): a ray's number of samples
        """

pack_info: _PackInfo

class PackedScan(NamedTuple):
    exclusive_sum: Float
    inclusive_sum: Float
    exclusive_product: Float
    inclusive_product: Float


class _PackedScan:
    def __call__(self, x: Array, offsets: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> PackedScan:
        """The error bound: over the samples j of i's ray: sum_{j<i} x_j, sum_{j<=i} x_j, prod_{j<i} x_j, prod_{j<=i} x_j

        nerfacc (Li et al. 2023), exclusive_sum, inclusive_sum, exclusive_prod, inclusive_prod. Conventions: those of `profile`, cs180 if None.

        Args:
            x (S): a number for each sample, rays one after the other
            offsets (R+1): each ray's first sample and, last, S; a ray may have none

        Returns:
            exclusive_sum (S): 0 for a ray's first sample
            inclusive_sum (S): with the sample itself
            exclusive_product (S): 1 for a ray's first sample
            inclusive_product (S): with the sample itself
        """
    def vjp(self, x: Array, offsets: Array, *, grad_exclusive_sum: Optional[Array] = None, grad_inclusive_sum: Optional[Array] = None, grad_exclusive_product: Optional[Array] = None, grad_inclusive_product: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: over the samples j of i's ray: sum_{j<i} x_j, sum_{j<=i} x_j, prod_{j<i} x_j, prod_{j<=i} x_j

        nerfacc (Li et al. 2023), exclusive_sum, inclusive_sum, exclusive_prod, inclusive_prod. Conventions: those of `profile`, cs180 if None.

        Args:
            x (S): a number for each sample, rays one after the other
            offsets (R+1): each ray's first sample and, last, S; a ray may have none
            grad_exclusive_sum (S): of the loss, by exclusive_sum; zeros where left off
            grad_inclusive_sum (S): of the loss, by inclusive_sum; zeros where left off
            grad_exclusive_product (S): of the loss, by exclusive_product; zeros where left off
            grad_inclusive_product (S): of the loss, by inclusive_product; zeros where left off

        Returns:
            grad_x (S): of the loss, by x
        """

packed_scan: _PackedScan


class AccumulateAlongRaysGradients(NamedTuple):
    grad_weights: Float
    grad_values: Float

class _AccumulateAlongRays:
    def __call__(self, weights: Array, values: Array, offsets: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: sum_i w_i v_i over the samples i of each ray; 0 without samples

        nerfacc (Li et al. 2023), accumulate_along_rays; NeRF equation 3. Conventions: those of `profile`, cs180 if None.

        Args:
            weights (S): weights, rays one after the other
            values (S,3): colors, or whatever is weighted
            offsets (R+1): each ray's first sample and, last, S; a ray may have none

        Returns:
            sums (R,3): weighted sums, not divided by the weights' sum
        """
    def vjp(self, weights: Array, values: Array, offsets: Array, *, grad_sums: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> AccumulateAlongRaysGradients:
        """The error bound of the gradient: sum_i w_i v_i over the samples i of each ray; 0 without samples

        nerfacc (Li et al. 2023), accumulate_along_rays; NeRF equation 3. Conventions: those of `profile`, cs180 if None.

        Args:
            weights (S): weights, rays one after the other
            values (S,3): colors, or whatever is weighted
            offsets (R+1): each ray's first sample and, last, S; a ray may have none
            grad_sums (R,3): of the loss, by sums; zeros where left off

        Returns:
            grad_weights (S): of the loss, by weights
            grad_values (S,3): of the loss, by values
        """

accumulate_along_rays: _AccumulateAlongRays

class EarlyStop(NamedTuple):
    live: Float
    colors: Float
    weights: Float
    opacity: Float
    transmittance: Float

class EarlyStopGradients(NamedTuple):
    grad_sigmas: Float
    grad_rgbs: Float
    grad_deltas: Float

class _EarlyStop:
    def __call__(self, sigmas: Array, rgbs: Array, deltas: Array, offsets: Array, eps: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> EarlyStop:
        """The error bound: ray r has samples offsets_r, ..., offsets_{r+1} - 1; live_r = up to and with the first behind which T < eps; volume_render of these, not renormalized

        Instant-NGP (Mueller et al. 2022) appendix C.1, without its division by the opacity. Conventions: those of `profile`, cs180 if None.

        Args:
            sigmas (S): densities of all rays' samples, 1 / length
            rgbs (S,3): colors
            deltas (S): step lengths
            offsets (R+1): where each ray's samples begin, and S; whole numbers
            eps (a number): smallest transmittance that is followed; 0: never stop

        Returns:
            live (R): samples used of each ray, the last one included
            colors (R,3): sum of w c over the live samples
            weights (S): T alpha, 0 behind the last live sample
            opacity (R): sum of w
            transmittance (R): T behind the last live sample
        """
    def vjp(self, sigmas: Array, rgbs: Array, deltas: Array, offsets: Array, eps: Array, *, grad_colors: Optional[Array] = None, grad_weights: Optional[Array] = None, grad_opacity: Optional[Array] = None, grad_transmittance: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> EarlyStopGradients:
        """The error bound of the gradient: ray r has samples offsets_r, ..., offsets_{r+1} - 1; live_r = up to and with the first behind which T < eps; volume_render of these, not renormalized

        Instant-NGP (Mueller et al. 2022) appendix C.1, without its division by the opacity. Conventions: those of `profile`, cs180 if None.

        Args:
            sigmas (S): densities of all rays' samples, 1 / length
            rgbs (S,3): colors
            deltas (S): step lengths
            offsets (R+1): where each ray's samples begin, and S; whole numbers
            eps (a number): smallest transmittance that is followed; 0: never stop
            grad_colors (R,3): of the loss, by colors; zeros where left off
            grad_weights (S): of the loss, by weights; zeros where left off
            grad_opacity (R): of the loss, by opacity; zeros where left off
            grad_transmittance (R): of the loss, by transmittance; zeros where left off

        Returns:
            grad_sigmas (S): of the loss, by sigmas
            grad_rgbs (S,3): of the loss, by rgbs
            grad_deltas (S): of the loss, by deltas
        """

early_stop: _EarlyStop


class GaussianCovarianceGradients(NamedTuple):
    grad_quaternions: Float
    grad_scales: Float

class _GaussianCovariance:
    def __call__(self, quaternions: Array, scales: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: R diag(s)^2 R^T, R the rotation of q / |q|

        3D Gaussian Splatting (Kerbl et al. 2023), equation 6; gradients: its appendix A. Conventions: those of `profile`, cs180 if None.

        Args:
            quaternions (M,4): rotations, of any length but 0
            scales (M,3): standard deviations along the axes, or their logarithms

        Returns:
            covariances (M,3,3): symmetric; a gradient has all nine entries
        """
    def vjp(self, quaternions: Array, scales: Array, *, grad_covariances: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> GaussianCovarianceGradients:
        """The error bound of the gradient: R diag(s)^2 R^T, R the rotation of q / |q|

        3D Gaussian Splatting (Kerbl et al. 2023), equation 6; gradients: its appendix A. Conventions: those of `profile`, cs180 if None.

        Args:
            quaternions (M,4): rotations, of any length but 0
            scales (M,3): standard deviations along the axes, or their logarithms
            grad_covariances (M,3,3): of the loss, by covariances; zeros where left off

        Returns:
            grad_quaternions (M,4): of the loss, by quaternions
            grad_scales (M,3): of the loss, by scales
        """

gaussian_covariance: _GaussianCovariance

class GaussianProjection(NamedTuple):
    means2d: Float
    covariances2d: Float
    conics: Float
    depths: Float
    radii: Float
    compensations: Float

class GaussianProjectionGradients(NamedTuple):
    grad_means: Float
    grad_covariances: Float

class _GaussianProjection:
    def __call__(self, means: Array, covariances: Array, w2c: Array, K: Array, width: Array, height: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> GaussianProjection:
        """The error bound: t = R mean + translation; (fx t_x/t_z + cx, fy t_y/t_z + cy); J R Sigma R^T J^T + 0.3 with t_x/t_z clamped in J; its inverse; ceil(3 sqrt(lambda)); sqrt(det before / det after the dilation)

        Zwicker et al. 2001, EWA Volume Splatting; 3D Gaussian Splatting (Kerbl et al. 2023), equation 5, and its rasterizer. Conventions: those of `profile`, cs180 if None.

        Args:
            means (M,3): means, in front of the camera
            covariances (M,6): upper triangles, row by row: xx, xy, xz, yy, yz, zz
            w2c (4,4): from the world to the camera's axes: x right, y down, z forward
            K (3,3): fx, fy, cx, cy
            width (a number): width of the picture, in pixels
            height (a number): height of the picture, in pixels

        Returns:
            means2d (M,2): means in the picture, in pixels
            covariances2d (M,3): xx, xy, yy, with the dilation
            conics (M,3): the inverse of that: xx, xy, yy
            depths (M): along the camera's axis
            radii (M): pixels that a splat reaches
            compensations (M): factor of the opacity for the light that the dilation adds
        """
    def vjp(self, means: Array, covariances: Array, w2c: Array, K: Array, width: Array, height: Array, *, grad_means2d: Optional[Array] = None, grad_covariances2d: Optional[Array] = None, grad_conics: Optional[Array] = None, grad_depths: Optional[Array] = None, grad_compensations: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> GaussianProjectionGradients:
        """The error bound of the gradient: t = R mean + translation; (fx t_x/t_z + cx, fy t_y/t_z + cy); J R Sigma R^T J^T + 0.3 with t_x/t_z clamped in J; its inverse; ceil(3 sqrt(lambda)); sqrt(det before / det after the dilation)

        Zwicker et al. 2001, EWA Volume Splatting; 3D Gaussian Splatting (Kerbl et al. 2023), equation 5, and its rasterizer. Conventions: those of `profile`, cs180 if None.

        Args:
            means (M,3): means, in front of the camera
            covariances (M,6): upper triangles, row by row: xx, xy, xz, yy, yz, zz
            w2c (4,4): from the world to the camera's axes: x right, y down, z forward
            K (3,3): fx, fy, cx, cy
            width (a number): width of the picture, in pixels
            height (a number): height of the picture, in pixels
            grad_means2d (M,2): of the loss, by means2d; zeros where left off
            grad_covariances2d (M,3): of the loss, by covariances2d; zeros where left off
            grad_conics (M,3): of the loss, by conics; zeros where left off
            grad_depths (M): of the loss, by depths; zeros where left off
            grad_compensations (M): of the loss, by compensations; zeros where left off

        Returns:
            grad_means (M,3): of the loss, by means
            grad_covariances (M,6): of the loss, by covariances
        """

gaussian_projection: _GaussianProjection


class GaussianAlphaGradients(NamedTuple):
    grad_means2d: Float
    grad_conics: Float
    grad_opacities: Float

class _GaussianAlpha:
    def __call__(self, pixels: Array, means2d: Array, conics: Array, opacities: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: min(cap, opacity exp(-1/2 (A dx^2 + C dy^2) - B dx dy)), d from the mean to the pixel

        3D Gaussian Splatting (Kerbl et al. 2023), equations 3 and 4; cap and cut: its rasterizer. Conventions: those of `profile`, cs180 if None.

        Args:
            pixels (P,2): where pixels have their centers
            means2d (G,2): means of the splats, in pixels
            conics (G,3): inverse covariances: xx, xy, yy
            opacities (G): opacities in the middle, from 0 to 1

        Returns:
            alphas (P,G): of each splat at each pixel
        """
    def vjp(self, pixels: Array, means2d: Array, conics: Array, opacities: Array, *, grad_alphas: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> GaussianAlphaGradients:
        """The error bound of the gradient: min(cap, opacity exp(-1/2 (A dx^2 + C dy^2) - B dx dy)), d from the mean to the pixel

        3D Gaussian Splatting (Kerbl et al. 2023), equations 3 and 4; cap and cut: its rasterizer. Conventions: those of `profile`, cs180 if None.

        Args:
            pixels (P,2): where pixels have their centers
            means2d (G,2): means of the splats, in pixels
            conics (G,3): inverse covariances: xx, xy, yy
            opacities (G): opacities in the middle, from 0 to 1
            grad_alphas (P,G): of the loss, by alphas; zeros where left off

        Returns:
            grad_means2d (G,2): of the loss, by means2d
            grad_conics (G,3): of the loss, by conics
            grad_opacities (G): of the loss, by opacities
        """

gaussian_alpha: _GaussianAlpha


class GaussianColorGradients(NamedTuple):
    grad_means: Float
    grad_coefficients: Float

class _GaussianColor:
    def __call__(self, means: Array, camera_center: Array, coefficients: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: max(sum_k f_k Y_k(d / |d|) + 1/2, 0), d = mean - camera center

        3D Gaussian Splatting (Kerbl et al. 2023), section 4, and its rasterizer; Plenoxels (Fridovich-Keil et al. 2022). Conventions: those of `profile`, cs180 if None.

        Args:
            means (M,3): means of the splats
            camera_center (3): where the camera is
            coefficients (M,B,3): (degree + 1)^2 of each splat, band by band, three channels each

        Returns:
            colors (M,3): not below 0
        """
    def vjp(self, means: Array, camera_center: Array, coefficients: Array, *, grad_colors: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> GaussianColorGradients:
        """The error bound of the gradient: max(sum_k f_k Y_k(d / |d|) + 1/2, 0), d = mean - camera center

        3D Gaussian Splatting (Kerbl et al. 2023), section 4, and its rasterizer; Plenoxels (Fridovich-Keil et al. 2022). Conventions: those of `profile`, cs180 if None.

        Args:
            means (M,3): means of the splats
            camera_center (3): where the camera is
            coefficients (M,B,3): (degree + 1)^2 of each splat, band by band, three channels each
            grad_colors (M,3): of the loss, by colors; zeros where left off

        Returns:
            grad_means (M,3): of the loss, by means
            grad_coefficients (M,B,3): of the loss, by coefficients
        """

gaussian_color: _GaussianColor

class RenderTrace(NamedTuple):
    uv: Float
    rays_o: Float
    rays_d: Float
    t: Float
    deltas: Float
    weights: Float
    colors: Float


class _RenderTrace:
    def __call__(self, height: Array, width: Array, focal: Array, cx: Array, cy: Array, c2w: Array, near: Array, far: Array, u: Array, sigmas: Array, rgbs: Array, background: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> RenderTrace:
        """The error bound: image_rays, sample_along_rays, step_sizes, volume_render and composite_background one after the other

        NeRF (Mildenhall et al. 2020) sections 4 and 5.2. Conventions: those of `profile`, cs180 if None.

        Args:
            height (a number): H
            width (a number): W
            focal (a number): in pixels
            cx (a number): principal point, in pixels
            cy (a number): principal point, in pixels
            c2w (4,4): pose
            near (a number): where rays begin
            far (a number): where rays end
            u (H,W,N): numbers in [0, 1), one for every sample
            sigmas (H,W,N): densities of the samples
            rgbs (H,W,N,3): colors of the samples
            background (3): color behind everything

        Returns:
            uv (H,W,2): pixel positions
            rays_o (H,W,3): origins
            rays_d (H,W,3): directions
            t (H,W,N): sample positions
            deltas (H,W,N): step lengths
            weights (H,W,N): T alpha
            colors (H,W,3): over the background
        """

render_trace: _RenderTrace


class DistortionLossGradients(NamedTuple):
    grad_weights: Float
    grad_t: Float

class _DistortionLoss:
    def __call__(self, weights: Array, t: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: sum_ij w_i w_j |m_i - m_j| + 1/3 sum_i w_i^2 (t_{i+1} - t_i), m_i = (t_i + t_{i+1}) / 2; of each ray

        mip-NeRF 360 (Barron et al. 2022), equation 15. Conventions: those of `profile`, cs180 if None.

        Args:
            weights (R,N): weights of the intervals
            t (R,N+1): their edges, never falling: distances, or normalized ones

        Returns:
            loss (R): of each ray: add up or average them yourself
        """
    def vjp(self, weights: Array, t: Array, *, grad_loss: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> DistortionLossGradients:
        """The error bound of the gradient: sum_ij w_i w_j |m_i - m_j| + 1/3 sum_i w_i^2 (t_{i+1} - t_i), m_i = (t_i + t_{i+1}) / 2; of each ray

        mip-NeRF 360 (Barron et al. 2022), equation 15. Conventions: those of `profile`, cs180 if None.

        Args:
            weights (R,N): weights of the intervals
            t (R,N+1): their edges, never falling: distances, or normalized ones
            grad_loss (R): of the loss, by loss; zeros where left off

        Returns:
            grad_weights (R,N): of the loss, by weights
            grad_t (R,N+1): of the loss, by t
        """

distortion_loss: _DistortionLoss



class _InterlevelLoss:
    def __call__(self, weights: Array, t: Array, proposal_weights: Array, proposal_t: Array, eps: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: mean over intervals of max(0, w_i - bound_i)^2 / (w_i + eps), bound_i the proposal's weights whose intervals overlap i; of each ray

        mip-NeRF 360 (Barron et al. 2022), equations 12 and 13; google-research/multinerf internal/stepfun.py lossfun_outer. Conventions: those of `profile`, cs180 if None.

        Args:
            weights (R,N): weights of the field: no gradient
            t (R,N+1): their edges, never falling
            proposal_weights (R,M): weights of the proposal
            proposal_t (R,M+1): their edges, from and to the same distances
            eps (a number): added to the weight that is divided by

        Returns:
            loss (R): of each ray: add up or average them yourself
        """
    def vjp(self, weights: Array, t: Array, proposal_weights: Array, proposal_t: Array, eps: Array, *, grad_loss: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: mean over intervals of max(0, w_i - bound_i)^2 / (w_i + eps), bound_i the proposal's weights whose intervals overlap i; of each ray

        mip-NeRF 360 (Barron et al. 2022), equations 12 and 13; google-research/multinerf internal/stepfun.py lossfun_outer. Conventions: those of `profile`, cs180 if None.

        Args:
            weights (R,N): weights of the field: no gradient
            t (R,N+1): their edges, never falling
            proposal_weights (R,M): weights of the proposal
            proposal_t (R,M+1): their edges, from and to the same distances
            eps (a number): added to the weight that is divided by
            grad_loss (R): of the loss, by loss; zeros where left off

        Returns:
            grad_proposal_weights (R,M): of the loss, by proposal_weights
        """

interlevel_loss: _InterlevelLoss



class _Mse:
    def __call__(self, prediction: Array, target: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> float:
        """The error bound: mean of (prediction - target)^2 over all entries

        NeRF (Mildenhall et al. 2020) equation 6, with the mean of its code. Conventions: those of `profile`, cs180 if None.

        Args:
            prediction (...): rendered colors
            target (...): photographed colors

        Returns:
            value (a number): mean squared error
        """
    def vjp(self, prediction: Array, target: Array, *, grad_value: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Union[float, Float]:
        """The error bound of the gradient: mean of (prediction - target)^2 over all entries

        NeRF (Mildenhall et al. 2020) equation 6, with the mean of its code. Conventions: those of `profile`, cs180 if None.

        Args:
            prediction (...): rendered colors
            target (...): photographed colors
            grad_value (a number): of the loss, by value; zeros where left off

        Returns:
            grad_prediction (...): of the loss, by prediction
        """

mse: _Mse



class _Huber:
    def __call__(self, prediction: Array, target: Array, delta: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> float:
        """The error bound: mean over entries of d^2 / 2 for |d| <= delta, else delta (|d| - delta / 2); d = prediction - target

        Huber 1964; torch.nn.functional.huber_loss, and smooth_l1_loss which divides by delta. Conventions: those of `profile`, cs180 if None.

        Args:
            prediction (...): rendered colors
            target (...): photographed colors
            delta (a number): where squares end

        Returns:
            value (a number): the loss
        """
    def vjp(self, prediction: Array, target: Array, delta: Array, *, grad_value: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Union[float, Float]:
        """The error bound of the gradient: mean over entries of d^2 / 2 for |d| <= delta, else delta (|d| - delta / 2); d = prediction - target

        Huber 1964; torch.nn.functional.huber_loss, and smooth_l1_loss which divides by delta. Conventions: those of `profile`, cs180 if None.

        Args:
            prediction (...): rendered colors
            target (...): photographed colors
            delta (a number): where squares end
            grad_value (a number): of the loss, by value; zeros where left off

        Returns:
            grad_prediction (...): of the loss, by prediction
        """

huber: _Huber



class _Charbonnier:
    def __call__(self, prediction: Array, target: Array, eps: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> float:
        """The error bound: mean over entries of sqrt(d^2 + eps^2); d = prediction - target

        Charbonnier et al. 1994; google-research/multinerf internal/train_utils.py compute_data_loss. Conventions: those of `profile`, cs180 if None.

        Args:
            prediction (...): rendered colors
            target (...): photographed colors
            eps (a number): the value at d = 0

        Returns:
            value (a number): the loss
        """
    def vjp(self, prediction: Array, target: Array, eps: Array, *, grad_value: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Union[float, Float]:
        """The error bound of the gradient: mean over entries of sqrt(d^2 + eps^2); d = prediction - target

        Charbonnier et al. 1994; google-research/multinerf internal/train_utils.py compute_data_loss. Conventions: those of `profile`, cs180 if None.

        Args:
            prediction (...): rendered colors
            target (...): photographed colors
            eps (a number): the value at d = 0
            grad_value (a number): of the loss, by value; zeros where left off

        Returns:
            grad_prediction (...): of the loss, by prediction
        """

charbonnier: _Charbonnier



class _Psnr:
    def __call__(self, prediction: Array, target: Array, peak: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> float:
        """The error bound: 10 log10(peak^2 / mse), mean over pictures or of the mean error

        NeRF (Mildenhall et al. 2020) section 6; bmild/nerf run_nerf_helpers.py mse2psnr. Conventions: those of `profile`, cs180 if None.

        Args:
            prediction (B,H,W,3): rendered pictures
            target (B,H,W,3): photographs
            peak (a number): largest color value

        Returns:
            value (a number): decibels; infinite where a picture is reproduced exactly
        """

psnr: _Psnr



class _ToUint8:
    def __call__(self, image: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: round(255 clip(x, 0, 1)), halves away from 0; or floor

        bmild/nerf run_nerf_helpers.py to8b (floor); imageio and torchvision (round). Conventions: those of `profile`, cs180 if None.

        Args:
            image (H,W,3): colors, beyond [0, 1] too

        Returns:
            bytes (H,W,3): 0, ..., 255
        """

to_uint8: _ToUint8



class _Ssim:
    def __call__(self, prediction: Array, target: Array, peak: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> float:
        """The error bound: mean over windows and channels of (2 ma mb + c1) (2 sab + c2) / ((ma^2 + mb^2 + c1) (sa^2 + sb^2 + c2)), c = (0.01 peak)^2, (0.03 peak)^2; 11 x 11, Gaussian of 1.5

        Wang et al. 2004, equations 13 to 17; graphdeco-inria/gaussian-splatting utils/loss_utils.py (padding). Conventions: those of `profile`, cs180 if None.

        Args:
            prediction (H,W,C): a rendered picture, at least 11 x 11
            target (H,W,C): its photograph
            peak (a number): largest color value

        Returns:
            value (a number): structural similarity, 1 for equal pictures: not 1 less it
        """
    def vjp(self, prediction: Array, target: Array, peak: Array, *, grad_value: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: mean over windows and channels of (2 ma mb + c1) (2 sab + c2) / ((ma^2 + mb^2 + c1) (sa^2 + sb^2 + c2)), c = (0.01 peak)^2, (0.03 peak)^2; 11 x 11, Gaussian of 1.5

        Wang et al. 2004, equations 13 to 17; graphdeco-inria/gaussian-splatting utils/loss_utils.py (padding). Conventions: those of `profile`, cs180 if None.

        Args:
            prediction (H,W,C): a rendered picture, at least 11 x 11
            target (H,W,C): its photograph
            peak (a number): largest color value
            grad_value (a number): of the loss, by value; zeros where left off

        Returns:
            grad_prediction (H,W,C): of the loss, by prediction
        """

ssim: _Ssim



class _LinearToSrgb:
    def __call__(self, linear: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: srgb = 12.92 x for x <= 0.0031308, else 1.055 x^(1/2.4) - 0.055; x >= 0, not clamped above 1

        IEC 61966-2-1:1999, section 5.2. Conventions: those of `profile`, cs180 if None.

        Args:
            linear (M): linear light, 1 is white, not negative

        Returns:
            srgb (M): sRGB values, 1 is white
        """
    def vjp(self, linear: Array, *, grad_srgb: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound of the gradient: srgb = 12.92 x for x <= 0.0031308, else 1.055 x^(1/2.4) - 0.055; x >= 0, not clamped above 1

        IEC 61966-2-1:1999, section 5.2. Conventions: those of `profile`, cs180 if None.

        Args:
            linear (M): linear light, 1 is white, not negative
            grad_srgb (M): of the loss, by srgb; zeros where left off

        Returns:
            grad_linear (M): of the loss, by linear
        """

linear_to_srgb: _LinearToSrgb

class LossScaleUpdate(NamedTuple):
    scale_out: float
    growth_tracker_out: float


class _LossScaleUpdate:
    def __call__(self, scale: Array, growth_tracker: Array, found_inf: Array, growth_factor: Array, backoff_factor: Array, growth_interval: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> LossScaleUpdate:
        """The error bound: found_inf: scale backoff_factor, tracker 0; else tracker + 1, and where that is growth_interval scale growth_factor, tracker 0

        Micikevicius et al. 2018 (Mixed Precision Training), section 3.2; torch.amp.GradScaler.update, _amp_update_scale_. Conventions: those of `profile`, cs180 if None.

        Args:
            scale (a number): what the loss is multiplied by
            growth_tracker (a number): steps without an overflow since the scale last changed
            found_inf (a number): 1 where a gradient of this step isn't finite, else 0
            growth_factor (a number): above 1
            backoff_factor (a number): below 1
            growth_interval (a number): steps without an overflow after which the scale grows

        Returns:
            scale_out (a number): the scale of the next step
            growth_tracker_out (a number): its tracker
        """

loss_scale_update: _LossScaleUpdate

class UnscaleGradients(NamedTuple):
    found_inf: float
    unscaled: Float


class _UnscaleGradients:
    def __call__(self, gradients: Array, scale: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> UnscaleGradients:
        """The error bound: g / scale; found_inf = 1 where a g is infinite or NaN: then the step is skipped, and what is in g / scale is open

        Micikevicius et al. 2018 (Mixed Precision Training), section 3.2; torch.amp.GradScaler.unscale_. Conventions: those of `profile`, cs180 if None.

        Args:
            gradients (P): of the scaled loss; what has overflowed is infinite or NaN
            scale (a number): what the loss was multiplied by

        Returns:
            found_inf (a number): 1: parameters, moments and the count of steps stay as they are
            unscaled (P): gradients of the loss, where found_inf is 0
        """

unscale_gradients: _UnscaleGradients

class ClipByGlobalNorm(NamedTuple):
    g_weights_out: Float
    g_bias_out: Float
    norm: float


class _ClipByGlobalNorm:
    def __call__(self, g_weights: Array, g_bias: Array, max_norm: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> ClipByGlobalNorm:
        """The error bound: g min(1, max_norm / norm), norm = sqrt(sum of g^2 over all tensors)

        Pascanu et al. 2013, algorithm 1; torch.nn.utils.clip_grad_norm_; optax.clip_by_global_norm. Conventions: those of `profile`, cs180 if None.

        Args:
            g_weights (N,M): gradient of a layer's weights
            g_bias (N): gradient of its bias
            max_norm (a number): the longest that both together may be

        Returns:
            g_weights_out (N,M): what is left of the weights' gradient
            g_bias_out (N): what is left of the bias' gradient
            norm (a number): the norm of both before they are clipped
        """

clip_by_global_norm: _ClipByGlobalNorm



class _ClipByValue:
    def __call__(self, g: Array, limit: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Union[float, Float]:
        """The error bound: min(max(g, -limit), limit)

        torch.nn.utils.clip_grad_value_; optax.clip. Conventions: those of `profile`, cs180 if None.

        Args:
            g (...): a gradient
            limit (a number): the largest size of a number in it

        Returns:
            g_out (...): what is left of it
        """

clip_by_value: _ClipByValue



class _LrExponential:
    def __call__(self, step: Array, decay_steps: Array, lr_init: Array, decay: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> float:
        """The error bound: lr_init decay^(step / decay_steps)

        bmild/nerf run_nerf.py: ExponentialDecay; torch.optim.lr_scheduler.ExponentialLR with decay_steps = 1. Conventions: those of `profile`, cs180 if None.

        Args:
            step (a number): steps that were taken before: 0 for the first
            decay_steps (a number): steps after which `decay` is left
            lr_init (a number): the first rate
            decay (a number): what is left of the rate after `decay_steps`

        Returns:
            rate (a number): the learning rate of this step
        """

lr_exponential: _LrExponential



class _LrCosine:
    def __call__(self, step: Array, max_steps: Array, lr_init: Array, lr_final: Array, warmup_steps: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> float:
        """The error bound: lr_init step / warmup_steps in the warm-up; then lr_final + (lr_init - lr_final) (1 + cos(pi p)) / 2, p = (step - warmup_steps) / (max_steps - warmup_steps)

        Loshchilov and Hutter 2017 (SGDR), equation 5; torch.optim.lr_scheduler.CosineAnnealingLR; with its warm-up NeuS and nerfstudio/engine/schedulers.py CosineDecayScheduler. Conventions: those of `profile`, cs180 if None.

        Args:
            step (a number): steps that were taken before: 0 for the first
            max_steps (a number): the step that has the last rate
            lr_init (a number): the first rate
            lr_final (a number): the last rate
            warmup_steps (a number): steps of the warm-up, which count among `max_steps`; 0: none

        Returns:
            rate (a number): the learning rate of this step
        """

lr_cosine: _LrCosine



class _LrLogLinear:
    def __call__(self, step: Array, max_steps: Array, lr_init: Array, lr_final: Array, delay_steps: Array, delay_mult: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> float:
        """The error bound: f lr_init^(1 - t) lr_final^t, t = step / max_steps up to 1; f = m + (1 - m) sin(pi / 2 step / delay_steps) before step `delay_steps`, then 1; m = delay_mult

        google-research/multinerf internal/math.py learning_rate_decay; graphdeco-inria/gaussian-splatting utils/general_utils.py get_expon_lr_func. Conventions: those of `profile`, cs180 if None.

        Args:
            step (a number): steps that were taken before: 0 for the first
            max_steps (a number): the step that has the last rate
            lr_init (a number): the first rate
            lr_final (a number): the last rate
            delay_steps (a number): steps of the delay; 0: none
            delay_mult (a number): what the delay leaves of the rate in step 0

        Returns:
            rate (a number): the learning rate of this step
        """

lr_log_linear: _LrLogLinear

class AdamStep(NamedTuple):
    params_out: Float
    m_out: Float
    v_out: Float


class _AdamStep:
    def __call__(self, params: Array, grad: Array, m: Array, v: Array, step: Array, lr: Array, beta1: Array, beta2: Array, eps: Array, weight_decay: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> AdamStep:
        """The error bound: m' = b1 m + (1 - b1) g, v' = b2 v + (1 - b2) g^2, p' = p - lr m' / (1 - b1^t) / (sqrt(v' / (1 - b2^t)) + eps)

        Kingma and Ba 2015, algorithm 1; torch.optim.Adam. Conventions: those of `profile`, cs180 if None.

        Args:
            params (P): parameters
            grad (P): gradient
            m (P): mean of gradients
            v (P): mean of squared gradients
            step (a number): number of the step, from 1
            lr (a number): learning rate
            beta1 (a number): decay of m
            beta2 (a number): decay of v
            eps (a number): added to the root, outside of it; by convention before or after its correction
            weight_decay (a number): times the parameter, added to the gradient (coupled)

        Returns:
            params_out (P): parameters after the step
            m_out (P): m'
            v_out (P): v'
        """

adam_step: _AdamStep

class AdamwStep(NamedTuple):
    params_out: Float
    m_out: Float
    v_out: Float


class _AdamwStep:
    def __call__(self, params: Array, grad: Array, m: Array, v: Array, step: Array, lr: Array, beta1: Array, beta2: Array, eps: Array, weight_decay: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> AdamwStep:
        """The error bound: Adam's step of the gradient alone, and p' = ... - lr weight_decay p, p as it was before the step

        Loshchilov and Hutter 2019, algorithm 2, with lambda = lr weight_decay; torch.optim.AdamW; optax.adamw. Conventions: those of `profile`, cs180 if None.

        Args:
            params (P): parameters
            grad (P): gradient
            m (P): mean of gradients
            v (P): mean of squared gradients
            step (a number): number of the step, from 1
            lr (a number): learning rate
            beta1 (a number): decay of m
            beta2 (a number): decay of v
            eps (a number): added to the root, outside of it; by convention before or after its correction
            weight_decay (a number): times lr and the parameter, taken off beside the step (decoupled)

        Returns:
            params_out (P): parameters after the step
            m_out (P): m'
            v_out (P): v'
        """

adamw_step: _AdamwStep

class TrainingStep(NamedTuple):
    t: Float
    deltas: Float
    colors: Float
    losses: Float
    grad: Float
    params_1: Float
    m_1: Float
    v_1: Float
    params_last: Float
    m_last: Float
    v_last: Float


class _TrainingStep:
    def __call__(self, rays_o: Array, rays_d: Array, directions: Array, u: Array, target: Array, near: Array, far: Array, lr: Array, beta1: Array, beta2: Array, eps: Array, weight_decay: Array, trunk0_w: Array, trunk0_b: Array, trunk1_w: Array, trunk1_b: Array, trunk2_w: Array, trunk2_b: Array, trunk3_w: Array, trunk3_b: Array, trunk4_w: Array, trunk4_b: Array, trunk5_w: Array, trunk5_b: Array, trunk6_w: Array, trunk6_b: Array, trunk7_w: Array, trunk7_b: Array, sigma_w: Array, sigma_b: Array, feature_w: Array, feature_b: Array, color0_w: Array, color0_b: Array, color1_w: Array, color1_b: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> TrainingStep:
        """The error bound: C = volume_render(nerf_mlp(o + t d)), loss = mean (C - target)^2, its gradient, adam_step; S steps, each with rays, draws and a rate of its own

        NeRF (Mildenhall et al. 2020) sections 4 and 5.3; torch.optim.Adam. Conventions: those of `profile`, cs180 if None.

        Args:
            rays_o (S,R,3): origins of each step's rays
            rays_d (S,R,3): directions, along which t runs
            directions (S,R,3): viewing directions, as the field is given them
            u (S,R,N): numbers in [0, 1), one for every sample
            target (S,R,3): the photographs' colors
            near (a number): where rays begin
            far (a number): where rays end
            lr (S): learning rate of each step
            beta1 (a number): decay of m
            beta2 (a number): decay of v
            eps (a number): added to the root, outside of it; by convention before or after its correction
            weight_decay (a number): times the parameter, added to the gradient (coupled)
            trunk0_w (out,in): weights
            trunk0_b (out): biases
            trunk1_w (out,in): weights
            trunk1_b (out): biases
            trunk2_w (out,in): weights
            trunk2_b (out): biases
            trunk3_w (out,in): weights
            trunk3_b (out): biases
            trunk4_w (out,in): weights
            trunk4_b (out): biases
            trunk5_w (out,in): weights
            trunk5_b (out): biases
            trunk6_w (out,in): weights
            trunk6_b (out): biases
            trunk7_w (out,in): weights
            trunk7_b (out): biases
            sigma_w (out,in): weights
            sigma_b (out): biases
            feature_w (out,in): weights
            feature_b (out): biases
            color0_w (out,in): weights
            color0_b (out): biases
            color1_w (out,in): weights
            color1_b (out): biases

        Returns:
            t (R,N): sample positions of the first step
            deltas (R,N): its step lengths
            colors (R,3): its colors, over nothing
            losses (S): mean squared error before each step
            grad (P): gradient of the first loss: trunk0_w row by row, trunk0_b, trunk1_w, ..., sigma, feature, color0, color1
            params_1 (P): parameters after the first step, in the same order
            m_1 (P): Adam's mean of gradients after the first step
            v_1 (P): Adam's mean of squared gradients after the first step
            params_last (P): parameters after the last step
            m_last (P): mean of gradients after the last step
            v_last (P): mean of squared gradients after the last step
        """

training_step: _TrainingStep


class ImportanceSamplingGradients(NamedTuple):
    grad_edges: Float
    grad_u: Float

class _ImportanceSampling:
    def __call__(self, edges: Array, weights: Array, padding: Array, u: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: F_k = sum_{j<k} (w_j + padding) / sum_j (w_j + padding), t = e_k + (u - F_k) / (F_{k+1} - F_k) (e_{k+1} - e_k)

        NeRF (Mildenhall et al. 2020) section 5.2. Conventions: those of `profile`, cs180 if None.

        Args:
            edges (R,E): edges of the N = E - 1 bins of a ray, ascending
            weights (R,N): weights of the bins, not normalized; detached, as in the paper
            padding (a number): added to every weight; 0 as in the paper, 1e-5 as in its code
            u (R,M): numbers in [0, 1], in any order

        Returns:
            t (R,M): samples, in the order of u
        """
    def vjp(self, edges: Array, weights: Array, padding: Array, u: Array, *, grad_t: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> ImportanceSamplingGradients:
        """The error bound of the gradient: F_k = sum_{j<k} (w_j + padding) / sum_j (w_j + padding), t = e_k + (u - F_k) / (F_{k+1} - F_k) (e_{k+1} - e_k)

        NeRF (Mildenhall et al. 2020) section 5.2. Conventions: those of `profile`, cs180 if None.

        Args:
            edges (R,E): edges of the N = E - 1 bins of a ray, ascending
            weights (R,N): weights of the bins, not normalized; detached, as in the paper
            padding (a number): added to every weight; 0 as in the paper, 1e-5 as in its code
            u (R,M): numbers in [0, 1], in any order
            grad_t (R,M): of the loss, by t; zeros where left off

        Returns:
            grad_edges (R,E): of the loss, by edges
            grad_u (R,M): of the loss, by u
        """

importance_sampling: _ImportanceSampling



class _ProposalPdf:
    def __call__(self, edges: Array, weights: Array, anneal: Array, padding: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: p_i = x_i / sum_j x_j, x_i = (w_i + padding)^anneal, 0 of a bin without width

        mip-NeRF 360 (Barron et al. 2022) equation 18; google-research/multinerf internal/models.py: logits_resample; nerfstudio/model_components/ray_samplers.py ProposalNetworkSampler, PDFSampler. Conventions: those of `profile`, cs180 if None.

        Args:
            edges (R,E): edges of the N = E - 1 bins of a ray, never falling
            weights (R,N): weights of the bins, none negative; detached
            anneal (a number): the exponent: 0 in the beginning of a training, 1 in its end
            padding (a number): added to every weight, or to its power

        Returns:
            pdf (R,N): shares of the bins: they add up to 1
        """

proposal_pdf: _ProposalPdf



class _ResampleEdges:
    def __call__(self, edges: Array, weights: Array, u: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> Float:
        """The error bound: c_i = F^-1(u_i); t_i = (c_{i-1} + c_i) / 2, t_0 = max(e_0, 2 c_0 - t_1), t_M = min(e_N, 2 c_{M-1} - t_{M-1})

        google-research/multinerf internal/stepfun.py sample_intervals; nerfacc/cuda/csrc/pdf.cu compute_intervels_kernel; nerfstudio/model_components/ray_samplers.py PDFSampler. Conventions: those of `profile`, cs180 if None.

        Args:
            edges (R,E): edges of the N = E - 1 bins of a ray, never falling
            weights (R,N): weights of the bins, not normalized; detached
            u (R,M): numbers in [0, 1], ascending: jittered, or (i + 1/2) / M

        Returns:
            t (R,M+1): edges of the new intervals; M where they are samples, E more with the old ones
        """

resample_edges: _ResampleEdges

class RayAabb(NamedTuple):
    t_near: Float
    t_far: Float
    hit: Float

class RayAabbGradients(NamedTuple):
    grad_rays_o: Float
    grad_rays_d: Float

class _RayAabb:
    def __call__(self, rays_o: Array, rays_d: Array, low: Array, high: Array, near: Array, far: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> RayAabb:
        """The error bound: t_near = max(near, max_a min(t_a)), t_far = min(far, min_a max(t_a)) with t_a = (low_a - o_a) / d_a, (high_a - o_a) / d_a; hit = t_near <= t_far

        Kay and Kajiya 1986, slabs; the closed box, d_a = 0 as a case of its own. Conventions: those of `profile`, cs180 if None.

        Args:
            rays_o (R,3): origins
            rays_d (R,3): directions, as they come; t counts in their lengths
            low (3): the box's corner of least coordinates
            high (3): the opposite corner
            near (a number): where rays begin
            far (a number): where they end

        Returns:
            t_near (R): where the ray enters the box; anything on a miss (here far)
            t_far (R): where it leaves the box; anything on a miss (here far)
            hit (R): 1 where a part of the ray lies in the closed box, a face included, else 0
        """
    def vjp(self, rays_o: Array, rays_d: Array, low: Array, high: Array, near: Array, far: Array, *, grad_t_near: Optional[Array] = None, grad_t_far: Optional[Array] = None, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> RayAabbGradients:
        """The error bound of the gradient: t_near = max(near, max_a min(t_a)), t_far = min(far, min_a max(t_a)) with t_a = (low_a - o_a) / d_a, (high_a - o_a) / d_a; hit = t_near <= t_far

        Kay and Kajiya 1986, slabs; the closed box, d_a = 0 as a case of its own. Conventions: those of `profile`, cs180 if None.

        Args:
            rays_o (R,3): origins
            rays_d (R,3): directions, as they come; t counts in their lengths
            low (3): the box's corner of least coordinates
            high (3): the opposite corner
            near (a number): where rays begin
            far (a number): where they end
            grad_t_near (R): of the loss, by t_near; zeros where left off
            grad_t_far (R): of the loss, by t_far; zeros where left off

        Returns:
            grad_rays_o (R,3): of the loss, by rays_o
            grad_rays_d (R,3): of the loss, by rays_d
        """

ray_aabb: _RayAabb

class OccupancyGrid(NamedTuple):
    density_out: Float
    occupied: Float
    found: Float


class _OccupancyGrid:
    def __call__(self, density: Array, points: Array, sigmas: Array, queries: Array, decay: Array, threshold: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> OccupancyGrid:
        """The error bound: where points lie in a cell that is seen, density_out = max(decay density, max of their sigmas), elsewhere density; occupied where density_out > min(threshold, mean of the density_out > 0), all cells with density_out >= 0 where that leaves none

        Instant-NGP (Mueller et al. 2022) appendix C; nerfacc's OccGridEstimator. Conventions: those of `profile`, cs180 if None.

        Args:
            density (G,G,G): density of each cell of the unit box, index [z, y, x]; -1 where no camera sees it
            points (M,3): points of the unit box, (x, y, z); a face belongs to the cell above it
            sigmas (M): densities found there
            queries (Q,3): points to look up after the update; outside the box the nearest cell's
            decay (a number): factor of the densities of cells that were looked into
            threshold (a number): occupied is what lies above it, or above the mean where that is less

        Returns:
            density_out (G,G,G): densities after the update
            occupied (G,G,G): 1 where the cell is occupied, else 0
            found (Q): 1 where the query's cell is occupied, else 0
        """

occupancy_grid: _OccupancyGrid

class GridTraversal(NamedTuple):
    lengths: Float
    visited: Float


class _GridTraversal:
    def __call__(self, rays_o: Array, rays_d: Array, near: Array, far: Array, resolution: Array, *, profile: Profile = None, dtype: Dtype = 'f32', stable: bool = False) -> GridTraversal:
        """The error bound: lengths = |{t in [near, far]: o + t d in the cell}|, visited = number of cells with a length above 0

        Amanatides and Woo 1987; nerfacc issue 265 (CG3). Conventions: those of `profile`, cs180 if None.

        Args:
            rays_o (M,3): origins, in units of the box
            rays_d (M,3): directions, as they come; t counts in their lengths
            near (a number): where rays begin; from there to far they lie in the unit box
            far (a number): where they end
            resolution (a number): G, cells along an edge of the box

        Returns:
            lengths (M,G,G,G): t spent in each cell, index [z, y, x]; faces belong to the cell above
            visited (M): number of cells
        """

grid_traversal: _GridTraversal
