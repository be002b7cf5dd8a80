//! Joints that mimic others, resolved to the independent joints.

use super::error::RobotError;
use super::joint::{Joint, JointSpec, Limits, Mimic, MimicSpec};
use super::nearest::resembling;
use super::range::{RANGE, is_moderate};
use super::warning::Warning;
use std::collections::HashMap;

/// The independent joint, ratio and offset of every joint that mimics another one, in the order of `order`.
///
/// `q_i = r_i q_j + o_i` with `q_j = r_j q_k + o_j` gives `q_i = r_i r_j q_k + (r_i o_j + o_i)`; each joint
/// is visited once.
pub(super) fn resolved(specs: &[JointSpec], order: &[usize]) -> Result<Vec<Option<Mimic>>, RobotError> {
    if specs.iter().all(|spec| spec.mimic.is_none()) {
        return Ok(vec![None; order.len()]);
    }
    let names = || order.iter().map(|&source| specs[source].name.as_str());
    let index: HashMap<&str, usize> = names().enumerate().map(|(i, name)| (name, i)).collect();
    let spec = |i: usize| &specs[order[i]];
    let master = |i: usize| match &spec(i).mimic {
        None => Ok(None),
        Some(MimicSpec { joint, ratio, offset }) => {
            let of = &spec(i).name;
            let known = index.get(joint.as_str()).ok_or_else(|| RobotError::UnknownMimic {
                joint: of.clone(),
                master: joint.clone(),
                nearest: resembling(joint, names()),
            })?;
            let mimic = Mimic { joint: *known, ratio: *ratio, offset: *offset };
            check(of, &mimic)?;
            Ok(Some(mimic))
        }
    };
    let mut found: Vec<Option<Option<Mimic>>> = vec![None; order.len()];
    for start in 0..order.len() {
        let (mut chain, mut on_chain) = (Vec::new(), HashMap::new());
        let mut at = start;
        // To the first joint that is independent or known.
        while found[at].is_none() {
            match master(at)? {
                None => found[at] = Some(None),
                Some(mimic) => {
                    if let Some(&first) = on_chain.get(&at) {
                        let around: &[(usize, Mimic)] = &chain[first..];
                        let joints = around.iter().map(|&(joint, _)| spec(joint).name.clone()).collect();
                        return Err(RobotError::MimicCycle { joints });
                    }
                    on_chain.insert(at, chain.len());
                    chain.push((at, mimic));
                    at = mimic.joint;
                }
            }
        }
        for (joint, mimic) in chain.into_iter().rev() {
            let beyond = found[mimic.joint].flatten();
            let mimic = match beyond {
                None => mimic,
                Some(beyond) => Mimic {
                    joint: beyond.joint,
                    ratio: mimic.ratio * beyond.ratio,
                    offset: mimic.ratio.mul_add(beyond.offset, mimic.offset),
                },
            };
            check(&spec(joint).name, &mimic)?;
            found[joint] = Some(Some(mimic));
        }
    }
    Ok(found.into_iter().map(Option::flatten).collect())
}

/// Products of ratios with masses and velocities neither vanish nor overflow.
fn check(joint: &str, mimic: &Mimic) -> Result<(), RobotError> {
    let ratio = match mimic.ratio {
        0.0 => "a joint that does not move with another one is a fixed one",
        _ => "its size must lie between 1e-75 and 1e75",
    };
    let checks = [
        ("the ratio of mimicry", mimic.ratio, RANGE.contains(&mimic.ratio.abs()), ratio),
        ("the offset of mimicry", mimic.offset, is_moderate(mimic.offset), "its size must be 1e75 at most"),
    ];
    match checks.into_iter().find(|(_, _, ok, _)| !ok) {
        Some((what, value, _, rule)) => Err(RobotError::BadValue { joint: joint.into(), what, value, rule }),
        None => Ok(()),
    }
}

/// Narrows the limits of independent joints by those of the joints that mimic them.
///
/// Position `(lower - offset) / ratio`, velocity by the size of the ratio; the effort is that of the
/// independent joint. Where no position would be left, the limits of the mimic are not used, with a warning.
pub(super) fn narrow_limits(joints: &mut [Joint], warnings: &mut Vec<Warning>) {
    for i in 0..joints.len() {
        let Some(Mimic { joint, ratio, offset }) = joints[i].mimic else {
            continue;
        };
        let (own, limits) = (joints[i].limits, joints[joint].limits);
        // A mimic joint of a file often has no figures of its own: limits that coincide, or a velocity of 0.
        let is_range = own.lower < own.upper;
        let velocity = if own.velocity > 0.0 { own.velocity } else { f64::INFINITY };
        let ends = [own.lower, own.upper].map(|end| (end - offset) / ratio);
        let narrowed = Limits {
            lower: if is_range { limits.lower.max(ends[0].min(ends[1])) } else { limits.lower },
            upper: if is_range { limits.upper.min(ends[0].max(ends[1])) } else { limits.upper },
            velocity: limits.velocity.min(velocity / ratio.abs()),
            ..limits
        };
        if narrowed.lower <= narrowed.upper {
            joints[joint].limits = narrowed;
        } else {
            let (mimic, master) = (joints[i].name.clone(), joints[joint].name.clone());
            warnings.push(Warning::MimicLimits { joint: mimic, master });
        }
    }
}
