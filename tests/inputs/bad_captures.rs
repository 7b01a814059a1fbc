//! Rows of captures: files of COLMAP's models, of LLFF, and of key cameras.

/// Files of other bytes (see `draw::bytes`). `16 = ffff` puts two bytes at byte 16, `a -> b` text in the place of text.
///
/// Bytes of `cameras.bin`: count 0, number 8, model 12, width 16, height 24, parameters 32 (OPENCV: fx, fy, cx, cy, k1, k2, p1, p2). Of
/// `images.bin`: count 0, number 8, quaternion 12, translation 44, camera 68, name 72 (`d.png`), features 78, the first: u 86, v 94,
/// point 102. Of `points3D.bin`: count 0, number 8, place 16, color 40, error 43, track 51.
#[rustfmt::skip]
pub(crate) const CAPTURES: &[(&str, &str, &str)] = &[
    ("colmap/sparse/0/cameras.bin", "cut 0", "cut off, 0 bytes"), ("colmap/sparse/0/cameras.bin", "cut 50", "cut off"), ("colmap/sparse/0/cameras.bin", "cut -1", "cut off"), ("colmap/sparse/0/cameras.bin", "text", "cut off"),
    ("colmap/sparse/0/cameras.bin", "zeros", "bytes after its end"), ("colmap/sparse/0/cameras.bin", "fifo", "a pipe or a device"), ("colmap/sparse/0/cameras.bin", "folder", "a folder"),
    ("colmap/sparse/0/cameras.bin", "0 = ffffffffffffffff", "18446744073709551615 entries"), ("colmap/sparse/0/cameras.bin", "0 = 00", "bytes after its end"), ("colmap/sparse/0/cameras.bin", "0 = 02", "cut off"),
    ("colmap/sparse/0/cameras.bin", "12 = 0c", "model of camera 7: found 12"), ("colmap/sparse/0/cameras.bin", "12 = ffffffff", "model of camera 7: found 4294967295"), ("colmap/sparse/0/cameras.bin", "12 = 07", "length: found 24 bytes"),
    ("colmap/sparse/0/cameras.bin", "8 = 06", "camera of a.png: found 7"), ("colmap/sparse/0/cameras.bin", "16 = 00", "size of camera 7: found 0x8"), ("colmap/sparse/0/cameras.bin", "24 = ffffffffffffffff", "size of camera 7"),
    ("colmap/sparse/0/cameras.bin", "16 = 80", "size of a.png: found 12x8; expected the shape of 128x8"), ("colmap/sparse/0/cameras.bin", "32 = 000000000000f87f", "parameters of camera 7: found NaN"), ("colmap/sparse/0/cameras.bin", "32 = 00000000000024c0", "focal length of camera 7: found -10"),
    ("colmap/sparse/0/cameras.bin", "40 = 0000000000000000", "focal length of camera 7: found 10, 0"), ("colmap/sparse/0/cameras.bin", "64 = 00000000000059c0", "lens of"), ("colmap/sparse/0/cameras.bin", "64 = 000000000000f07f", "parameters of camera 7: found inf"),
    ("colmap/sparse/0/images.bin", "gone", "images.bin: can't be read"), ("colmap/sparse/0/images.bin", "cut 0", "cut off"), ("colmap/sparse/0/images.bin", "cut 30", "cut off"), ("colmap/sparse/0/images.bin", "cut -1", "cut off"), ("colmap/sparse/0/images.bin", "zeros", "bytes after its end"), ("colmap/sparse/0/images.bin", "fifo", "a pipe or a device"),
    ("colmap/sparse/0/images.bin", "0 = 00ffffffffffffff", "entries of 73 bytes"), ("colmap/sparse/0/images.bin", "12 = 000000000000f87f", "rotation of d.png"), ("colmap/sparse/0/images.bin", "12 = 0000000000001440", "rotation of d.png: found [5"), ("colmap/sparse/0/images.bin", "44 = 000000000000f07f", "translation of d.png"),
    ("colmap/sparse/0/images.bin", "44 = 0000000000007e7e", "translation of d.png"), ("colmap/sparse/0/images.bin", "68 = 08", "camera of d.png: found 8"), ("colmap/sparse/0/images.bin", "72 = ff", "expected UTF-8"), ("colmap/sparse/0/images.bin", "72 = 2f", "name of a picture: found /.png"), ("colmap/sparse/0/images.bin", "72 = 2e2e2f78", "name of a picture: found ../xg; expected a path below"), ("colmap/sparse/0/images.bin", "72 = 63", "c.png twice"),
    ("colmap/sparse/0/images.bin", "78 = ffffffffffffff7f", "entries of 24 bytes"), ("colmap/sparse/0/images.bin", "86 = 000000000000f87f", "points of d.png"), ("colmap/sparse/0/images.bin", "102 = 01", "points of d.png: found point 1"),
    ("colmap/sparse/0/points3D.bin", "gone", "points3D.bin: can't be read"), ("colmap/sparse/0/points3D.bin", "cut 50", "cut off"), ("colmap/sparse/0/points3D.bin", "cut -1", "cut off"), ("colmap/sparse/0/points3D.bin", "0 = ffffffffffffffff", "entries of 51 bytes"), ("colmap/sparse/0/points3D.bin", "8 = 65", "point 101 twice"),
    ("colmap/sparse/0/points3D.bin", "16 = 000000000000f87f", "place of point 100"), ("colmap/sparse/0/points3D.bin", "16 = 000000000000f07f", "place of point 100"), ("colmap/sparse/0/points3D.bin", "43 = 000000000000f87f", "error of point 100"), ("colmap/sparse/0/points3D.bin", "51 = ffffffffffffffff", "entries of 8 bytes"),
    ("colmap/images/a.png", "cut 50", "cut off"), ("colmap/images/a.png", "text", "picture"),
    ("text/sparse/0/cameras.txt", "cut 50", "line 2"), ("text/sparse/0/cameras.txt", "SIMPLE_PINHOLE -> PINHOLE", "line 2: found the end of the line; expected 4 parameters of PINHOLE"), ("text/sparse/0/cameras.txt", "SIMPLE_PINHOLE -> SIMPLE", "line 2: found SIMPLE"), ("text/sparse/0/cameras.txt", "7 S -> -7 S", "line 2: found -7"),
    ("text/sparse/0/cameras.txt", " 12 8 -> 12.5 8 ", "line 2"), ("text/sparse/0/cameras.txt", "10 6 4 -> NaN 6 4", "parameters of camera 7: found NaN"), ("text/sparse/0/cameras.txt", "10 6 4 -> 10 6 4 1", "line 2: found 1; expected the end"), ("text/sparse/0/cameras.txt", "not utf-8", "cameras.txt"), ("text/sparse/0/cameras.txt", "zeros", "cameras.txt"),
    ("text/sparse/0/images.txt", "gone", "images.txt: can't be read"), ("text/sparse/0/images.txt", "1 1 0 0 0 0 0 4 7 a.png -> 1 1 0 0 0 0 0 4 7", "line 2: found the end of the line; expected a picture's name"), ("text/sparse/0/images.txt", " 7 a.png -> 9 a.png", "images.txt"), ("text/sparse/0/images.txt", " 4 7 a.png -> inf 7 a.png", "images.txt"),
    ("text/sparse/0/images.txt", " 100  -> 100.5 ", "line 3"), ("text/sparse/0/images.txt", " 100  -> 1 ", "images.txt"), ("text/sparse/0/images.txt", "1 2 -1 -> 1 2", "line 3"), ("text/sparse/0/images.txt", "text", "line 1"), ("text/sparse/0/images.txt", "cut 0", "pictures: found none"),
    ("text/sparse/0/points3D.txt", "gone", "points3D.txt: can't be read"), ("text/sparse/0/points3D.txt", "cut 50", "points3D.txt"), ("text/sparse/0/points3D.txt", "100 -1 -> 100 x", "line 2: found x; expected a place"), ("text/sparse/0/points3D.txt", "100 -1 -> 101 -1", "point 101 twice"), ("text/sparse/0/points3D.txt", "100 -1 -> 100 1e300", "place of point 100"), ("text/sparse/0/points3D.txt", "0.25 -> inf", "error of point 100"),
    ("llff/poses_bounds.npy", "cut 0", "poses_bounds.npy"), ("llff/poses_bounds.npy", "cut 50", "bytes"), ("llff/poses_bounds.npy", "cut -1", "bytes"), ("llff/poses_bounds.npy", "text", "signature"), ("llff/poses_bounds.npy", "zeros", "signature"), ("llff/poses_bounds.npy", "fifo", "a pipe or a device"),
    ("llff/images/a.png", "cut 50", "cut off"),
];

/// The key cameras: a place, what is put there, part of the message.
#[rustfmt::skip]
pub(crate) const KEYS: &[(&str, &str, &str)] = &[
    ("/frames", "", "frames"), ("/frames", "[]", "frames: found none"), ("/frames", "{}", "frames: found {}"), ("/frames", "[7]", "transform_matrix of frames[0]"), ("/frames/0/transform_matrix", "", "transform_matrix of frames[0]: found no matrix"),
    ("/frames/1/transform_matrix", "[[1]]", "transform_matrix of frames[1]"), ("/frames/1/transform_matrix/0/0", "9", "expected a rotation"), ("/frames/1/transform_matrix/0/3", "null", "NaN in row 0, column 3"), ("/frames/0/camera_angle_x", "0", "camera_angle_x of frames[0]: found 0"),
    ("/frames/0/camera_angle_x", "\"1\"", "camera_angle_x of frames[0]: found \"1\""), ("/frames/1/camera_angle_x", "4", "camera_angle_x of frames[1]: found 4"),
];
