//! What a problem asks beside joints, torques and time.

use super::Payload;
use super::key::Key;
use super::obstacles::{BodyPairs, Collision, Obstacle};
use super::references::Reference;
use super::tools::{Keep, Kept, ToolCost, ToolPose};

/// Poses of tools at the ends, what tools keep along the motion, what they cost, references over time, and
/// obstacles.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Task {
    /// Where tools are at the start.
    pub start_tools: Vec<ToolPose>,
    /// Where tools are at the end.
    pub end_tools: Vec<ToolPose>,
    /// What tools keep all along the motion.
    pub keep: Vec<Keep>,
    /// Running costs of tools.
    pub tool_costs: Vec<ToolCost>,
    /// References over time, whose distance costs something.
    pub references: Vec<Reference>,
    /// What the robot does not touch.
    pub obstacles: Vec<Obstacle>,
    /// With what it does not touch them.
    pub collision: Option<Collision>,
    /// What the robot carries from the start on, whose shapes are bodies too. Masses are those of the robot:
    /// [`Robot::with_payload`](costate::robot::Robot::with_payload) adds them.
    pub payloads: Vec<Payload>,
}

impl Task {
    /// Whether anything is asked.
    pub fn is_empty(&self) -> bool {
        *self == Self { payloads: self.payloads.clone(), ..Self::default() }
    }

    /// Whether bodies keep away from anything.
    pub(crate) fn has_collisions(&self) -> bool {
        let pairs = self.collision.as_ref().map(|collision| &collision.pairs);
        let has_pairs = match pairs {
            None | Some(BodyPairs::None) => false,
            Some(BodyPairs::These(pairs)) => !pairs.is_empty(),
            Some(BodyPairs::All) => true,
        };
        has_pairs || !self.obstacles.is_empty()
    }

    /// The key of its first part.
    pub(crate) fn first_key(&self) -> Option<Key> {
        let parts = [
            (self.start_tools.is_empty(), "start.tool", "frame"),
            (self.end_tools.is_empty(), "end.tool", "frame"),
            (self.keep.is_empty(), "keep", "kind"),
            (self.tool_costs.is_empty(), "cost.tool", "frame"),
            (self.references.is_empty(), "cost.reference", "times"),
            (self.obstacles.is_empty(), "obstacle", "kind"),
            (self.collision.is_none(), "collision", "capsules"),
        ];
        parts.into_iter().find(|(is_empty, ..)| !is_empty).map(|(_, table, name)| Key::entry(table, name, 0))
    }

    /// Whether the acceleration of a tool is limited.
    pub(crate) fn limits_accelerations(&self) -> bool {
        self.keep.iter().any(|keep| matches!(keep.kept, Kept::Acceleration { .. }))
    }

    /// Whether anything but references of joints is asked: what moves with the links.
    pub(crate) fn moves_with_links(&self) -> bool {
        let mut links = self.clone();
        links.references.retain(|reference| matches!(reference, Reference::Tool(_)));
        !links.is_empty()
    }

    /// With a tool here at the start. The start must leave joints free for it.
    #[must_use]
    pub fn with_start_tool(mut self, pose: ToolPose) -> Self {
        self.start_tools.push(pose);
        self
    }

    /// With a tool here at the end. The end must leave joints free for it.
    #[must_use]
    pub fn with_end_tool(mut self, pose: ToolPose) -> Self {
        self.end_tools.push(pose);
        self
    }

    /// With something that a tool keeps.
    #[must_use]
    pub fn with_keep(mut self, keep: Keep) -> Self {
        self.keep.push(keep);
        self
    }

    /// With a running cost of a tool.
    #[must_use]
    pub fn with_tool_cost(mut self, cost: ToolCost) -> Self {
        self.tool_costs.push(cost);
        self
    }

    /// With a reference over time.
    #[must_use]
    pub fn with_reference(mut self, reference: impl Into<Reference>) -> Self {
        self.references.push(reference.into());
        self
    }

    /// With an obstacle.
    #[must_use]
    pub fn with_obstacle(mut self, obstacle: Obstacle) -> Self {
        self.obstacles.push(obstacle);
        self
    }

    /// With the body of something that the robot carries from the start on; its mass is that of the robot
    /// already.
    #[must_use]
    pub fn with_payload(mut self, payload: Payload) -> Self {
        self.payloads.push(payload);
        self
    }

    /// With these bodies of the robot.
    #[must_use]
    pub fn with_collision(self, collision: Collision) -> Self {
        Self { collision: Some(collision), ..self }
    }
}
