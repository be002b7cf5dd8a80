//! Bodies from the collision models of a URDF.

use super::obstacles::{Collision, LinkCapsule};
use costate::robot::urdf::{CollisionModel, Geometry, collisions};
use costate::robot::{RobotError, printable};
use nalgebra::Vector3;

/// Why the collision models of a URDF give no bodies.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfBodyError {
    /// The text is no URDF, or one of its models is malformed.
    #[error(transparent)]
    Urdf(#[from] RobotError),
    /// A model that no capsule is made of.
    #[error(
        "link '{}' has a collision model (line {line} of the URDF) that is {shape}, of which no capsule is made; \
         list the bodies of this link as [[collision.capsule]] with frame = \"{}\"",
        printable(.link), printable(.link)
    )]
    NoCapsule {
        /// The link.
        link: String,
        /// The line of the model, from 1.
        line: usize,
        /// What it is.
        shape: String,
    },
}

impl Collision {
    /// With the bodies of the `<collision>` models of a URDF, for each link that has none among
    /// [`capsules`](Self::capsules) yet. They have the names of the links; the second one of a link ends in
    /// ` 2`.
    ///
    /// - A sphere is one.
    /// - A cylinder becomes the capsule of its radius from end to end, whose caps reach a radius beyond the
    ///   ends; so does a `<capsule>`, whose `length` is that of its cylinder.
    /// - A box becomes the capsule around it along its longest edge: the radius is half the diagonal of the
    ///   two other edges.
    ///
    /// All of them contain the model.
    ///
    /// ```
    /// # use costate_control::Collision;
    /// let text = r#"<robot name="arm"><link name="hand"><collision>
    ///     <origin xyz="0 0 0.1"/><geometry><cylinder radius="0.05" length="0.2"/></geometry>
    /// </collision></link></robot>"#;
    /// let collision = Collision::default().with_urdf(text)?;
    /// let hand = &collision.capsules[0];
    /// assert_eq!((hand.frame.as_str(), hand.from, hand.to), ("link:hand", [0.0; 3], Some([0.0, 0.0, 0.2])));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`UrdfBodyError::Urdf`], [`UrdfBodyError::NoCapsule`]: a mesh.
    pub fn with_urdf(mut self, text: &str) -> Result<Self, UrdfBodyError> {
        let named = |frame: &str, link: &str| frame.strip_prefix("link:").unwrap_or(frame) == link;
        let listed: Vec<String> = self.capsules.iter().map(|capsule| capsule.frame.clone()).collect();
        let is_listed = |link: &str| listed.iter().any(|frame| named(frame, link));
        let mut found: Vec<LinkCapsule> = Vec::new();
        for model in collisions(text)?.iter().filter(|model| !is_listed(&model.link)) {
            let (half, radius) = capsule(model)?;
            let before = found.iter().filter(|body| named(&body.frame, &model.link)).count();
            let [from, to] = [-1.0, 1.0].map(|side| {
                let end = model.placement.rotation * half * side + model.placement.translation;
                <[f64; 3]>::from(end)
            });
            let is_sphere = half == Vector3::zeros();
            let name =
                if before == 0 { model.link.clone() } else { format!("{} {}", model.link, before + 1) };
            found.push(LinkCapsule {
                name,
                frame: format!("link:{}", model.link),
                from,
                to: (!is_sphere).then_some(to),
                radius,
            });
        }
        self.capsules.append(&mut found);
        Ok(self)
    }
}

