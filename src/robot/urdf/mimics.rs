//! `<mimic>` of the joints of a URDF: what it refers to.

use super::parts::{JointType, Source};
use crate::robot::error::RobotError;
use crate::robot::link::Placement;
use crate::robot::nearest::resembling;
use crate::robot::printable::{printable, printable_number};
use crate::robot::warning::Warning;
use std::collections::{HashMap, HashSet};

/// Joints that mimic a fixed joint, whose position is 0, become fixed at their offset; so do their own
/// mimics.
///
/// A joint of several degrees of freedom mimics nothing and is not mimicked.
pub(super) fn settle(source: &mut Source, warnings: &mut Vec<Warning>) -> Result<(), RobotError> {
    let index: HashMap<&str, usize> =
        source.joints.iter().enumerate().map(|(i, joint)| (joint.name.as_str(), i)).collect();
    let mut masters = vec![None; source.joints.len()];
    for (i, joint) in source.joints.iter().enumerate() {
        let Some(mimic) = &joint.mimic else { continue };
        let names = source.joints.iter().map(|joint| joint.name.as_str());
        let refused = |error: RobotError| Err(error.at(mimic.line));
        let (of, master) = (joint.name.clone(), mimic.spec.joint.clone());
        let Some(&at) = index.get(master.as_str()) else {
            let nearest = resembling(&master, names);
            return refused(RobotError::UnknownMimic { joint: of, master, nearest });
        };
        for at in [i, at] {
            if let Some(kind) = source.joints[at].kind.with_several_freedoms() {
                let several = source.joints[at].name.clone();
                return refused(RobotError::UnsupportedMimic { joint: of, master, several, kind });
            }
        }
        masters[i] = Some(at);
    }
    for i in 0..masters.len() {
        let (mut chain, mut seen) = (Vec::new(), HashSet::new());
        let mut at = i;
        while let Some(master) = masters[at].filter(|_| source.joints[at].kind != JointType::Fixed) {
            if !seen.insert(at) {
                break; // The builder names the loop.
            }
            chain.push(at);
            at = master;
        }
        if source.joints[at].kind == JointType::Fixed {
            // Its position counts as 0, where a mimic was fixed before, as its constant.
            let mut position = source.joints[at].fixed_at;
            for &joint in chain.iter().rev() {
                let joint = &mut source.joints[joint];
                if let Some(mimic) = joint.mimic.take() {
                    position = mimic.spec.ratio.mul_add(position, mimic.spec.offset);
                    let [name, master] =
                        [&joint.name, &mimic.spec.joint].map(|name| printable(name).to_string());
                    let held = printable_number(position);
                    let text = format!(
                        "joint '{name}' mimics joint '{master}', which is fixed: it is held at {held}"
                    );
                    warnings.push(Warning::Note { text });
                }
                joint.fix(position);
            }
        }
    }
    Ok(())
}

impl super::parts::SourceJoint {
    /// Makes it a fixed joint at this position (rad, m).
    fn fix(&mut self, position: f64) {
        if let Some(kind) = self.kind.moves() {
            let motion: Placement = kind.motion(&(self.axis / self.axis.norm()), position);
            self.placement = self.placement.then(&motion);
        }
        (self.kind, self.fixed_at) = (JointType::Fixed, position);
    }
}
