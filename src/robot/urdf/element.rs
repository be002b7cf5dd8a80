//! One element of a URDF: its children and attributes, refused by line, name and remedy.

use super::xml::Lines;
use crate::robot::error::RobotError;
use crate::robot::printable::printable;
use roxmltree::Node;
use std::fmt::Display;

/// An element and the link or joint it belongs to.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    node: Node<'a, 'a>,
    lines: &'a Lines,
    owner: &'a str,
}

impl<'a> Element<'a> {
    /// `owner` is how messages call the link or joint, such as `joint 'elbow'`; empty while its name is
    /// unknown.
    pub(super) fn new(node: Node<'a, 'a>, lines: &'a Lines, owner: &'a str) -> Self {
        Self { node, lines, owner }
    }

    pub(super) fn line(&self) -> usize {
        self.lines.line(self.node)
    }

    /// Its name and owner, such as `<origin> of joint 'elbow'`.
    pub(super) fn description(&self) -> String {
        let tag = printable(self.node.tag_name().name());
        if self.owner.is_empty() { format!("<{tag}>") } else { format!("<{tag}> of {}", self.owner) }
    }

    /// The error that this element is malformed: its description, then `problem`.
    pub(super) fn refuse(&self, problem: impl Display) -> RobotError {
        RobotError::malformed(format!("{} {problem}", self.description())).at(self.line())
    }

    /// The child element of that name, of which there may be one.
    pub(super) fn child(&self, name: &str) -> Result<Option<Self>, RobotError> {
        let namespace = self.node.tag_name().namespace();
        let mut found = self.node.children().filter(|child| {
            child.is_element() && child.tag_name().name() == name && child.tag_name().namespace() == namespace
        });
        let first = found.next().map(|node| Self { node, ..*self });
        match found.next() {
            Some(node) => Err(Self { node, ..*self }.refuse("is given twice; keep one of them")),
            None => Ok(first),
        }
    }

    /// The child element of that name, which must exist.
    pub(super) fn required_child(&self, name: &str) -> Result<Self, RobotError> {
        self.child(name)?.ok_or_else(|| self.refuse(format_args!("has no <{name}>; add it")))
    }

    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    /// An attribute that must exist and not be blank.
    pub(super) fn required_text(&self, name: &str) -> Result<&'a str, RobotError> {
        let text = self.attribute(name).filter(|text| !text.trim().is_empty());
        text.ok_or_else(|| self.refuse(format_args!("has no {name}; add {name}=\"...\"")))
    }

    /// The `N` numbers of an attribute, if it exists; `inf` and `nan` are numbers here.
    pub(super) fn any_numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, RobotError> {
        let Some(text) = self.attribute(name) else { return Ok(None) };
        let refuse =
            |problem: String| Err(self.refuse(format_args!("has {name}=\"{}\", {problem}", printable(text))));
        let (mut numbers, mut count) = ([0.0; N], 0);
        for word in text.split_whitespace() {
            match word.parse::<f64>() {
                Ok(number) => {
                    numbers.iter_mut().skip(count).take(1).for_each(|entry| *entry = number);
                    count += 1;
                }
                Err(_) if text.contains("${") || text.contains("$(") => {
                    return refuse(
                        "which looks like xacro; expand the file first (xacro robot.xacro > robot.urdf)"
                            .into(),
                    );
                }
                Err(_) if word.contains(',') => {
                    return refuse(
                        "which contains a comma; separate numbers by blanks, write decimals with a point"
                            .into(),
                    );
                }
                Err(_) => {
                    let word = printable(word);
                    return refuse(format!("where '{word}' is not a number; write one such as 0.25"));
                }
            }
        }
        let found = if count == 1 { "one number".into() } else { format!("{count} numbers") };
        match N {
            _ if count == N => Ok(Some(numbers)),
            1 => refuse(format!("{found}; give one")),
            _ => refuse(format!("{found}; give {N}, separated by blanks")),
        }
    }

    /// The `N` finite numbers of an attribute, if it exists.
    pub(super) fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, RobotError> {
        let numbers = self.any_numbers::<N>(name)?;
        match numbers.as_ref().and_then(|all| all.iter().find(|x| !x.is_finite())) {
            Some(x) => {
                Err(self.refuse(format_args!("has {name} = {x}, which is not finite; give a finite number")))
            }
            None => Ok(numbers),
        }
    }

    /// The finite number of an attribute, if it exists.
    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, RobotError> {
        Ok(self.numbers::<1>(name)?.map(|[x]| x))
    }

    /// The finite number of an attribute that must exist.
    pub(super) fn required_number(&self, name: &str) -> Result<f64, RobotError> {
        self.number(name)?.ok_or_else(|| self.refuse(format_args!("has no {name}; add {name}=\"...\"")))
    }
}