/// From the centre to one end of the segment, in the axes of the model, and the radius (m).
fn capsule(model: &CollisionModel) -> Result<(Vector3<f64>, f64), UrdfBodyError> {
    let refuse =
        |shape: String| Err(UrdfBodyError::NoCapsule { link: model.link.clone(), line: model.line, shape });
    match &model.geometry {
        Geometry::Sphere { radius } => Ok((Vector3::zeros(), *radius)),
        Geometry::Cylinder { radius, length } => Ok((Vector3::z() * (0.5 * length), *radius)),
        Geometry::Box { size } => {
            let half = Vector3::from(*size) * 0.5;
            let longest = half.imax();
            let mut along = Vector3::zeros();
            along[longest] = half[longest];
            Ok((along, (half - along).norm()))
        }
        Geometry::Mesh { file, .. } => refuse(format!("the mesh {}", printable(file))),
        _ => refuse("of another shape".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::{Collision, LinkCapsule, UrdfBodyError};
    use std::f64::consts::FRAC_PI_2;

    fn urdf(models: &str) -> String {
        format!("<robot name=\"arm\"><link name=\"hand\">\n{models}</link></robot>")
    }

    fn model(origin: &str, shape: &str) -> String {
        format!("<collision><origin {origin}/><geometry>{shape}</geometry></collision>\n")
    }

    #[test]
    fn models_become_capsules_that_contain_them() {
        let turned = format!("xyz=\"1 0 0\" rpy=\"0 {FRAC_PI_2} 0\"");
        let text = [
            model("xyz=\"1 2 3\"", "<sphere radius=\"0.3\"/>"),
            model(&turned, "<cylinder radius=\"0.1\" length=\"0.4\"/>"),
            model("xyz=\"0 0 1\"", "<box size=\"0.3 2 0.4\"/>"),
        ];
        let found = Collision::default().with_urdf(&urdf(&text.concat())).unwrap().capsules;
        let body = |name: &str| LinkCapsule::sphere("link:hand", 0.0).with_name(name);
        let expected = [
            LinkCapsule { from: [1.0, 2.0, 3.0], radius: 0.3, ..body("hand") },
            LinkCapsule { from: [0.8, 0.0, 0.0], to: Some([1.2, 0.0, 0.0]), radius: 0.1, ..body("hand 2") },
            LinkCapsule { from: [0.0, -1.0, 1.0], to: Some([0.0, 1.0, 1.0]), radius: 0.25, ..body("hand 3") },
        ];
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!((&found.name, &found.frame), (&expected.name, &expected.frame));
            let numbers =
                |body: &LinkCapsule| [body.from, body.to.unwrap_or([9.0; 3]), [body.radius; 3]].concat();
            let close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-15;
            assert!(numbers(found).iter().zip(&numbers(expected)).all(close), "{found:?}");
        }
    }

    /// No corner of a box is outside of its capsule.
    #[test]
    fn a_capsule_contains_the_corners_of_its_box() {
        for size in [[0.3_f64, 0.2, 0.1], [0.1, 0.1, 0.1], [0.2, 0.5, 0.5]] {
            let [x, y, z] = size;
            let text = urdf(&model("", &format!("<box size=\"{x} {y} {z}\"/>")));
            let body = Collision::default().with_urdf(&text).unwrap().capsules.remove(0);
            let end: [f64; 3] = body.to.unwrap();
            for corner in 0..8 {
                let at: [f64; 3] =
                    [0, 1, 2].map(|k| 0.5 * size[k] * if corner >> k & 1 == 1 { 1.0 } else { -1.0 });
                // The segment lies along an axis of the box.
                let square: f64 = (0..3).map(|k| (at[k].abs() - end[k].abs()).max(0.0).powi(2)).sum();
                assert!(square.sqrt() <= body.radius + 1e-15, "{size:?} {at:?}");
            }
        }
    }

    #[test]
    fn meshes_are_refused_by_link_and_line_unless_their_link_has_bodies() {
        let text = urdf(&model("", "<mesh filename=\"hand.stl\"/>"));
        let error = Collision::default().with_urdf(&text).unwrap_err();
        assert!(
            matches!(&error, UrdfBodyError::NoCapsule { link, line: 2, .. } if link == "hand"),
            "{error}"
        );
        for word in ["'hand'", "line 2", "mesh hand.stl", "[[collision.capsule]]"] {
            assert!(error.to_string().contains(word), "{error}");
        }
        let own = LinkCapsule::sphere("hand", 0.1);
        let kept = Collision::of(vec![own.clone()]).with_urdf(&text).unwrap();
        assert_eq!(kept.capsules, [own]);
        let error = Collision::default().with_urdf("<robot").unwrap_err();
        assert!(matches!(error, UrdfBodyError::Urdf(_)), "{error}");
    }
}
