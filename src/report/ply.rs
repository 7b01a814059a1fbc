//! Points and lines as a PLY, which MeshLab, CloudCompare and Blender open.

use glam::DVec3;

/// Vertices with colors, and edges between them by number.
pub(crate) fn bytes(vertices: &[(DVec3, [u8; 3])], edges: &[[u32; 2]]) -> Vec<u8> {
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", vertices.len());
    ["x", "y", "z"].iter().for_each(|axis| header += &format!("property double {axis}\n"));
    ["red", "green", "blue"].iter().for_each(|channel| header += &format!("property uchar {channel}\n"));
    if !edges.is_empty() {
        header += &format!("element edge {}\nproperty int vertex1\nproperty int vertex2\n", edges.len());
    }
    let mut bytes = (header + "end_header\n").into_bytes();
    for (place, color) in vertices {
        place.to_array().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend(color);
    }
    edges.iter().flatten().for_each(|end| bytes.extend((*end as i32).to_le_bytes()));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vertex_takes_as_many_bytes_as_the_header_says() {
        let bytes = bytes(&[(DVec3::new(1.0, 2.0, 3.0), [7, 8, 9]); 2], &[[0, 1]]);
        let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
        let header = String::from_utf8(bytes[..end].to_vec()).unwrap();
        assert!(header.contains("element vertex 2\n") && header.contains("element edge 1\n"), "{header}");
        let rest = &bytes[end..];
        assert_eq!(rest.len(), 2 * (3 * 8 + 3) + 2 * 4);
        assert_eq!(
            (&rest[8..16], &rest[24..27], &rest[58..62]),
            (&2f64.to_le_bytes()[..], &[7, 8, 9][..], &[1, 0, 0, 0][..])
        );
    }
}
