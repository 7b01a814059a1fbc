//! Profiles of Gaussian splatting.

use super::Profile;
use crate::convention::*;

/// gsplat.
pub(super) const GSPLAT: Profile = Profile {
    name: "gsplat",
    title: "nerfstudio-project/gsplat, from 1.1 on",
    conventions: Conventions {
        radius_floor: RadiusFloor::Hundredth,
        alpha_cap: AlphaCap::Thousandth,
        faint: Faint::Skipped,
        alpha_stop: AlphaStop::InFront,
        positive_power: PositivePower::Skipped,
        stop: Stop::InFront,
        harmonic_form: HarmonicForm::Normalized,
        ssim_peak: PsnrPeak::One,
        ..CS180
    },
    sources: &[
        ("quaternion", "gsplat/cuda/_torch_impl.py _quat_to_rotmat: F.normalize(quats)"),
        ("quaternion_order", "gsplat/cuda/_torch_impl.py _quat_to_rotmat: w, x, y, z = unbind(quats)"),
        ("quaternion_length", "gsplat/cuda/_torch_impl.py _quat_to_rotmat: F.normalize(quats)"),
        ("splat_scale", "gsplat/cuda/_torch_impl.py _quat_scale_to_covar_preci: R * scales"),
        ("splat_center", "gsplat/cuda/_torch_impl.py accumulate: pixel_coords + 0.5"),
        ("splat_dilation", "gsplat/cuda/_torch_impl.py _fully_fused_projection: eps2d = 0.3"),
        (
            "splat_clamp",
            "gsplat/cuda/_torch_impl.py _persp_proj: lim_x_pos = (width - cx) / fx + 0.3 * tan_fovx, lim_x_neg = cx / fx + 0.3 * tan_fovx",
        ),
        ("splat_clamp_gradient", "gsplat/cuda/_torch_impl.py _persp_proj: tz * clamp(tx / tz), by autograd"),
        (
            "radius_floor",
            "gsplat/cuda/_torch_impl.py _fully_fused_projection: b + sqrt(clamp(b**2 - det, min=0.01))",
        ),
        (
            "compensation_floor",
            "gsplat/cuda/_torch_impl.py _fully_fused_projection: sqrt(clamp(det_orig / det, min=0.0))",
        ),
        ("alpha_cap", "gsplat/cuda/_torch_impl.py accumulate: clamp_max(opacities * exp(-sigmas), 0.999)"),
        (
            "faint",
            "gsplat/cuda/csrc/RasterizeToPixels3DGSFwd.cu: alpha < ALPHA_THRESHOLD, 1 / 255, is skipped",
        ),
        (
            "alpha_stop",
            "gsplat/cuda/csrc/RasterizeToPixels3DGSFwd.cu: next_T <= 1e-4 ends the pixel, that splat left out",
        ),
        ("positive_power", "gsplat/cuda/csrc/RasterizeToPixels3DGSFwd.cu: sigma < 0 is skipped"),
        (
            "cap_gradient",
            "gsplat/cuda/csrc/RasterizeToPixels3DGSBwd.cu: opac * vis <= 0.999 alone has a gradient",
        ),
        ("conic_gradient", "gsplat/cuda/csrc/RasterizeToPixels3DGSBwd.cu: v_sigma * delta.x * delta.y"),
        (
            "stop",
            "gsplat/cuda/csrc/RasterizeToPixels3DGSFwd.cu: next_T <= 1e-4 ends before the splat is added",
        ),
        ("harmonic_sign", "gsplat/cuda/_torch_impl.py _eval_sh_bases_fast: -0.488 y, 0.488 z, -0.488 x"),
        ("harmonic_form", "gsplat/cuda/_torch_impl.py _spherical_harmonics: F.normalize(dirs)"),
        ("splat_color", "gsplat/rendering.py rasterization: clamp_min(colors + 0.5, 0.0)"),
        ("ssim_padding", "examples/simple_trainer.py: fused_ssim(colors, pixels, padding = valid)"),
        ("ssim_peak", "fused_ssim/__init__.py fused_ssim: C1 = 0.01 ** 2"),
    ],
    beyond: "sorting and tiles; radii along each axis and by opacity in later versions; its `spherical_harmonics` has neither 1/2 nor clamp",
};

