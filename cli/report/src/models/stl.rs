//! Meshes in STL files, binary or text.

use super::mesh::Mesh;

/// Bytes before the triangles of a binary file, and of each triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// Reads either kind. A binary file is one with the length that its number of triangles asks for, as some
/// begin with the word of a text.
pub fn read(bytes: &[u8]) -> Result<Mesh, String> {
    match bytes.get(80..HEAD).and_then(|count| <[u8; 4]>::try_from(count).ok()).map(u32::from_le_bytes) {
        Some(count) if HEAD as u64 + TRIANGLE as u64 * u64::from(count) == bytes.len() as u64 => {
            Mesh::of_corners(bytes[HEAD..].chunks_exact(TRIANGLE).flat_map(corners))
        }
        _ if bytes.trim_ascii_start().starts_with(b"solid") => text(bytes),
        Some(count) => Err(format!(
            "is no STL: {count} triangles do not fit a file of {} bytes; write it again",
            bytes.len()
        )),
        None => Err("is no STL: it is too short; write it again".into()),
    }
}

/// The corners of a binary triangle, after its normal.
fn corners(triangle: &[u8]) -> [[f32; 3]; 3] {
    let number = |k: usize| f32::from_le_bytes([0, 1, 2, 3].map(|byte| triangle[12 + 4 * k + byte]));
    [0, 1, 2].map(|corner| [0, 1, 2].map(|k| number(3 * corner + k)))
}

fn text(bytes: &[u8]) -> Result<Mesh, String> {
    let text = String::from_utf8_lossy(bytes);
    let mut corners = Vec::new();
    for (line, words) in text.lines().enumerate() {
        let mut words = words.split_ascii_whitespace();
        if words.next() != Some("vertex") {
            continue;
        }
        let numbers: Vec<f32> = words.map_while(|word| word.parse().ok()).collect();
        match numbers[..] {
            [x, y, z] => corners.push([x, y, z]),
            _ => return Err(format!("line {}: a vertex has three numbers; correct it", line + 1)),
        }
    }
    Mesh::of_corners(corners.into_iter())
}

#[cfg(test)]
mod tests {
    use super::read;

    #[test]
    fn both_kinds_give_the_same_mesh() {
        let corners = [
            [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
            [[1.0, 0.0, 0.0], [1.0, 2.0, 0.5], [0.0, 2.0, 0.0]],
        ];
        let mut binary = b"solid of a liar".to_vec();
        binary.resize(80, b' ');
        binary.extend(2_u32.to_le_bytes());
        let mut text = "solid two\n".to_owned();
        for triangle in corners {
            binary.extend([0; 12]);
            text += "facet normal 0 0 1\nouter loop\n";
            for corner in triangle {
                binary.extend(corner.iter().flat_map(|x| x.to_le_bytes()));
                text += &format!("  vertex {} {} {}\n", corner[0], corner[1], corner[2]);
            }
            binary.extend([0; 2]);
            text += "endloop\nendfacet\n";
        }
        let mesh = read(&binary).unwrap();
        assert_eq!(mesh, read(text.as_bytes()).unwrap());
        assert_eq!((mesh.triangles(), mesh.vertices()), (2, 4));
        assert!(read(b"solid").unwrap_err().contains("no triangle"));
        binary[0] = b'x';
        assert!(read(&binary[..150]).unwrap_err().contains("150 bytes"));
        assert!(read(b"").unwrap_err().contains("too short"));
    }
}
