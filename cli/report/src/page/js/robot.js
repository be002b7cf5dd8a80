// Poses of the links from positions of the joints: X_i = X_parent X_i(0) J_i(q_i). A floating or spherical joint
// is a chain: three slides or none, a quaternion, and two joints that are fixed.

const joints = stageData.joints;

const posesAt = (q) => {
  const poses = [];
  joints.forEach((joint) => {
    const standing = joint.parent === null ? joint.at : then(poses[joint.parent], joint.at);
    if (joint.kind === "fixed") return poses.push(standing);
    if (joint.kind === "quaternion") return poses.push(then(standing, turnOf(q.slice(joint.q, joint.q + 4))));
    const position = joint.ratio * q[joint.q] + joint.offset;
    const motion = joint.kind === "revolute" ? rotation(joint.axis, position)
      : [1, 0, 0, 0, 1, 0, 0, 0, 1, ...times3(joint.axis, position)];
    return poses.push(then(standing, motion));
  });
  return poses;
};

const carriedBy = (poses, joint) => (joint === null ? stillPlacement : poses[joint]);

// Positions of a tool at many times.
const toolPath = (tool, list) => list.map((time) =>
  placed(carriedBy(posesAt(positionsAt(time)), tool.joint), tool.at.slice(9)));

// Times between which the path of a tool is straight enough to be drawn.
const pathTimes = Array.from({ length: 241 }, (_, k) => startTime + (endTime - startTime) * k / 240);
