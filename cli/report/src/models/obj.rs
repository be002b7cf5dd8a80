//! Meshes in OBJ files: vertices and faces; all else is left out.

use super::mesh::Mesh;

pub fn read(bytes: &[u8]) -> Result<Mesh, String> {
    let text = String::from_utf8_lossy(bytes);
    let (mut vertices, mut corners) = (Vec::new(), Vec::new());
    for (line, words) in text.lines().enumerate() {
        let refuse = |what: &str| Err(format!("line {}: {what}; correct it", line + 1));
        let mut words = words.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f32> = words.map_while(|word| word.parse().ok()).collect();
                match numbers[..] {
                    // A weight or a colour may follow.
                    [x, y, z, ..] => vertices.push([x, y, z]),
                    _ => return refuse("a vertex has three numbers"),
                }
            }
            Some("f") => {
                let face: Option<Vec<[f32; 3]>> = words.map(|word| vertex(word, &vertices)).collect();
                let Some(face) = face else { return refuse("a face has a vertex that was not given before") };
                let [first, ref rest @ ..] = face[..] else { return refuse("a face has three vertices") };
                if rest.len() < 2 {
                    return refuse("a face has three vertices");
                }
                corners.extend(rest.windows(2).flat_map(|pair| [first, pair[0], pair[1]]));
            }
            _ => {}
        }
    }
    Mesh::of_corners(corners.into_iter())
}

/// The vertex of a corner such as `7`, `7/1/2` or `-1`: counted from 1, or backwards from the last one.
fn vertex(corner: &str, vertices: &[[f32; 3]]) -> Option<[f32; 3]> {
    let number: i64 = corner.split('/').next()?.parse().ok()?;
    let index = if number < 0 { vertices.len() as i64 + number } else { number - 1 };
    vertices.get(usize::try_from(index).ok()?).copied()
}

#[cfg(test)]
mod tests {
    use super::read;

    #[test]
    fn faces_may_have_many_corners() {
        let square = "# a comment\nv 0 0 0 1\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1/1 -2 4//1\n";
        let mesh = read(square.as_bytes()).unwrap();
        assert_eq!((mesh.vertices(), mesh.triangles()), (4, 2));
        for (text, words) in [
            ("v 1 2\n", "line 1: a vertex"),
            ("v 0 0 0\nf 1 2 3\n", "line 2: a face"),
            ("v 0 0 0\nf 1 1\n", "three vertices"),
            ("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
            ("v 0 0 0\n", "no triangle"),
        ] {
            assert!(read(text.as_bytes()).unwrap_err().contains(words), "{text}");
        }
    }
}
