//! One element of a URDF: its children and attributes, refused by line, name and remedy.

use crate::robot::error::RobotError;
use roxmltree::Node;
use std::fmt::Display;
use std::path::PathBuf;

/// `error`, at that line of a file whose path the caller knows.
pub(super) fn at(line: usize, error: RobotError) -> RobotError {
    RobotError::InFile { path: PathBuf::new(), line: Some(line), error: Box::new(error) }
}

/// Where the lines of a text begin (bytes); looking a line up here does not read the text again.
pub(super) struct Lines(Vec<usize>);

impl Lines {
    pub(super) fn of(text: &str) -> Self {
        Self(std::iter::once(0).chain(text.match_indices('\n').map(|(end, _)| end + 1)).collect())
    }

    /// Number of lines.
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// Line, from 1, on which the element begins.
    pub(super) fn line(&self, node: Node<'_, '_>) -> usize {
        self.0.partition_point(|&start| start <= node.range().start)
    }
}

/// An element and the link or joint it belongs to.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    node: Node<'a, 'a>,
    lines: &'a Lines,
    owner: &'a str,
}

impl<'a> Element<'a> {
    /// `owner` is how messages call what it belongs to, such as `joint 'elbow'`; empty where that has no name yet.
    pub(super) fn new(node: Node<'a, 'a>, lines: &'a Lines, owner: &'a str) -> Self {
        Self { node, lines, owner }
    }

    pub(super) fn line(&self) -> usize {
        self.lines.line(self.node)
    }

    /// Its name and owner, such as `<origin> of joint 'elbow'`.
    pub(super) fn description(&self) -> String {
        let tag = self.node.tag_name().name();
        if self.owner.is_empty() { format!("<{tag}>") } else { format!("<{tag}> of {}", self.owner) }
    }

    /// The error that this element is malformed: its description, then `problem`.
    pub(super) fn refuse(&self, problem: impl Display) -> RobotError {
        at(self.line(), RobotError::Malformed { message: format!("{} {problem}", self.description()) })
    }

    /// The child element of that name, of which there may be one.
    pub(super) fn child(&self, name: &str) -> Result<Option<Self>, RobotError> {
        let namespace = self.node.tag_name().namespace();
        let mut found = self.node.children().filter(|child| {
            child.is_element() && child.tag_name().name() == name && child.tag_name().namespace() == namespace
        });
        let first = found.next().map(|node| Self { node, ..*self });
        match found.next() {
            Some(node) => Err(Self { node, ..*self }.refuse("stands there twice; keep one of them")),
            None => Ok(first),
        }
    }

    /// The child element of that name, which must be there.
    pub(super) fn required_child(&self, name: &str) -> Result<Self, RobotError> {
        self.child(name)?.ok_or_else(|| self.refuse(format_args!("has no <{name}>; add it")))
    }

    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    /// An attribute that must be there and not be blank.
    pub(super) fn required_text(&self, name: &str) -> Result<&'a str, RobotError> {
        let text = self.attribute(name).filter(|text| !text.trim().is_empty());
        text.ok_or_else(|| self.refuse(format_args!("has no {name}; add {name}=\"...\"")))
    }

    /// The `N` numbers of an attribute, if it is there, each as it is written: `inf` and `nan` are numbers here.
    pub(super) fn any_numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, RobotError> {
        let Some(text) = self.attribute(name) else { return Ok(None) };
        let refuse = |problem: String| Err(self.refuse(format_args!("has {name}=\"{text}\", {problem}")));
        let mut numbers = Vec::with_capacity(N);
        for word in text.split_whitespace() {
            match word.parse::<f64>() {
                Ok(number) => numbers.push(number),
                Err(_) if text.contains("${") || text.contains("$(") => {
                    return refuse(
                        "which looks like xacro; expand the file first (xacro robot.xacro > robot.urdf)"
                            .into(),
                    );
                }
                Err(_) if word.contains(',') => {
                    return refuse(
                        "where a comma stands; separate numbers by blanks, write decimals with a point"
                            .into(),
                    );
                }
                Err(_) => return refuse(format!("where '{word}' is not a number; write one such as 0.25")),
            }
        }
        let count = numbers.len();
        match <[f64; N]>::try_from(numbers) {
            Ok(numbers) => Ok(Some(numbers)),
            Err(_) => refuse(match N {
                1 => format!("{count} numbers; give one"),
                _ => format!("{count} numbers; give {N}, separated by blanks"),
            }),
        }
    }

    /// The `N` finite numbers of an attribute, if it is there.
    pub(super) fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, RobotError> {
        let numbers = self.any_numbers::<N>(name)?;
        match numbers.as_ref().and_then(|all| all.iter().find(|x| !x.is_finite())) {
            Some(x) => {
                Err(self.refuse(format_args!("has {name} = {x}, which is not finite; give a finite number")))
            }
            None => Ok(numbers),
        }
    }

    /// The finite number of an attribute, if it is there.
    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, RobotError> {
        Ok(self.numbers::<1>(name)?.map(|[x]| x))
    }

    /// The finite number of an attribute that must be there.
    pub(super) fn required_number(&self, name: &str) -> Result<f64, RobotError> {
        self.number(name)?.ok_or_else(|| self.refuse(format_args!("has no {name}; add {name}=\"...\"")))
    }
}