/// The rasterizer of 3D Gaussian Splatting.
pub(super) const INRIA: Profile = Profile {
    name: "3dgs",
    title: "graphdeco-inria/diff-gaussian-rasterization, 3D Gaussian Splatting",
    conventions: Conventions {
        quaternion: Quaternion::AsGiven,
        quaternion_length: QuaternionLength::AsGiven,
        splat_center: SplatCenter::Integer,
        splat_clamp: SplatClamp::Centered,
        splat_clamp_gradient: SplatClampGradient::Held,
        compensation_floor: CompensationFloor::FiveThousandths,
        alpha_cap: AlphaCap::Hundredth,
        faint: Faint::Skipped,
        alpha_stop: AlphaStop::InFront,
        positive_power: PositivePower::Skipped,
        cap_gradient: CapGradient::Through,
        conic_gradient: ConicGradient::Entry,
        stop: Stop::InFront,
        harmonic_form: HarmonicForm::Homogeneous,
        ssim_padding: SsimPadding::Zero,
        ssim_peak: PsnrPeak::One,
        ..CS180
    },
    sources: &[
        (
            "quaternion",
            "gaussian-splatting scene/colmap_loader.py qvec2rotmat: 1 - 2 * qvec[2]**2 - 2 * qvec[3]**2, not divided",
        ),
        ("quaternion_order", "cuda_rasterizer/forward.cu computeCov3D: r = q.x"),
        ("quaternion_length", "cuda_rasterizer/forward.cu computeCov3D: q = rot, the division commented out"),
        ("splat_scale", "cuda_rasterizer/forward.cu computeCov3D: S[0][0] = mod * scale.x"),
        ("splat_center", "cuda_rasterizer/auxiliary.h ndc2Pix: ((v + 1.0) * S - 1.0) * 0.5"),
        ("splat_dilation", "cuda_rasterizer/forward.cu preprocessCUDA: h_var = 0.3"),
        ("splat_clamp", "cuda_rasterizer/forward.cu computeCov2D: limx = 1.3 * tan_fovx"),
        (
            "splat_clamp_gradient",
            "cuda_rasterizer/backward.cu computeCov2DCUDA: x_grad_mul, and 2 * h_x * t.x * tz3 with the clamped t.x",
        ),
        ("radius_floor", "cuda_rasterizer/forward.cu preprocessCUDA: mid + sqrt(max(0.1, mid * mid - det))"),
        (
            "compensation_floor",
            "cuda_rasterizer/forward.cu preprocessCUDA: sqrt(max(0.000025, det_cov / det_cov_plus_h_cov))",
        ),
        ("alpha_cap", "cuda_rasterizer/forward.cu renderCUDA: min(0.99, con_o.w * exp(power))"),
        ("faint", "cuda_rasterizer/forward.cu renderCUDA: alpha < 1 / 255 is skipped"),
        (
            "alpha_stop",
            "cuda_rasterizer/forward.cu renderCUDA: test_T < 0.0001 ends the pixel, that splat left out",
        ),
        ("positive_power", "cuda_rasterizer/forward.cu renderCUDA: power > 0 is skipped"),
        (
            "cap_gradient",
            "cuda_rasterizer/backward.cu renderCUDA: dL_dG = con_o.w * dL_dalpha, capped or not",
        ),
        ("conic_gradient", "cuda_rasterizer/backward.cu renderCUDA: -0.5 * gdx * d.y * dL_dG"),
        ("stop", "cuda_rasterizer/forward.cu renderCUDA: test_T < 0.0001 ends before the splat is added"),
        ("harmonic_sign", "cuda_rasterizer/forward.cu computeColorFromSH: - SH_C1 * y"),
        ("harmonic_form", "cuda_rasterizer/forward.cu computeColorFromSH: SH_C2[2] * (2 zz - xx - yy)"),
        ("splat_color", "cuda_rasterizer/forward.cu computeColorFromSH: result += 0.5, max(result, 0)"),
        ("ssim_window", "gaussian-splatting utils/loss_utils.py create_window: gaussian(11, 1.5)"),
        (
            "ssim_padding",
            "gaussian-splatting utils/loss_utils.py _ssim: padding = window_size // 2, of zeros",
        ),
        ("ssim_variance", "gaussian-splatting utils/loss_utils.py _ssim: conv2d(img1 * img1) - mu1_sq"),
        ("ssim_peak", "gaussian-splatting utils/loss_utils.py _ssim: C1 = 0.01 ** 2"),
    ],
    beyond: "sorting and tiles; 1e-7 is added to depths and to squared determinants; quaternions are divided, and scales exponentiated, in \
             Python",
};
