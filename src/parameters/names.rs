//! Names of parameters.

use super::error::ParameterError;
use super::parameter::{Axis, Parameter};
use super::set::ParameterSet;
use crate::robot::resembling;

impl ParameterSet {
    /// The parameter of the model of that name.
    pub(super) fn find(&self, name: &str) -> Option<Parameter> {
        let joint = |name: &str| self.robot().joints().iter().position(|joint| joint.name == name);
        if let Some(gravity) = Parameter::gravity_named(name) {
            return Some(gravity);
        }
        let (of, entry) = name.rsplit_once('.')?;
        if let Some(joint) = joint(of) {
            return Parameter::of_joint(joint).find(|parameter| parameter.entry_name() == entry);
        }
        let pair = of
            .match_indices(", ")
            .find_map(|(at, comma)| Some([joint(&of[..at])?, joint(&of[at + comma.len()..])?]));
        pair.filter(|_| entry == "armature")
            .map(|[i, j]| Parameter::Armature { joints: [i.max(j), i.min(j)] })
    }

    /// What to say about a name that no parameter has: known joints and entries that resemble its parts.
    pub(super) fn unknown(&self, name: &str) -> ParameterError {
        let joints = || self.robot().joints().iter().map(|joint| joint.name.as_str());
        let entries: Vec<_> = Parameter::of_joint(0).map(|parameter| parameter.entry_name()).collect();
        let gravity = Axis::ALL.map(|axis| Parameter::Gravity { axis }.entry_name());
        let known = |part: &str| joints().chain(entries.iter().copied()).any(|name| name == part);
        let nearest = match name.rsplit_once('.') {
            None => resembling(name, gravity.into_iter()),
            Some((of, entry)) => {
                let of = if known(of) { vec![of.to_owned()] } else { resembling(of, joints()) };
                let entry = if known(entry) {
                    vec![entry.to_owned()]
                } else {
                    resembling(entry, entries.iter().copied())
                };
                let pairs = of.iter().flat_map(|of| entry.iter().map(move |entry| format!("{of}.{entry}")));
                pairs.collect()
            }
        };
        ParameterError::UnknownParameter { name: name.into(), nearest, entries: entries.join(", ") }
    }

    /// The name of a parameter of the model.
    pub(super) fn name_of(&self, parameter: &Parameter) -> String {
        let name = |joint: usize| &self.robot().joints()[joint].name;
        let entry = parameter.entry_name();
        match parameter.joints() {
            [None, _] => entry.into(),
            [Some(i), Some(j)] if i != j => format!("{}, {}.{entry}", name(i), name(j)),
            [Some(joint), _] => format!("{}.{entry}", name(joint)),
        }
    }
}
