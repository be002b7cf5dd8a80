//! The soles of the feet of a gait.

use costate::robot::{Placement, Robot};
use costate_control::Problem;

/// The sole of a foot.
pub(crate) struct Sole {
    /// The joint that moves the foot.
    pub joint: usize,
    /// The frame of the foot, in that of the joint: x from heel to toe, z up from the ground.
    pub placement: Placement,
    /// x of heel and toe (m).
    pub ends: [f64; 2],
    /// Along y (m); zero in the plane.
    pub width: f64,
}

impl Sole {
    /// Heel and toe, or all corners in turn, in the frame of the joint (m).
    pub fn outline(&self) -> Vec<[f64; 3]> {
        let [heel, toe] = self.ends;
        let half = 0.5 * self.width;
        let corners = match self.width > 0.0 {
            true => vec![[heel, half], [toe, half], [toe, -half], [heel, -half]],
            false => vec![[heel, 0.0], [toe, 0.0]],
        };
        let corner = |[x, y]: [f64; 2]| {
            let corner = Placement::from_xyz_rpy([x, y, 0.0], [0.0; 3]);
            self.placement.then(&corner).translation.into()
        };
        corners.into_iter().map(corner).collect()
    }
}

/// Those of all feet of the gait that a problem asks for; none of feet that are points.
pub(crate) fn soles(problem: &Problem) -> Vec<Sole> {
    let Some(gait) = &problem.gait else { return Vec::new() };
    let Some(ends) = gait.sole else { return Vec::new() };
    let feet = gait.stance.iter().chain(&gait.swing);
    feet.filter_map(|foot| sole(&problem.robot, foot, ends, gait.sole_width)).collect()
}

fn sole(robot: &Robot, foot: &str, ends: [f64; 2], width: f64) -> Option<Sole> {
    let frame = robot.frame(foot).ok()?;
    Some(Sole { joint: frame.joint?, placement: frame.placement, ends, width })
}

#[cfg(test)]
mod tests {
    use super::soles;
    use crate::svg::Skeleton;
    use costate::robot::LoadOptions;
    use costate_control::ProblemFile;

    fn problem(name: &str) -> costate_control::Problem {
        ProblemFile::read(format!("../../examples/problems/{name}.toml"), LoadOptions::default())
            .unwrap()
            .problem
    }

    /// On straight legs both feet are flat below the body, from heel to toe.
    #[test]
    fn the_edges_of_soles_are_on_the_ground() {
        for (name, corners, edges) in [("seven_link_walk", 2, 1), ("biped_walk", 4, 4)] {
            let problem = problem(name);
            let soles = soles(&problem);
            let [heel, toe] = problem.gait.as_ref().unwrap().sole.unwrap();
            let [bare, figure] = [Skeleton::new(&problem.robot, &[]), Skeleton::new(&problem.robot, &soles)];
            assert_eq!(figure.lines.len(), bare.lines.len() + 2 * edges, "{name}");
            let upright = vec![0.0; problem.robot.dof()];
            let [bare, points] = [&bare, &figure].map(|figure| figure.points(&upright).unwrap());
            let drawn = &points[bare.len()..];
            assert_eq!(drawn.len(), 2 * corners, "{name}");
            let lowest = bare.iter().map(|point| point[2]).fold(f64::INFINITY, f64::min);
            let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
            for [x, _, z] in drawn {
                assert!((z - lowest).abs() < 1e-12, "{name}: {drawn:?}");
                (least, most) = (least.min(*x), most.max(*x));
            }
            assert!((least - heel).abs() < 1e-12 && (most - toe).abs() < 1e-12, "{name}: {drawn:?}");
            assert!(figure.points(&[]).is_err());
        }
        assert!(soles(&problem("rabbit_walk")).is_empty());
    }
}
