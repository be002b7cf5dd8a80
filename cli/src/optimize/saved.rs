//! A solution as JSON: what `--json` prints and `[start_from] file` reads.

use super::continuation::Points;
use costate_control::{Solution, Status, Trajectory};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::Path;

/// A solution; numbers that are not finite are null.
#[derive(Serialize)]
pub struct Saved<'a> {
    status: &'static str,
    cost: f64,
    /// Only where the problem has penalties.
    #[serde(skip_serializing_if = "Option::is_none")]
    penalty_cost: Option<f64>,
    /// Only where some is left.
    #[serde(skip_serializing_if = "Option::is_none")]
    smoothing: Option<f64>,
    final_time: f64,
    hamiltonian: f64,
    hamiltonian_drift: f64,
    costate_start: Costate,
    end_defect: f64,
    shooting_defect: f64,
    newton_iterations: usize,
    nodes: usize,
    conjugate_time: Option<f64>,
    trajectory: Nodes,
    /// Only with `--continue`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub continuation: Option<Points<'a>>,
}

#[derive(Serialize)]
struct Costate {
    y_q: Vec<f64>,
    y_p: Vec<f64>,
}

/// One entry per node; y = (y_q, y_p).
#[derive(Serialize, Deserialize)]
struct Nodes {
    t: Vec<f64>,
    q: Vec<Vec<f64>>,
    v: Vec<Vec<f64>>,
    p: Vec<Vec<f64>>,
    u: Vec<Vec<f64>>,
    y: Vec<Vec<f64>>,
}

/// What a start needs of a saved solution.
#[derive(Deserialize)]
struct Loaded {
    final_time: f64,
    trajectory: Nodes,
}

impl Saved<'_> {
    pub fn new(solution: &Solution, with_penalty: bool) -> Self {
        let Trajectory { t, q, v, p, u, y_q, y_p, .. } = solution.trajectory.clone();
        let y = y_q.into_iter().zip(y_p).map(|(y_q, y_p)| [y_q, y_p].concat()).collect();
        let (y_q, y_p) = solution.costate_start.clone();
        Self {
            status: solution.status.name(),
            cost: solution.cost,
            penalty_cost: with_penalty.then_some(solution.penalty_cost),
            smoothing: (solution.smoothing > 0.0).then_some(solution.smoothing),
            final_time: solution.final_time,
            hamiltonian: solution.hamiltonian,
            hamiltonian_drift: solution.hamiltonian_drift,
            costate_start: Costate { y_q, y_p },
            end_defect: solution.end_defect,
            shooting_defect: solution.shooting_defect,
            newton_iterations: solution.newton_iterations,
            nodes: solution.nodes,
            conjugate_time: solution.conjugate_time,
            trajectory: Nodes { t, q, v, p, u, y },
            continuation: None,
        }
    }

    /// Reads a solution of a robot of `n` joints.
    pub fn read(path: &Path, n: usize) -> Result<Solution, String> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| format!("{}: cannot be read ({error}); check the path", path.display()))?;
        let in_file = |message: String| {
            format!("{}: {message}; give a file that `costate optimize --save` wrote", path.display())
        };
        let loaded: Loaded = serde_json::from_str(&text)
            .map_err(|error| in_file(format!("not the solution of a problem ({error})")))?;
        loaded.trajectory.check(n).map_err(in_file)?;
        loaded.solution(n).map_err(|error| in_file(format!("not the solution of a problem ({error})")))
    }
}

impl Nodes {
    fn check(&self, n: usize) -> Result<(), String> {
        let count = self.t.len();
        if count < 2 || self.t.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err("`t` is not a rising list of at least two times".into());
        }
        let lists = [("q", &self.q, n), ("v", &self.v, n), ("p", &self.p, n), ("u", &self.u, n)];
        for (key, rows, width) in lists.into_iter().chain([("y", &self.y, 2 * n)]) {
            if rows.len() != count {
                return Err(format!("`{key}` has {} entries, `t` has {count}", rows.len()));
            }
            if let Some(row) = rows.iter().find(|row| row.len() != width) {
                return Err(format!("`{key}` has {} numbers a node; this robot has {width}", row.len()));
            }
        }
        Ok(())
    }
}

impl Loaded {
    /// The motion; figures that only solving gives are left at zero.
    fn solution(self, n: usize) -> serde_json::Result<Solution> {
        let Nodes { t, q, v, p, u, y } = self.trajectory;
        let (y_q, y_p): (Vec<_>, Vec<_>) = y.iter().map(|y| y.split_at(n)).unzip();
        serde_json::from_value(json!({
            "status": Status::Converged.name(),
            "cost": 0.0,
            "final_time": self.final_time,
            "hamiltonian": 0.0,
            "hamiltonian_drift": 0.0,
            "costate_start": [y_q[0], y_p[0]],
            "newton_iterations": 0,
            "nodes": t.len(),
            "trajectory": { "t": t, "q": q, "v": v, "p": p, "u": u, "y_q": y_q, "y_p": y_p },
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A saved motion of two nodes.
    fn text(t: &str, q: &str, y: &str) -> String {
        let rest = "\"v\":[[0],[0.1]],\"p\":[[0],[0.1]],\"u\":[[1],[-1]]";
        format!(
            "{{\"status\":\"mesh_limit\",\"final_time\":2,\"trajectory\":{{\"t\":{t},\"q\":{q},\"y\":{y},{rest}}}}}"
        )
    }

    fn read(name: &str, text: &str) -> Result<Solution, String> {
        let file = std::env::temp_dir().join(format!("costate_saved_{}_{name}.json", std::process::id()));
        std::fs::write(&file, text).unwrap();
        let solution = Saved::read(&file, 1);
        std::fs::remove_file(&file).unwrap();
        solution
    }

    #[test]
    fn what_is_saved_is_what_is_read() {
        let solution =
            read("whole", &text("[0,0.3]", "[[0.1],[0.30000000000000004]]", "[[1,2],[3,4]]")).unwrap();
        let again = serde_json::to_string(&Saved::new(&solution, false)).unwrap();
        let again = read("again", &again).unwrap();
        assert_eq!(again.trajectory, solution.trajectory);
        assert_eq!((again.final_time, again.costate_start), (2.0, (vec![1.0], vec![2.0])));
        assert_eq!(solution.trajectory.q[1][0], 0.30000000000000004);
    }

    #[test]
    fn what_is_no_motion_of_the_robot_is_refused_with_the_reason() {
        let (t, q, y) = ("[0,1]", "[[0],[1]]", "[[1,2],[3,4]]");
        for (name, text, reason) in [
            ("text", "cost: 1".into(), "not the solution of a problem"),
            ("short", text("[0]", q, y), "two times"),
            ("falling", text("[1,0]", q, y), "two times"),
            ("rows", text(t, "[[0]]", y), "`q` has 1 entries, `t` has 2"),
            ("joints", text(t, "[[0,1],[1,2]]", y), "`q` has 2 numbers a node; this robot has 1"),
            ("costate", text(t, q, "[[1],[3]]"), "`y` has 1 numbers a node; this robot has 2"),
            ("null", text(t, "[[0],[null]]", y), "null"),
        ] {
            let error = read(name, &text).unwrap_err();
            assert!(error.contains(reason), "{error}");
        }
    }
}
