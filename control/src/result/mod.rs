//! What a solve gives: figures, values over time, and their JSON form.

pub(crate) mod complete;
pub(crate) mod conjugate;
pub(crate) mod constraint_forces;
mod csv;
pub(crate) mod defect;
pub(crate) mod disconjugate;
mod forward;
pub(crate) mod infeasibility;
pub(crate) mod jacobi_fields;
pub(crate) mod limit_use;
pub(crate) mod limits;
pub(crate) mod mesh_nodes;
pub(crate) mod motion;
pub(crate) mod nodes;
pub(crate) mod polish_report;
pub(crate) mod quintic;
pub(crate) mod rates;
pub(crate) mod rows;
pub(crate) mod samples;
pub(crate) mod saved;
pub(crate) mod saved_start;
pub(crate) mod solution;
pub(crate) mod solved;
pub(crate) mod stage_times;
pub(crate) mod trajectory;
pub(crate) mod trajectory_error;
pub(crate) mod verify;
